#include "growth/step.hpp"

#include "growth/kink.hpp"
#include "growth/piece.hpp"
#include "growth/symmetry_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace kerf::growth::step_test {
namespace {

TEST(Piece, GoesOnSmoothly) {
  // Chords of an arc around (0, 1): the end is on the circle to the third order.
  const PathTip tip{{0, 0}, 0, 0};
  double before = 0;
  for (const double turn : {0.4, 0.2, 0.1}) {
    const GrowthPiece piece = arc_piece(tip, turn, turn);
    for (const int n : {2, 5}) {
      const std::vector<Vec2> points = chords(piece, n);
      ASSERT_EQ(points.size(), static_cast<std::size_t>(n));
      const Vec2 last = points[n - 1] - points[n - 2];
      EXPECT_NEAR(std::atan2(last.y(), last.x()), turn, 1e-14);
      EXPECT_NEAR(points[0].y(), 0, 1e-15);
    }
    const double off = (chords(piece, 2).back() - Vec2(std::sin(turn), 1 - std::cos(turn))).norm();
    if (before > 0) {
      EXPECT_NEAR(off / before, 1. / 8, 0.01);
    }
    before = off;
    EXPECT_NEAR(end_of(piece, 4).direction, turn, 1e-15);
    EXPECT_NEAR(end_of(piece, 4).curvature, 1, 1e-14);
  }
  const GrowthPiece straight = straight_piece({{1, 2}, pi / 2, 0}, -pi / 2, 3);
  EXPECT_LT((chords(straight, 1).back() - Vec2(4, 2)).norm(), 1e-15);
  // Behind a kink the direction is that of theta (1 + c sqrt(s)): two thirds of the turn in the mean.
  const std::vector<Vec2> kinked = chords(kinked_piece(tip, 0, 3e-3, 1), 7);
  EXPECT_NEAR(kinked.back().y(), 2e-3, 1e-8);
  EXPECT_THROW(chords(arc_piece(tip, 0.1, 1), 1), Error);
  EXPECT_THROW(arc_piece(tip, 0.1, 0), Error);
  EXPECT_THROW(arc_piece(tip, nan, 1), Error);
}

TEST(Piece, EndOfAPolyline) {
  std::vector<Vec2> circle;
  for (int i = 0; i <= 5; ++i) circle.emplace_back(2 * std::cos(0.3 * i), 2 * std::sin(0.3 * i));
  const PathTip tip = tip_of(circle, true);
  EXPECT_NEAR(tip.curvature, 0.5, 1e-14);
  EXPECT_NEAR(tip.direction, 1.5 + pi / 2, 1e-14);
  EXPECT_NEAR(tip_of(circle, false).direction, 1.35 + pi / 2, 1e-14);
  EXPECT_EQ(tip_of(std::vector<Vec2>{{0, 0}, {1, 1}}, true).curvature, 0);
  EXPECT_THROW(tip_of(std::vector<Vec2>{{0, 0}}, true), Error);
  EXPECT_THROW(tip_of(std::vector<Vec2>{{1, 1}, {1, 1}}, true), Error);
}

TEST(Search, FindsLocalSymmetryOfSeriesInFewSolves) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  int most = 0;
  for (int i = 0; i < 300; ++i) {
    // A body whose K behind a turn is that of the series with T, of any unit, and a first turn that is off.
    const double unit = std::exp(10 * normal(random));
    TipLoad tip{unit * std::abs(normal(random)), unit * normal(random), 0};
    tip.T = 0.3 * std::sin(i) * (tip.K_I + std::abs(tip.K_II));
    const Direction truth = symmetric_direction(tip, 0.5);
    const double first = truth.angle + 0.2 * normal(random);
    SymmetrySearch search(std::abs(first) < 1.5 ? first : 0, {1e-6, 12});
    while (search.turn()) search.answer(kink(tip, *search.turn(), 0.5));
    EXPECT_TRUE(search.found()) << tip.K_I << " " << tip.K_II << " " << tip.T;
    most = std::max(most, static_cast<int>(search.answers().size()));
    EXPECT_NEAR(search.best().turn, truth.angle, 1e-4);
    EXPECT_LE(std::abs(search.best().turn - truth.angle), 3 * search.turn_error() + 1e-12);
  }
  EXPECT_LE(most, 9);
  // Closed at first: a crack under shear alone finds its wing from straight on.
  SymmetrySearch wing(0, {1e-3, 10});
  while (wing.turn()) wing.answer(kink({0, 1, 0}, *wing.turn()));
  EXPECT_TRUE(wing.found());
  EXPECT_NEAR(wing.best().turn * 180 / pi, -77.33, 0.2);
  // No symmetry: closed whatever the turn. It ends, and says that it found none.
  SymmetrySearch none_found(0.1);
  int asked = 0;
  while (none_found.turn()) none_found.answer({-1, 0.3}), ++asked;
  EXPECT_LE(asked, 6);
  EXPECT_FALSE(none_found.found());
  EXPECT_EQ(none_found.turn_error(), infinity);
  EXPECT_THROW(none_found.answer({1, 1}), Error);
  EXPECT_THROW(SymmetrySearch{nan}, Error);
  SymmetrySearch broken(0);
  EXPECT_THROW(broken.answer({nan, 0}), Error);
}

// A tip in a body where k_2 is that of the first order in the path: grown from the left end along x, chord by chord.
struct SlightBody {
  double K_I = 1, K_II = 0, T = 0;
  KinkLoad at(const std::vector<Vec2>& path) const {
    const double a = path.back().x();
    double history = 0;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const Vec2 d = path[i + 1] - path[i];
      history += d.y() / d.x() * 2 * (std::sqrt(a - path[i].x()) - std::sqrt(std::max(a - path[i + 1].x(), 0.)));
    }
    const Vec2 last = path.back() - path[path.size() - 2];
    return {K_I, K_II + last.y() / last.x() * K_I / 2 - std::sqrt(2 / pi) * T * history};
  }
};

enum class Pieces { Straight, Curved };

// A path on its way.
struct Growing {
  std::vector<Vec2> path = {{0, 0}};
  PathTip tip{{0, 0}, 0, 0};
  bool first = true;
};

// One step more: what a driver does with a body on a mesh. n chords.
Growing grown(const SlightBody& body, const Growing& from, double length, Pieces pieces, int n) {
  const double kink = symmetric_direction({body.K_I, body.K_II, 0}).angle;
  const auto drawn = [&](double turn) {
    if (pieces == Pieces::Straight) return straight_piece(from.tip, turn, length);
    return from.first ? kinked_piece(from.tip, kink, turn, length) : arc_piece(from.tip, turn, length);
  };
  const auto with = [&](double turn) {
    std::vector<Vec2> all = from.path;
    for (const Vec2& p : chords(drawn(turn), n)) all.push_back(p);
    return all;
  };
  SymmetrySearch search(pieces == Pieces::Straight ? 0 : from.tip.curvature * length, {1e-12, 20});
  while (search.turn()) search.answer(body.at(with(*search.turn())));
  EXPECT_TRUE(search.found());
  const double turn = search.best().turn;
  return {with(turn), end_of(drawn(turn), n), false};
}

// y/slope at x = 1 less that of the closed form, after n steps that begin short, as the root of the way behind a kink
// wants.
double error_after(const SlightBody& body, int steps, Pieces pieces, int n) {
  Growing now;
  for (int i = 0; i < steps; ++i) now = grown(body, now, (2. * i + 1) / (steps * steps), pieces, n);
  const double slope = -2 * body.K_II / body.K_I;
  return now.path.back().y() / slope - slightly_curved_path(1, 1, 2 * std::sqrt(2) * body.T / body.K_I);
}

SlightBody slight_body(double beta) {
  return {1, -0.5e-6, beta / (2 * std::sqrt(2))};
}

TEST(Step, PathOfCotterellAndRiceInTheOrderOfItsPieces) {
  for (const double beta : {-2., -1., 1.}) {
    const SlightBody body = slight_body(beta);
    const auto straight = [&](int steps) { return std::abs(error_after(body, steps, Pieces::Straight, 1)); };
    const auto curved = [&](int steps, int n) { return std::abs(error_after(body, steps, Pieces::Curved, n)); };
    // Straight pieces: first order. Curved ones: second, if the chord at the tip shrinks as well, else nearly so.
    EXPECT_NEAR(straight(20) / straight(40), 2, 0.1) << beta;
    EXPECT_GT(curved(20, 16) / curved(40, 32), 3.9) << beta;
    EXPECT_GT(curved(20, 8) / curved(40, 8), 3) << beta;
    EXPECT_LT(curved(20, 8), straight(20) / 15) << beta;
  }
}

TEST(Step, CompetingTips) {
  const Advances a = advance(std::vector<double>{1e-9, 4e-9, 0, 2e-9}, 0.5);
  EXPECT_EQ(a.lengths, (std::vector<double>{0.125, 0.5, 0, 0.25}));
  EXPECT_FALSE(a.all_rest || a.runs);
  EXPECT_TRUE(advance(std::vector<double>{0, 0}, 1).all_rest);
  const Advances runs = advance(std::vector<double>{1, infinity}, 1);
  EXPECT_TRUE(runs.runs);
  EXPECT_EQ(runs.lengths, (std::vector<double>{0, 1}));
  EXPECT_EQ(advance(std::vector<double>{1e-320, 3e-320}, 3).lengths[1], 3);
  EXPECT_THROW(advance(std::vector<double>{-1}, 1), Error);
  EXPECT_THROW(advance(std::vector<double>{1}, 0), Error);
}

// Loads on the ends of a strip of compliance C(a): G = P^2 C'/2 = G_c.
TEST(Step, CourseOfTheLoad) {
  const auto at = [](double compliance, double slope) {
    const double load = std::sqrt(2 / slope);
    return LoadPoint{load, load * compliance};
  };
  // A double cantilever, C = a^3: the load falls, and displacements grow. An inner crack, C = 1 + a^2: back to a^2 =
  // 1/3.
  const auto cantilever = [&](double a) { return at(a * a * a, 3 * a * a); };
  const auto inner = [&](double a) { return at(1 + a * a, 2 * a); };
  for (const double a : {0.2, 0.5, 0.577, 0.578, 0.9}) {
    EXPECT_EQ(course(cantilever(a), cantilever(a + 1e-4)), Course::LoadFalls);
    EXPECT_EQ(course(inner(a), inner(a + 1e-4)), a < std::sqrt(1. / 3) ? Course::SnapBack : Course::LoadFalls) << a;
    EXPECT_EQ(course(inner(a + 1e-4), inner(a)), Course::Stable);
  }
}

TEST(Step, ReleasedEnergyIsTheLossOfPotentialEnergy) {
  // Unit loads: the potential energy is -C/2, and G = C'/2; C = a^4, and C = exp(a).
  const auto sums = [](auto G, int n) {
    std::vector<double> a, g;
    for (int i = 0; i <= n; ++i) a.push_back(1 + i / static_cast<double>(n)), g.push_back(G(a.back()));
    const ReleasedBounds b = bound_released_energy(a, g, g);
    const ReleasedEnergy r = released_energy(a, g);
    EXPECT_LE(b.lower, r.energy);
    EXPECT_GE(b.upper, r.energy);
    return r;
  };
  const auto cubic = [](double a) { return 2 * a * a * a; };
  const auto grows = [](double a) { return std::exp(a) / 2; };
  EXPECT_NEAR(sums(cubic, 4).energy, 7.5, 1e-13);
  const double exact = (std::exp(2) - std::exp(1)) / 2;
  for (const int n : {4, 5, 8, 16}) {
    const ReleasedEnergy r = sums(grows, n);
    EXPECT_LT(std::abs(r.energy - exact), r.error) << n;
    EXPECT_LT(r.error, 0.2 / (n * n)) << n;
  }
  EXPECT_TRUE(std::isnan(sums(grows, 1).error));
  const std::vector<double> a = {1, 2}, two = {2, 2}, one = {1, 1};
  EXPECT_THROW(bound_released_energy(a, two, one), Error);
  EXPECT_THROW(released_energy(two, a), Error);
}

}  // namespace
}  // namespace kerf::growth::step_test
