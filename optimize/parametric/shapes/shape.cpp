// The table of drawn things looked up, and what several of them need: constraints on one thing, cosines with their
// derivatives, places on polylines, names and boxes of points. A kind of thing is a row of functions (shape.hpp): how
// many variables it has, what it draws, where vertices lie on it, what keeps it meshable; each is in a file of its own
// here. Constraints of a thing see its own variables alone: `own_constraint` puts the derivative to where these stand
// in the design. What is wrong with a thing is Error(Usage) with its name.

#include "optimize/parametric/shapes/shape.hpp"

#include "geometry/plane.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

using Eigen::VectorXd;

const DrawnShape& shape_of(const Drawn& d) {
  for (const DrawnShape* shape : drawn_shapes)
    if (shape->kind == d.kind) return *shape;
  throw Error(Fault::Usage, fmt::format("nothing draws '{}'", d.name));
}

void require(bool good, const Drawn& d, const std::string& what) {
  if (!good) throw Error(Fault::Usage, fmt::format("the design of {}: {}", name(d), what));
}

double mesh_size(const Problem& p) {
  return target_size(p.sizing, p.frame);
}

Index hole_label(Shape& shape, const std::string& name) {
  const std::string label = "hole:" + name;
  const auto found = std::find(shape.labels.begin(), shape.labels.end(), label);
  if (found != shape.labels.end()) return static_cast<Index>(found - shape.labels.begin());
  shape.labels.push_back(label);
  return static_cast<Index>(shape.labels.size()) - 1;
}

Constraint own_constraint(std::string what, Eigen::Index first, Eigen::Index count,
                          std::function<double(const VectorXd& v, VectorXd& gradient)> value) {
  return {std::move(what), [=](const VectorXd& x, VectorXd* gradient) {
            VectorXd by = VectorXd::Zero(count);
            const double c = value(x.segment(first, count), by);
            if (gradient) {
              gradient->setZero(x.size());
              gradient->segment(first, count) = by;
            }
            return c;
          }};
}

// dc/da = b/(|a||b|) - c a/|a|^2; of a vector without length no direction is known.
double cosine(const Vec2& a, const Vec2& b, Vec2& by_a, Vec2& by_b) {
  const double la = a.norm(), lb = b.norm();
  if (!(la > 0) || !(lb > 0)) {
    by_a = by_b = Vec2::Zero();
    return 1;
  }
  const double c = a.dot(b) / (la * lb);
  by_a = b / (la * lb) - c * a / (la * la);
  by_b = a / (la * lb) - c * b / (lb * lb);
  return c;
}

std::vector<std::string> coordinate_names(Eigen::Index count) {
  std::vector<std::string> names;
  for (Eigen::Index i = 0; i < count; ++i) names.push_back(fmt::format("{}{}", i % 2 == 0 ? "x" : "y", i / 2 + 1));
  return names;
}

std::string radius_in_words(const Guess& g) {
  return fmt::format("radius {:.3g}", g.size);
}

CoordinateBox box_of_points(const Drawn& d) {
  CoordinateBox box{Vec2::Constant(infinity), {}};
  box.high = -box.low;
  for (Eigen::Index i = 0; i < d.lower.size(); i += 2) {
    box.low = box.low.cwiseMin(d.lower.segment<2>(i));
    box.high = box.high.cwiseMax(d.upper.segment<2>(i));
  }
  return box;
}

Spot place_on(const std::vector<Vec2>& points, bool closed, const Vec2& x) {
  const auto count = static_cast<Index>(points.size()) - (closed ? 0 : 1);
  Spot spot{.piece = 0, .pieces = count};
  double least = 0;
  for (Index i = 0; i < count; ++i) {
    const Vec2& a = points[static_cast<std::size_t>(i)];
    const Vec2& b = points[static_cast<std::size_t>(i + 1) % points.size()];
    const double away = distance(x, a, b);
    if (i > 0 && away >= least) continue;
    least = away;
    spot.piece = i;
    spot.part = foot(x, a, b);
  }
  return spot;
}

}  // namespace kerf
