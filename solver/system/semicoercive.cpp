// Pieces of a body that contact alone holds: K has their rigid motions R for its kernel, R_c their jumps on the rows in
// contact. Slides that no row of R_c sees get rows of no law until R_c has full rank. At as many pivoted rows as there
// are motions the diagonal is doubled for the factor, K + D = L L', and
//   S = L_22 L_22' - D,   S R_c = 0   [theory: C.24];
// the problem is solvable if R'F + sum_i q_i g_i = 0 for some q >= 0 on the rays g_i of the contact cones [theory:
// C.25], found by nonnegative least squares [Lawson, Hanson 1974]; else the motion with which rigid pieces would begin
// is named [Moreau 1988; theory: C.37]. The search adds a proximal term (delta/2) |Q'(j - j_m)|^2 on the motions
// [theory: C.26]. Derived in docs/theory/contact.md, section Pieces that contact holds.

#include "solver/system/semicoercive.hpp"

#include "base/dense.hpp"
#include "base/nonnegative.hpp"
#include "geometry/plane.hpp"
#include "geometry/topology.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

namespace {

/// What a piece's motion is on all unknowns: its trace on the base unknowns, right less left on the jumps.
Eigen::VectorXd on_unknowns(const Mesh& mesh, const Kernel& k, const Skeleton& s, const Semicoercive& semicoercive,
                            const PieceMotion& of) {
  const Eigen::VectorXd at = trace(mesh, k, s, of.motion);
  Eigen::VectorXd all = Eigen::VectorXd::Zero(s.total);
  const auto in = [&](Index t) { return t != none && semicoercive.piece[t] == of.piece; };
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    const auto [left, right] = mesh.sides[e];
    const double jumps = (in(right) ? 1 : 0) - (in(left) ? 1 : 0);
    for (int i = 0; i < s.per_edge; ++i) {
      const Index u = edge_unknown(s, e) + i;
      if (in(left == none ? right : left)) all[u] = at[u];
      if (s.jump[e] != none && jumps != 0) all[s.jump[e] + i] = jumps * at[u];
    }
  }
  for (std::size_t t = 0; s.per_vertex > 0 && t < mesh.triangles.size(); ++t)
    if (in(static_cast<Index>(t)))
      for (const Index corner : s.corners.of[t])
        for (int i = 0; i < s.per_vertex; ++i) all[corner_unknown(s, corner) + i] = at[corner_unknown(s, corner) + i];
  return all;
}

Eigen::MatrixXd on_unknowns(const Mesh& mesh, const Kernel& k, const Skeleton& s, const Semicoercive& semicoercive) {
  Eigen::MatrixXd all(s.total, static_cast<Eigen::Index>(semicoercive.motions.size()));
  for (std::size_t i = 0; i < semicoercive.motions.size(); ++i)
    all.col(static_cast<Eigen::Index>(i)) = on_unknowns(mesh, k, s, semicoercive, semicoercive.motions[i]);
  return all;
}

constexpr double resists = 1e-9;  // relative eigenvalues of rows'rows below are rounding

/// Orthonormal combinations that the rows do not see.
/// By eigenvalues of rows'rows, squares of singular values: the limit on those is 3e-5 of the largest.
Eigen::MatrixXd unseen_by(const Eigen::MatrixXd& rows) {
  const Eigen::Index n = rows.cols();
  if (rows.rows() == 0) return Eigen::MatrixXd::Identity(n, n);
  const auto [values, vectors] = eigenpairs(transposed_multiply(rows, rows));
  const double largest = values[n - 1];
  Eigen::Index count = 0;
  while (count < n && !(values[count] > resists * largest)) ++count;
  return vectors.leftCols(count);
}

/// Of a combination, what the piece that moves most does.
/// For messages: the sizes are those of the shares, in units of the radius of each piece.
PieceMotion leading(const Semicoercive& semicoercive, const Eigen::VectorXd& share) {
  std::vector<double> size;
  for (std::size_t i = 0; i < semicoercive.motions.size(); ++i) {
    const auto piece = static_cast<std::size_t>(semicoercive.motions[i].piece);
    if (size.size() <= piece) size.resize(piece + 1, 0);
    size[piece] += std::pow(share[static_cast<Eigen::Index>(i)], 2);
  }
  const Index piece = static_cast<Index>(std::max_element(size.begin(), size.end()) - size.begin());
  PieceMotion sum{piece, {}, {}};
  for (std::size_t i = 0; i < semicoercive.motions.size(); ++i) {
    const PieceMotion& m = semicoercive.motions[i];
    if (m.piece != piece) continue;
    const double f = share[static_cast<Eigen::Index>(i)];
    sum.inside = m.inside;
    sum.motion.center = m.motion.center;
    sum.motion.translation += f * m.motion.translation;
    sum.motion.rotation += f * m.motion.rotation;
  }
  return sum;
}

std::string named(const PieceMotion& m) {
  return fmt::format("the piece around ({:.4g}, {:.4g}) is free to make {}", m.inside.x(), m.inside.y(),
                     describe(m.motion));
}

/// Rows that a law acts on, and tangential jumps that could become rows of none.
struct FaceUnknowns {
  std::vector<Index> resisting, sliding;
};
/// Tangential jumps without friction resist nothing, and are candidates for rows of no law.
FaceUnknowns face_unknowns(const Mesh& mesh, const Scene& scene, const Skeleton& s) {
  FaceUnknowns f;
  for (std::size_t c = 0; c < mesh.cracks.size(); ++c) {
    if (!is_unilateral(scene.laws[c])) continue;
    for (const CrackEdge& edge : mesh.cracks[c])
      for (int i = 0; i < s.per_edge; ++i) {
        const Index u = s.jump[edge.edge] + i;
        if (s.bounded[u] || s.frictional[u])
          f.resisting.push_back(u);
        else if (!s.fixed[u])
          f.sliding.push_back(u);
      }
  }
  return f;
}

}  // namespace

std::vector<Index> pieces_of(const Mesh& mesh, const Scene& scene) {
  std::vector<bool> cut(mesh.edges.size(), false);
  for (std::size_t e = 0; e < cut.size(); ++e)
    cut[e] = mesh.crack[e] != none && scene.laws[mesh.crack[e]].kind != CrackLaw::Kind::Bonded;
  return pieces(mesh, cut);
}

/// `left` shrinks by one column with each row that is added. A jump of 1e-6 of a motion of unit size is the least that
/// stops it.
Semicoercive semicoercive_pieces(const Mesh& mesh, const Kernel& k, const Scene& scene, Skeleton& s) {
  Semicoercive semicoercive{.piece = pieces_of(mesh, scene)};
  const Index count =
      semicoercive.piece.empty() ? 0 : 1 + *std::max_element(semicoercive.piece.begin(), semicoercive.piece.end());
  for (Index p = 0; p < count && count > 1; ++p) {
    const auto inside = std::find(semicoercive.piece.begin(), semicoercive.piece.end(), p) - semicoercive.piece.begin();
    for (const RigidMotion& motion : free_motions(mesh, k, s, semicoercive.piece, p))
      semicoercive.motions.push_back({p, centroid(mesh, static_cast<Index>(inside)), motion});
  }
  semicoercive.in_pieces = count > 1;
  if (semicoercive.empty()) return {.in_pieces = semicoercive.in_pieces};
  const Eigen::MatrixXd all = on_unknowns(mesh, k, s, semicoercive);
  const FaceUnknowns faces = face_unknowns(mesh, scene, s);
  std::vector<Index> rows = faces.resisting;
  semicoercive.free = unseen_by(all(rows, Eigen::all));
  for (Eigen::MatrixXd left = semicoercive.free; left.cols() > 0; left = unseen_by(all(rows, Eigen::all))) {
    Index best = none;
    double most = 1e-6;  // jumps of motions of unit size
    for (const Index u : faces.sliding)
      if (const double jump = std::abs(all.row(u).dot(left.col(0))); jump > most) most = jump, best = u;
    if (best == none)
      throw Error(Fault::Numerics,
                  fmt::format("cracks cut the body into {} pieces, and {}, which no contact can stop; support that "
                              "piece, give the crack contact = \"unilateral\", or end it inside the body",
                              count, named(leading(semicoercive, left.col(0)))));
    s.sliding[best] = true;
    rows.push_back(best);
  }
  return semicoercive;
}

namespace {

/// Forces of contact on a motion, by unit pressures: a column per ray of the cones.
/// Rays of the cone at a Gauss point: n, or with friction its edges n + f t and n - f t, and +-t where a slip bound
/// acts on open points as well.
Eigen::MatrixXd rays(const Numbered& of, const Eigen::MatrixXd& jumps) {
  const Skeleton& s = of.skeleton;
  const Index leading = of.ordering.leading();
  std::vector<Eigen::VectorXd> all;
  const auto row = [&](Index u) -> Eigen::VectorXd { return jumps.row(of.ordering.row[u] - leading).transpose(); };
  for (std::size_t c = 0; c < of.mesh.cracks.size(); ++c)
    for (const CrackEdge& edge : of.mesh.cracks[c])
      for (int i = 0; i < s.per_edge; i += 2) {
        const Index u = s.jump[edge.edge] + i;
        if (!s.bounded[u]) continue;
        const CrackLaw& law = of.scene.laws[c];
        if (!s.frictional[u + 1]) {
          all.push_back(row(u));
          continue;
        }
        for (const double side : {-1.0, 1.0}) all.push_back(row(u) + side * law.friction * row(u + 1));
        if (law.slip_bound > 0)
          for (const double side : {-1.0, 1.0}) all.push_back(side * row(u + 1));
      }
  Eigen::MatrixXd matrix(jumps.cols(), static_cast<Eigen::Index>(all.size()));
  for (std::size_t i = 0; i < all.size(); ++i) matrix.col(static_cast<Eigen::Index>(i)) = all[i];
  return matrix;
}

/// A place where two pieces may press on each other: an end of a straight run of a crack's edges. Forces on the
/// motions.
struct Foot {
  Eigen::VectorXd normal, tangential;
  double friction, slip_bound;
  std::array<Index, 2> triangles;  // on either side
};

/// Pressures on a straight run act as two at its ends do.
std::vector<Foot> feet(const Numbered& of, const Semicoercive& semicoercive) {
  const Mesh& mesh = of.mesh;
  const Skeleton& s = of.skeleton;
  const auto count = static_cast<Eigen::Index>(semicoercive.motions.size());
  const auto pieces_beside = [&](Index e) {
    const auto [left, right] = mesh.sides[e];
    return std::array{semicoercive.piece[left], semicoercive.piece[right]};
  };
  const auto goes_on = [&](const CrackEdge& a, const CrackEdge& b) {
    std::array<Index, 2> p = pieces_beside(a.edge), q = pieces_beside(b.edge);
    std::ranges::sort(p), std::ranges::sort(q);
    const Vec2 n = s.frame[a.edge].col(0), m = s.frame[b.edge].col(0);
    constexpr double straight = 1e-10;
    return p == q && std::abs(cross(n, m)) < straight && std::abs(n.dot(tangent(mesh, b.edge))) < straight;
  };
  std::vector<Foot> all;
  for (std::size_t c = 0; c < mesh.cracks.size(); ++c) {
    const std::vector<CrackEdge>& crack = mesh.cracks[c];
    for (std::size_t i = 0; i < crack.size(); ++i) {
      const Index e = crack[i].edge;
      const auto [left, right] = pieces_beside(e);
      if (left == right || s.jump[e] == none || !s.bounded[s.jump[e]]) continue;
      for (const int end : {0, 1}) {
        const bool first = (end == 0) == crack[i].forward;
        if (first ? i > 0 && goes_on(crack[i - 1], crack[i]) : i + 1 < crack.size() && goes_on(crack[i], crack[i + 1]))
          continue;
        const Mat2 frame = frame_at(s, e, end == 0 ? 0 : s.per_edge / 2 - 1);
        const Vec2 x = mesh.points[mesh.edges[e][end]];
        Foot foot{Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count), of.scene.laws[c].friction,
                  of.scene.laws[c].slip_bound, mesh.sides[e]};
        for (Eigen::Index k = 0; k < count; ++k) {
          const PieceMotion& m = semicoercive.motions[static_cast<std::size_t>(k)];
          const Vec2 jump = ((m.piece == right ? 1 : 0) - (m.piece == left ? 1 : 0)) * m.motion.at(x);
          foot.normal[k] = jump.dot(frame.col(0)), foot.tangential[k] = jump.dot(frame.col(1));
        }
        all.push_back(std::move(foot));
      }
    }
  }
  return all;
}

/// As `rays`.
Eigen::MatrixXd rays(const std::vector<Foot>& feet, Eigen::Index motions) {
  std::vector<Eigen::VectorXd> all;
  for (const Foot& f : feet)
    for (const double side : {-1.0, 1.0}) {
      all.push_back(f.normal + side * f.friction * f.tangential);
      if (f.slip_bound > 0) all.push_back(side * f.tangential);
    }
  Eigen::MatrixXd matrix(motions, static_cast<Eigen::Index>(all.size()));
  for (std::size_t i = 0; i < all.size(); ++i) matrix.col(static_cast<Eigen::Index>(i)) = all[i];
  return matrix;
}

/// How rigid pieces at rest begin to move under the work `f` per motion: the forces at their feet press where they do
/// not part and rub against the way they slide, at most by friction times what presses (complementarity, by projected
/// Gauss-Seidel [Moreau 1988]). Motions have unit mass.
/// One sweep over the feet changes one force after the other so that its own point obeys the law; motions follow at
/// once (Gauss-Seidel). Slip bounds stop any slide here: only what Coulomb and contact allow is named.
Eigen::VectorXd beginning(const std::vector<Foot>& feet, const Eigen::VectorXd& f) {
  constexpr int most = 20000;
  constexpr double settled = 1e-12;
  Eigen::VectorXd motion = f;
  std::vector<Vec2> force(feet.size(), Vec2::Zero());
  for (int sweep = 0; sweep < most; ++sweep) {
    double change = 0;
    for (std::size_t i = 0; i < feet.size(); ++i) {
      const auto move = [&](const Eigen::VectorXd& along, double& part, double low, double high) {
        const double mass = along.squaredNorm();
        if (!(mass > 0)) return;
        const double now = std::clamp(part - along.dot(motion) / mass, low, high), step = now - part;
        motion += step * along;
        change = std::max(change, std::abs(step) * std::sqrt(mass));
        part = now;
      };
      move(feet[i].normal, force[i].x(), 0, infinity);
      const double most_shear = feet[i].slip_bound > 0 ? infinity : feet[i].friction * force[i].x();
      move(feet[i].tangential, force[i].y(), -most_shear, most_shear);
    }
    if (change <= settled * f.norm()) break;
  }
  return motion;
}

/// What of f no combination of the columns with factors >= 0 balances: f + A q at the best q.
Eigen::VectorXd unbalanced(const Eigen::MatrixXd& A, const Eigen::VectorXd& f) {
  return f + multiply(A, nonnegative_least_squares(A, -f));
}

/// An orthonormal basis of what the columns span.
Eigen::MatrixXd basis_of(const Eigen::MatrixXd& columns) {
  if (columns.cols() == 0) return columns;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr = pivoted_qr(columns);
  return orthonormal(qr, qr.rank());
}

}  // namespace

/// Slides get the mean of the diagonal for a stiffness: S stays definite, and the state is the one that slides least.
void Semicoercive::release(Eigen::Ref<Eigen::MatrixXd> S) const {
  if (empty()) return;
  S.diagonal() -= springs;
  if (slides.cols() > 0) S += S.diagonal().mean() * slides * slides.transpose();
}

/// First the feet, where forces may act up to the ends of the faces: if these do not balance the loads nothing does.
/// Then the Gauss points of the mesh: if those do not, triangles at the ends of the feet are too large. What is left in
/// between is rounding and taken out of F.
void hold(const Numbered& of, const LowerTriangle& K, Eigen::VectorXd& F, Semicoercive& semicoercive,
          std::vector<std::string>& notes) {
  const Ordering& o = of.ordering;
  const Eigen::MatrixXd all = on_unknowns(of.mesh, of.kernel, of.skeleton, semicoercive);
  const Eigen::Index motions = all.cols();
  Eigen::MatrixXd jumps(o.contact_rows, motions);
  Eigen::VectorXd work = Eigen::VectorXd::Zero(motions), size = work;
  const Index leading_rows = o.leading();
  for (Index u = 0; u < of.skeleton.total; ++u) {
    const Index row = o.row[u];
    if (row == none) continue;
    work += F[row] * all.row(u).transpose();
    size += std::abs(F[row]) * all.row(u).transpose().cwiseAbs();
    if (row >= leading_rows) jumps.row(row - leading_rows) = all.row(u);
  }
  // Loads that balance nearly are those of a mesh; what balances to rounding alone is told apart from what does not.
  constexpr double balanced = 1e-6, rounding = 1e-13;
  const double allowed = balanced * size.norm() + rounding * F.lpNorm<1>();
  const std::vector<Foot> places = feet(of, semicoercive);
  const Eigen::VectorXd falls = unbalanced(rays(places, motions), work);
  if (falls.norm() > allowed) {
    const Eigen::VectorXd begins = beginning(places, work);
    throw Error(Fault::Numerics,
                fmt::format("contact does not hold the body: {}, and the loads push it that way; press it onto what "
                            "should hold it, or support it with a [[boundary]]",
                            named(leading(semicoercive, begins.norm() > allowed ? begins : falls))));
  }
  const Eigen::VectorXd left = unbalanced(rays(of, jumps), work);
  if (left.norm() > allowed) {
    std::vector<Index> ends;
    for (const Foot& foot : places) ends.insert(ends.end(), foot.triangles.begin(), foot.triangles.end());
    std::ranges::sort(ends);
    ends.erase(std::ranges::unique(ends).begin(), ends.end());
    throw CoarseFeet(
        fmt::format("contact holds the body, but by pressures nearer to the ends of the faces than the mesh "
                    "has points: {}; a smaller mesh.size shows them",
                    named(leading(semicoercive, left))),
        std::move(ends));
  }
  if (left.norm() > 0 && left.norm() <= rounding * F.lpNorm<1>()) {
    Eigen::MatrixXd on_rows = Eigen::MatrixXd::Zero(F.size(), motions);
    for (Index u = 0; u < of.skeleton.total; ++u)
      if (o.row[u] != none) on_rows.row(o.row[u]) = all.row(u);
    F -= multiply(on_rows, solve_spd(transposed_multiply(on_rows, on_rows), left));
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> pivots = pivoted_qr(jumps.transpose());
  semicoercive.springs = Eigen::VectorXd::Zero(o.contact_rows);
  for (Eigen::Index i = 0; i < motions; ++i) {
    const Index row = static_cast<Index>(pivots.colsPermutation().indices()[i]);
    semicoercive.springs[row] = K.values[K.start[leading_rows + row]];
  }
  semicoercive.slides = basis_of(multiply(jumps, semicoercive.free));
  semicoercive.others =
      basis_of(jumps - multiply(semicoercive.slides, transposed_multiply(semicoercive.slides, jumps)));
  std::vector<Index> named_pieces;
  for (const PieceMotion& m : semicoercive.motions)
    if (std::find(named_pieces.begin(), named_pieces.end(), m.piece) == named_pieces.end())
      named_pieces.push_back(m.piece);
  std::string note = fmt::format("{} piece{} of the body {} held by contact alone", named_pieces.size(),
                                 named_pieces.size() == 1 ? "" : "s", named_pieces.size() == 1 ? "is" : "are");
  if (semicoercive.slides.cols() > 0)
    note += fmt::format("; {} without resistance, and stays where it slides least",
                        named(leading(semicoercive, semicoercive.free.col(0))));
  notes.push_back(std::move(note));
}

/// delta = 1e-4 of the mean diagonal of S. When the set stays S alone takes it on, whose moving rows are definite where
/// contact holds the pieces.
Contact semicoercive(const SmallProblem& p, const std::vector<Motion>& guess) {
  constexpr int most = 30;
  const double weight = 1e-4 * p.S.diagonal().mean();
  const Eigen::MatrixXd& Q = p.semicoercive.others;
  const Eigen::MatrixXd held = p.S + weight * Q * Q.transpose();
  Contact found{.jump = Eigen::VectorXd::Zero(p.r.size()), .motion = guess};
  int iterations = 0;
  for (int step = 0; step < most; ++step) {
    const Eigen::VectorXd r = p.r + weight * (Q * (Q.transpose() * found.jump));
    const std::vector<Motion> before = found.motion;
    found = dual_qp(held, r, p.points, before);
    iterations += found.iterations;
    if (step > 0 && found.motion != before) continue;
    Contact alone = dual_qp(p.S, p.r, p.points, found.motion);
    iterations += alone.iterations;
    if (!alone.converged) continue;
    found = std::move(alone);
    break;
  }
  found.iterations = iterations;
  return found;
}

}  // namespace kerf
