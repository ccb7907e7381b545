// Changes that are really drawn: the difference of J between the bodies with and without the change, divided by the
// scale of the change, at several radii; least squares in powers of eps^2 with weight eps^2 extrapolate it to 0.
// Both bodies have the lines of the change in their meshes, and sizes do not depend on what is drawn, so that most of
// the error of the meshes cancels. The doubt: the fit without its last power, and J on two meshes.

#include "tests/truth/drawn.hpp"

#include "kerf/recover.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <map>

namespace kerf::drawn {

namespace {

enum Label : Index { Bottom, Right, Top, Left };

const Vec2 from(0.45, 1.35), tip(1.1, 1.5);

// Of the area of the ellipse, of this many sides.
Loop ring(const Vec2& at, const Vec2& semi_axes, double angle, int sides) {
  const double step = 2 * pi / sides, larger = std::sqrt(step / std::sin(step));
  const Vec2 along(std::cos(angle), std::sin(angle)), across(-along.y(), along.x());
  std::vector<Vec2> points;
  for (int i = 0; i < sides; ++i)
    points.emplace_back(
        at + larger * (semi_axes.x() * std::cos(i * step) * along + semi_axes.y() * std::sin(i * step) * across));
  Loop loop = polygon("ring", points, rim);
  for (Side& s : loop.sides) s.smooth = true;
  return loop;
}

struct Body {
  Shape shape;
  Scene scene;
};

Material matrix() {
  return plane_strain(1, 0.3);
}
Vec2 force(const Vec2& x) {
  return {0.6 - 0.3 * x.y(), -0.9 + 0.4 * x.x()};
}

Support roller(Index label, bool x, std::function<double(const Vec2&)> value) {
  return {label, false, x, !x,
          [=](const Vec2& at, const Vec2&) { return x ? Vec2(value(at), 0) : Vec2(0, value(at)); }};
}

// Shear tractions agree in the corners.
Body body(const Load& load) {
  Body b;
  b.shape.labels = {"bottom", "right", "top", "left", "rim"};
  b.shape.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 2}, {0, 2}}, Bottom);
  for (Index i = 0; i < 4; ++i) b.shape.outline.sides[static_cast<std::size_t>(i)].label = i;
  b.shape.cracks = {{"crack", {from, tip}}};
  b.scene.material = matrix();
  b.scene.laws = {{load.contact ? CrackLaw::Kind::Unilateral : CrackLaw::Kind::Open}};
  if (load.fluid)
    b.scene.laws[0].pressure = [](const Vec2& x, const Vec2&) { return Vec2(0.5 - 0.2 * x.x() * x.y(), 0); };
  if (load.regions) {
    b.shape.regions.push_back(ring({1.3, 0.7}, {0.5, 0.5}, 0, 48));
    b.scene.regions.push_back(plane_strain(2.5, 0.4));
  }
  const double moves = load.prescribed ? 1 : 0;
  b.scene.supports = {
      roller(Left, true, [=](const Vec2& x) { return moves * (0.3 * (x.y() - 0.7) * (x.y() - 0.7) - 0.4); }),
      roller(Bottom, false, [=](const Vec2& x) { return moves * (0.5 * (x.x() - 1.2) * (x.x() - 1.2) + 0.2); })};
  b.scene.tractions.push_back({Right, [](const Vec2& x, const Vec2&) { return Vec2(0.8 + 0.3 * x.y(), 0.2 * x.y()); }});
  const double turns = load.prescribed ? 0.75 : 0.9;  // where the tension on top begins
  if (load.contact)
    b.scene.tractions.push_back(
        {Top, [=](const Vec2& x, const Vec2&) { return Vec2(0.2 * x.x(), 2 * (x.x() - turns)); }});
  else
    b.scene.tractions.push_back({Top, [](const Vec2& x, const Vec2&) { return Vec2(0.2 * x.x(), 0.9 - 0.2 * x.x()); }});
  if (load.body) b.scene.body = force;
  return b;
}

// Filled: the same lines, nothing changed.
struct Drawing {
  const Change& change;
  double eps, angle;
  bool filled;
};
void draw(const Drawing& d, Body& b) {
  const auto& [change, eps, angle, filled] = d;
  const Perturbation& p = change.p;
  const double longer = p.kind == Perturbation::Kind::Ellipse ? std::sqrt(p.aspect) : 1;
  const Loop line =
      ring(place(), eps * Vec2(longer, 1 / longer), angle, p.kind == Perturbation::Kind::Ellipse ? 64 : 40);
  if (filled && p.kind != Perturbation::Kind::Crack) {
    const Material around = b.scene.regions.empty() ? b.scene.material : b.scene.regions[0];
    b.shape.regions.push_back(line);
    b.scene.regions.push_back(around);
    return;
  }
  switch (p.kind) {
    case Perturbation::Kind::ClampedHole:
      b.scene.supports.push_back(
          {rim, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
      [[fallthrough]];
    case Perturbation::Kind::Hole:
    case Perturbation::Kind::Ellipse:
      b.shape.holes.push_back(line);
      break;
    case Perturbation::Kind::Inclusion:
      b.shape.regions.push_back(line);
      b.scene.regions.push_back(p.inclusion);
      break;
    case Perturbation::Kind::Crack: {
      const Vec2 half = eps * Vec2(std::cos(angle), std::sin(angle));
      b.shape.cracks.push_back({"change", {place() - half, place() + half}});
      b.scene.laws.push_back({filled ? CrackLaw::Kind::Bonded : CrackLaw::Kind::Unilateral});
    }
  }
}

struct Spot {
  Vec2 at;
  double size, around = 0;  // up to this distance
};
double target(const std::vector<Spot>& spots, const Vec2& x) {
  constexpr double size = 0.13, grading = 0.3;
  double least = size;
  for (const Spot& s : spots) least = std::min(least, s.size + grading * std::max(0., (x - s.at).norm() - s.around));
  return least;
}

// Sizes that do not depend on what is drawn: the meshes of all bodies agree far from it.
Mesh graded(const Body& plain, const Shape& drawn, const std::vector<Spot>& spots) {
  const bool cracked = drawn.cracks.size() > plain.shape.cracks.size();  // filled or not, its lines are there
  const Shape& first = cracked ? drawn : plain.shape;
  double least = 1e-3;
  for (const Spot& s : spots) least = std::min(least, s.size);
  const Sizing sizing{.size = 0.13, .crack_tip_size = least, .grading = 0.3};
  Mesh mesh = triangulate(first, sizing);
  for (int round = 0; round < 3; ++round) {
    std::vector<double> size;
    for (const Vec2& x : mesh.points) size.push_back(target(spots, x));
    mesh = triangulate(round < 2 ? first : drawn, sizing, Background{&mesh, size});
  }
  return mesh;
}

std::vector<Spot> ends_of_contact(const Solved& s) {
  std::vector<Spot> ends;
  for (std::size_t c = 0; c < s.model->mesh.cracks.size(); ++c) {
    const std::vector<CrackPoint> profile = crack_profile(*s.model, *s.state, static_cast<Index>(c));
    for (std::size_t i = 1; i < profile.size(); ++i)
      if (profile[i].status != profile[i - 1].status) ends.push_back({0.5 * (profile[i].at + profile[i - 1].at), 2e-3});
  }
  return ends;
}

Solved solved(const Load& load, const Body& b, const std::vector<Spot>& spots) {
  Solved s;
  s.model = std::make_shared<Model>(prepare(graded(body(load), b.shape, spots), element("bdms", 3), b.scene, 2));
  s.state = std::make_shared<State>(solve(*s.model));
  if (!certified(*s.state)) throw Error(Fault::Numerics, "the drawn body could not be solved");
  return s;
}

// Fine at tips, corners, the ends of contact, and of this size around the change.
Solved solved(const Load& load, const Body& b, double near) {
  std::vector<Spot> spots = {{from, 1e-3}, {tip, 1e-3}, {tip, 0.04, 0.25}, {place(), near}};
  for (const Side& s : b.shape.outline.sides) spots.push_back({s.start, 0.03});
  for (std::size_t c = 1; c < b.shape.cracks.size(); ++c)
    for (const Vec2& x : b.shape.cracks[c].points) spots.push_back({x, 1e-4 * near});
  Solved s = solved(load, b, spots);
  if (!load.contact) return s;
  const std::vector<Spot> ends = ends_of_contact(s);
  if (ends.empty()) throw Error(Fault::Numerics, "the crack is not partly closed");
  spots.insert(spots.end(), ends.begin(), ends.end());
  return solved(load, b, spots);
}

// Smooth, 0 further than 0.6 from the change.
double around(const Vec2& x) {
  const double t = 1 - (x - place() - Vec2(0.1, 0.05)).squaredNorm() / 0.36;
  return t > 0 ? t * t * t : 0;
}

}  // namespace

const std::vector<Load>& loads() {
  static const std::vector<Load> all = {{"traction"},
                                        {"body_force", true},
                                        {"prescribed", false, true},
                                        {"body_and_prescribed", true, true},
                                        {"contact", false, false, true},
                                        {"regions", false, false, false, true},
                                        {"all", true, true, true, true},
                                        {"fluid", false, true, false, false, true},
                                        {"fluid_and_contact", true, false, true, false, true}};
  return all;
}

const std::vector<Change>& changes() {
  using Kind = Perturbation::Kind;
  static const std::vector<Change> all = {{"hole", {Kind::Hole}},
                                          {"clamped_hole", {Kind::ClampedHole}},
                                          {"inclusion", {Kind::Inclusion, plane_strain(4, 0.15)}},
                                          {"ellipse", {Kind::Ellipse, {}, 2, 1.2}},
                                          {"crack", {Kind::Crack, {}, 1, 0.4}}};
  return all;
}

std::vector<Named> functionals(const Load& load) {
  const VectorField goal = [](const Vec2& x) { return Vec2(0.3 * x.x(), -0.2 + 0.1 * x.y()); };
  const BoundaryField measured = [](const Vec2& x, const Vec2&) { return Vec2(1.2 + 0.4 * x.y(), -0.2 * x.y()); };
  const BoundaryField wanted = [](const Vec2& x, const Vec2&) { return Vec2(0.5, 0.2 * x.x()); };
  const Vec2 along = (tip - from).normalized();
  const Term power = stress_power(3, around, true),
             release = energy_release_rate(tip, along, {0.06, 0.24}, load.body ? force : VectorField());
  std::vector<Named> all;
  const auto add = [&](const std::string& name, std::vector<Term> terms) {
    all.push_back({name, {name, std::move(terms)}});
  };
  add("energy", {energy()});
  add("compliance", {compliance()});
  add("volume", {volume()});
  add("displacement_tracking", {displacement_tracking(goal, {})});
  add("boundary_tracking", {boundary_tracking(Top, wanted, {})});
  add("stress_power", {power});
  add("stress_pnorm", {stress_pnorm(2.5, around, true)});
  add("misfit", {misfit(Right, measured)});
  add("energy_release_rate", {release});
  add("crack_opening", {crack_opening(0, {})});
  std::vector<Term> sum = {energy(), compliance(), volume(), displacement_tracking(goal, {}), crack_opening(0, {})};
  const double factors[] = {0.7, -0.4, 0.5, 0.3, 0.8};
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i].factor = factors[i];
  add("sum", sum);
  return all;
}

Solved solve_body(const Load& load) {
  return solved(load, body(load), 0.03);
}

Solved solve_drawn(const Load& load, const Change& change, double eps, double angle, bool filled) {
  Body b = body(load);
  draw({change, eps, angle, filled}, b);
  return solved(load, b, 0.15 * eps);
}

Vec2 place() {
  return {1.35, 0.75};
}

const std::vector<double>& radii() {
  static const std::vector<double> all = {0.08, 0.055, 0.038, 0.026};
  return all;
}

double extrapolated(const std::vector<double>& eps, const std::vector<double>& quotients, int terms) {
  const auto n = static_cast<Eigen::Index>(eps.size());
  Eigen::MatrixXd a(n, terms);
  Eigen::VectorXd b(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double x = std::pow(eps[static_cast<std::size_t>(i)], 2);  // the weight, too: meshes err by 1/eps^2
    for (int k = 0; k < terms; ++k) a(i, k) = x * std::pow(x, k);
    b[i] = x * quotients[static_cast<std::size_t>(i)];
  }
  const Eigen::VectorXd scale = a.colwise().norm().transpose();
  return a.cwiseQuotient(scale.transpose().replicate(n, 1)).householderQr().solve(b)[0] / scale[0];
}

std::vector<Comparison> compare(const Load& load, const Change& change, const std::vector<Named>& functionals,
                                const std::vector<double>& radii) {
  const Solved before = solve_body(load);
  const std::vector<Vec2> at = {place()};
  const bool series = has_series(change.p);
  std::vector<Comparison> result(functionals.size());
  std::vector<std::vector<double>> scales(functionals.size());
  for (std::size_t i = 0; i < functionals.size(); ++i) try {
      const Analysis a = analyze(functionals[i].j, *before.model, *before.state);
      for (const double eps : radii) {
        const MapPoint p = map_at(a, functionals[i].j, {.perturbation = change.p, .radius = eps}, at)[0];
        result[i].angle = p.angle;
        result[i].predicted = series ? p.value : 1;
        scales[i].push_back(series ? scale(change.p, eps) : p.value);
      }
    } catch (const Error& e) {
      result[i].refused = e.what();
    }
  struct Pair {
    Solved before, after;
  };
  std::map<double, std::vector<Pair>> drawn;  // per angle
  for (std::size_t i = 0; i < functionals.size(); ++i) {
    if (!result[i].refused.empty()) continue;
    std::vector<Pair>& bodies = drawn[result[i].angle];
    const auto solve = [&](double eps, bool filled) { return solve_drawn(load, change, eps, result[i].angle, filled); };
    if (bodies.empty())
      for (const double eps : radii) bodies.push_back({solve(eps, true), solve(eps, false)});
    const auto value = [&](const Solved& s) { return analyze(functionals[i].j, *s.model, *s.state, true).value; };
    for (std::size_t k = 0; k < bodies.size(); ++k)
      result[i].quotients.push_back((value(bodies[k].after) - value(bodies[k].before)) / scales[i][k]);
    result[i].drawn = extrapolated(radii, result[i].quotients, static_cast<int>(radii.size()));
    constexpr double meshes = 2e-6;  // the same J on two meshes, relative
    result[i].unsure =
        meshes * std::abs(value(bodies[0].before) / scales[i].back()) +
        std::abs(result[i].drawn - extrapolated(radii, result[i].quotients, static_cast<int>(radii.size()) - 1));
  }
  return result;
}

}  // namespace kerf::drawn
