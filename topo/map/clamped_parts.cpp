// Maps of clamped holes of a body that several processes hold in parts. The regular part of Green's tensor, w_j of
// (T.28), is an answer of the whole body and as smooth as the distance to its sides, so that the first process computes
// it on the mesh before the division: samples for the map everywhere [theory: T.31, T.32] and the value itself at the
// listed points. It is packed into bytes, and every process evaluates M F = u(x0) [theory: T.29] with the displacements
// of its own part. Functionals that need an integral of G + w over the body per point are refused. Derived in
// docs/theory/topological_derivatives.md, section "Clamped holes".

#include "topo/clamped_parts.hpp"

#include "base/packer.hpp"
#include "topo/analysis.hpp"
#include "topo/map/fields.hpp"
#include "topo/map/green_of_body.hpp"
#include "topo/map/mask.hpp"

#include <stdexcept>

namespace kerf {

template <typename Visit, Like<Wall> T>
static void fields(Visit& visit, T& w) {
  visit(w.a, w.b, w.axes, w.times);
}

template <typename Visit, Like<GreenSamples> T>
static void fields(Visit& visit, T& g) {
  visit(g.walls, g.x, g.rest, g.error);
}

template <typename Visit, Like<GreenOfBody::Tensor> T>
static void fields(Visit& visit, T& tensor) {
  visit(tensor.samples, tensor.at);
}

template <typename Visit, Like<GreenOfBody> T>
static void fields(Visit& visit, T& green) {
  visit(green.points, green.body, green.measured);
}

namespace {

/// Barriers are the walls' segments and are not sent.
void set_barriers(GreenSamples& g) {
  for (const auto& alike : g.walls)
    for (const Wall& w : alike) g.barriers.emplace_back(w.a, w.b);
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
  to(green);
  return std::move(to).take();
}

std::shared_ptr<const GreenOfBody> green_from(std::string_view packed) {
  Unpacker from(packed);
  auto green = std::make_shared<GreenOfBody>();
  from(*green);
  set_barriers(green->body.samples);
  if (green->measured) set_barriers(green->measured->samples);
  return green;
}

// The analysis may share its fields: they are copied, and the tensor put beside them.
void take_green(std::shared_ptr<const GreenOfBody> green, Analysis& a) {
  auto fields = a.fields ? std::make_shared<MapFields>(*a.fields) : std::make_shared<MapFields>();
  fields->green = std::move(green);
  a.fields = std::move(fields);
}

}  // namespace kerf
