#include "solver/system/standing.hpp"

#include "base/dense.hpp"
#include "geometry/topology.hpp"
#include "solver/nonnegative.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// What a piece's motion is on all unknowns: its trace on the base unknowns, right less left on the jumps.
Eigen::VectorXd on_unknowns(const Mesh& mesh, const Kernel& k, const Skeleton& s, const Standing& standing,
                            const PieceMotion& of) {
  const Eigen::VectorXd at = trace(mesh, k, s, of.motion);
  Eigen::VectorXd all = Eigen::VectorXd::Zero(s.total);
  const auto in = [&](Index t) { return t != none && standing.piece[t] == of.piece; };
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

Eigen::MatrixXd on_unknowns(const Mesh& mesh, const Kernel& k, const Skeleton& s, const Standing& standing) {
  Eigen::MatrixXd all(s.total, static_cast<Eigen::Index>(standing.motions.size()));
  for (std::size_t i = 0; i < standing.motions.size(); ++i)
    all.col(static_cast<Eigen::Index>(i)) = on_unknowns(mesh, k, s, standing, standing.motions[i]);
  return all;
}

constexpr double resists = 1e-9;  // relative singular values below are rounding

/// Orthonormal combinations that the rows do not see.
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
PieceMotion leading(const Standing& standing, const Eigen::VectorXd& share) {
  std::vector<double> size;
  for (std::size_t i = 0; i < standing.motions.size(); ++i) {
    const auto piece = static_cast<std::size_t>(standing.motions[i].piece);
    if (size.size() <= piece) size.resize(piece + 1, 0);
    size[piece] += std::pow(share[static_cast<Eigen::Index>(i)], 2);
  }
  const Index piece = static_cast<Index>(std::max_element(size.begin(), size.end()) - size.begin());
  PieceMotion sum{piece, {}, {}};
  for (std::size_t i = 0; i < standing.motions.size(); ++i) {
    const PieceMotion& m = standing.motions[i];
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
FaceUnknowns face_unknowns(const Mesh& mesh, const Scene& scene, const Skeleton& s) {
  FaceUnknowns f;
  for (std::size_t c = 0; c < mesh.cracks.size(); ++c) {
    if (scene.laws[c].kind != CrackLaw::Kind::Unilateral) continue;
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

Standing standing_pieces(const Mesh& mesh, const Kernel& k, const Scene& scene, Skeleton& s) {
  std::vector<bool> cut(mesh.edges.size(), false);
  for (std::size_t e = 0; e < cut.size(); ++e)
    cut[e] = mesh.crack[e] != none && scene.laws[mesh.crack[e]].kind != CrackLaw::Kind::Bonded;
  Standing standing{.piece = pieces(mesh, cut)};
  const Index count = standing.piece.empty() ? 0 : 1 + *std::max_element(standing.piece.begin(), standing.piece.end());
  for (Index p = 0; p < count && count > 1; ++p) {
    const auto inside = std::find(standing.piece.begin(), standing.piece.end(), p) - standing.piece.begin();
    for (const RigidMotion& motion : free_motions(mesh, k, s, standing.piece, p))
      standing.motions.push_back({p, centroid(mesh, static_cast<Index>(inside)), motion});
  }
  standing.in_pieces = count > 1;
  if (standing.empty()) return {.in_pieces = standing.in_pieces};
  const Eigen::MatrixXd all = on_unknowns(mesh, k, s, standing);
  const FaceUnknowns faces = face_unknowns(mesh, scene, s);
  std::vector<Index> rows = faces.resisting;
  standing.free = unseen_by(all(rows, Eigen::all));
  for (Eigen::MatrixXd left = standing.free; left.cols() > 0; left = unseen_by(all(rows, Eigen::all))) {
    Index best = none;
    double most = 1e-6;  // jumps of motions of unit size
    for (const Index u : faces.sliding)
      if (const double jump = std::abs(all.row(u).dot(left.col(0))); jump > most) most = jump, best = u;
    if (best == none && multiply(all.bottomRows(s.total - s.base), left.col(0)).cwiseAbs().maxCoeff() < 1e-6)
      throw Error(Fault::Numerics,
                  fmt::format("cracks cut the body into {} pieces that contact may hold together, but nothing holds "
                              "the whole against {}; support one of its pieces",
                              count, describe(leading(standing, left.col(0)).motion)));
    if (best == none)
      throw Error(Fault::Numerics,
                  fmt::format("cracks cut the body into {} pieces, and {}, which no contact can stop; support that "
                              "piece, give the crack contact = \"unilateral\", or end it inside the body",
                              count, named(leading(standing, left.col(0)))));
    s.sliding[best] = true;
    rows.push_back(best);
  }
  return standing;
}

namespace {

/// Forces of contact on a motion, by unit pressures: a column per ray of the cones.
Eigen::MatrixXd rays(const Numbered& of, const Eigen::MatrixXd& jumps) {
  const Skeleton& s = of.skeleton;
  const Index leading = of.ordering.size - of.ordering.contact_rows;
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

void Standing::release(Eigen::Ref<Eigen::MatrixXd> S) const {
  if (empty()) return;
  S.diagonal() -= springs;
  if (slides.cols() > 0) S += S.diagonal().mean() * slides * slides.transpose();
}

void hold(const Numbered& of, const LowerTriangle& K, const Eigen::VectorXd& F, Standing& standing,
          std::vector<std::string>& notes) {
  const Ordering& o = of.ordering;
  const Eigen::MatrixXd all = on_unknowns(of.mesh, of.kernel, of.skeleton, standing);
  const Eigen::Index motions = all.cols();
  Eigen::MatrixXd jumps(o.contact_rows, motions);
  Eigen::VectorXd work = Eigen::VectorXd::Zero(motions), size = work;
  const Index leading_rows = o.size - o.contact_rows;
  for (Index u = 0; u < of.skeleton.total; ++u) {
    const Index row = o.row[u];
    if (row == none) continue;
    work += F[row] * all.row(u).transpose();
    size += std::abs(F[row]) * all.row(u).transpose().cwiseAbs();
    if (row >= leading_rows) jumps.row(row - leading_rows) = all.row(u);
  }
  // Loads that balance nearly are those of a mesh; what balances to rounding alone is told apart from what does not.
  constexpr double balanced = 1e-6;
  const Eigen::VectorXd left = unbalanced(rays(of, jumps), work);
  if (left.norm() > balanced * size.norm())
    throw Error(Fault::Numerics,
                fmt::format("contact does not hold the body: {}, and the loads push it that way; press it onto what "
                            "should hold it, or support it with a [[boundary]]",
                            named(leading(standing, left))));
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> pivots = pivoted_qr(jumps.transpose());
  standing.springs = Eigen::VectorXd::Zero(o.contact_rows);
  for (Eigen::Index i = 0; i < motions; ++i) {
    const Index row = static_cast<Index>(pivots.colsPermutation().indices()[i]);
    standing.springs[row] = K.values[K.start[leading_rows + row]];
  }
  standing.slides = basis_of(multiply(jumps, standing.free));
  standing.others = basis_of(jumps - multiply(standing.slides, transposed_multiply(standing.slides, jumps)));
  std::vector<Index> named_pieces;
  for (const PieceMotion& m : standing.motions)
    if (std::find(named_pieces.begin(), named_pieces.end(), m.piece) == named_pieces.end())
      named_pieces.push_back(m.piece);
  std::string note = fmt::format("{} piece{} of the body {} held by contact alone", named_pieces.size(),
                                 named_pieces.size() == 1 ? "" : "s", named_pieces.size() == 1 ? "is" : "are");
  if (standing.slides.cols() > 0)
    note += fmt::format("; {} without resistance, and stays where it slides least",
                        named(leading(standing, standing.free.col(0))));
  notes.push_back(std::move(note));
}

Contact semicoercive(const SmallProblem& p, const std::vector<Motion>& guess) {
  constexpr int most = 30;
  const double weight = 1e-4 * p.S.diagonal().mean();
  const Eigen::MatrixXd& Q = p.standing.others;
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
