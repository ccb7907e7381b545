// Where the data of an expansion jump: weights and targets of J, the body force, an eigenstrain. Nothing is known of
// these functions but their values. All of them at a place form one vector, taken at fixed values of the fields; each
// quarter of an edge of the mesh is bisected towards the half that changes more. A jump keeps its size under halving, a
// smooth function does not, which is what tells them apart; what lies between two samples of a quarter is not seen.
// Crossings are joined within triangles to segments, from which masks and validations keep away.
// docs/theory/validation.md has the rule, section "The verdict".

#include "topo/map/jumps.hpp"

#include "base/parallel.hpp"
#include "solver/data.hpp"
#include "solver/system.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace kerf {

namespace {

// The data at places, with the state and the material left as they are.
class PlaceData {
 public:
  PlaceData(const Model& m, const Functional& j) : m_(m), material_(m.scene.material) {
    for (const Term& term : j.terms)
      if (term.density && term.uses_place) terms_.push_back(&term);
  }
  bool empty() const {
    return terms_.empty() && !m_.scene.body && !has_eigenstrain(m_.scene);
  }
  // t: a triangle beside the place, whose region has the eigenstrain.
  // The fields are arbitrary and not 0, so that a density keeps its dependence on the place.
  std::vector<double> at(const Vec2& x, Index t) const {
    std::vector<double> v;
    for (const Term* term : terms_) {
      const Density d = term->density({.x = x,
                                       .stress = (Mat2() << 1, 0.3, 0.3, -0.7).finished(),
                                       .displacement = Vec2(0.6, -0.4),
                                       .rotation = 0.2,
                                       .material = material_});
      v.insert(v.end(), {d.value, d.by_stress(0, 0), d.by_stress(1, 1), d.by_stress(0, 1), d.by_displacement.x(),
                         d.by_displacement.y(), d.by_rotation});
    }
    if (m_.scene.body) add(m_.scene.body(x), v);
    if (has_eigenstrain(m_.scene)) {
      const Eigenstrain* e = eigenstrain_of(m_.mesh, m_.scene, t);
      add(e ? e->normal(x) : Vec2(Vec2::Zero()), v);
      add(e ? e->shear(x) : Vec2(Vec2::Zero()), v);
    }
    return v;
  }

 private:
  static void add(const Vec2& of, std::vector<double>& v) {
    v.insert(v.end(), {of.x(), of.y()});
  }
  const Model& m_;
  const Material material_;
  std::vector<const Term*> terms_;
};

// The component that changes most from a to b, against its size.
double change(const std::vector<double>& a, const std::vector<double>& b, const std::vector<double>& size) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    if (size[k] > 0) most = std::max(most, std::abs(a[k] - b[k]) / size[k]);
  return most;
}

constexpr double jump_counts = 1e-3;  // of the size of the data
constexpr int quarters = 4;

// Sizes are the largest values at centroids: what counts as a jump is relative to them.
class JumpFinder {
 public:
  JumpFinder(const Model& m, const PlaceData& data) : m_(m), data_(data) {
    for (std::size_t t = 0; t < m.mesh.triangles.size(); ++t) {
      const std::vector<double> v = data.at(centroid(m.mesh, static_cast<Index>(t)), static_cast<Index>(t));
      size_.resize(v.size(), 0);
      for (std::size_t k = 0; k < v.size(); ++k)
        if (std::isfinite(v[k])) size_[k] = std::max(size_[k], std::abs(v[k]));
    }
  }

  // Four quarters: two jumps on one edge are told apart where they lie in different ones.
  std::vector<Vec2> on_edge(Index e) const {
    const auto& [left, right] = m_.mesh.sides[e];
    const Index t = left != none ? left : right;
    const Vec2 a = m_.mesh.points[m_.mesh.edges[e][0]], b = m_.mesh.points[m_.mesh.edges[e][1]];
    std::vector<Vec2> found;
    Sampled from{a, data_.at(a, t)};
    for (int q = 1; q <= quarters; ++q) {
      const Vec2 x = a + (b - a) * q / quarters;
      Sampled to{x, data_.at(x, t)};
      if (const auto at = between(from, to, t)) found.push_back(*at);
      from = std::move(to);
    }
    return found;
  }

 private:
  struct Sampled {
    Vec2 x;
    std::vector<double> v;
  };
  // A change that halving the distance does not lessen. A smooth one is a tenth after four halvings.
  std::optional<Vec2> between(Sampled from, Sampled to, Index t) const {
    constexpr int halvings = 40;
    const double whole = change(from.v, to.v, size_);
    for (int k = 0; k < halvings; ++k) {
      if (!(change(from.v, to.v, size_) > std::max(jump_counts, 0.1 * whole))) return std::nullopt;
      const Vec2 x = 0.5 * (from.x + to.x);
      Sampled middle{x, data_.at(x, t)};
      (change(from.v, middle.v, size_) > change(middle.v, to.v, size_) ? to : from) = std::move(middle);
    }
    return to.x;
  }

  const Model& m_;
  const PlaceData& data_;
  std::vector<double> size_;
};

}  // namespace

// Each crossing as a point, and segments between crossings of two edges of a triangle.
std::vector<std::pair<Vec2, Vec2>> jumps_of_data(const Model& m, const Functional& j) {
  const PlaceData data(m, j);
  std::vector<std::pair<Vec2, Vec2>> all;
  if (data.empty()) return all;
  const JumpFinder finder(m, data);
  std::vector<std::vector<Vec2>> crossings(m.mesh.edges.size());
  parallel_for(static_cast<Index>(crossings.size()), m.threads, [&](Index begin, Index end) {
    for (Index e = begin; e < end; ++e) crossings[static_cast<std::size_t>(e)] = finder.on_edge(e);
  });
  for (const std::vector<Vec2>& on : crossings)
    for (const Vec2& x : on) all.emplace_back(x, x);
  for (const std::array<Index, 3>& edges : m.mesh.edges_of)
    for (std::size_t i = 0; i < 3; ++i)
      for (const Vec2& a : crossings[edges[i]])
        for (const Vec2& b : crossings[edges[(i + 1) % 3]]) all.emplace_back(a, b);
  return all;
}

}  // namespace kerf
