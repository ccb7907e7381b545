// How meshes follow what numbers draw: which vertices lie on a drawn thing (by its label, its crack or its region),
// where on it, where they go with the variables, and forces on them pulled back, sum_k force_k . d position_k/dx.
// Places are kept in coordinates of the thing (axes of an ellipse, shares of pieces), so that a position is a smooth
// function of the variables and its derivative exact. Drawn things are counted behind those of the frame, in the order
// of the design. docs/theory/shape_gradient.md, section "Carrying a motion into the mesh", has what is done with them.

#include "optimize/parametric/followers.hpp"

#include "kerf/optimize.hpp"

namespace kerf {

using Eigen::VectorXd;

Eigen::Index variable_count(const Design& d) {
  Eigen::Index count = 0;
  for (const Drawn& one : d.drawn) count += one.lower.size();
  return count;
}

std::vector<Eigen::Index> first_variables(const Design& d) {
  std::vector<Eigen::Index> first;
  Eigen::Index next = 0;
  for (const Drawn& one : d.drawn) {
    first.push_back(next);
    next += one.lower.size();
  }
  return first;
}

std::vector<VectorXd> parts(const Design& d, const VectorXd& x) {
  std::vector<VectorXd> all;
  Eigen::Index first = 0;
  for (const Drawn& one : d.drawn) {
    all.push_back(x.segment(first, one.lower.size()));
    first += one.lower.size();
  }
  return all;
}

namespace {

/// What drawn things are in a mesh, counted behind what the frame has.
struct Numbers {
  Shape labels;
  Index crack, region;
};

/// Vertices on the next drawn thing.
std::vector<bool> vertices_on(const Drawn& d, const Mesh& mesh, Numbers& next) {
  const BodyPart part = shape_of(d).part;
  const Index label = part == BodyPart::Hole ? hole_label(next.labels, d.name) : none;
  const auto in_region = [&](Index t) { return t != none && region_of(mesh, t) == next.region; };
  std::vector<bool> on(mesh.points.size(), false);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    // The rim of a region are edges with it on one side only.
    const bool mine = part == BodyPart::Crack    ? mesh.crack[e] == next.crack
                      : part == BodyPart::Region ? in_region(mesh.sides[e][0]) != in_region(mesh.sides[e][1])
                                                 : mesh.label[e] == label;
    if (mine)
      for (const Index i : mesh.edges[e]) on[static_cast<std::size_t>(i)] = true;
  }
  next.crack += part == BodyPart::Crack ? 1 : 0;
  next.region += part == BodyPart::Region ? 1 : 0;
  return on;
}

}  // namespace

std::vector<Follower> followers(const Design& d, const VectorXd& at, const Problem& p, const Mesh& mesh) {
  std::vector<Follower> all;
  const std::vector<VectorXd> part = parts(d, at);
  Numbers next{p.frame, static_cast<Index>(p.frame.cracks.size()), static_cast<Index>(p.frame.regions.size())};
  for (std::size_t k = 0; k < d.drawn.size(); ++k) {
    const std::vector<bool> on = vertices_on(d.drawn[k], mesh, next);
    const auto spot = shape_of(d.drawn[k]).locate(part[k], mesh_size(p));
    for (std::size_t i = 0; i < on.size(); ++i)
      if (on[i]) all.push_back({static_cast<Index>(i), static_cast<Index>(k), spot(mesh.points[i])});
  }
  return all;
}

Points positions(const Design& d, const std::vector<Follower>& f, const VectorXd& x) {
  const std::vector<VectorXd> part = parts(d, x);
  Points at(2, static_cast<Eigen::Index>(f.size()));
  for (std::size_t i = 0; i < f.size(); ++i) {
    const auto k = static_cast<std::size_t>(f[i].drawn);
    at.col(static_cast<Eigen::Index>(i)) = shape_of(d.drawn[k]).position(f[i].spot, part[k]);
  }
  return at;
}

// The force on a follower times the derivative of its position, thing by thing.
VectorXd pull_back(const Design& d, const std::vector<Follower>& f, const VectorXd& x, const Points& force) {
  const std::vector<VectorXd> part = parts(d, x);
  const std::vector<Eigen::Index> first = first_variables(d);
  VectorXd sum = VectorXd::Zero(x.size());
  for (std::size_t i = 0; i < f.size(); ++i) {
    const auto k = static_cast<std::size_t>(f[i].drawn);
    shape_of(d.drawn[k])
        .pull(f[i].spot, part[k], force.col(static_cast<Eigen::Index>(i)), sum.segment(first[k], part[k].size()));
  }
  return sum;
}

// Cracks and inclusions take nothing from the body.
double area_of_holes(const Design& d, const VectorXd& x, VectorXd* gradient) {
  if (gradient) gradient->setZero(x.size());
  const std::vector<VectorXd> part = parts(d, x);
  const std::vector<Eigen::Index> first = first_variables(d);
  double area = 0;
  for (std::size_t k = 0; k < d.drawn.size(); ++k) {
    const DrawnShape& shape = shape_of(d.drawn[k]);
    if (!shape.add_area) continue;
    VectorXd by = VectorXd::Zero(part[k].size());
    shape.add_area(part[k], area, gradient ? &by : nullptr);
    if (gradient) gradient->segment(first[k], by.size()) = by;
  }
  return area;
}

}  // namespace kerf
