// `kerf bench proof`: whether guaranteed intervals contain the exact value, how wide they are and what they cost.
// Straight open cracks in an infinite plate are cut out as a square under their exact tractions, one of them with a
// body force whose stress diag(0, y) the crack does not feel. K_I, K_II and G at both tips, stresses and the
// topological derivative at three points, on uniform meshes, on meshes graded to the tips, and refined for K. Half
// widths are relative to the size of the quantity: K over the norm of both, stresses over the norm of the tensor. The
// cost is the processor time of one quantity over that of the state. A guaranteed interval that does not contain its
// value is a failure. The second part compares c2 with series on the disc (second_terms.cpp). docs/theory/bounds.md,
// docs/theory/guarantees.md.

#include "bench/measure/proof.hpp"

#include "bench/command/records.hpp"
#include "bench/measure/second_terms.hpp"
#include "io/files.hpp"
#include "kerf/adaptive.hpp"
#include "kerf/derivative_bounds.hpp"
#include "kerf/fracture.hpp"
#include "kerf/stop.hpp"
#include "plot/multiples.hpp"
#include "tests/support/exact_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>

namespace kerf {

namespace {

struct ProofProblem {
  const char* name;
  const char* field;  // of the crack
  double angle;       // of the crack
  // A body force (0, -1) and its stress diag(0, y) on top, which a crack along y = 0 does not feel: singular fields are
  // cut off then.
  bool weight = false;
};
constexpr std::array problems{ProofProblem{"c01_modeI", "c01_modeI", 0}, ProofProblem{"c02_modeII", "c02_modeII", 0},
                              ProofProblem{"c03_inclined_open", "c03_inclined_open", pi / 6},
                              ProofProblem{"c01_with_weight", "c01_modeI", 0, true}};

struct Whole {
  exact::ExactField crack;
  bool weight;

  Mat2 stress(const Vec2& x) const {
    return crack.stress(x, exact::side_of(crack, x)) + Mat2{{0, 0}, {0, weight ? x.y() : 0}};
  }
};
struct Posed {
  Whole exact;
  Shape shape;
  Scene scene;
};

Posed pose(const ProofProblem& p) {
  const Vec2 end(std::cos(p.angle), std::sin(p.angle));
  Posed posed{{exact::table_field(p.field, 0.3), p.weight}, {}, {}};
  posed.shape = {.outline = polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0),
                 .cracks = {{"c", {-end, end}}},
                 .labels = {"side"}};
  posed.scene.material = posed.exact.crack.material;
  posed.scene.tractions = {{0, [f = posed.exact](const Vec2& x, const Vec2& n) -> Vec2 { return f.stress(x) * n; }}};
  if (p.weight) posed.scene.body = [](const Vec2&) { return Vec2(0, -1); };
  posed.scene.laws = {{.kind = CrackLaw::Kind::Open}};
  return posed;
}

double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Measured {
  ProofRow like;  // what all its rows have in common
  double state_seconds;
  ProofBench& bench;

  void add(const std::string& quantity, const Bounded& b, double exact, double size, double seconds) const {
    ProofRow row = like;
    row.quantity = quantity;
    row.exact = exact, row.lower = b.lower, row.upper = b.upper;
    row.relative = 0.5 * (b.upper - b.lower) / size;
    row.guaranteed = b.guaranteed;
    row.contained = b.lower <= exact && exact <= b.upper;
    row.cost = seconds / state_seconds;
    bench.rows.push_back(std::move(row));
  }
};

/// The intervals of several quantities together, and the processor time of each.
struct Timed {
  QuantityIntervals found;
  double each;
};
Timed timed(const QuantityBounds& bounds, const QuantityRequest& request) {
  const double before = processor_seconds();
  Timed t{bounds.all(request), 0};
  t.each = (processor_seconds() - before) / static_cast<double>(2 * request.tips.size() + 3 * request.points.size());
  return t;
}

const std::vector<Vec2> places{{0.3, 0.9}, {-1.2, -0.3}, {0.1, -0.4}};

/// K_I, K_II and G of the tips, and stress and T at points where `with_points`.
void measure_quantities(const Posed& p, const Model& m, const State& s, bool with_points, const Measured& to) {
  const QuantityBounds bounds(m, s);
  const std::vector<TipIntensity> tips = crack_tips(m, s);
  timed(bounds, {.tips = {tips.front()}});  // what the state itself takes is done once
  const auto [found, each] = timed(bounds, {.tips = tips, .points = with_points ? places : std::vector<Vec2>()});
  for (std::size_t i = 0; i < tips.size(); ++i) {
    const auto exact = std::ranges::find_if(
        p.exact.crack.tips, [&](const exact::ExactTip& t) { return (t.at - tips[i].at).norm() < 1e-9; });
    const TipBounds& b = found.tips[i];
    const double size = std::hypot(exact->k1, exact->k2);
    to.add("K_I", b.K_I, exact->k1, size, each);
    to.add("K_II", b.K_II, exact->k2, size, each);
    const double rate = size * size / plane_modulus(p.scene.material);
    to.add("G", b.G, rate, rate, 2 * each);
  }
  if (!with_points) return;
  const DerivativeBounds derivative({"energy", {energy()}}, {}, m);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec2& x = places[i];
    const Mat2 exact = p.exact.stress(x);
    StressBounds b = found.points[i];
    const double size = exact.norm();
    to.add("s_xx", b.s11, exact(0, 0), size, each);
    to.add("s_yy", b.s22, exact(1, 1), size, each);
    to.add("s_xy", b.s12, exact(0, 1), size, each);
    if (p.exact.weight) continue;  // T has the displacement in it, which nothing fixes
    const double T = exact::hole_derivative(p.scene.material, exact);
    to.add("T", derivative.at(x, b), T, std::abs(T), 3 * each);
  }
}

Sizing sizing_of(const std::string& mesh, double size) {
  return {.size = size, .crack_tip_size = mesh == "uniform" ? size : size / 100};
}

void run_proof(const ProofProblem& problem, const std::string& mesh, int degree, double size, ProofBench& bench) {
  const Posed p = pose(problem);
  const double before = processor_seconds();
  const Model m = prepare(triangulate(p.shape, sizing_of(mesh, size)), bdms(degree), p.scene, 1);
  const State s = solve(m);
  const Measured to{{.problem = problem.name,
                     .mesh = mesh,
                     .degree = degree,
                     .triangles = static_cast<Index>(m.mesh.triangles.size())},
                    processor_seconds() - before,
                    bench};
  measure_quantities(p, m, s, true, to);
}

/// Refined until K_I at the end of the crack (K_II of a crack under shear alone) is known to 1e-4.
void run_goal(const ProofProblem& problem, int degree, double error, ProofBench& bench) {
  const Posed p = pose(problem);
  const bool shear = std::string_view(problem.field) == "c02_modeII";
  Adaptation how{.error = error, .max_triangles = 20000, .threads = 1};
  how.goal = [&](const Model& m, const State& s, const Indicator& own) {
    const QuantityBounds bounds(m, s, true);
    const TipBounds b = bounds.tip({.crack = 0, .at_start = false});
    const Bounded& k = shear ? b.K_II : b.K_I;
    return refine_for(own, k, b.eta);
  };
  const double before = processor_seconds();
  const Adapted a = solve_adaptively(p.shape, {.size = 0.4}, bdms(degree), p.scene, how);
  const Measured to{{.problem = problem.name,
                     .mesh = "goal",
                     .degree = degree,
                     .triangles = static_cast<Index>(a.model.mesh.triangles.size())},
                    processor_seconds() - before,
                    bench};
  measure_quantities(p, a.model, a.state, false, to);
}

std::string proof_table(const ProofBench& bench) {
  std::string out =
      "| problem | mesh | degree | triangles | K_I, K_II | G | stress | T | contained | guaranteed | cost per quantity "
      "|\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (std::size_t i = 0; i < bench.rows.size();) {
    const ProofRow& first = bench.rows[i];
    std::array<double, 4> widest{nan, nan, nan, nan};
    int contained = 0, guaranteed = 0, count = 0;
    double cost = 0;
    for (; i < bench.rows.size(); ++i, ++count) {
      const ProofRow& r = bench.rows[i];
      if (r.problem != first.problem || r.mesh != first.mesh || r.degree != first.degree ||
          r.triangles != first.triangles)
        break;
      const int column = r.quantity.starts_with("K") ? 0 : r.quantity == "G" ? 1 : r.quantity == "T" ? 3 : 2;
      if (!(r.relative <= widest[static_cast<std::size_t>(column)]))
        widest[static_cast<std::size_t>(column)] = r.relative;
      contained += r.contained;
      guaranteed += r.guaranteed;
      if (column == 0) cost = std::max(cost, r.cost);
    }
    const auto text = [](double w) { return std::isfinite(w) ? fmt::format("{:.1e}", w) : std::string("-"); };
    out += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} of {} | {} | {:.2f} |\n", first.problem,
                       first.mesh, first.degree, first.triangles, text(widest[0]), text(widest[1]), text(widest[2]),
                       text(widest[3]), contained, count, guaranteed, cost);
  }
  return out;
}

void draw_widths(const std::filesystem::path& path, const ProofBench& bench) {
  Multiples all{.title = "Guaranteed intervals",
                .subtitle = "half width over the quantity, against triangles",
                .least = 1e-6,
                .most = 1};
  for (const char* quantity : {"K_I", "G", "s_yy", "T"})
    for (const char* mesh : {"uniform", "tips"}) {
      Multiple panel{.title = fmt::format("{}, {} mesh", quantity, mesh), .x_label = "triangles", .points = {}};
      for (const ProofRow& r : bench.rows) {  // the widest of all tips or points of a mesh
        if (r.quantity != quantity || r.mesh != mesh || r.degree != 1 || r.problem != problems[2].name) continue;
        const std::string triangles = fmt::format("{}", r.triangles);
        if (panel.points.empty() || panel.points.back().label != triangles) panel.points.push_back({triangles});
        MultiplePoint& point = panel.points.back();
        if (!(r.relative <= point.value)) point.value = r.relative;
        if (!r.contained) point.mark = MultipleMark::Bad;
      }
      if (!panel.points.empty()) all.panels.push_back(std::move(panel));
    }
  if (!all.panels.empty()) draw(path, all);
}

std::string proof_page(const ProofBench& bench) {
  return "# Guaranteed intervals\n\nMade by `kerf bench proof`. Straight open cracks in an infinite plate, cut out as "
         "a "
         "square under the exact tractions; one of them with a body force and its stress on top, so that singular "
         "fields "
         "are cut off in a disc. Half the width of the interval over the quantity (K over the norm of both, "
         "stresses over the norm of the tensor); the widest of all tips and points. Cost: processor time of one "
         "quantity, "
         "of those of two tips and three points found together, over that of the state and its mesh.\n\n" +
         proof_table(bench) +
         (bench.second.empty()
              ? std::string()
              : "\n## The second term\n\nA hole, a softer and a stiffer inclusion (1/5 and 5 times) at three places of "
                "the unit disc under loads of degree 4, against series that fit all conditions on both circles and "
                "know "
                "nothing of expansions. The worst of the three places: c2 against the sum of the sizes of its parts; "
                "what the first term, and both, leave of the change of J that a change of a quarter of the distance "
                "to the rim makes.\n\n" +
                    second_term_table(bench.second));
}

}  // namespace

ProofBench run_proof_bench(const BenchOptions& options) {
  make_folder(options.folder);
  ProofBench bench{.quick = options.quick};
  const std::vector<double> uniform = options.quick ? std::vector<double>{0.3} : std::vector{0.14, 0.062, 0.031},
                            graded = options.quick ? std::vector<double>{0.3} : std::vector{0.14, 0.07, 0.0345};
  for (const ProofProblem& p : problems) {
    if (!is_wanted(options.cases, p.name)) continue;
    const auto go_on = [&](const std::string& phase) {
      if (options.on_phase) options.on_phase(fmt::format("{} {}", p.name, phase));
      return !stop_asked(options);
    };
    for (const double size : uniform)
      if (go_on(fmt::format("uniform {}", size))) run_proof(p, "uniform", 1, size, bench);
    for (const double size : graded)
      if (go_on(fmt::format("tips {}", size))) run_proof(p, "tips", 1, size, bench);
    if (go_on("tips, degree 2")) run_proof(p, "tips", 2, graded[graded.size() / 2], bench);
    for (const int degree : {1, 2})
      if (!p.weight && go_on(fmt::format("goal, degree {}", degree)))
        run_goal(p, degree, options.quick ? 1e-2 : 1e-4, bench);
  }
  if (is_wanted(options.cases, "disc") && !stop_asked(options)) bench.second = measure_second_terms(options);
  bench.stopped = stop_asked(options);
  write_proof_csv(options.folder / "proof.csv", bench);
  if (!bench.second.empty()) write_second_terms_csv(options.folder / "second_terms.csv", bench);
  write_proof_json(options.folder / "proof.json", bench);
  write_file(options.folder / "proof.md", proof_page(bench));
  draw_widths(options.folder / "proof.png", bench);
  return bench;
}

std::size_t failures(const ProofBench& bench) {
  return static_cast<std::size_t>(
      std::ranges::count_if(bench.rows, [](const ProofRow& r) { return r.guaranteed && !r.contained; }));
}

std::string summary(const ProofBench& bench) {
  std::size_t guaranteed = 0, contained = 0;
  for (const ProofRow& r : bench.rows) guaranteed += r.guaranteed, contained += r.guaranteed && r.contained;
  return proof_table(bench) + (bench.second.empty() ? std::string() : second_term_table(bench.second)) +
         fmt::format("{} of {} guaranteed intervals contain the exact value\n", contained, guaranteed);
}

std::vector<std::string> proof_case_names() {
  std::vector<std::string> names;
  for (const ProofProblem& p : problems) names.emplace_back(p.name);
  names.emplace_back("disc");
  return names;
}

}  // namespace kerf
