// The condensed system K x = F: every triangle is eliminated onto its traces (E.4), seen through the numbering with
// jumps,
//   K = sum_T R_T' K_T R_T,   F = sum_T R_T' (F_T - K_T m_prescribed) + tractions,
// R_T from the unknowns to what triangle T sees, base plus jump on the right side of a crack. Where a material is
// nearly incompressible a penalty raises the compliance of the mean pressure of each triangle by a, a mu = 1e-3, and
// the traces t_m that pay it back are kept [theory: E.12, E.14]. Triangles are condensed by eights on several threads.
// Bits do not depend on how many: an entry between edges gets at most two contributions, whose sum has no order;
// entries of vertices, with more, are added in the order of the triangles. Derived in docs/theory/elements.md.

#include "solver/system/assemble.hpp"
#include "solver/system/corner_loads.hpp"

#include "base/parallel.hpp"
#include "solver/system/pattern.hpp"

#include <algorithm>
#include <atomic>

namespace kerf {

namespace {

// The local problems of displacement elements are not mixed, those with stresses at vertices do not degenerate.
constexpr bool needs_penalty(const Element& e) {
  return e.at_vertices == AtVertices::Nothing || e.at_vertices == AtVertices::Rotation;
}

// Penalty::a times mu, or 0 where nothing asks for one.
double penalty_for(const Element& e, const Scene& scene) {
  // Below this compliance c mu plain condensation loses more than two digits: nu > 0.498 in plane strain. As large a
  // penalty costs as many digits, and the iterations shrink the error by about a/(a + 1/mu).
  constexpr double small = 1e-3;
  const std::vector<Material> all = all_materials(scene);
  const bool asked = std::any_of(all.begin(), all.end(), [](const Material& m) { return m.c * m.mu < small; });
  return asked && needs_penalty(e) ? small : 0;
}

// See ForceMoments; per edge of the mesh, a column.
// Components that the support does not hold have none.
Eigen::Matrix4Xd cubic_traces(const Assembly& from) {
  const Mesh& mesh = from.mesh;
  const EdgeRule rule = gauss(data_points);
  Eigen::Matrix4Xd coefficients = Eigen::Matrix4Xd::Zero(4, static_cast<Eigen::Index>(mesh.edges.size()));
  for (std::size_t i = 0; i < from.scene.supports.size(); ++i) {
    const Support& support = from.scene.supports[i];
    const std::vector<Index>& edges = labeled(from.data, support.label);
    for (std::size_t j = 0; j < edges.size(); ++j) {
      const Index e = edges[j];
      const Vec2 n = outward_normal(mesh, e);
      for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
        Vec2 value = from.data.supports[i].values[j].at.col(q);
        if (!support.first) value[0] = 0;
        if (!support.second) value[1] = 0;
        if (support.normal_frame) value = value[0] * n + value[1] * Vec2(-n.y(), n.x());
        for (int k = 2; k < 4; ++k)
          coefficients.col(e).segment<2>(2 * (k - 2)) += rule.w[q] * legendre(k, rule.s[q]) * value;
      }
    }
  }
  return coefficients;
}

bool has_cubic_traces(const Assembly& from) {
  return from.kernel.element.at_vertices == AtVertices::Stress;
}

// Means of the eigenstrain against the stress functions.
// `weigh` with the eigenstrain for weights is its inner product with each stress function.
Eigen::VectorXd strain_moments(const Assembly& from, const Triangle& shape, Index t) {
  const TriangleRule& rule = from.kernel.load;
  const Eigen::Index n = rule.w.size();
  Fields w{strain_at(from.data.strain, t, rule.x) * rule_weights(rule, shape).asDiagonal(), Points::Zero(2, n),
           Eigen::RowVectorXd::Zero(n)};
  return weigh(from.kernel, shape, rule_points(rule, shape), w).head(stress_count(from.kernel.element));
}

// Body force and eigenstrain of one triangle.
void set_force(const Assembly& from, Index t, System& a) {
  const Triangle shape = triangle(from.mesh, from.skeleton, t);
  const int moments = displacement_count(from.kernel.element);
  if (from.scene.body)
    a.force.col(t).head(moments) =
        force_moments(from.kernel, shape, body_force(from.data, from.scene, t, rule_points(from.kernel.load, shape)));
  if (!from.data.strain.empty())
    a.force.col(t).tail(stress_count(from.kernel.element)) = strain_moments(from, shape, t);
}

// Triangles that are eliminated side by side, and what that finds.
class Group {
 public:
  static constexpr Index most = 8;

  // The shares of `count` triangles from `first` on; a.traces keeps what the way back needs to know.
  void condense(const Assembly& from, Index first, Index count, System& a) {
    for (Index i = 0; i < count; ++i) {
      const Index t = first + i;
      set_force(from, t, a);
      const Material& material = material_of(from.mesh, from.scene, t);
      LocalTriangle& local = locals_[static_cast<std::size_t>(i)];
      local = {triangle(from.mesh, from.skeleton, t), &material, force_of(a, t), {.a = a.penalty / material.mu}};
      a.alike->share(t, local);
    }
    const auto n = static_cast<std::size_t>(count);
    kerf::condense(from.kernel, std::span(locals_).first(n), std::span(shares_).first(n));
    for (Index i = 0; a.penalty > 0 && i < count; ++i) {
      const Condensed& c = share(i);
      a.traces.col(first + i) << c.trace, c.own, c.by_theta;
    }
  }
  Condensed& share(Index i) {
    return shares_[static_cast<std::size_t>(i)];
  }

 private:
  std::array<LocalTriangle, most> locals_;
  std::array<Condensed, most> shares_;
};

// Without unknowns at vertices every entry gets at most two contributions, one from each side of an edge: their sum
// does not depend on the order, so that adding them atomically is deterministic.
void add_atomically(double& target, double value) {
  std::atomic_ref<double>(target).fetch_add(value, std::memory_order_relaxed);
}

// The unknowns that a triangle sees and that are solved for.
struct Entry {
  int local;
  Index row;
};
struct MatrixEntries {
  std::array<Entry, 2 * max_skeleton> all;
  int count = 0;
};

// Adds a triangle's share to F, less what the prescribed values do.
// A value of what T sees counts twice where base and jump are both unknowns: entry (i, row of base) and (i, row of
// jump).
MatrixEntries scatter_loads(const Assembly& from, Index t, Condensed& c, System& a) {
  const Skeleton& s = from.skeleton;
  const Ordering& o = from.ordering;
  const Seen view = seen(from.mesh, s, t);
  MatrixEntries entries;
  for (int i = 0; i < view.count; ++i) {
    const double value = s.prescribed[view.base[i]] + (view.jump[i] != none ? s.prescribed[view.jump[i]] : 0);
    if (value != 0) c.F -= value * c.K.col(i);
    if (o.row[view.base[i]] != none) entries.all[entries.count++] = {i, o.row[view.base[i]]};
    if (view.jump[i] != none && o.row[view.jump[i]] != none) entries.all[entries.count++] = {i, o.row[view.jump[i]]};
  }
  for (int p = 0; p < entries.count; ++p) add_atomically(a.F[entries.all[p].row], c.F[entries.all[p].local]);
  return entries;
}

// The same, and to K.
void scatter(const Assembly& from, Index t, Condensed& c, System& a) {
  const Skeleton& s = from.skeleton;
  const Ordering& o = from.ordering;
  const bool in_sequence = s.per_vertex > 0;
  const auto [entries, used] = scatter_loads(from, t, c, a);
  for (int p = 0; p < used; ++p) {
    for (int q = 0; q < used; ++q) {
      if (entries[p].row < entries[q].row) continue;
      double& target = a.K->values[place(o, *a.K, entries[p].row, entries[q].row)];
      const double value = c.K(entries[p].local, entries[q].local);
      // Only a base unknown's own edge is shared by two triangles.
      if (!in_sequence && entries[p].local / s.per_edge == entries[q].local / s.per_edge)
        add_atomically(target, value);
      else
        target += value;
    }
  }
}

void condense_and_scatter(const Assembly& from, System& a) {
  const Index triangles = static_cast<Index>(from.mesh.triangles.size());
  parallel_for(triangles, from.threads, [&](Index begin, Index end) {
    Group group;
    for (Index first = begin; first < end; first += Group::most) {
      const Index count = std::min(Group::most, end - first);
      group.condense(from, first, count, a);
      for (Index i = 0; i < count; ++i) scatter(from, first + i, group.share(i), a);
    }
  });
}

// Around a vertex many triangles meet: they are condensed in parallel but added in their order.
void condense_then_scatter(const Assembly& from, System& a) {
  const Index triangles = static_cast<Index>(from.mesh.triangles.size());
  constexpr Index batch = 2048;
  std::vector<Condensed> condensed(batch);
  for (Index first = 0; first < triangles; first += batch) {
    const Index size = std::min(batch, triangles - first);
    parallel_for(size, from.threads, [&](Index begin, Index end) {
      Group group;
      for (Index i = begin; i < end; ++i) {
        group.condense(from, first + i, 1, a);
        condensed[i] = group.share(0);
      }
    });
    for (Index i = 0; i < size; ++i) scatter(from, first + i, condensed[i], a);
  }
}

}  // namespace

ForceMoments force_of(const System& a, Index t) {
  return a.force.cols() == 0 ? ForceMoments() : ForceMoments(a.force.col(t));
}

namespace {

// Room for the loads of triangles, with those of cubic traces.
Eigen::MatrixXd empty_force(const Assembly& from) {
  const Element& e = from.kernel.element;
  const Eigen::Index triangles = static_cast<Eigen::Index>(from.mesh.triangles.size());
  Eigen::MatrixXd force;
  const bool strained = !from.data.strain.empty();
  if (from.scene.body || has_cubic_traces(from) || strained)
    force.setZero(
        displacement_count(e) + (has_cubic_traces(from) ? cubic_trace_count : 0) + (strained ? stress_count(e) : 0),
        triangles);
  if (has_cubic_traces(from)) {
    const Eigen::Matrix4Xd cubic = cubic_traces(from);
    for (Index t = 0; t < static_cast<Index>(triangles); ++t)
      for (int i = 0; i < 3; ++i)
        force.col(t).segment<4>(displacement_count(e) + 4 * i) = cubic.col(from.mesh.edges_of[t][i]);
  }
  return force;
}

// The loads on edges.
void add_tractions(const Assembly& from, System& a) {
  a.tractions = traction_loads(from.mesh, from.kernel, from.skeleton, from.data);
  if (has_unseen_traces(from.kernel.element))
    fit_corner_loads(from.mesh, from.kernel, from.scene, from.skeleton, a.tractions);
  for (Index u = 0; u < from.skeleton.total; ++u)
    if (from.ordering.row[u] != none) a.F[from.ordering.row[u]] += a.tractions[u];
}

// Whether body force, eigenstrain or prescribed values act on it. Sets the first two.
bool is_loaded(const Assembly& from, Index t, System& a) {
  set_force(from, t, a);
  if (a.force.cols() > 0 && !a.force.col(t).isZero(0)) return true;
  const Seen view = seen(from.mesh, from.skeleton, t);
  for (int i = 0; i < view.count; ++i)
    for (const Index u : {view.base[i], view.jump[i]})
      if (u != none && from.skeleton.prescribed[u] != 0) return true;
  return false;
}

}  // namespace

// K does not depend on loads, nor do trace and by_theta of the penalty: triangles that no load acts on are left out.
System assemble_loads(const Assembly& from, const System& like, bool with_matrix) {
  System a{.penalty = like.penalty, .force = empty_force(from), .traces = like.traces, .alike = like.alike};
  if (with_matrix) a.K = like.K;
  // What the loads before did to the mean trace: triangles that bear none now are not condensed again.
  if (a.traces.rows() > 0) a.traces.row(a.traces.rows() - 2).setZero();
  a.F = Eigen::VectorXd::Zero(from.ordering.size);
  const auto add = [&](Index begin, Index end) {
    Group group;
    for (Index t = begin; t < end; ++t) {
      if (!is_loaded(from, t, a)) continue;
      group.condense(from, t, 1, a);
      scatter_loads(from, t, group.share(0), a);
    }
  };
  const bool held_at_rest = std::ranges::all_of(from.skeleton.prescribed, [](double u) { return u == 0; });
  const Index triangles =
      a.force.cols() == 0 && held_at_rest ? 0 : static_cast<Index>(from.mesh.triangles.size());  // none is loaded
  if (from.skeleton.per_vertex > 0)
    add(0, triangles);  // around a vertex many triangles meet, which are added in their order
  else
    parallel_for(triangles, from.threads, add);
  add_tractions(from, a);
  return a;
}

namespace {

/// Before any triangle is condensed.
System begun(const Assembly& from) {
  System a;
  a.penalty = from.plain ? 0 : penalty_for(from.kernel.element, from.scene);
  if (a.penalty > 0)
    a.traces.resize(skeleton_count(from.kernel.element) + 2, static_cast<Eigen::Index>(from.mesh.triangles.size()));
  a.force = empty_force(from);
  a.alike = std::make_shared<const CongruentTriangles>(from.mesh, from.kernel, from.skeleton, from.scene, from.data,
                                                       a.penalty, from.threads);
  return a;
}

}  // namespace

// For solves in parts: each part condenses for itself, on the process that has it.
System assemble_without_matrix(const Assembly& from) {
  System a = begun(from);
  a.F = Eigen::VectorXd::Zero(from.ordering.size);
  // Only a penalty needs what condensing finds.
  parallel_for(static_cast<Index>(from.mesh.triangles.size()), from.threads, [&](Index begin, Index end) {
    Group group;
    for (Index first = begin; first < end; first += Group::most) {
      const Index count = std::min(Group::most, end - first);
      if (a.penalty > 0)
        group.condense(from, first, count, a);
      else
        for (Index t = first; a.force.cols() > 0 && t < first + count; ++t) set_force(from, t, a);
    }
  });
  add_tractions(from, a);
  return a;
}

System assemble(const Assembly& from) {
  System a = begun(from);
  *a.K = pattern(from.ordering);
  a.F = Eigen::VectorXd::Zero(from.ordering.size);
  if (from.skeleton.per_vertex > 0)
    condense_then_scatter(from, a);
  else
    condense_and_scatter(from, a);
  add_tractions(from, a);
  return a;
}

}  // namespace kerf
