// Maps of clamped holes of a body that several processes hold in parts. The regular part of Green's tensor, w_j of
// (T.28), is an answer of the whole body and as smooth as the distance to its sides, so that the first process computes
// it on the mesh before the division: samples for the map everywhere [theory: T.31, T.32] and the value itself at the
// listed points. It is packed into bytes, and every process evaluates M F = u(x0) [theory: T.29] with the displacements
// of its own part. Functionals that need an integral of G + w over the body per point are refused. Derived in
// docs/theory/topological_derivatives.md, section "Clamped holes".

#include "topo/clamped_parts.hpp"

#include "solver/packer.hpp"
#include "topo/analysis.hpp"
#include "topo/map/fields.hpp"
#include "topo/map/green_of_body.hpp"
#include "topo/map/mask.hpp"

#include <stdexcept>

namespace kerf {

namespace {

void put(const Vec2& x, Packer& to) {
  to.put(Eigen::MatrixXd(x));
}
void put(const Mat2& m, Packer& to) {
  to.put(Eigen::MatrixXd(m));
}

template <typename T>
void put_all(const std::vector<T>& all, Packer& to) {
  to.put(all.size());
  for (const T& one : all) put(one, to);
}
template <typename T>
std::vector<T> all_from(Unpacker& from) {
  std::vector<T> all(from.get<std::size_t>());
  for (T& one : all) one = from.matrix<T>();
  return all;
}

// `samples_from` reads in the same order. The barriers are the walls' segments and are not sent.
void put(const GreenSamples& g, Packer& to) {
  to.put(g.walls.size());
  for (const auto& alike : g.walls) {
    to.put(alike.size());
    for (const Wall& w : alike) {
      put(w.a, to);
      put(w.b, to);
      put(w.axes, to);
      put(w.times, to);
    }
  }
  put_all(g.x, to);
  put_all(g.rest, to);
  to.put(g.error);
}

// Barriers are made from the walls again.
GreenSamples samples_from(Unpacker& from) {
  GreenSamples g;
  g.walls.resize(from.get<std::size_t>());
  for (auto& alike : g.walls) {
    alike.resize(from.get<std::size_t>());
    for (Wall& w : alike) {
      w.a = from.matrix<Vec2>();
      w.b = from.matrix<Vec2>();
      w.axes = from.matrix<Mat2>();
      w.times = from.matrix<Vec2>();
      g.barriers.emplace_back(w.a, w.b);
    }
  }
  g.x = all_from<Vec2>(from);
  g.rest = all_from<Mat2>(from);
  g.error = from.get<double>();
  return g;
}

void put(const GreenOfBody::Tensor& tensor, Packer& to) {
  put(tensor.samples, to);
  put_all(tensor.at, to);
}
GreenOfBody::Tensor tensor_from(Unpacker& from) {
  GreenSamples samples = samples_from(from);
  return {std::move(samples), all_from<Mat2>(from)};
}

/// `points` of the body, in their triangles; elsewhere 0.
GreenOfBody::Tensor tensor_of(const Model& m, const Field& s, double eps, std::span<const Vec2> candidates,
                              std::span<const Vec2> points) {
  GreenOfBody::Tensor tensor{.samples = sample_green(m, s, eps, candidates, locate(m.mesh, candidates)), .at = {}};
  GreenTensor green(m, s);
  const std::vector<Index> where = locate(m.mesh, points);
  for (std::size_t i = 0; i < points.size(); ++i)
    tensor.at.push_back(where[i] == none ? Mat2(Mat2::Zero()) : green.at(points[i], where[i], false).regular);
  return tensor;
}

}  // namespace

// Samples are taken at centroids that the mask leaves free: nearer to a feature no map asks for the tensor.
std::shared_ptr<const GreenOfBody> green_of_body(const Analysis& a, const Functional& j, const MapRequest& r,
                                                 std::span<const Vec2> points) {
  const Model& m = *a.model;
  if (needs_points(m, j, r.perturbation))
    throw Error(Fault::Usage,
                "functional \"" + j.kind +
                    "\": a clamped hole takes an integral over the whole body per point, which no process "
                    "has; use an energy, or a functional that is linear in the state");
  std::vector<Vec2> candidates;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) candidates.push_back(centroid(m.mesh, t));
  const std::vector<bool> masked = too_close(m, j, candidates, clear_radii * r.radius, r.radius);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (!masked[i]) candidates[kept++] = candidates[i];
  candidates.resize(kept);
  auto green = std::make_shared<GreenOfBody>();
  green->points.assign(points.begin(), points.end());
  green->body = tensor_of(m, *a.state, r.radius, candidates, points);
  if (a.measured) green->measured = tensor_of(*a.measured_model, *a.measured, r.radius, candidates, points);
  return green;
}

// Listed points are compared bit by bit: all processes have them from the same case.
Mat2 GreenOfBody::regular(const Tensor& tensor, const Vec2& x) const {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i] == x) return tensor.at[i];
  return interpolate(tensor.samples, x);
}

std::string packed(const GreenOfBody& green) {
  Packer to;
  put_all(green.points, to);
  put(green.body, to);
  to.put(green.measured.has_value());
  if (green.measured) put(*green.measured, to);
  return std::move(to).take();
}

std::shared_ptr<const GreenOfBody> green_from(std::string_view packed) {
  Unpacker from(packed);
  auto green = std::make_shared<GreenOfBody>();
  green->points = all_from<Vec2>(from);
  green->body = tensor_from(from);
  if (from.get<bool>()) green->measured = tensor_from(from);
  return green;
}

// The analysis may share its fields: they are copied, and the tensor put beside them.
void take_green(std::shared_ptr<const GreenOfBody> green, Analysis& a) {
  auto fields = a.fields ? std::make_shared<MapFields>(*a.fields) : std::make_shared<MapFields>();
  fields->green = std::move(green);
  a.fields = std::move(fields);
}

}  // namespace kerf
