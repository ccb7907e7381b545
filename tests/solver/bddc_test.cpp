// Bodies that several processes solve together by BDDC of our own: as one factor does, in few iterations whatever
// materials, cracks and shapes of parts are. The processes are threads.

#include "kerf/mesher.hpp"
#include "solver/system.hpp"
#include "solver/system/complement.hpp"
#include "solver/system/gradients.hpp"
#include "solver/system/inside.hpp"
#include "solver/system/primal.hpp"
#include "tests/support/communicator.hpp"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf::bddc_test {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

/// [0, length] x [0, 1], held on its left side, drawn up on its right side.
struct Body {
  double length = 1, size = 0.12, poisson = 0.3;
  Element element = bdms(1);
  std::vector<Crack> cracks = {};
  CrackLaw law = {.kind = CrackLaw::Kind::Open};
  std::vector<Loop> discs = {};
  std::vector<double> young = {};  // of these
  Precision precision = Precision::Double;
};

const Crack slanted{"c", {{0.31, 0.42}, {0.72, 0.55}}, {}};

Mesh mesh_of(const Body& b) {
  Shape shape{.outline = polygon("outline", {{0, 0}, {b.length, 0}, {b.length, 1}, {0, 1}}, 0),
              .holes = {},
              .cracks = b.cracks,
              .labels = {"bottom", "right", "top", "left"},
              .regions = b.discs};
  for (Index side = 0; side < 4; ++side) shape.outline.sides[static_cast<std::size_t>(side)].label = side;
  return triangulate(shape, {.size = b.size, .crack_tip_size = b.size / 2});
}

Scene scene_of(const Body& b) {
  Scene s;
  s.material = plane_strain(1, b.poisson);
  for (const double young : b.young) s.regions.push_back(plane_strain(young, b.poisson));
  s.supports = {{3, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  s.tractions = {{1, [](const Vec2&, const Vec2&) { return Vec2(0.3, 1); }}};
  s.laws.assign(b.cracks.size(), b.law);
  return s;
}

/// Of each triangle the one of columns x rows boxes that it lies in.
std::vector<Index> boxes(const Mesh& mesh, double length, int columns, int rows) {
  std::vector<Index> process;
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
    const Vec2 x = centroid(mesh, t);
    process.push_back(static_cast<Index>(x.x() / length * columns) * rows + static_cast<Index>(x.y() * rows));
  }
  return process;
}

struct Found {
  double energy = 0;
  Certificate certificate;
  SolverEffort effort;
};
Found in_parts(const Body& b, const std::vector<Index>& process) {
  const Mesh coarse = mesh_of(b);
  Found found;
  test::on_peers(*std::ranges::max_element(process) + 1, [&](Communicator& comm) {
    MeshPart part = mesh_part(coarse, process, comm.count(), comm.here(), 1);
    SharedBody body(std::move(part), b.element, scene_of(b), 1, {}, pieces_for_pressure(coarse, scene_of(b)), comm,
                    nullptr, b.precision);
    const State state = body.solve();
    const double energy = sum(comm, strain_energy(body.model(), state));
    if (comm.here() == 0) found = {energy, state.certificate, body.effort()};
  });
  return found;
}
double by_one(const Body& b) {
  const Model m = prepare(refine(mesh_of(b)), b.element, scene_of(b), 1);
  return strain_energy(m, solve(m));
}

SolverEffort expect_same(const Body& b, int columns, int rows, const std::string& what, double within = 1e-9) {
  const Found found = in_parts(b, boxes(mesh_of(b), b.length, columns, rows));
  const double truth = by_one(b);
  EXPECT_NEAR(found.energy, truth, within * truth) << what;
  EXPECT_LT(found.certificate.residual, 1e-8) << what;
  EXPECT_GT(found.effort.primal, 0) << what;
  EXPECT_LE(found.effort.primal, found.effort.interface_rows) << what;
  EXPECT_EQ(found.effort.parts, columns * rows) << what;
  EXPECT_GT(found.effort.sent, 0) << what;
  return found.effort;
}

TEST(Bddc, FewIterationsForAllMaterialsAndDegrees) {
  struct Row {
    Element element;
    double poisson;
  };
  for (const Row& row : {Row{bdms(1), 0.3}, Row{bdms(1), 0.4999}, Row{bdms(2), 0.499999}, Row{bdms(1), 0.5},
                         Row{bdms(3), 0.3}, Row{bdms(2), 0.5}}) {
    Body b{.poisson = row.poisson, .element = row.element, .cracks = {slanted}};
    if (row.element.degree > 1) b.size = 0.25;
    const std::string what = "degree " + std::to_string(row.element.degree) + ", nu " + std::to_string(row.poisson);
    const SolverEffort e = expect_same(b, 2, 2, what);
    EXPECT_LE(e.iterations, 12) << what;
    EXPECT_LE(e.condition, 5) << what;
  }
}

// Rounds go on from what the rounding of L leaves.
TEST(Bddc, InsidesInSinglePrecision) {
  for (const double poisson : {0.3, 0.4999, 0.5})
    for (const auto kind : {CrackLaw::Kind::Open, CrackLaw::Kind::Unilateral}) {
      const Body b{.poisson = poisson, .cracks = {slanted}, .law = {.kind = kind}, .precision = Precision::Single};
      expect_same(b, 2, 2, "nu " + std::to_string(poisson));
    }
  expect_same({.length = 20, .size = 0.7, .precision = Precision::Single}, 5, 1, "a strip", 1e-8);
}

TEST(Bddc, FewIterationsWhateverTheContrast) {
  for (const double contrast : {1e3, 1e9}) {
    Body b{.discs = {circle("stiff", {0.47, 0.52}, 0.2, none), circle("soft", {0.75, 0.25}, 0.1, none)},
           .young = {contrast, 1 / contrast}};
    const SolverEffort e = expect_same(b, 3, 2, "contrast " + std::to_string(contrast));
    EXPECT_LE(e.iterations, 17) << contrast;
    EXPECT_LE(e.condition, 6) << contrast;
  }
}

TEST(Bddc, StripsOfAnyLength) {
  for (const double length : {20., 100., 400.}) {
    const Body b{.length = length, .size = 0.7};
    // One process ends at the residual that rounding leaves, with up to 1.1e-9 of the energy at a length of 20.
    const SolverEffort e = expect_same(b, 5, 1, "length " + std::to_string(length), 1e-8);
    EXPECT_LE(e.iterations, 8) << length;
    EXPECT_LE(e.condition, 1.5) << length;
  }
}

TEST(Bddc, CracksAcrossAndAlongParts) {
  const std::vector<Crack> both{{"along", {{0.5, 0.2}, {0.5, 0.8}}, {}}, {"across", {{0.1, 0.6}, {0.4, 0.7}}, {}}};
  for (const auto kind : {CrackLaw::Kind::Open, CrackLaw::Kind::Unilateral, CrackLaw::Kind::Bonded})
    for (const double friction : {0., 0.3}) {
      if (friction > 0 && kind != CrackLaw::Kind::Unilateral) continue;
      const Body b{.cracks = both, .law = {.kind = kind, .friction = friction}};
      const SolverEffort e = expect_same(b, 2, 2, "kind " + std::to_string(static_cast<int>(kind)));
      EXPECT_LE(e.iterations, 14);
      EXPECT_LE(e.condition, 5);
    }
}

// Parts of a few triangles, in several pieces, and shared in pieces of one edge.
TEST(Bddc, PartsOfAnyShape) {
  const Body b{.size = 0.3};
  const Mesh mesh = mesh_of(b);
  std::vector<Index> process(mesh.triangles.size());
  for (std::size_t t = 0; t < process.size(); ++t) process[t] = static_cast<Index>(t * 7 % 5);
  const Found scattered = in_parts(b, process);
  const double truth = by_one(b);
  EXPECT_NEAR(scattered.energy, truth, 1e-9 * truth);
  std::ranges::fill(process, 0);
  process.back() = 1;
  EXPECT_NEAR(in_parts(b, process).energy, truth, 1e-9 * truth);
  std::ranges::fill(process, 0);  // one has all, and shares nothing
  const Found alone = in_parts(b, process);
  EXPECT_NEAR(alone.energy, truth, 1e-9 * truth);
  EXPECT_EQ(alone.effort.interface_rows, 0);
}

// Two parts share one piece, which nothing else that they share holds: their motions are not felt by what is held.
TEST(Bddc, TwoPartsOfWhichOneIsFree) {
  const SolverEffort e = expect_same({}, 2, 1, "two");
  EXPECT_GE(e.primal, 3);
  EXPECT_LE(e.iterations, 3);
}

TEST(Bddc, TheSameBitsAgain) {
  const Body b{.cracks = {slanted}};
  const std::vector<Index> process = boxes(mesh_of(b), 1, 2, 2);
  EXPECT_EQ(in_parts(b, process).energy, in_parts(b, process).energy);
}

MatrixXd definite_matrix(Eigen::Index n, unsigned seed) {
  std::srand(seed);
  const MatrixXd a = MatrixXd::Random(n, n);
  return a * a.transpose() / static_cast<double>(n) + 0.1 * MatrixXd::Identity(n, n);
}

TEST(Bddc, SoftForcesAreAllEigenvectorsAboveTheThreshold) {
  for (const Eigen::Index n : {1, 4, 90, 300}) {
    const MatrixXd X = definite_matrix(n, 1);
    MatrixXd Z = X;
    const Eigen::Index soft = std::min<Eigen::Index>(n, 9);
    const MatrixXd more = MatrixXd::Random(n, soft);
    for (Eigen::Index k = 0; k < soft; ++k) Z += std::pow(10, k) * more.col(k) * more.col(k).transpose();
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> all(Z, X);
    const MatrixXd found = soft_forces(Z, X, 5);
    ASSERT_EQ(found.cols(), (all.eigenvalues().array() > 5).count()) << n;
    // The others are orthogonal to them in X.
    const MatrixXd others = all.eigenvectors().leftCols(n - found.cols()),
                   lengths = (found.transpose() * X * found).diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
    EXPECT_LT((lengths * found.transpose() * X * others).norm(), 0.05) << n;
  }
}

/// A grid of springs, each node held a little.
PartMatrix grid(Index side) {
  PartMatrix part{.rows = side * side};
  part.start = {0};
  for (Index row = 0; row < part.rows; ++row) {
    const Index x = row % side, y = row / side;
    const auto put = [&](bool there, Index column, double value) {
      if (!there) return;
      part.columns.push_back(column);
      part.values.push_back(value);
    };
    put(y > 0, row - side, -1);
    put(x > 0, row - 1, -1);
    put(true, row, 4 + 0.01 * (1 + row % 7));
    put(x + 1 < side, row + 1, -1);
    put(y + 1 < side, row + side, -1);
    part.start.push_back(static_cast<Index>(part.columns.size()));
  }
  return part;
}

// In one piece, in two, of which one sees all that is shared or each its own, and with nothing inside.
TEST(Bddc, InsideLeavesTheComplement) {
  constexpr Index side = 45;
  MatrixXd K = MatrixXd::Zero(side * side, side * side);
  const PartMatrix part = grid(side);
  for (Index row = 0; row < part.rows; ++row)
    for (Index p = part.start[row]; p < part.start[row + 1]; ++p) K(row, part.columns[p]) = part.values[p];
  const VectorXd b = VectorXd::Random(part.rows), x = K.llt().solve(b);
  const auto rows_where = [&](const auto& is_shared) {
    std::vector<Index> rows;
    for (Index row = part.rows; row-- > 0;)
      if (is_shared(row % side, row / side)) rows.push_back(row);
    return rows;
  };
  for (const std::vector<Index>&shared :
       {rows_where([](Index i, Index j) { return i == 0 || j == 0; }),
        rows_where([](Index i, Index) { return i == 9; }), rows_where([](Index i, Index) { return i >= 20 && i < 22; }),
        rows_where([](Index, Index) { return false; })}) {
    const auto count = static_cast<Eigen::Index>(shared.size());
    PartMatrix first = part, second = part;
    MatrixXd S, again;
    const Inside one(first, shared, 1, Precision::Double, S), three(second, shared, 3, Precision::Double, again);
    EXPECT_TRUE((S.triangularView<Eigen::Lower>().toDenseMatrix().array() ==
                 again.triangularView<Eigen::Lower>().toDenseMatrix().array())
                    .all());
    EXPECT_TRUE(first.values.empty());
    VectorXd y = one.forward(b);
    EXPECT_EQ(y, three.forward(b));
    const MatrixXd whole = S.selfadjointView<Eigen::Lower>();
    if (count > 0) y.tail(count) = whole.llt().solve(y.tail(count));
    EXPECT_LT((one.backward(y) - x).norm(), 1e-11 * x.norm()) << count;
  }
}

TEST(Bddc, ComplementIsMatrixAndFactorInOne) {
  const MatrixXd S = definite_matrix(50, 2), C = MatrixXd::Random(20, 3);
  Complement c(S);
  const VectorXd shift = VectorXd::LinSpaced(50, 0.1, 1), b = VectorXd::Random(50);
  ASSERT_TRUE(c.factorize(shift, {{10, C}}));
  MatrixXd other = S;
  other.diagonal() += shift;
  other.block(10, 10, 20, 20) += C * C.transpose();
  EXPECT_LT((other * c.solve(b) - b).norm(), 1e-12);
  EXPECT_LT((c.inverse_block(10, 20) - MatrixXd(other.inverse()).block(10, 10, 20, 20)).norm(), 1e-11);
  EXPECT_LT((c.multiply(b) - S * b).norm(), 1e-13 * S.norm());
  EXPECT_FALSE(c.factorize(VectorXd::Constant(50, -1e3), {}));
  EXPECT_LT((c.multiply(b) - S * b).norm(), 1e-13 * S.norm());
}

TEST(Bddc, GradientsBeginWithWhatTheyKnow) {
  const MatrixXd A = definite_matrix(40, 3);
  test::on_peers(1, [&](Communicator& comm) {
    const auto times = [&](const VectorXd& x) -> VectorXd { return A * x; };
    const auto same = [](const VectorXd& r) { return r; };
    SharedGradients g(comm, {VectorXd::Ones(40), times, same});
    const VectorXd b = VectorXd::Random(40);
    const SharedSolved first = g.solve(b), again = g.solve(b);
    // It ends where r.P r, here r.r, is that part of the energy.
    EXPECT_LT((A * first.x - b).norm(), 1.01 * SharedIteration::tolerance * std::sqrt(b.dot(first.x)));
    EXPECT_LE(first.iterations, 41);
    const VectorXd values = Eigen::SelfAdjointEigenSolver<MatrixXd>(A).eigenvalues();
    EXPECT_NEAR(first.condition, values[39] / values[0], 0.01 * first.condition);
    EXPECT_LE(again.iterations, 1);
    EXPECT_LT((again.x - first.x).norm(), 1e-9 * first.x.norm());
    EXPECT_EQ(g.solve(VectorXd::Zero(40)).iterations, 0);
  });
}

}  // namespace
}  // namespace kerf::bddc_test
