// `kerf bench machines`: several processes on one body, from 4 to 64 parts. A unit square, held on one side and sheared
// on the other, with a crack per part and one through nearly all of the body, with inclusions of contrast 10^3 and
// 10^-3 across parts, for Poisson's ratios up to 1/2 and degrees 1 to 3; H/h is the length of a part over that of an
// edge. A row has iterations to 1e-10, the condition that conjugate gradients show, sizes of interface and small
// problem, bytes that a process sends per iteration, memory, time, and how far the strain energy is off that of a
// factor of the whole. It is met within 30 iterations, condition 30 and 1e-9. The program starts itself by mpiexec for
// each number of parts and reads what that has left, also when it ended early. docs/theory/elements.md, "Solving in
// parts".

#include "bench/measure/machines.hpp"

#include "app/processes.hpp"
#include "base/packer.hpp"
#include "base/stopwatch.hpp"
#include "bench/command/records.hpp"
#include "bench/command/shell.hpp"
#include "kerf/mesher.hpp"
#include "plot/chart.hpp"
#include "solver/system.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace kerf {

namespace {

const std::array<int, 5> all_parts{4, 9, 16, 32, 64};

/// One row to be measured.
struct Plan {
  std::string family;
  Element element;
  double poisson = 0.3, contrast = 1;
  bool cracked = false;
  double across = 10;   // H/h
  Index triangles = 0;  // of the whole body, in place of H/h
};

Shape square() {
  Shape shape;
  shape.outline = polygon("outline", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0);
  shape.labels = {"bottom", "right", "top", "left"};
  for (Index i = 0; i < 4; ++i) shape.outline.sides[static_cast<std::size_t>(i)].label = i;
  return shape;
}

/// A crack per part, .6 of a part long and any way round, and one through nearly all of the body.
std::vector<Crack> cracks(int parts) {
  const int n = std::max(2, static_cast<int>(std::lround(std::sqrt(parts))));
  std::mt19937 bits(11);
  const auto random = [&](double low, double high) { return low + (high - low) * (bits() / 4294967296.0); };
  std::vector<Crack> all;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double x = i + 0.5 + random(-0.1, 0.1), y = j + 0.5 + random(-0.1, 0.1), angle = random(0, pi);
      const Vec2 center = Vec2(x, y) / n, along = 0.3 / n * Vec2(std::cos(angle), std::sin(angle));
      if (j != n / 2) all.push_back({fmt::format("c{}", all.size()), {center - along, center + along}, {}});
    }
  const double middle = (n / 2 + 0.5) / n, slope = 0.05 / n;
  all.push_back({"long", {{0.1, middle - slope}, {0.9, middle + slope}}, {}});
  return all;
}

/// Discs that are wider than parts and stand where parts meet.
std::vector<Loop> inclusions() {
  return {circle("a", {0.31, 0.33}, 0.21, none), circle("b", {0.72, 0.64}, 0.17, none)};
}

Shape shape_of(const Plan& plan, int parts) {
  Shape shape = square();
  if (plan.cracked) shape.cracks = cracks(parts);
  if (plan.contrast != 1) shape.regions = inclusions();
  return shape;
}

Scene scene_of(const Plan& plan, std::size_t cracks) {
  Scene s;
  s.material = plane_strain(1, plan.poisson);
  if (plan.contrast != 1)
    s.regions = {plane_strain(plan.contrast, plan.poisson), plane_strain(1 / plan.contrast, plan.poisson)};
  s.supports.push_back({3, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
  s.tractions.push_back({1, [](const Vec2&, const Vec2&) -> Vec2 { return {0.3, 1}; }});
  s.laws.assign(cracks, CrackLaw{.kind = CrackLaw::Kind::Open});
  return s;
}

double size_of(const Plan& plan, int parts) {
  if (plan.triangles > 0) return std::sqrt(4 / std::sqrt(3.0) / static_cast<double>(plan.triangles));
  return 1 / (std::sqrt(static_cast<double>(parts)) * plan.across);
}

std::vector<Plan> plans_of(const BenchOptions& options, int parts) {
  std::vector<Plan> plans;
  const std::vector<double> poisson = options.quick ? std::vector{0.3, 0.5} : std::vector{0.3, 0.4999, 0.499999, 0.5};
  std::vector<Element> of{bdms(1), bdms(2), bdms(3)};
  if (options.quick) of = {bdms(1)};
  const double across = options.quick ? 5 : 8;
  const auto each = [&](const std::string& family, const std::vector<Element>& elements) {
    for (const Element& e : elements)
      for (const bool cracked : {false, true})
        for (const double nu : poisson) plans.push_back({family, e, nu, 1, cracked, across});
  };
  if (is_wanted(options.cases, "table")) each("table", of);
  if (is_wanted(options.cases, "elements") && !options.quick && parts <= 16) each("elements", {afw(1), afw(2), afw(3)});
  if (is_wanted(options.cases, "sizes") && !options.quick && parts <= 16)
    for (const bool cracked : {false, true})
      for (const double nu : {0.3, 0.499999})
        for (const double h : {4, 8, 16, 32}) plans.push_back({"sizes", bdms(1), nu, 1, cracked, h});
  if (is_wanted(options.cases, "contrast"))
    for (const Element& e : of)
      for (const double nu : options.quick ? std::vector{0.3} : std::vector{0.3, 0.499999})
        plans.push_back({"contrast", e, nu, 1e3, false, across});
  if (is_wanted(options.cases, "scaling") && !options.quick && parts <= 16) {
    plans.push_back({"strong", bdms(1), 0.3, 1, true, 0, 40000});
    plans.push_back({"weak", bdms(1), 0.3, 1, true, 0, 5000 * parts});
  }
  return plans;
}

Mesh mesh_of(const Plan& plan, const Shape& shape, int parts) {
  const double size = size_of(plan, parts);
  return triangulate(shape, {.size = size, .crack_tip_size = size / 2});
}

/// What the others need to mesh the same body.
struct RowTask {
  std::string element;
  int degree = 0;
  double poisson = 0, contrast = 0, across = 0;
  bool cracked = false;
  Index triangles = 0;
  std::vector<Index> process;  // per triangle
};
template <typename Visit, Like<RowTask> T>
void fields(Visit& visit, T& t) {
  visit(t.element, t.degree, t.poisson, t.contrast, t.across, t.cracked, t.triangles, t.process);
}
std::string packed_task(const Plan& plan, std::vector<Index> process) {
  Packer to;
  to(RowTask{std::string(plan.element.name), plan.element.degree, plan.poisson, plan.contrast, plan.across,
             plan.cracked, plan.triangles, std::move(process)});
  return std::move(to).take();
}

/// What all processes find together.
struct SolvedTogether {
  double energy = 0, seconds = 0;
  SharedEffort effort;
  std::string refused;
};
SolvedTogether solve_together(const Plan& plan, const Mesh& mesh, const std::vector<Index>& process,
                              Communicator& comm) {
  const Scene scene = scene_of(plan, mesh.cracks.size());
  Stopwatch watch;
  try {
    MeshPart part = mesh_part(mesh, process, static_cast<int>(comm.count()), comm.here(), 0);
    SharedBody body(std::move(part), plan.element, scene, 1, {}, pieces_for_pressure(mesh, scene), comm);
    const State state = body.solve();
    return {sum(comm, strain_energy(body.model(), state)), watch.lap(), body.effort(), {}};
  } catch (const Error& e) {  // which all find
    return {.refused = e.what()};
  }
}

MachineRow row_of(const Plan& plan, Processes& processes) {
  const int parts = processes.count();
  MachineRow row{.family = plan.family,
                 .parts = parts,
                 .element = std::string(plan.element.name),
                 .degree = plan.element.degree,
                 .poisson = plan.poisson,
                 .contrast = plan.contrast * plan.contrast};
  const Shape shape = shape_of(plan, parts);
  row.cracks = static_cast<int>(shape.cracks.size());
  row.across = 1 / (std::sqrt(static_cast<double>(parts)) * size_of(plan, parts));
  const Mesh mesh = mesh_of(plan, shape, parts);
  row.triangles = static_cast<Index>(mesh.triangles.size());
  const Model whole = prepare(mesh, plan.element, scene_of(plan, shape.cracks.size()), 1);
  row.factor_s = whole.seconds.factor;
  row.unknowns = whole.inner->ordering.size;
  const double energy = strain_energy(whole, solve(whole));
  const std::vector<Index> process =
      shares(whole, [&](const auto& start, const auto& near) { return processes.partition(start, near); });
  SolvedTogether found;
  processes.work(packed_task(plan, process),
                 [&](Communicator& comm) { found = solve_together(plan, mesh, process, comm); });
  const SharedEffort& effort = found.effort;
  row.refused = found.refused;
  row.off = std::abs(found.energy - energy) / energy;
  row.parts_s = found.seconds - effort.seconds;
  row.iterate_s = effort.seconds / std::max(effort.solves, 1);
  row.iterations = effort.iterations;
  row.condition = effort.condition;
  row.interface_unknowns = effort.interface_rows;
  row.primal_unknowns = effort.primal;
  row.sent = effort.sent;
  row.first_mb = effort.first_mb;
  row.others_mb = effort.other_mb;
  return row;
}

void run_here(const BenchOptions& options, Processes& processes, MachineBench& bench) {
  processes.take_options({});
  for (const Plan& plan : plans_of(options, processes.count())) {
    if (stop_asked(options)) break;
    if (options.on_phase)
      options.on_phase(fmt::format("{} parts: {}, {} {}, nu = {}{}", processes.count(), plan.family, plan.element.name,
                                   plan.element.degree, plan.poisson, plan.cracked ? ", cracked" : ""));
    bench.rows.push_back(row_of(plan, processes));
    write_machines_json(options.folder / "machines.json", bench);  // another row may end all processes
  }
}

/// The same program by mpiexec, which measures in a folder of its own.
void run_there(const BenchOptions& options, int parts, MachineBench& bench) {
  if (!in_path("mpiexec"))
    throw Error(Fault::Usage, "kerf bench machines starts processes by mpiexec, and there is none (openmpi-bin)");
  std::error_code unknown;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  const std::filesystem::path folder = options.folder / fmt::format("parts_{}", parts);
  std::string line = geteuid() == 0 ? "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 " : "";
  line += fmt::format(
      "OPENBLAS_NUM_THREADS=1 mpiexec --oversubscribe --bind-to none -n {} '{}' machines --quiet --force -o '{}'{}",
      parts, program.string(), folder.string(), options.quick ? " --quick" : "");
  for (const std::string& name : options.cases) line += fmt::format(" --case {}", name);
  const Outcome outcome = shell(line + " 2>&1");
  const auto rows = read_machines_json(folder / "machines.json");
  bench.rows.insert(bench.rows.end(), rows.begin(), rows.end());
  if (outcome.code != 0)
    bench.notes.push_back(fmt::format("{} parts ended with code {} after {} rows: {}", parts, outcome.code, rows.size(),
                                      last_line(outcome.output)));
}

void draw_machines(const std::filesystem::path& path, const MachineBench& bench) {
  Chart chart{.title = "kerf bench machines",
              .subtitle = "most iterations of bdms 1 to 3 to 1e-10 (dashed: cracks across parts)",
              .x_label = "parts",
              .y_label = "iterations",
              .series = {},
              .slopes = {},
              .linear_y = true};
  std::size_t style = 0;
  for (const double nu : {0.3, 0.4999, 0.499999, 0.5}) {
    for (const bool cracked : {false, true}) {
      Series series{.name = fmt::format("nu = {}{}", nu, cracked ? ", cracked" : ""),
                    .points = {},
                    .dashed = cracked,
                    .style = style};
      for (const int parts : all_parts) {
        int most = 0;
        for (const MachineRow& r : bench.rows)
          if (r.family == "table" && r.parts == parts && r.poisson == nu && (r.cracks > 0) == cracked)
            most = std::max(most, r.iterations);
        if (most > 0) series.points.emplace_back(parts, most);
      }
      if (!series.points.empty()) chart.series.push_back(std::move(series));
    }
    ++style;
  }
  if (!chart.series.empty()) draw(path, chart);
}

}  // namespace

bool MachineRow::met() const {
  return refused.empty() && iterations <= 30 && condition <= 30 && off <= 1e-9;
}

void work_on_machine_row(std::string_view bytes, Communicator& comm) {
  const auto task = Unpacker(bytes).get<RowTask>();
  const Plan plan{.family = {},
                  .element = element(task.element, task.degree),
                  .poisson = task.poisson,
                  .contrast = task.contrast,
                  .cracked = task.cracked,
                  .across = task.across,
                  .triangles = task.triangles};
  const int parts = static_cast<int>(comm.count());
  solve_together(plan, mesh_of(plan, shape_of(plan, parts), parts), task.process, comm);
}

MachineBench run_machine_bench(const BenchOptions& options, Processes& processes) {
  make_folder(options.folder);
  MachineBench bench{.rows = {}, .notes = {}, .quick = options.quick};
  if (processes.count() > 1) {
    run_here(options, processes, bench);
  } else {
    processes.require();  // says what is missing before anything is started
    for (const int parts : options.quick ? std::vector<int>{4} : std::vector<int>(all_parts.begin(), all_parts.end())) {
      if (stop_asked(options)) break;
      if (options.on_phase) options.on_phase(fmt::format("{} parts", parts));
      run_there(options, parts, bench);
    }
  }
  bench.stopped = stop_asked(options);
  write_machines_csv(options.folder / "machines.csv", bench);
  write_machines_json(options.folder / "machines.json", bench);
  draw_machines(options.folder / "machines.png", bench);
  return bench;
}

std::string summary(const MachineBench& bench) {
  if (bench.rows.empty()) return fmt::format("nothing was run\n{}\n", fmt::join(bench.notes, "\n"));
  std::string out =
      "Iterations to 1e-10, the condition that they show, and how far the energy is off that of a factor; kB: what a "
      "process sends per iteration, the most of all:\n";
  out += fmt::format("{:<9}{:>6} {:<9}{:>10}{:>7}{:>9}{:>6}{:>9}{:>6}{:>7}{:>10}{:>8}{:>8}{:>7}{:>7}{:>7}{:>9}\n",
                     "family", "parts", "element", "nu", "cracks", "contrast", "H/h", "unknowns", "iter", "cond",
                     "interface", "primal", "kB", "MB", "parts s", "iter s", "off");
  std::size_t missed = 0;
  for (const MachineRow& r : bench.rows) {
    missed += !r.met();
    out += fmt::format(
        "{:<9}{:>6} "
        "{:<9}{:>10}{:>7}{:>9.0e}{:>6.0f}{:>9}{:>6}{:>7.3g}{:>10}{:>8}{:>8.1f}{:>7.0f}{:>7.2f}{:>7.2f}{:>9.0e}{}\n",
        r.family, r.parts, fmt::format("{} {}", r.element, r.degree), r.poisson, r.cracks, r.contrast, r.across,
        r.unknowns, r.iterations, r.condition, r.interface_unknowns, r.primal_unknowns, r.sent / 1000, r.others_mb,
        r.parts_s, r.iterate_s, r.off,
        !r.refused.empty() ? "  " + r.refused
        : r.met()          ? ""
                           : "  missed");
  }
  out += fmt::format("{} of {} rows within 30 iterations, condition 30 and 1e-9\n", bench.rows.size() - missed,
                     bench.rows.size());
  for (const std::string& note : bench.notes) out += note + "\n";
  if (bench.stopped) out += "stopped before the end\n";
  return out;
}

std::vector<std::string> machine_case_names() {
  return {"table", "elements", "sizes", "contrast", "scaling"};
}

}  // namespace kerf
