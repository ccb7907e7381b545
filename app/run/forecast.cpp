// Triangles, memory and seconds of a run, from trials on coarser meshes, and what the limits allow of them. A trial on
// about 2,000 to 10,000 triangles is run; with g the growth of the number of triangles n each phase is continued by a
// law of its own, measured:
//   assembly, estimate, recovery, map ~ g;  factor ~ g^1.2;  solves and contact ~ g^1.1;  files +5 % of what is more;
//   memory = 48 MB + 31 N log2 N + 49.8 k^2 n + 35.3 m n bytes,  N = k n condensed unknowns, m n all unknowns
// (16.5 in place of 31 with the factor in single precision). Of several runs of a trial each phase counts with its
// least time, since other work of the machine only makes it longer. An adapted mesh counts with its largest number of
// triangles, an optimization with its largest number of solves: then the forecast is an upper end. What exceeds a limit
// is refused with the mesh size that would fit.

#include "app/forecast.hpp"

#include "app/progress.hpp"
#include "app/run/margins.hpp"
#include "kerf/mesher.hpp"
#include "kerf/stop.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

namespace kerf {

namespace {

namespace fs = std::filesystem;

/// A folder that goes away.
struct Scratch {
  fs::path path;
  Scratch() {
    std::string name = (fs::temp_directory_path() / "kerf-forecast-XXXXXX").string();
    if (!mkdtemp(name.data())) throw Error(Fault::Files, "cannot make a folder for a trial in " + name);
    path = name;
    // Limits end a run at once.
    static fs::path doomed;
    static const bool registered = std::at_quick_exit([] {
                                     std::error_code ignored;
                                     if (!doomed.empty()) fs::remove_all(doomed, ignored);
                                   }) == 0;
    (void)registered;
    doomed = path;
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

/// Equilateral ones.
double triangles_of_size(const Case& c) {
  const double h = target_size(c.sizing, c.shape);
  return area(c.shape) / (std::sqrt(3.0) / 4 * h * h);
}

/// Triangles that mesh.refine makes of one.
double divided(const Case& c) {
  return std::pow(4, c.divisions);
}

Case coarser(const Case& c, double factor) {
  Case out = c;
  out.sizing.size = factor * target_size(c.sizing, c.shape);
  out.sizing.crack_tip_size *= factor;
  out.adapt.reset();
  return out;
}

/// What a run on n triangles took.
struct Trial {
  double n = 0;
  double meshed = 0;  // triangles of the mesh alone; where contact ends there are more then
  Result result;
};

Trial try_out(const Case& c, Job job, int threads, const fs::path& folder) {
  Trial t{.meshed = static_cast<double>(triangulate(c.shape, c.sizing).triangles.size())};
  t.result = run(c, job, {.folder = folder, .threads = threads});
  t.n = t.result.triangles;
  return t;
}

constexpr std::array phases_of_state{&Seconds::mesh,          &Seconds::assemble, &Seconds::factor,
                                     &Seconds::solve,         &Seconds::contact,  &Seconds::estimate,
                                     &Seconds::energy_bounds, &Seconds::tips,     &Seconds::recover};

double of_state(const Seconds& s) {
  double sum = 0;
  for (double Seconds::*phase : phases_of_state) sum += s.*phase;
  return sum;
}

/// Seconds on n triangles from those of a trial. Measured from 2,000 to 190,000 triangles: nested dissection should
/// grow as n^1.5, but large supernodes run faster; a validation is balls, which do not grow, and about three states;
/// files are pictures mostly.
Seconds continued(const Trial& trial, const Seconds& of_trial, double n) {
  const double growth = n / trial.n;
  if (growth < 1.2) return of_trial;  // the trial was the case itself
  Seconds s = of_trial;
  s.mesh *= growth;
  s.assemble *= growth;
  s.factor *= std::pow(growth, 1.2);
  s.solve *= std::pow(growth, 1.1);
  s.contact *= std::pow(growth, 1.1);
  for (double Seconds::*phase :
       {&Seconds::estimate, &Seconds::energy_bounds, &Seconds::tips, &Seconds::recover, &Seconds::map})
    s.*phase *= growth;
  const double more = of_state(s) - of_state(of_trial);
  if (s.validate > 0) s.validate += 3 * more;
  s.output += 0.05 * more;
  s.total = of_state(s) + s.map + s.validate + s.output;
  return s;
}

/// Phase by phase the smaller time: what else the machine does makes times longer only.
Seconds lesser(Seconds a, const Seconds& b) {
  for (double Seconds::*phase : phases_of_state) a.*phase = std::min(a.*phase, b.*phase);
  a.total = of_state(a) + a.map + a.validate + a.output;
  return a;
}

/// Measured on six elements from 10,000 to 350,000 triangles, within 20 %: the program, the factor, the matrix, fields.
double memory_of_state(double n, const Trial& trial, bool single) {
  const StateResult& s = *trial.result.state;
  const double condensed = static_cast<double>(s.condensed_unknowns) / trial.n,
               all = static_cast<double>(s.unknowns) / trial.n, N = condensed * n;
  const double factor = single ? 16.5 : 31;
  return 48 + 1e-6 * (factor * N * std::log2(std::max(N, 2.0)) + 49.8 * condensed * condensed * n + 35.3 * all * n);
}

/// Solves that an optimization makes at most, each with its mesh; a step of a level set counts for its derivatives and
/// for what is refused, too.
double solves_of(const OptimizeRequest& r) {
  const double cases = std::max<double>(1, static_cast<double>(r.load_cases.size()));
  return cases * r.max_iterations * (r.method == OptimizeMethod::LevelSet ? 3 : 1.5);
}

std::string memory_words(double mb) {
  return mb < 1000 ? fmt::format("{:.0f} MB", mb) : fmt::format("{:.2g} GB", mb / 1000);
}

/// The size with about that many triangles: fewer by a share.
double size_for(const Case& c, double share) {
  return target_size(c.sizing, c.shape) / std::sqrt(share);
}

/// `rough`: of the run, `of_trial`: of the trial, as their sizes say it.
void count_triangles(const Case& c, const Trial& trial, double rough, double of_trial, Forecast& f) {
  constexpr double countable = 4e6;
  if (c.adapt) {
    f.triangles = rough;
  } else if (rough < countable) {
    f.exact = trial.n == trial.meshed;
    f.triangles =
        divided(c) * (static_cast<double>(triangulate(c.shape, c.sizing).triangles.size()) + (trial.n - trial.meshed));
  } else {
    f.triangles = rough * std::max(1.0, trial.n / of_trial);
  }
}

}  // namespace

double rough_triangles(const Case& c) {
  return c.adapt ? c.adapt->max_triangles : divided(c) * triangles_of_size(c);
}

Forecast forecast(const Case& c, Job job, int threads) {
  Stopwatch watch;
  const Scratch scratch;
  Case plain = c;
  const bool grows = c.grow && (job == Job::Grow || job == Job::Run);
  const bool optimizes = c.optimize && (job == Job::Optimize || job == Job::Run);
  if (optimizes) plain.element = plain.optimize_element, plain.sizing = problem_of(c).sizing;
  plain.optimize.reset();
  plain.grow.reset();
  plain.output.margins = false;
  plain.divisions = 0;
  if (c.synthetic)  // any data cost the same
    plain.functional = with_measured(std::move(plain.functional), c.synthetic->label,
                                     [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); });
  plain.synthetic.reset();
  if (job == Job::Optimize || job == Job::Grow) job = Job::Solve;
  const double uniform = triangles_of_size(c), rough = rough_triangles(c),
               aim = std::clamp(rough / 12, 2000.0, 10000.0);
  const auto coarse = [&](double n) { return coarser(plain, std::max(c.adapt ? 0.0 : 1.0, std::sqrt(uniform / n))); };
  const Case larger = coarse(aim);
  Case quiet = larger;
  quiet.output.vtk = quiet.output.png = quiet.output.html = false;
  try_out(coarse(300), Job::Solve, threads, scratch.path / "warm");  // modules and fonts are loaded once
  const Trial trial = try_out(larger, job, threads, scratch.path / "trial");
  Seconds seconds = trial.result.seconds;
  for (int k = 0; k < 2; ++k)
    seconds = lesser(seconds, try_out(quiet, Job::Solve, threads, scratch.path / "again").result.seconds);

  Forecast f;
  count_triangles(c, trial, rough, triangles_of_size(larger), f);
  const Seconds s = continued(trial, seconds, f.triangles);
  f.seconds = s.total;
  // The state of one degree more: twice the entries of the factor, and twice its time.
  const double margins = wants_margins(c, f.triangles) && !optimizes ? 2 : 0;
  f.seconds += margins * of_state(s);
  if (c.adapt) f.seconds += 0.6 * of_state(s);  // the rounds before
  if (optimizes) f.seconds += solves_of(*c.optimize) * of_state(s);
  constexpr double states_of_step = 3;
  if (grows) f.seconds += states_of_step * c.grow->steps * of_state(s);
  f.at_most = c.adapt || optimizes || grows;
  // What a trial needed beyond its state (a validation: its balls), the run will need, too.
  const auto memory = [&](bool single) {
    const double before = memory_of_state(trial.n, trial, single), state = memory_of_state(f.triangles, trial, single);
    const double balls = seconds.validate > 0 ? 3 * (state - before) : 0;
    return state + margins * 0.7 * (state - 48) + balls + std::max(0.0, trial.result.peak_memory_mb - before);
  };
  f.memory_mb = memory(c.precision == FactorPrecision::Single);
  if (c.precision == FactorPrecision::Auto && c.backend == Backend::Cholmod && !optimizes && seconds.validate == 0 &&
      !has_unseen_traces(c.element))
    f.single_mb = memory(true);
  f.taken = watch.lap();
  return f;
}

std::string in_words(const Forecast& f) {
  return fmt::format("{}{:.0f} triangles, {} of memory{}, {}{}{}", f.exact ? "" : "about ",
                     f.exact ? f.triangles : std::round(f.triangles / 100) * 100, memory_words(f.memory_mb),
                     f.single ? " with the factor in single precision" : "", f.at_most ? "at most " : "",
                     duration(f.seconds), f.by_one ? " by one process, and less for each of several" : "");
}

double available_memory_mb() {
  double mb = infinity;
  std::ifstream machine("/proc/meminfo"), container("/sys/fs/cgroup/memory.max");
  for (std::string key, rest; machine >> key; std::getline(machine, rest))
    if (double kb = 0; key == "MemAvailable:" && machine >> kb) mb = kb / 1024;
  if (double bytes = 0; container >> bytes) mb = std::min(mb, bytes / (1 << 20));  // or the word "max"
  return mb;
}

void refuse_larger(Forecast& f, const Allowed& limits, const Case& c) {
  const auto refuse = [&](const std::string& why, double share) {
    throw Error(Fault::Numerics,
                fmt::format("{}: {}; {} would fit", why, in_words(f),
                            c.adapt ? fmt::format("mesh.adapt.max_triangles = {:.2g}", share * f.triangles)
                                    : fmt::format("mesh.size = {:.2g}", size_for(c, share))));
  };
  const double memory = limits.memory_mb.value_or(available_memory_mb());
  if (f.memory_mb > memory && f.single_mb) {
    f.single = true;
    f.memory_mb = *f.single_mb;
  }
  constexpr double margin = 0.8;  // memory grows a little faster than the number of triangles, seconds more
  if (f.memory_mb > memory)
    refuse(fmt::format("this needs more memory than the {} that {}", memory_words(memory),
                       limits.memory_mb ? "are allowed" : "there are; --max-memory overrides this"),
           margin * memory / f.memory_mb);
  if (limits.seconds && f.seconds > *limits.seconds)
    refuse(fmt::format("this takes longer than the {} that are allowed", duration(*limits.seconds)),
           margin * std::pow(*limits.seconds / f.seconds, 1 / 1.2));
}

std::optional<Forecast> forecast_where_needed(const Case& c, Job job, int threads, const Allowed& limits, bool asked) {
  constexpr double worth_it = 200000, meshable = 2e7;  // triangles
  asked = asked || limits.memory_mb || limits.seconds;
  if (c.backend == Backend::Petsc) {
    if (!asked) return std::nullopt;
    Case alone = c;
    alone.backend = Backend::Cholmod;
    alone.petsc.clear();
    Forecast f = forecast(alone, job, threads);
    f.by_one = true;
    // Several processes take about as much memory together, and how much less time nobody knows: the run is watched.
    if (limits.memory_mb) refuse_larger(f, {limits.memory_mb, std::nullopt}, c);
    return f;
  }
  const bool validates = job == Job::Validate || (job == Job::Run && c.validate);
  const double rough = rough_triangles(c);
  if (!asked && (rough < worth_it || rough > meshable)) return std::nullopt;  // the mesher refuses more
  try {
    Forecast f = forecast(c, asked || !validates ? job : Job::Solve, threads);
    refuse_larger(f, limits, c);
    f.at_most = f.at_most || (!asked && validates);
    return f;
  } catch (const Error& e) {
    if (stop_requested()) throw Error(Fault::Numerics, "stopped while finding out what the run will take");
    if (asked || e.fault != Fault::Geometry) throw;
    return std::nullopt;  // too coarse a trial says nothing of the case
  }
}

}  // namespace kerf
