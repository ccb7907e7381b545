// The unknowns of the condensed system: displacements m at the Gauss points of edges, two components in the frame of
// the edge, values at vertices where the element has them, and behind all of these the jumps j on crack edges,
//   m_right = m_left + j   [theory: C.3],   j_n = [u].n >= 0, p_n >= 0 at the Gauss points where faces may touch (C.4).
// On crack edges frames are (normal, tangent), those of the true curve where a crack is curved. Prescribed
// displacements are projections in L2, which at Gauss points with weights w is m_g = sum_q w_q phi_g(s_q) u(s_q)/w_g
// (E.5), and moments of tractions are |e| sum_q w_q phi_g(s_q) t(s_q). Jumps that have a gap are counted from first
// contact, -gap prescribed (C.21, C.22). Which combinations of traces no triangle sees is marked for elements that have
// some. Derived in docs/theory/contact.md, section Jumps as unknowns, and docs/theory/elements.md, section
// Hybridization.

#include "solver/system/skeleton.hpp"
#include "geometry/topology.hpp"
#include "solver/state/solve.hpp"

#include <fmt/core.h>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

Mat2 edge_frame(const Mesh& mesh, Index e) {
  Mat2 f;
  f << normal(mesh, e), tangent(mesh, e);
  return f;
}

void check_finite(const Vec2& value, const Vec2& x, const char* what) {
  if (!value.allFinite())
    throw Error(Fault::Numerics, fmt::format("the {} is not finite at ({:.6g}, {:.6g})", what, x.x(), x.y()));
}

// A crack whose faces can part.
bool opens(const Mesh& mesh, const Scene& scene, Index e) {
  return mesh.crack[e] != none && scene.laws[mesh.crack[e]].kind != CrackLaw::Kind::Bonded;
}

// As `require`; the element does not fit the scene.
void need(const Element& e, Ability can) {
  if (const auto why = refusal(e, can)) throw Error(Fault::Numerics, *why);
}

void check_element(const Mesh& mesh, const Element& e, const Scene& scene) {
  if (!mesh.region.empty()) need(e, can_have_regions);
  if (has_eigenstrain(scene)) need(e, can_be_strained);
  if (std::ranges::any_of(all_materials(scene), [](const Material& m) { return !(m.c > 0); }))
    need(e, can_be_incompressible);
  for (std::size_t crack = 0; crack < mesh.cracks.size(); ++crack) {
    const auto kind = scene.laws[crack].kind;
    if (mesh.cracks[crack].empty() || kind == CrackLaw::Kind::Bonded) continue;
    need(e, can_open);
    if (kind == CrackLaw::Kind::Unilateral) need(e, can_contact);
    if (has_pressure(scene.laws[crack])) need(e, can_press_cracks);
  }
}

// Directions at a point of a curved edge: the normal of its polynomial on the side of `chord`, and that turned.
Mat2 frame_on_curve(const Mesh& mesh, const Skeleton& s, Index e, double at, const Vec2& chord) {
  const Vec2 n = normal_at(on_edge(mesh, s.curvatures, e, at), chord).normalized();
  return (Mat2() << n, Vec2(-n.y(), n.x())).finished();
}

// Frames of curved cracks: the true normal, on the side of the chord's.
void bend(const Mesh& mesh, const Kernel& k, const Scene& scene, Skeleton& s) {
  s.bent_at.assign(mesh.edges.size(), none);
  if (!is_mixed(k.element)) return;
  for (std::size_t crack = 0; crack < mesh.cracks.size(); ++crack) {
    for (const CrackEdge& c : mesh.cracks[crack]) {
      const bool bowed = curvature_at(s.curvatures, c.edge);
      if (!bowed && !scene.laws[crack].normal) continue;
      s.bent_at[c.edge] = static_cast<Index>(s.bent.size());
      const Vec2& a = mesh.points[mesh.edges[c.edge][0]];
      const Vec2& b = mesh.points[mesh.edges[c.edge][1]];
      const Vec2 chord = normal(mesh, c.edge);
      for (int g = 0; g < points_per_edge(k.element); ++g) {
        if (bowed) {
          s.bent.push_back(frame_on_curve(mesh, s, c.edge, k.trace.s[g], chord));
          continue;
        }
        Vec2 n = scene.laws[crack].normal(a + k.trace.s[g] * (b - a));
        if (n.dot(chord) < 0) n = -n;
        s.bent.push_back((Mat2() << n, Vec2(-n.y(), n.x())).finished());
      }
    }
  }
}

// Normal jumps are counted from where the faces touch.
void shift_by_gaps(const Mesh& mesh, const Kernel& k, const Scene& scene, Skeleton& s) {
  for (std::size_t crack = 0; crack < mesh.cracks.size(); ++crack) {
    if (!has_gap(scene.laws[crack])) continue;
    for (const CrackEdge& c : mesh.cracks[crack]) {
      const EdgeLine line = edge_line(mesh, c.edge);
      for (int g = 0; g < points_per_edge(k.element); ++g) {
        const Vec2 x = on_edge(mesh, s.curvatures, c.edge, k.trace.s[g]).x, gap = scene.laws[crack].gap(x, line.n);
        check_finite(gap, x, "gap of a crack");
        s.prescribed[s.jump[c.edge] + 2 * g] = -gap.x();
      }
    }
  }
}

// The frames of a curved edge that is held along its normal.
void bend_roller(const Mesh& mesh, const Kernel& k, Index e, const Vec2& outward, Skeleton& s) {
  s.bent_at[e] = static_cast<Index>(s.bent.size());
  for (int g = 0; g < points_per_edge(k.element); ++g)
    s.bent.push_back(frame_on_curve(mesh, s, e, k.trace.s[g], outward));
}

// Displacement elements take the value in the middle of the edge; values at corners come from support_corners.
void support_edges(const Mesh& mesh, const Kernel& k, const Loading& loading, Skeleton& s) {
  const int points = points_per_edge(k.element);
  const EdgeRule rule = gauss(data_points);
  for (std::size_t i = 0; i < loading.scene.supports.size(); ++i) {
    const Support& support = loading.scene.supports[i];
    const std::vector<Index>& edges = labeled(loading.data, support.label);
    for (std::size_t j = 0; j < edges.size(); ++j) {
      const Index e = edges[j];
      const Vec2& a = mesh.points[mesh.edges[e][0]];
      const Vec2& b = mesh.points[mesh.edges[e][1]];
      const Vec2 n = outward_normal(mesh, e);
      s.frame[e] = Mat2::Identity();
      if (support.normal_frame) {
        s.frame[e] << n, Vec2(-n.y(), n.x());
        if (curvature_at(s.curvatures, e)) bend_roller(mesh, k, e, n, s);
      }
      const auto value_at = [&](double along) -> Vec2 {
        const Vec2 x = a + along * (b - a);
        const Vec2 value = support.value(x, n);
        check_finite(value, x, "prescribed displacement");
        return value;
      };
      for (int g = 0; g < points; ++g) {
        Vec2 moment = Vec2::Zero();
        if (is_mixed(k.element))  // the basis is orthogonal: its mass on the edge is diag(w)
          for (int q = 0; q < data_points; ++q)
            moment += rule.w[q] * trace_basis(k.trace, rule.s[q])[g] / k.trace.w[g] *
                      loading.data.supports[i].values[j].at.col(q);
        else
          moment = value_at(k.trace.s[g]);
        for (int d = 0; d < 2; ++d)
          if (d == 0 ? support.first : support.second) {
            const Index unknown = edge_unknown(s, e) + 2 * g + d;
            s.fixed[unknown] = true;
            s.prescribed[unknown] = moment[d];
          }
      }
    }
  }
}

/// The corner of boundary edge e at its end.
Index corner_of(const Mesh& mesh, const Skeleton& s, Index e, int end) {
  const Index t = mesh.sides[e][0] == none ? mesh.sides[e][1] : mesh.sides[e][0];
  int i = 0;
  while (mesh.triangles[t][i] != mesh.edges[e][end]) ++i;
  return s.corners.of[t][i];
}

// Displacement elements: at a corner the supports of the edges that meet there add up, two directions at most.
// With axes e_1, e_2 of the corner and the value along e_1 known, a second direction d gives the value along e_2: (v -
// (d.e_1) u_1)/(d.e_2). Directions closer than 1e-3 count as one.
void support_corners(const Mesh& mesh, const Scene& scene, Skeleton& s) {
  for (const Support& support : scene.supports)
    for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
      if (mesh.label[e] != support.label) continue;
      const Vec2 n = outward_normal(mesh, e);
      Mat2 frame = Mat2::Identity();
      if (support.normal_frame) frame << n, Vec2(-n.y(), n.x());
      for (int end = 0; end < 2; ++end) {
        const Vec2& x = mesh.points[mesh.edges[e][end]];
        const Vec2 value = support.value(x, n);
        check_finite(value, x, "prescribed displacement");
        const Index corner = corner_of(mesh, s, e, end), unknown = corner_unknown(s, corner);
        auto axes = s.corner_frame[corner].topLeftCorner<2, 2>();
        for (int d = 0; d < 2; ++d) {
          if (!(d == 0 ? support.first : support.second) || (s.fixed[unknown] && s.fixed[unknown + 1])) continue;
          const Vec2 direction = frame.col(d);
          if (!s.fixed[unknown]) {
            axes << direction, Vec2(-direction.y(), direction.x());
            s.fixed[unknown] = true;
            s.prescribed[unknown] = value[d];
            continue;
          }
          const double across = direction.dot(axes.col(1));
          constexpr double parallel = 1e-3;
          if (std::abs(across) < parallel) continue;
          s.fixed[unknown + 1] = true;
          s.prescribed[unknown + 1] = (value[d] - direction.dot(axes.col(0)) * s.prescribed[unknown]) / across;
        }
      }
    }
}

// Stresses at vertices: sigma n = g on every edge that is not supported there, in the mean of squares where two edges
// meet in a corner. Without this the order of the element falls by half [theory: E.16].
// A row d.(s n) on (s11, s22, sqrt(2) s12) is (d_1 n_1, d_2 n_2, (d_1 n_2 + d_2 n_1)/sqrt(2)). The right singular
// vectors become the frame of the corner: what the tractions say are its first components, the rest stays free.
void load_corners(const Mesh& mesh, const Scene& scene, Skeleton& s) {
  struct Rows {
    Eigen::Matrix<double, Eigen::Dynamic, 3> rows;
    Eigen::VectorXd values;
  };
  std::vector<Rows> given(s.corners.vertex.size());
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    if (mesh.label[e] == none) continue;
    const Vec2 n = outward_normal(mesh, e);
    for (int end = 0; end < 2; ++end) {
      const Vec2& x = mesh.points[mesh.edges[e][end]];
      Vec2 value = Vec2::Zero();
      for (const Traction& traction : scene.tractions)
        if (traction.label == mesh.label[e]) value += traction.value(x, n);
      check_finite(value, x, "traction");
      Rows& r = given[corner_of(mesh, s, e, end)];
      for (int d = 0; d < 2; ++d) {
        if (s.fixed[edge_unknown(s, e) + d]) continue;
        const Vec2 direction = s.frame[e].col(d);
        const Eigen::Index count = r.values.size();
        r.rows.conservativeResize(count + 1, 3);
        r.values.conservativeResize(count + 1);
        r.rows.row(count) << direction.x() * n.x(), direction.y() * n.y(),
            (direction.x() * n.y() + direction.y() * n.x()) / std::sqrt(2.0);
        r.values[count] = direction.dot(value);
      }
    }
  }
  for (std::size_t c = 0; c < given.size(); ++c) {
    if (given[c].values.size() == 0) continue;
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(Eigen::MatrixXd(given[c].rows),
                                                Eigen::ComputeThinU | Eigen::ComputeFullV);
    s.corner_frame[c] = svd.matrixV();
    constexpr double dependent = 1e-6;
    for (Eigen::Index i = 0; i < svd.singularValues().size(); ++i) {
      if (svd.singularValues()[i] < dependent) continue;
      const Index unknown = corner_unknown(s, static_cast<Index>(c)) + static_cast<Index>(i);
      s.fixed[unknown] = true;
      s.prescribed[unknown] = svd.matrixU().col(i).dot(given[c].values) / svd.singularValues()[i];
    }
  }
}

// At a corner between edges with normals a, b a symmetric stress has a.s b = b.s a, so that cubic traces have a
// combination there that the triangle does not see. The combinations around a vertex add up to one that no triangle
// sees where the edges lie on two lines and the ends of the fan, if it has any, are free.
// Marks the traces around such a vertex.
void mark_unseen(const Mesh& mesh, const Scene& scene, Skeleton& s) {
  const Index edges = static_cast<Index>(mesh.edges.size());
  std::vector<bool> cut(edges);
  for (Index i = 0; i < edges; ++i) cut[i] = opens(mesh, scene, i);
  const Corners corners = split_at(mesh, cut);
  std::vector<bool> unseen(corners.vertex.size(), true);
  constexpr double parallel = 1e-6;
  // The edge of triangle t at the vertex that is not `edge`.
  const auto other = [&](Index t, Index vertex, Index edge) {
    for (int i = 0; i < 3; ++i)
      if (mesh.edges_of[t][i] != edge && mesh.triangles[t][i] != vertex) return mesh.edges_of[t][i];
    return none;
  };
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t)
    for (int i = 0; i < 3; ++i)
      for (const int k : {(i + 1) % 3, (i + 2) % 3}) {
        const Index vertex = mesh.triangles[t][i], edge = mesh.edges_of[t][k];
        if (cut[edge]) continue;
        const Vec2 across = normal(mesh, other(t, vertex, edge));
        const Index beyond = mesh.sides[edge][0] == t ? mesh.sides[edge][1] : mesh.sides[edge][0];
        bool seen_here = false;
        if (beyond != none)
          seen_here = std::abs(cross(across, normal(mesh, other(beyond, vertex, edge)))) > parallel;
        else
          for (int d = 0; d < 2; ++d)
            seen_here = seen_here ||
                        (s.fixed[edge_unknown(s, edge) + d] && std::abs(across.dot(s.frame[edge].col(d))) > parallel);
        if (seen_here) unseen[corners.of[t][i]] = false;
      }
  s.unseen.assign(s.total, false);
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t)
    for (int i = 0; i < 3; ++i)
      if (unseen[corners.of[t][i]])
        for (const int k : {(i + 1) % 3, (i + 2) % 3}) {
          const Index edge = mesh.edges_of[t][k];
          for (int u = 0; u < s.per_edge; ++u) {
            s.unseen[edge_unknown(s, edge) + u] = true;
            if (s.jump[edge] != none) s.unseen[s.jump[edge] + u] = true;
          }
        }
}

}  // namespace

const Mat2& frame_at(const Skeleton& s, Index edge, int point) {
  return s.bent_at[edge] == none ? s.frame[edge] : s.bent[s.bent_at[edge] + point];
}

// Frames of chords with a prescribed normal (a crack on an arc) are known at Gauss points alone: between these the
// edge's own stands.
Mat2 frame_between(const Mesh& mesh, const Skeleton& s, Index edge, double at) {
  if (s.bent_at[edge] == none || !curvature_at(s.curvatures, edge)) return s.frame[edge];
  return frame_on_curve(mesh, s, edge, at, s.frame[edge].col(0));
}

Index edge_unknown(const Skeleton& s, Index edge) {
  return edge * s.per_edge;
}

Index corner_unknown(const Skeleton& s, Index corner) {
  return static_cast<Index>(s.frame.size()) * s.per_edge + corner * s.per_vertex;
}

// A uniform pressure stores no energy where c = 0. Its level is free where every normal component on the boundary is
// prescribed and no face can open.
bool has_free_pressure(const Mesh& mesh, const Scene& scene, const Skeleton& s) {
  if (std::ranges::any_of(all_materials(scene), [](const Material& m) { return m.c > 0; })) return false;
  bool contact = false;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    if (mesh.sides[e][0] == none || mesh.sides[e][1] == none) {
      for (int i = 0; i < s.per_edge; ++i) {
        constexpr double across = 1e-12;
        if (!s.fixed[edge_unknown(s, e) + i] && std::abs(s.frame[e].col(i % 2).dot(normal(mesh, e))) > across)
          return false;
      }
    } else if (mesh.crack[e] != none) {
      const CrackLaw::Kind kind = scene.laws[mesh.crack[e]].kind;
      if (kind == CrackLaw::Kind::Open) return false;
      contact = contact || kind == CrackLaw::Kind::Unilateral;
    }
  }
  if (contact) throw Error(Fault::Numerics, open_level);
  return true;
}

// The unknowns: edges, corners, jumps. A continuous rotation has a copy for each fan between open cracks and between
// materials: with single values across a crack the error at its tips falls more slowly.
Skeleton number(const Mesh& mesh, const Kernel& k, const Loading& loading, const EdgeCurvatures& curvatures) {
  const Scene& scene = loading.scene;
  check_element(mesh, k.element, scene);
  Skeleton s;
  s.curvatures = curvatures;
  s.per_edge = per_edge(k.element);
  s.per_vertex = per_vertex(k.element);
  const Index edges = static_cast<Index>(mesh.edges.size());
  s.frame.resize(edges);
  s.jump.assign(edges, none);
  s.base = edges * s.per_edge;
  if (s.per_vertex > 0) {
    std::vector<bool> cut(edges);
    // The rotation jumps between materials, where the displacement kinks.
    const bool rotation = k.element.at_vertices == AtVertices::Rotation;
    for (Index e = 0; e < edges; ++e) cut[e] = opens(mesh, scene, e) || (rotation && is_interface(mesh, e));
    s.corners = split_at(mesh, cut);
    s.base += static_cast<Index>(s.corners.vertex.size()) * s.per_vertex;
    s.corner_frame.assign(s.corners.vertex.size(), Eigen::Matrix3d::Identity());
  }
  s.total = s.base;
  for (Index e = 0; e < edges; ++e) {
    s.frame[e] = edge_frame(mesh, e);
    if (mesh.crack[e] != none && s.per_edge > 0) {
      s.jump[e] = s.total;
      s.total += s.per_edge;
    }
  }
  bend(mesh, k, scene, s);
  s.prescribed.assign(s.total, 0);
  s.fixed.assign(s.total, false);
  s.bounded.assign(s.total, false);
  s.frictional.assign(s.total, false);
  s.sliding.assign(s.total, false);
  for (Index e = 0; e < edges; ++e) {
    if (s.jump[e] == none) continue;
    const CrackLaw& law = scene.laws[mesh.crack[e]];
    const bool unilateral = is_unilateral(law), rough = has_friction(law);
    for (int i = 0; i < s.per_edge; ++i) {
      const Index unknown = s.jump[e] + i;
      s.fixed[unknown] = law.kind == CrackLaw::Kind::Bonded;
      s.bounded[unknown] = unilateral && i % 2 == 0;
      s.frictional[unknown] = rough && i % 2 == 1;
    }
  }
  shift_by_gaps(mesh, k, scene, s);
  support_edges(mesh, k, loading, s);
  if (k.element.at_vertices == AtVertices::Displacement) support_corners(mesh, scene, s);
  if (k.element.at_vertices == AtVertices::Stress) {
    if (has_free_pressure(mesh, scene, s)) need(k.element, can_be_enclosed);
    load_corners(mesh, scene, s);
  }
  if (has_unseen_traces(k.element)) mark_unseen(mesh, scene, s);
  return s;
}

const Material& material_of(const Mesh& mesh, const Scene& scene, Index t) {
  const Index region = region_of(mesh, t);
  return region == none ? scene.material : scene.regions[region];
}

// The triangle points into the skeleton's frames and curvatures, which must outlive it.
Triangle triangle(const Mesh& mesh, const Skeleton& s, Index t) {
  Triangle result = cell_of(mesh, s.curvatures, t);
  for (int i = 0; i < 3; ++i) {
    const Index e = mesh.edges_of[t][i];
    result.frame[i] = s.frame[e];
    if (s.bent_at[e] != none) result.bent[i] = s.bent.data() + s.bent_at[e];
    if (s.per_vertex > 1) result.corner[i] = s.corner_frame[s.corners.of[t][i]];
  }
  return result;
}

// sides[1] is the right side of an edge, the one that sees base and jump.
Seen seen(const Mesh& mesh, const Skeleton& s, Index t) {
  Seen result;
  for (int i = 0; i < 3; ++i) {
    const Index e = mesh.edges_of[t][i];
    const bool right = s.jump[e] != none && mesh.sides[e][1] == t;
    for (int k = 0; k < s.per_edge; ++k) {
      result.base[result.count] = edge_unknown(s, e) + k;
      result.jump[result.count++] = right ? s.jump[e] + k : none;
    }
  }
  if (s.per_vertex > 0)
    for (const Index corner : s.corners.of[t])
      for (int k = 0; k < s.per_vertex; ++k) {
        result.base[result.count] = corner_unknown(s, corner) + k;
        result.jump[result.count++] = none;
      }
  return result;
}

// Base plus jump on the right of a crack (C.3).
SkeletonVector trace_seen(const Mesh& mesh, const Skeleton& s, const Eigen::VectorXd& values, Index t) {
  const Seen view = seen(mesh, s, t);
  SkeletonVector trace(view.count);
  for (int i = 0; i < view.count; ++i)
    trace[i] = values[view.base[i]] + (view.jump[i] == none ? 0 : values[view.jump[i]]);
  return trace;
}

namespace {

/// The corner of triangle t at a vertex.
Index corner_in(const Mesh& mesh, const Skeleton& s, Index t, Index vertex) {
  int i = 0;
  while (mesh.triangles[t][i] != vertex) ++i;
  return s.corners.of[t][i];
}

// Of one edge of a crack: the pressure pushes its right side along the normal, its left side the other way, and a shear
// so along the normal turned by +90 degrees.
void add_pressure(const Mesh& mesh, const Kernel& k, const Skeleton& s, Index e, const EdgeValues& values,
                  Eigen::VectorXd& load) {
  const EdgeRule rule = gauss(data_points);
  const double l = length(mesh, e);
  for (int q = 0; q < data_points; ++q) {
    const double at = rule.s[q];
    const Vec2 slope = on_edge(mesh, s.curvatures, e, at).slope;
    const Vec2 n = curvature_at(s.curvatures, e) ? Vec2(slope.y() / l, -slope.x() / l) : normal(mesh, e);
    const Vec2 moment = l * rule.w[q] * (values.at(0, q) * n + values.at(1, q) * Vec2(-n.y(), n.x()));
    if (is_mixed(k.element)) {
      const Eigen::VectorXd basis = trace_basis(k.trace, at);
      for (int g = 0; g < basis.size(); ++g)
        load.segment<2>(s.jump[e] + 2 * g) += basis[g] * frame_at(s, e, g).transpose() * moment;
      continue;
    }
    const double bubble = s.per_edge > 0 ? 4 * at * (1 - at) : 0;
    if (s.per_edge > 0) load.segment<2>(s.jump[e]) += bubble * s.frame[e].transpose() * moment;
    for (int end = 0; end < 2; ++end)
      for (int side = 0; side < 2; ++side) {
        const Index corner = corner_in(mesh, s, mesh.sides[e][side], mesh.edges[e][end]);
        load.segment<2>(corner_unknown(s, corner)) += (side == 0 ? -1 : 1) * ((end == 0 ? 1 - at : at) - 0.5 * bubble) *
                                                      s.corner_frame[corner].topLeftCorner<2, 2>().transpose() * moment;
      }
  }
}

}  // namespace

// Data have data_points Gauss points on an edge, which are exact for polynomials of degree 7 against the traces (D.2).
// P_2 has a bubble in the middle of the edge, 4 s (1 - s), whose half is taken from the linear functions at the ends.
Eigen::VectorXd traction_loads(const Mesh& mesh, const Kernel& k, const Skeleton& s, const SceneData& data) {
  Eigen::VectorXd load = Eigen::VectorXd::Zero(s.total);
  const EdgeRule rule = gauss(data_points);
  for (const LoadedEdges& traction : data.tractions)
    for (std::size_t j = 0; j < traction.values.size(); ++j) {
      const Index e = labeled(data, traction.label)[j];
      const double l = length(mesh, e);
      for (int q = 0; q < data_points; ++q) {
        const Vec2 moment = l * rule.w[q] * traction.values[j].at.col(q);
        const auto add = [&](Index unknown, double share, const Mat2& frame) {
          for (int d = 0; d < 2; ++d) load[unknown + d] += share * frame.col(d).dot(moment);
        };
        const double at = rule.s[q];
        if (is_mixed(k.element)) {
          const Eigen::VectorXd basis = trace_basis(k.trace, at);
          for (int g = 0; g < basis.size(); ++g) add(edge_unknown(s, e) + 2 * g, basis[g], frame_at(s, e, g));
          continue;
        }
        const double bubble = s.per_edge > 0 ? 4 * at * (1 - at) : 0;
        if (s.per_edge > 0) add(edge_unknown(s, e), bubble, s.frame[e]);
        for (int end = 0; end < 2; ++end) {
          const Index corner = corner_of(mesh, s, e, end);
          add(corner_unknown(s, corner), (end == 0 ? 1 - at : at) - 0.5 * bubble,
              s.corner_frame[corner].topLeftCorner<2, 2>());
        }
      }
    }
  for (const LoadedCrack& c : data.pressures)
    for (std::size_t j = 0; j < c.values.size(); ++j)
      add_pressure(mesh, k, s, mesh.cracks[c.crack][j].edge, c.values[j], load);
  return load;
}

}  // namespace kerf
