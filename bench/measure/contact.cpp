// `kerf bench contact`: what contact costs beside the same body with open cracks. Four families, each with a knob:
// unknowns on one crack, number of cracks, depth of a crack beneath a pressed side or in a bent body; each without
// friction and with 0.3. Meshes are made so that the knob alone grows: edges of the crack for the first, cracks at
// random with constant density for the second. Times are processor seconds without meshing, medians of three up to
// 30,000 triangles; contact that is large begins on meshes four times coarser, as a run would begin, and pays for them.
// Memory is the peak less that with open cracks. docs/theory/contact.md, "Large contact" and "Beneath a side".

#include "bench/measure/contact.hpp"

#include "bench/command/records.hpp"
#include "bench/measure/measure.hpp"
#include "geometry/plane.hpp"
#include "io/files.hpp"
#include "kerf/mesher.hpp"
#include "kerf/model.hpp"
#include "solver/lone_cracks.hpp"
#include "solver/system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace kerf {

namespace {

Shape square_with_half(double half) {
  Shape shape;
  shape.outline = polygon("outline", {{-half, -half}, {half, -half}, {half, half}, {-half, half}}, 0);
  shape.labels = {"bottom", "right", "top", "left"};
  for (Index i = 0; i < 4; ++i) shape.outline.sides[static_cast<std::size_t>(i)].label = i;
  return shape;
}

using Pull = std::function<Vec2(const Vec2&)>;

/// Clamped below; tractions on the right, above and on the left.
Scene clamped(const std::array<Pull, 3>& pulls) {
  Scene s;
  s.material = plane_strain(1, 0.3);
  s.supports.push_back({0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
  for (std::size_t k = 0; k < pulls.size(); ++k)
    if (pulls[k])
      s.tractions.push_back(
          {static_cast<Index>(k) + 1, [pull = pulls[k]](const Vec2& x, const Vec2&) -> Vec2 { return pull(x); }});
  return s;
}

/// A body, its loads, and its meshes: `coarser` times the lengths of the one that is measured.
struct ContactProblem {
  Shape shape;
  Scene scene;
  std::function<Mesh(const Shape&, double coarser)> mesh;
  double size = 0.5;  // of the edges far from everything
};

double distance_to_crack(const Crack& crack, const Vec2& x) {
  return distance(x, crack.points.front(), crack.points.back());
}

// Pressed at one end and open at the other.
ContactProblem one_crack(double unknowns) {
  ContactProblem p{square_with_half(2),
                   clamped({Pull{},
                            [](const Vec2& x) -> Vec2 {
                              return {0.2, x.x()};
                            },
                            Pull{}}),
                   {}};
  p.shape.cracks = {{"c", {{-0.92, -0.39}, {0.92, 0.39}}, {}}};
  const double edge = 2 * 2 / unknowns;  // two unknowns on each of a crack of length 2
  p.mesh = [edge](const Shape& shape, double coarser) {
    const Mesh coarse = triangulate(shape, {.size = 0.2});
    Background background{&coarse, {}};
    for (const Vec2& x : coarse.points)
      background.size.push_back(coarser * edge + 0.5 * distance_to_crack(shape.cracks[0], x));
    return triangulate(shape, {.size = 0.5, .grading = 0.5}, background);
  };
  return p;
}

/// Straight cracks at random, none nearer than .15 to another, as many per area for any count.
Shape random_cracks(int count) {
  const double half = 0.6 + 0.7 * std::sqrt(static_cast<double>(count));
  Shape shape = square_with_half(half);
  std::mt19937 bits(7);
  const auto random = [&](double low, double high) { return low + (high - low) * (bits() / 4294967296.0); };
  const double room = half - 0.6;
  while (static_cast<int>(shape.cracks.size()) < count) {
    const double x = random(-room, room), y = random(-room, room), angle = random(0, pi), length = random(0.2, 0.5);
    const Vec2 center(x, y), along = length * Vec2(std::cos(angle), std::sin(angle));
    const Crack next{fmt::format("c{}", shape.cracks.size()), {center - along, center + along}, {}};
    const auto near = [&](const Crack& other) {
      if ((other.points[0] + other.points[1] - 2 * center).norm() > 2.4) return false;
      for (int i = 0; i <= 20; ++i)
        if (distance_to_crack(other, next.points[0] + i / 20.0 * (next.points[1] - next.points[0])) < 0.15) return true;
      return false;
    };
    if (std::ranges::none_of(shape.cracks, near)) shape.cracks.push_back(next);
  }
  return shape;
}

ContactProblem many_cracks(double count) {
  ContactProblem p{random_cracks(static_cast<int>(count)),
                   clamped({[](const Vec2& x) -> Vec2 {
                              return {0.4 * std::sin(x.y()), 0.3};
                            },
                            [](const Vec2& x) -> Vec2 {
                              return {0.3, 0.2 * std::sin(x.x()) - 0.1};
                            },
                            [](const Vec2& x) -> Vec2 {
                              return {-0.4 * std::sin(x.y()), -0.3};
                            }}),
                   {}};
  p.size = 0.12;
  p.mesh = [size = p.size](const Shape& shape, double coarser) {
    return triangulate(shape, {.size = size * coarser, .crack_tip_size = 0.02 * coarser});
  };
  return p;
}

ContactProblem beneath(double depth, const std::array<Pull, 3>& pulls) {
  ContactProblem p{square_with_half(0.5), clamped(pulls), {}};
  p.shape.cracks = {{"c", {{-0.25, 0.5 - depth}, {0.25, 0.5 - depth}}, {}}};
  p.mesh = [](const Shape& shape, double coarser) {
    return triangulate(shape, {.size = 0.05 * coarser, .long_ligaments = true});
  };
  return p;
}

ContactProblem pressed_beneath(double depth) {
  return beneath(depth, {Pull{}, [](const Vec2& x) -> Vec2 { return {0, -std::cos(4 * pi * x.x())}; }, Pull{}});
}

ContactProblem bent_beneath(double depth) {
  return beneath(depth, {[](const Vec2& x) -> Vec2 {
                           return {x.y(), 0};
                         },
                         Pull{},
                         [](const Vec2& x) -> Vec2 {
                           return {-x.y(), 0};
                         }});
}

struct Family {
  const char *name, *knob;
  ContactProblem (*make)(double);
  std::vector<double> values, quick;
};

const std::vector<Family>& families() {
  static const std::vector<Family> all = {
      {"unknowns", "asked for on one crack", one_crack, {500, 2000, 8000, 25000, 50000}, {200}},
      {"cracks", "how many", many_cracks, {10, 50, 200, 1000}, {4}},
      {"depth", "beneath a side; the crack is .5 long", pressed_beneath, {1e-1, 1e-2, 3e-3, 1e-3, 1e-4}, {1e-2}},
      {"bending", "depth beneath a side; the crack is .5 long", bent_beneath, {1e-1, 1e-2, 3e-3, 1e-3, 1e-4}, {1e-2}}};
  return all;
}

struct Solved {
  Model model;
  State state;
};

Solved solved(Mesh mesh, Scene scene, const CrackLaw& law, const ContactGuess& guess) {
  scene.laws.assign(mesh.cracks.size(), law);
  Model model = prepare(std::move(mesh), element("bdms"), std::move(scene), 1, {.contact = guess});
  State state = solve(model);
  return {std::move(model), std::move(state)};
}

bool is_large(const Mesh& mesh, const CrackLaw& law) {
  Index edges = 0;
  for (const auto& crack : mesh.cracks) edges += static_cast<Index>(crack.size());
  return 2 * edges * (law.friction > 0 ? 2 : 1) > Preparation{}.most_dense;
}

/// As solve_graded begins where contact is large: by meshes four times coarser, down to where it is not; or with cracks
/// alone, where that is hardly coarser.
ContactGuess coarser_guess(const ContactProblem& p, const CrackLaw& law, double coarser, Index finer_triangles,
                           double& meshing) {
  ProcessorWatch watch;
  Mesh mesh = p.mesh(p.shape, coarser);
  meshing += watch.lap();
  const Index triangles = static_cast<Index>(mesh.triangles.size());
  if (constexpr Index fewer = 5; triangles * fewer > finer_triangles) {
    Scene scene = p.scene;
    scene.laws.assign(p.shape.cracks.size(), law);
    return lone_cracks_guess(p.shape, element("bdms"), scene, coarser * p.size, 1);
  }
  ContactGuess guess;
  if (is_large(mesh, law)) guess = coarser_guess(p, law, 4 * coarser, triangles, meshing);
  const Solved s = solved(std::move(mesh), p.scene, law, guess);
  return contact_guess(s.model, s.state);
}

void measure_contact(const ContactProblem& p, ContactRow& row) {
  const Mesh mesh = p.mesh(p.shape, 1);
  row.triangles = static_cast<Index>(mesh.triangles.size());
  const CrackLaw open{.kind = CrackLaw::Kind::Open}, touching{.friction = row.friction};
  std::vector<double> linear, contact;
  double peak_open = 0, peak = 0;
  const int repeat = row.triangles < 30000 ? 3 : 1;
  for (int k = 0; k < repeat; ++k) {
    forget_peak_memory();
    ProcessorWatch watch;
    { const Solved s = solved(mesh, p.scene, open, {}); }
    linear.push_back(watch.lap());
    peak_open = peak_memory_mb();
    forget_peak_memory();
    watch.lap();
    double meshing = 0;
    ContactGuess guess;
    if (is_large(mesh, touching)) guess = coarser_guess(p, touching, 4, row.triangles, meshing);
    const Solved s = solved(mesh, p.scene, touching, guess);
    contact.push_back(watch.lap() - meshing);
    peak = peak_memory_mb();
    row.unknowns = s.model.inner->ordering.contact_rows;
    row.sets = s.state.contact_iterations;
    row.solves = s.state.linear_solves;
    row.kkt = s.state.certificate.kkt;
    row.certified = certified(s.state);
  }
  const auto median = [](std::vector<double>& v) {
    std::ranges::sort(v);
    return v[v.size() / 2];
  };
  row.linear_s = median(linear);
  row.contact_s = median(contact);
  row.memory_mb = std::max(0.0, peak - peak_open);
}

std::string contact_table(const ContactBench& bench) {
  std::string out =
      "| family | knob | friction | triangles | contact unknowns | sets | linear solve, s | contact over it | MB on "
      "top "
      "| kkt |\n|---|---|---|---|---|---|---|---|---|---|\n";
  for (const ContactRow& r : bench.rows)
    if (r.refused.empty())
      out += fmt::format("| {} | {:g} | {:g} | {} | {} | {} | {:.3f} | {:.2f} | {:.0f} | {:.1e}{} |\n", r.family,
                         r.knob, r.friction, r.triangles, r.unknowns, r.sets, r.linear_s, r.ratio(), r.memory_mb, r.kkt,
                         r.certified ? "" : ", not certified");
    else
      out += fmt::format("| {} | {:g} | {:g} | {} | refused: {} |\n", r.family, r.knob, r.friction, r.triangles,
                         r.refused);
  return out;
}

std::string contact_page(const ContactBench& bench) {
  std::string out =
      "# Contact\n\nMade by `kerf bench contact`: bdms of degree 1, one thread, processor time without meshing. What "
      "contact takes, with the coarser meshes that it begins with where it is large, over what the same body with open "
      "cracks takes in the same run; the peak of memory, less that with open cracks.\n\n";
  for (const Family& f : families()) out += fmt::format("- {}: {}\n", f.name, f.knob);
  return out + "\n" + contact_table(bench);
}

}  // namespace

ContactBench run_contact_bench(const BenchOptions& options) {
  make_folder(options.folder);
  ContactBench bench{.quick = options.quick};
  for (const Family& f : families()) {
    if (!is_wanted(options.cases, f.name)) continue;
    for (const double friction : {0.0, 0.3})
      for (const double knob : options.quick ? f.quick : f.values) {
        if (stop_asked(options)) continue;
        if (options.on_phase) options.on_phase(fmt::format("{} {:g}, friction {:g}", f.name, knob, friction));
        ContactRow row{.family = f.name, .knob = knob, .friction = friction};
        try {
          measure_contact(f.make(knob), row);
        } catch (const Error& e) {
          row.refused = e.what();
        }
        bench.rows.push_back(std::move(row));
      }
  }
  bench.stopped = stop_asked(options);
  write_contact_csv(options.folder / "contact.csv", bench);
  write_contact_json(options.folder / "contact.json", bench);
  write_file(options.folder / "contact.md", contact_page(bench));
  return bench;
}

std::string summary(const ContactBench& bench) {
  return contact_table(bench);
}

std::vector<std::string> contact_case_names() {
  std::vector<std::string> names;
  for (const Family& f : families()) names.emplace_back(f.name);
  return names;
}

}  // namespace kerf
