// The continuous displacement v of the upper bound [theory: B.1], from the recovered displacement u* of the solution
// [theory: R.1]: polynomials of degree trace + 1 by their nodes. Steps, each of which leaves alone what the one before
// has set:
// 1. averages of u* at the nodes, with the weights |T| mu, one per side of a crack that may open;
// 2. corners: prescribed values, and openings 0 <= [v].n <= what the edges beside can hold;
// 3. edges: prescribed values by a fit of degree 7, elsewhere the mean of the multiplier,
//   int_e v = int_e multiplier, so that int_T div v = int_T 2 c tr s (+ the eigenstrain)      [theory: B.6];
// 4. unilateral cracks: Bernstein coefficients of [v].n at least 0, the mean kept;
// 5. bubbles on held edges for what degree trace + 1 misses of the prescribed values. Step 3 is what lets div v be
// corrected inside each triangle, and keeps the bound finite as c -> 0. The second half of the file does the same for
// several fields side by side, on straight triangles without contact. See "An admissible displacement" in
// docs/theory/bounds.md.

#include "solver/bounds/conforming.hpp"

#include "solver/anisotropic.hpp"
#include "solver/system.hpp"

#include "base/dense.hpp"
#include "base/parallel.hpp"
#include "kerf/recover.hpp"
#include "solver/bounds/right_inverse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace kerf {

namespace {

/// Evenly spaced points s = i/n with the weights of their interpolation polynomial: int p = sum w_i p(s_i) for p in
/// P_n.
EdgeRule even(int n) {
  EdgeRule rule{Eigen::VectorXd::LinSpaced(n + 1, 0, 1), Eigen::VectorXd(n + 1)};
  const EdgeRule exact = gauss(n + 1);
  rule.w = traces(rule, exact.s) * exact.w;
  return rule;
}

int corner_at(const Mesh& mesh, Index t, Index vertex) {
  const auto& v = mesh.triangles[t];
  return v[0] == vertex ? 0 : v[1] == vertex ? 1 : 2;
}

// 0 <= (v_right - v_left).n <= most, at the corners of a vertex on a unilateral crack.
struct Opening {
  Index edge, left, right;
  Vec2 n;
  double most;
};

// The point nearest to j with 0 <= n_i.j <= most_i. Zero is one.
// The feasible set is a polygon in the plane of jumps, so that the nearest point is j itself, a foot on one line, or a
// crossing of two: all are tried. `parallel`: lines whose crossing is not determined by their normals.
Vec2 project(const Vec2& j, const std::vector<Opening>& openings) {
  struct Line {
    Vec2 n;
    double at;
  };
  std::vector<Line> lines;
  for (const Opening& o : openings) lines.insert(lines.end(), {{o.n, 0}, {o.n, o.most}});
  std::vector<Vec2> candidates{j};
  for (const Line& a : lines) {
    candidates.push_back(j + (a.at - a.n.dot(j)) * a.n);
    for (const Line& b : lines) {
      constexpr double parallel = 1e-6;
      if (std::abs(cross(a.n, b.n)) < parallel) continue;
      candidates.push_back(Vec2(a.at * b.n.y() - b.at * a.n.y(), b.at * a.n.x() - a.at * b.n.x()) / cross(a.n, b.n));
    }
  }
  Vec2 best = Vec2::Zero();
  const double rounding = 1e-10 * j.norm();  // the edges of a straight crack are not quite parallel
  for (const Vec2& c : candidates) {
    const bool allowed = std::all_of(openings.begin(), openings.end(), [&](const Opening& o) {
      return o.n.dot(c) >= -rounding && o.n.dot(c) <= o.most + rounding;
    });
    if (allowed && (c - j).norm() < (best - j).norm()) best = c;
  }
  return best;
}

// The copies of a vertex where several cracks meet, moved as little as possible until 0 <= opening <= most on every
// edge: those without room, and then those found to take too much, are held at it.
// x = start + within open' f, f >= 0 the forces of a small contact problem (C.6) on the rows that are free; `regular`
// keeps its matrix definite where rows depend on each other. Every round holds one row more at least, so that the loop
// ends. Where the rows cannot all be met the copies are closed, which is admissible.
void open_junction(const std::vector<Index>& copies, const std::vector<Opening>& openings, Points& v) {
  const Eigen::Index n = 2 * static_cast<Eigen::Index>(copies.size());
  const Index count = static_cast<Index>(openings.size());
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(count, n);
  Eigen::VectorXd start(n), most(count);
  for (Eigen::Index i = 0; 2 * i < n; ++i) start.segment<2>(2 * i) = v.col(copies[i]);
  for (Index i = 0; i < count; ++i) {
    const auto place = [&](Index corner) {
      return 2 * (std::find(copies.begin(), copies.end(), corner) - copies.begin());
    };
    rows.row(i).segment<2>(place(openings[i].right)) += openings[i].n.transpose();
    rows.row(i).segment<2>(place(openings[i].left)) -= openings[i].n.transpose();
    most[i] = openings[i].most;
  }
  const double rounding = 1e-10 * start.norm();
  std::vector<bool> held(count);
  for (Index i = 0; i < count; ++i) held[i] = most[i] <= rounding;
  Eigen::VectorXd x;
  for (bool changed = true; changed;) {
    std::vector<Index> fixed, free;
    for (Index i = 0; i < count; ++i) (held[i] ? fixed : free).push_back(i);
    x = start;
    Eigen::MatrixXd within = Eigen::MatrixXd::Identity(n, n);
    if (!fixed.empty()) {
      const Eigen::MatrixXd equal = rows(fixed, Eigen::all);
      const Eigen::MatrixXd inverse = pseudo_inverse(equal);
      x += multiply(inverse, most(fixed) - multiply(equal, x));
      within -= multiply(inverse, equal);
    }
    if (!free.empty()) {
      const Eigen::MatrixXd seen = rows(free, Eigen::all);
      Eigen::VectorXd closing(seen.rows());
      for (Eigen::Index i = 0; i < seen.rows(); ++i) closing[i] = -seen.row(i).dot(x);
      const Eigen::MatrixXd open = multiply(seen, within);
      constexpr double regular = 1e-12;
      const Eigen::MatrixXd gram =
          multiply_transposed(open, open) + regular * Eigen::MatrixXd::Identity(open.rows(), open.rows());
      x += transposed_multiply(open, solve_unilateral(gram, closing).jump);
    }
    changed = false;
    for (const Index i : free)
      if (rows.row(i).dot(x) > most[i] + rounding) held[i] = changed = true;
  }
  const Eigen::VectorXd opening = multiply(rows, x);
  Vec2 mean = Vec2::Zero();
  for (Eigen::Index i = 0; 2 * i < n; ++i) mean += 2 * x.segment<2>(2 * i) / static_cast<double>(n);
  const bool possible = (opening.array() >= -rounding).all() && (opening.array() <= most.array() + rounding).all();
  for (Eigen::Index i = 0; 2 * i < n; ++i) v.col(copies[i]) = possible ? Vec2(x.segment<2>(2 * i)) : mean;
}

// A component that a support prescribes at a corner.
struct Held {
  Vec2 direction;
  double value;
};

/// Moves v to the line of the first component, or to the point where two that are not parallel agree.
Vec2 obey(Vec2 v, const std::vector<Held>& held) {
  const Held* first = nullptr;
  for (const Held& h : held) {
    if (!first) {
      v += (h.value - h.direction.dot(v)) * h.direction;
      first = &h;
      continue;
    }
    constexpr double parallel = 1e-6;
    const double turn = cross(first->direction, h.direction);
    if (std::abs(turn) < parallel) continue;
    return Vec2(first->value * h.direction.y() - h.value * first->direction.y(),
                h.value * first->direction.x() - first->value * h.direction.x()) /
           turn;
  }
  return v;
}

// The nodes: corners (one per side of a crack that may open), then degree - 1 per edge (twice at such cracks), in the
// direction of the edge. Interior ones are no concern of the neighbors.
// The number of a node on an edge counts along the edge; a triangle that has the edge on its right counts backward.
struct Nodes {
  int degree;
  Mesh mesh;  // bonded cracks are none
  Corners corners;
  std::vector<std::array<Index, 2>> slot;  // per edge: on its left and right
  Index count = 0;

  Index on_edge(Index e, int side, int i) const {  // i = 1 .. degree - 1
    return static_cast<Index>(corners.vertex.size()) + slot[e][side] * (degree - 1) + i - 1;
  }
  Index corner(Index t, Index vertex) const {
    return corners.of[t][corner_at(mesh, t, vertex)];
  }
  /// Per place of lattice(degree) the number of the node, none inside the triangle.
  std::vector<Index> of(Index t) const {
    std::vector<Index> nodes(dim(degree), none);
    for (int i = 0; i < 3; ++i) {
      const Index e = mesh.edges_of[t][i];
      const int side = mesh.sides[e][0] == t ? 0 : 1;
      for (int r = 0; r <= degree; ++r) {
        std::array<int, 3> l{0, 0, 0};
        l[(i + 1) % 3] = degree - r;
        l[(i + 2) % 3] = r;
        nodes[lattice_place(degree, l[1], l[2])] = r == 0        ? corners.of[t][(i + 1) % 3]
                                                   : r == degree ? corners.of[t][(i + 2) % 3]
                                                                 : on_edge(e, side, side == 0 ? r : degree - r);
      }
    }
    return nodes;
  }
};

/// The faces of a bonded crack share their nodes.
Nodes make_nodes(const Model& m, int degree) {
  Nodes n{degree, m.mesh, {}, {}, 0};
  for (Index& crack : n.mesh.crack)
    if (crack != none && m.scene.laws[crack].kind == CrackLaw::Kind::Bonded) crack = none;
  n.corners = split_at_cracks(n.mesh);
  Index slots = 0;
  for (std::size_t e = 0; e < n.mesh.edges.size(); ++e) {
    const Index left = slots++;
    n.slot.push_back({left, n.mesh.crack[e] == none ? left : slots++});
  }
  n.count = static_cast<Index>(n.corners.vertex.size()) + slots * (degree - 1);
  return n;
}

// Averages, weighted by area and stiffness, at the nodes of u*, which stays in `nodal` at the interior ones.
// A stiff neighbour counts more, since a wrong displacement costs it more energy.
Points averages(const Model& m, const Field& s, const Nodes& nodes, Eigen::MatrixXd& nodal) {
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  const Points at = lattice(nodes.degree);
  const TriangleRule rule{at, Eigen::VectorXd(at.cols())};
  nodal.resize(2 * at.cols(), triangles);
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const Points u = recovered_displacement(m, s, t, rule_points(rule, triangle(m, t)));
      nodal.col(t) = Eigen::Map<const Eigen::VectorXd>(u.data(), u.size());
    }
  });
  Points sum = Points::Zero(2, nodes.count);
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(nodes.count);
  for (Index t = 0; t < triangles; ++t) {
    const std::vector<Index> of = nodes.of(t);
    const double w = area(m.mesh, t) * material_of(m.mesh, m.scene, t).mu;
    for (std::size_t i = 0; i < of.size(); ++i)
      if (of[i] != none) {
        sum.col(of[i]) += w * nodal.col(t).segment<2>(2 * static_cast<Eigen::Index>(i));
        weight[of[i]] += w;
      }
  }
  for (Index i = 0; i < nodes.count; ++i) sum.col(i) /= weight[i];
  return sum;
}

// Mean over an edge of the multiplier on one of its sides, in the frame of the edge.
// The multiplier of the right side of a crack is that of the left plus the jump.
Vec2 mean_trace(const Model& m, const Field& s, Index e, int side) {
  Vec2 mean = Vec2::Zero();
  for (Eigen::Index g = 0; g < m.inner->kernel.trace.w.size(); ++g)
    for (int d = 0; d < 2; ++d) {
      const Index local = 2 * static_cast<Index>(g) + d;
      double value = s.skeleton[e * m.inner->skeleton.per_edge + local];
      if (side == 1 && m.inner->skeleton.jump[e] != none) value += s.skeleton[m.inner->skeleton.jump[e] + local];
      mean[d] += m.inner->kernel.trace.w[g] * value;
    }
  return mean;
}

/// The same of a roller along a curve, whose frames turn.
Vec2 mean_in_frame(const Model& m, const Field& s, Index e) {
  const Skeleton& skeleton = m.inner->skeleton;
  Vec2 mean = Vec2::Zero();
  for (Eigen::Index g = 0; g < m.inner->kernel.trace.w.size(); ++g)
    mean += m.inner->kernel.trace.w[g] * frame_at(skeleton, e, static_cast<int>(g)) *
            s.skeleton.segment<2>(e * skeleton.per_edge + 2 * static_cast<Index>(g));
  return skeleton.frame[e].transpose() * mean;
}

/// At least 0: the mean over the edge of what the discrete solution opens.
double mean_opening(const Model& m, const Field& s, Index e) {
  return std::max(0.0, mean_trace(m, s, e, 1).x() - mean_trace(m, s, e, 0).x());
}

template <class Visit>  // visit(edge) for every edge of a unilateral crack
void on_unilateral_edges(const Model& m, Visit&& visit) {
  for (std::size_t c = 0; c < m.mesh.cracks.size(); ++c)
    if (is_unilateral(m.scene.laws[c]))
      for (const CrackEdge& crack : m.mesh.cracks[c]) visit(crack.edge);
}

// Supports at the corners, and openings there that leave every crack edge room for its mean opening: with the Bernstein
// coefficients c_i of an opening of degree n, mean = sum c_i/(n + 1), all c_i can be >= 0 when c_0 + c_n <= (n + 1)
// mean.
// c_0 and c_n are the openings at the ends. An edge is shared by two vertices, so that its room is divided between them
// first, and each vertex is then projected by itself.
void correct_corners(const Model& m, const Field& s, const Nodes& nodes, const std::vector<EdgeData>& data, Points& v) {
  std::map<Index, std::vector<Held>> held;  // per corner
  std::map<Index, std::vector<Held>> at_vertex;
  for (const EdgeData& d : data)
    for (int end = 0; end < 2; ++end)
      for (int k = 0; k < 2; ++k)
        if (d.held[k]) {
          const Index vertex = m.mesh.edges[d.edge][end];
          const Held here = d.bent ? Held{frame_between(m.mesh, m.inner->skeleton, d.edge, end).col(k), 0}
                                   : Held{m.inner->skeleton.frame[d.edge].col(k), d.ends(k, end)};
          held[nodes.corner(d.triangle, vertex)].push_back(here);
          at_vertex[vertex].push_back(here);
        }
  std::map<Index, std::vector<Opening>> openings;  // per vertex
  on_unilateral_edges(m, [&](Index e) {
    for (const Index vertex : m.mesh.edges[e]) {
      const Opening o{e, nodes.corner(m.mesh.sides[e][0], vertex), nodes.corner(m.mesh.sides[e][1], vertex),
                      m.inner->skeleton.frame[e].col(0), (nodes.degree + 1) * mean_opening(m, s, e)};
      if (o.left != o.right) openings[vertex].push_back(o);
    }
  });
  // The room of an edge is shared between its ends in proportion to what each would take alone.
  std::map<Index, double> taken;
  const auto alone = [&](const std::vector<Opening>& list, const Opening& o) {
    std::vector<Opening> same;
    for (const Opening& other : list)
      if (other.left == o.left && other.right == o.right) same.push_back(other);
    return std::max(0.0, o.n.dot(project(v.col(o.right) - v.col(o.left), same)));
  };
  for (const auto& [vertex, list] : openings)
    for (const Opening& o : list) taken[o.edge] += alone(list, o);
  for (auto& [vertex, list] : openings) {
    std::vector<Opening> shared = list;
    for (Opening& o : shared)
      if (taken[o.edge] > o.most) o.most *= alone(list, o) / taken[o.edge];
    list = shared;
  }
  for (auto& [vertex, list] : openings) {
    std::vector<Index> copies;
    for (const Opening& o : list)
      for (const Index c : {o.left, o.right})
        if (std::find(copies.begin(), copies.end(), c) == copies.end()) copies.push_back(c);
    Vec2 mean = Vec2::Zero();
    for (const Index c : copies) mean += v.col(c) / static_cast<double>(copies.size());
    if (const auto fixed = at_vertex.find(vertex); fixed != at_vertex.end()) {  // the mouth of a crack in a support
      for (const Index c : copies) v.col(c) = obey(mean, fixed->second);
      continue;
    }
    if (copies.size() == 2) {
      for (Opening& o : list)
        if (o.left != copies[0]) o.n = -o.n;
      const Vec2 jump = project(v.col(copies[1]) - v.col(copies[0]), list);
      v.col(copies[0]) = mean - 0.5 * jump;
      v.col(copies[1]) = mean + 0.5 * jump;
      continue;
    }
    open_junction(copies, list, v);
  }
  for (const auto& [corner, list] : held)
    if (!openings.contains(nodes.corners.vertex[corner])) v.col(corner) = obey(v.col(corner), list);
}

// The nodes of an edge on one side, with its corners.
Points edge_values(const Nodes& nodes, const Points& v, Index e, int side) {
  const Index t = nodes.mesh.sides[e][side];
  Points value(2, nodes.degree + 1);
  for (int i = 1; i < nodes.degree; ++i) value.col(i) = v.col(nodes.on_edge(e, side, i));
  value.col(0) = v.col(nodes.corner(t, nodes.mesh.edges[e][0]));
  value.col(nodes.degree) = v.col(nodes.corner(t, nodes.mesh.edges[e][1]));
  return value;
}

// Bernstein coefficients of the opening made >= 0 with the mean kept, half the change on either side.
// Returns how far the coefficients at the ends are below 0: rounding.
// With inner coefficients c_i and s = sum c_i, the positive ones are scaled by s/sum max(c_i, 0) and the others set to
// 0, which keeps the sum and so the mean. The nodes at the ends do not move.
double correct_opening(const Nodes& nodes, const Eigen::MatrixXd& bernstein, const Vec2& n, Index e, Points& v) {
  const int degree = nodes.degree;
  const Eigen::VectorXd values = (edge_values(nodes, v, e, 1) - edge_values(nodes, v, e, 0)).transpose() * n;
  const Eigen::VectorXd c = solve_lu(bernstein, values);
  const auto inner = c.segment(1, degree - 1);
  const double below = std::max({0.0, -c[0], -c[degree]});
  if ((inner.array() >= 0).all()) return below;
  const double sum = std::max(0.0, inner.sum()), positive = inner.cwiseMax(0).sum();
  Eigen::VectorXd change = Eigen::VectorXd::Zero(degree + 1);
  change.segment(1, degree - 1) = (positive > 0 ? sum / positive : 0) * inner.cwiseMax(0) - inner;
  change = multiply(bernstein, change);
  for (int i = 1; i < degree; ++i) {
    v.col(nodes.on_edge(e, 0, i)) -= 0.5 * change[i] * n;
    v.col(nodes.on_edge(e, 1, i)) += 0.5 * change[i] * n;
  }
  return below;
}

// Prescribed components of an edge as linear + s (1 - s) p, p of degree 5 by moments, the ends given.
// mass p = moment, with mass = int s (1 - s) b_i b_j and moment = int b_i (u_D - linear): the rest of u_D is orthogonal
// to polynomials of degree 5.
struct Fit {
  EdgeRule carrier = gauss(data_carriers), sample = gauss(data_points);
  Eigen::MatrixXd basis = traces(carrier, sample.s);
  Eigen::VectorXd bump = sample.s.cwiseProduct((1 - sample.s.array()).matrix());
  Eigen::LLT<Eigen::MatrixXd> mass =
      cholesky(multiply_transposed(basis * sample.w.cwiseProduct(bump).asDiagonal(), basis));

  struct Result {
    Eigen::RowVectorXd p;
    double square;  // mean square of what is left
  };
  Result fit(const Eigen::RowVectorXd& data, double first, double last) const {
    const Eigen::RowVectorXd rest =
        data - (first * (1 - sample.s.array()) + last * sample.s.array()).matrix().transpose();
    const Eigen::VectorXd moment = basis * sample.w.asDiagonal() * rest.transpose();
    Result r{solve(mass, moment).transpose(), 0};
    const Eigen::RowVectorXd left = rest - (r.p * basis).cwiseProduct(bump.transpose());
    r.square = left.cwiseAbs2().dot(sample.w.transpose());
    return r;
  }
};

// Changes inside an edge: to the polynomial fitted to data, given the values `here`, or by a bubble of mean `rest`.
Eigen::RowVectorXd towards_data(const Fit& fit, const EdgeRule& rule, const Eigen::RowVectorXd& here,
                                const Eigen::RowVectorXd& data) {
  const Eigen::Index degree = here.size() - 1;
  Eigen::RowVectorXd change = Eigen::RowVectorXd::Zero(degree + 1);
  const Fit::Result f = fit.fit(data, here[0], here[degree]);
  for (Eigen::Index i = 1; i < degree; ++i) {
    const double at = rule.s[i];
    change[i] =
        here[0] * (1 - at) + here[degree] * at + at * (1 - at) * f.p.dot(trace_basis(fit.carrier, at)) - here[i];
  }
  return change;
}
/// 6 s (1 - s) has mean 1 over the edge.
Eigen::RowVectorXd bubble_of_mean(const EdgeRule& rule, double rest) {
  Eigen::RowVectorXd change = Eigen::RowVectorXd::Zero(rule.s.size());
  for (Eigen::Index i = 1; i + 1 < rule.s.size(); ++i) change[i] = 6 * rule.s[i] * (1 - rule.s[i]) * rest;
  return change;
}

// Through a curved edge flows what the multiplier lets through, so that the mean of the divergence over a triangle is
// that of 2 c tr s there as well: a bubble along the normal of the chord.
// int v . n |dx/ds| ds, n of the curve, is set to that of the multiplier; `flux`: that of the unit bubble.
void correct_flux(const Model& m, const Field& s, const Nodes& nodes, Index e, int side, Points& v) {
  const Skeleton& skeleton = m.inner->skeleton;
  const auto normal_at = [&](double at) -> Vec2 {  // times |dx/ds|
    const Vec2 slope = on_edge(m.mesh, skeleton.curvatures, e, at).slope;
    return {slope.y(), -slope.x()};
  };
  const EdgeRule& trace = m.inner->kernel.trace;
  double rest = 0;
  for (Eigen::Index g = 0; g < trace.w.size(); ++g) {
    const Index u = 2 * static_cast<Index>(g);
    Vec2 moved = s.skeleton.segment<2>(e * skeleton.per_edge + u);
    if (side == 1 && skeleton.jump[e] != none) moved += s.skeleton.segment<2>(skeleton.jump[e] + u);
    rest += trace.w[g] * normal_at(trace.s[g]).dot(frame_at(skeleton, e, static_cast<int>(g)) * moved);
  }
  static const EdgeRule rule = gauss(data_points);
  const Eigen::MatrixXd basis = traces(even(nodes.degree), rule.s);
  const Points value = edge_values(nodes, v, e, side) * basis;
  const Vec2 across = normal(m.mesh, e);
  double flux = 0;
  for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
    const Vec2 n = normal_at(rule.s[q]);
    rest -= rule.w[q] * n.dot(value.col(q));
    flux += rule.w[q] * 6 * rule.s[q] * (1 - rule.s[q]) * n.dot(across);
  }
  const Eigen::RowVectorXd change = bubble_of_mean(even(nodes.degree), rest / flux);
  for (int i = 1; i < nodes.degree; ++i) v.col(nodes.on_edge(e, side, i)) += change[i] * across;
}

// Edges take the prescribed values, or the mean of the discrete displacement.
void correct_edges(const Model& m, const Field& s, const Nodes& nodes, const std::vector<EdgeData>& data, Points& v) {
  const int degree = m.element.trace + 1;
  const EdgeRule rule = even(degree);
  const Fit fit;
  std::vector<const EdgeData*> given(m.mesh.edges.size(), nullptr);
  for (const EdgeData& d : data) given[d.edge] = &d;
  for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e) {
    const Mat2& frame = m.inner->skeleton.frame[e];
    for (int side = 0; side < 2; ++side) {
      if (m.mesh.sides[e][side] == none || (side == 1 && m.mesh.sides[e][0] != none && nodes.mesh.crack[e] == none))
        continue;
      const Points here = frame.transpose() * edge_values(nodes, v, e, side);
      const bool bent = given[e] && given[e]->bent;
      const Vec2 wanted = bent ? mean_in_frame(m, s, e) : mean_trace(m, s, e, side);
      for (int k = 0; k < 2; ++k) {
        const Eigen::RowVectorXd change = given[e] && given[e]->held[k] && !bent
                                              ? towards_data(fit, rule, here.row(k), given[e]->displacement.row(k))
                                              : bubble_of_mean(rule, wanted[k] - here.row(k).dot(rule.w));
        for (int i = 1; i < degree; ++i) v.col(nodes.on_edge(e, side, i)) += change[i] * frame.col(k);
      }
      if (curvature_at(m.inner->skeleton.curvatures, e) && !(given[e] && (given[e]->held[0] || given[e]->held[1])))
        correct_flux(m, s, nodes, e, side, v);
    }
  }
}

// Bernstein polynomials (columns) at evenly spaced points.
Eigen::MatrixXd bernstein_on_edge(int degree) {
  const EdgeRule rule = even(degree);
  Eigen::MatrixXd values(degree + 1, degree + 1);
  for (int i = 0; i <= degree; ++i)
    for (int k = 0; k <= degree; ++k)
      values(i, k) = std::round(std::tgamma(degree + 1) / (std::tgamma(k + 1) * std::tgamma(degree - k + 1))) *
                     std::pow(rule.s[i], k) * std::pow(1 - rule.s[i], degree - k);
  return values;
}

// What a supported edge still misses: bubbles that the triangle adds, and what even those leave. `here`: what is there,
// in the frame of the edge.
// `mismatch` collects 2 mu times the square of what is missed, with the largest shear modulus: the energy of an
// extension of it into the body is estimated from that sum (bounds.cpp, `unseen`).
class Bubbles {
 public:
  explicit Bubbles(const Model& m)
      : m_(m), degree_(m.element.trace + 1), at_carrier_(traces(even(degree_), fit_.carrier.s)) {}

  /// On the edge l_a l_b = s (1 - s): v + s (1 - s) bubble is linear + s (1 - s) p, p of the fit. Elsewhere in the
  /// triangle the product l_a l_b p((1 + l_b - l_a)/2) keeps the two other edges as they are.
  void add(const EdgeData& d, const Points& here, Conforming& result) const {
    if (d.bent) {
      add_bent(d, here, result);
      return;
    }
    EdgePolynomial value = here * at_carrier_, bubble = EdgePolynomial::Zero();
    for (int k = 0; k < 2; ++k) {
      if (!d.held[k]) continue;
      const Fit::Result f = fit_.fit(d.displacement.row(k), here(k, 0), here(k, degree_));
      const double ends = std::pow(d.ends(k, 0) - here(k, 0), 2) + std::pow(d.ends(k, 1) - here(k, degree_), 2);
      // Rapid changes: at most the product of the norms of value and slope, as between L2 and H1.
      const double rapid = d.rest[k] > 0 ? std::sqrt(d.rest[k] * d.rough[k]) : 0;
      const double missed = f.square + ends + rapid, rounding = 64 * std::numeric_limits<double>::epsilon();
      if (d.triangle < own_triangles(m_) && missed > rounding * rounding * d.displacement.squaredNorm())
        result.mismatch += 2 * shear_moduli(material_of(m_.mesh, m_.scene, d.triangle)).largest * missed;
      for (int g = 0; g < data_carriers; ++g) {
        const double at = fit_.carrier.s[g];
        const double linear = here(k, 0) * (1 - at) + here(k, degree_) * at;
        bubble(k, g) = f.p[g] - (value(k, g) - linear) / (at * (1 - at));
        value(k, g) = linear + at * (1 - at) * f.p[g];
      }
    }
    result.bubble.emplace_back(m_.inner->skeleton.frame[d.edge] * bubble);
    result.value.push_back(value);
  }

 private:
  /// On a roller along a curve both components are fitted to the part of what is there along the curve.
  /// v - (n . v) n is no polynomial where n turns: what the fit leaves across the curve counts as missed.
  void add_bent(const EdgeData& d, const Points& here, Conforming& result) const {
    const Skeleton& s = m_.inner->skeleton;
    const Mat2& frame = s.frame[d.edge];
    const auto across = [&](double at) -> Vec2 {
      return frame.transpose() * frame_between(m_.mesh, s, d.edge, at).col(0);
    };
    Points wanted = here * traces(even(degree_), fit_.sample.s);
    for (Eigen::Index q = 0; q < wanted.cols(); ++q) {
      const Vec2 n = across(fit_.sample.s[q]);
      wanted.col(q) -= n.dot(wanted.col(q)) * n;
    }
    const Points value = here * at_carrier_;
    EdgePolynomial bubble, moved;
    Points found(2, wanted.cols());
    for (int k = 0; k < 2; ++k) {
      const double first = here(k, 0), last = here(k, degree_);
      const Fit::Result f = fit_.fit(wanted.row(k), first, last);
      for (Eigen::Index q = 0; q < found.cols(); ++q)
        found(k, q) =
            first * (1 - fit_.sample.s[q]) + last * fit_.sample.s[q] + fit_.bump[q] * f.p.dot(fit_.basis.col(q));
      for (int g = 0; g < data_carriers; ++g) {
        const double at = fit_.carrier.s[g], linear = first * (1 - at) + last * at, bump = at * (1 - at);
        bubble(k, g) = f.p[g] - (value(k, g) - linear) / bump;
        moved(k, g) = linear + bump * f.p[g];
      }
    }
    double missed = std::pow(across(0).dot(here.col(0)), 2) + std::pow(across(1).dot(here.col(degree_)), 2);
    for (Eigen::Index q = 0; q < found.cols(); ++q)
      missed += fit_.sample.w[q] * std::pow(across(fit_.sample.s[q]).dot(found.col(q)), 2);
    constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();
    if (d.triangle < own_triangles(m_) && missed > rounding * rounding * here.squaredNorm())
      result.mismatch += 2 * shear_moduli(material_of(m_.mesh, m_.scene, d.triangle)).largest * missed;
    result.bubble.emplace_back(frame * bubble);
    result.value.push_back(moved);
  }

  const Model& m_;
  int degree_;
  Fit fit_;
  Eigen::MatrixXd at_carrier_;
};

void add_bubbles(const Model& m, const Nodes& nodes, const std::vector<EdgeData>& data, const Points& v,
                 Conforming& result) {
  const Bubbles bubbles(m);
  for (const EdgeData& d : data)
    bubbles.add(d,
                m.inner->skeleton.frame[d.edge].transpose() *
                    edge_values(nodes, v, d.edge, m.mesh.sides[d.edge][0] == d.triangle ? 0 : 1),
                result);
}

}  // namespace

/// The order of the steps matters: corners decide what edges may do, edges what their openings are.
Conforming conforming_displacement(const Model& m, const Field& s, const std::vector<EdgeData>& data) {
  const int degree = m.element.trace + 1;
  const Nodes nodes = make_nodes(m, degree);
  Conforming result{degree, {}, {}, {}, {}, 0};
  Points v = averages(m, s, nodes, result.nodal);
  correct_corners(m, s, nodes, data, v);
  correct_edges(m, s, nodes, data, v);
  const Eigen::MatrixXd values = bernstein_on_edge(degree);
  result.penetration.assign(m.mesh.edges.size(), 0);
  on_unilateral_edges(m, [&](Index e) {
    result.penetration[e] = correct_opening(nodes, values, m.inner->skeleton.frame[e].col(0), e, v);
  });
  add_bubbles(m, nodes, data, v, result);
  parallel_for(static_cast<Index>(m.mesh.triangles.size()), m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const std::vector<Index> of = nodes.of(t);
      for (std::size_t i = 0; i < of.size(); ++i)
        if (of[i] != none) result.nodal.col(t).segment<2>(2 * static_cast<Eigen::Index>(i)) = v.col(of[i]);
    }
  });
  return result;
}

/// Once per mesh. Nodes inside triangles get numbers of their own behind all others, so that one loop serves all nodes.
Averaging averaging(const Model& m) {
  const Nodes nodes = make_nodes(m, m.element.trace + 1);
  const Index triangles = static_cast<Index>(m.mesh.triangles.size()), edges = static_cast<Index>(m.mesh.edges.size());
  Averaging a{nodes.degree, dim(nodes.degree), nodes.count, {}, {}, Eigen::VectorXd(triangles), {}};
  a.of.reserve(static_cast<std::size_t>(triangles) * static_cast<std::size_t>(a.per_triangle));
  for (Index t = 0; t < triangles; ++t) {
    for (const Index node : nodes.of(t)) a.of.push_back(node == none ? a.count++ : node);
    a.share[t] = area(m.mesh, t) * material_of(m.mesh, m.scene, t).mu;
  }
  a.reciprocal.setZero(a.count);
  for (Index t = 0; t < triangles; ++t)
    for (int i = 0; i < a.per_triangle; ++i) a.reciprocal[a.of[t * a.per_triangle + i]] += a.share[t];
  a.reciprocal = a.reciprocal.cwiseInverse().eval();
  a.on.assign(static_cast<std::size_t>(2 * edges) * static_cast<std::size_t>(a.degree + 1), none);
  for (Index e = 0; e < edges; ++e)
    for (int side = 0; side < 2; ++side) {
      const Index t = m.mesh.sides[e][side];
      if (t == none || (side == 1 && m.mesh.sides[e][0] != none && nodes.mesh.crack[e] == none)) continue;
      Index* to = &a.on[static_cast<std::size_t>((2 * e + side) * (a.degree + 1))];
      for (int i = 1; i < a.degree; ++i) to[i] = nodes.on_edge(e, side, i);
      to[0] = nodes.corner(t, m.mesh.edges[e][0]);
      to[a.degree] = nodes.corner(t, m.mesh.edges[e][1]);
    }
  return a;
}

namespace {

using Row = Eigen::Array<double, 1, lanes>;

// The conforming displacements of fields side by side, step by step as of one.
// A row of `lanes` numbers per node and component; edges are walked once for all of them.
class LaneAverages {
 public:
  LaneAverages(const Averaging& by, const Model& m, const LaneStates& states,
               std::span<const std::vector<EdgeData>> data, LaneConforming& result)
      : by_(by), m_(m), states_(states), data_(data), result_(result), v_(result.values) {}

  void operator()() {
    average();
    for (int i = 0; i < states_.count; ++i) correct_corners(i);
    correct_edges();
    const Bubbles bubbles(m_);
    result_.of.assign(static_cast<std::size_t>(states_.count), {});
    for (int i = 0; i < states_.count; ++i) {
      Conforming& of = result_.of[static_cast<std::size_t>(i)];
      of.degree = by_.degree;
      for (const EdgeData& d : data_[static_cast<std::size_t>(i)])
        bubbles.add(d, along(v_, d.edge, m_.mesh.sides[d.edge][0] == d.triangle ? 0 : 1, i), of);
    }
  }

 private:
  const Index* on(Index e, int side) const {
    // The right side of an edge that is no crack has the values of the left.
    const auto at = [&](int k) { return &by_.on[static_cast<std::size_t>((2 * e + k) * (by_.degree + 1))]; };
    return at(side)[0] == none ? at(0) : at(side);
  }
  Eigen::Map<Row> row(Index node, int k) {
    return Eigen::Map<Row>(v_.at(node) + k * lanes);
  }

  // One field along an edge, in its frame.
  Points along(const LaneArray& v, Index e, int side, int lane) const {
    Points here(2, by_.degree + 1);
    for (int i = 0; i <= by_.degree; ++i) {
      const double* at = v.at(on(e, side)[i]) + lane;
      here.col(i) << at[0], at[lanes];
    }
    return m_.inner->skeleton.frame[e].transpose() * here;
  }

  /// In the order of the triangles, by one thread: the sum of a node takes its triangles in the same order each time.
  void average() {
    v_.resize(by_.count, 2);
    v_.clear();
    const int n = by_.per_triangle;
    for (Index t = 0; t < static_cast<Index>(m_.mesh.triangles.size()); ++t)
      for (int i = 0; i < n; ++i) {
        const Index node = by_.of[t * n + i];
        const double w = by_.share[t] * by_.reciprocal[node], *from = states_.nodal.at(t) + 2 * i * lanes;
        for (int k = 0; k < 2; ++k) row(node, k) += w * Eigen::Map<const Row>(from + k * lanes);
      }
  }

  /// Supports alone, as there is no contact: duals have values of their own at the same corners.
  void correct_corners(int lane) {
    std::map<Index, std::vector<Held>> held;
    for (const EdgeData& d : data_[static_cast<std::size_t>(lane)])
      for (int end = 0; end < 2; ++end)
        for (int k = 0; k < 2; ++k)
          if (d.held[k])
            held[on(d.edge, m_.mesh.sides[d.edge][0] == d.triangle ? 0 : 1)[end == 0 ? 0 : by_.degree]].push_back(
                {m_.inner->skeleton.frame[d.edge].col(k), d.ends(k, end)});
    for (const auto& [node, list] : held) {
      double* at = v_.at(node) + lane;
      const Vec2 moved = obey({at[0], at[lanes]}, list);
      at[0] = moved.x(), at[lanes] = moved.y();
    }
  }

  /// All duals have the same edges with data and hold the same components there, so that the first one tells where.
  void correct_edges() {
    const EdgeRule rule = even(by_.degree);
    const Fit fit;
    std::vector<Index> place(m_.mesh.edges.size(), none);  // of cracks the right side; neither is held
    const std::vector<EdgeData>& first = data_.front();
    for (std::size_t i = 0; i < first.size(); ++i) place[first[i].edge] = static_cast<Index>(i);
    for (Index e = 0; e < static_cast<Index>(m_.mesh.edges.size()); ++e)
      for (int side = 0; side < 2; ++side) {
        const Index* nodes = &by_.on[static_cast<std::size_t>((2 * e + side) * (by_.degree + 1))];
        if (nodes[0] == none) continue;
        const Mat2& frame = m_.inner->skeleton.frame[e];
        std::array<Row, 2> rest = missing(rule, nodes, e, side);
        const Index given = place[e];
        for (int k = 0; k < 2; ++k) {
          if (given != none && first[given].held[k])
            towards(fit, rule, e, side, k, given);
          else
            for (int i = 1; i < by_.degree; ++i) {
              const Row change = 6 * rule.s[i] * (1 - rule.s[i]) * rest[k];
              row(nodes[i], 0) += frame(0, k) * change;
              row(nodes[i], 1) += frame(1, k) * change;
            }
        }
      }
  }

  // What the means along the edge lack of those of the multipliers, in the frame of the edge.
  std::array<Row, 2> missing(const EdgeRule& rule, const Index* nodes, Index e, int side) {
    const Skeleton& skeleton = m_.inner->skeleton;
    const EdgeRule& trace = m_.inner->kernel.trace;
    const Mat2& frame = skeleton.frame[e];
    Row x = Row::Zero(), y = Row::Zero();
    for (int i = 0; i <= by_.degree; ++i) {
      x += rule.w[i] * row(nodes[i], 0);
      y += rule.w[i] * row(nodes[i], 1);
    }
    std::array<Row, 2> rest;
    for (int k = 0; k < 2; ++k) {
      rest[k] = -frame(0, k) * x - frame(1, k) * y;
      for (Eigen::Index g = 0; g < trace.w.size(); ++g) {
        const Index local = 2 * static_cast<Index>(g) + k;
        rest[k] += trace.w[g] * Eigen::Map<const Row>(states_.skeleton.at(e * skeleton.per_edge + local));
        if (side == 1 && skeleton.jump[e] != none)
          rest[k] += trace.w[g] * Eigen::Map<const Row>(states_.skeleton.at(skeleton.jump[e] + local));
      }
    }
    return rest;
  }

  void towards(const Fit& fit, const EdgeRule& rule, Index e, int side, int k, Index given) {
    const Vec2 way = m_.inner->skeleton.frame[e].col(k);
    for (int lane = 0; lane < states_.count; ++lane) {
      const EdgeData& d = data_[static_cast<std::size_t>(lane)][static_cast<std::size_t>(given)];
      const Eigen::RowVectorXd change = towards_data(fit, rule, along(v_, e, side, lane).row(k), d.displacement.row(k));
      for (int i = 1; i < by_.degree; ++i) {
        double* at = v_.at(on(e, side)[i]) + lane;
        at[0] += change[i] * way.x();
        at[lanes] += change[i] * way.y();
      }
    }
  }

  const Averaging& by_;
  const Model& m_;
  const LaneStates& states_;
  std::span<const std::vector<EdgeData>> data_;
  LaneConforming& result_;
  LaneArray& v_;
};

}  // namespace

void conforming_lanes(const Averaging& by, const Model& m, const LaneStates& states,
                      std::span<const std::vector<EdgeData>> data, LaneConforming& result) {
  LaneAverages(by, m, states, data, result)();
}

}  // namespace kerf
