// The tables of `kerf bench optimize` for a terminal: own runs against the best peer and the best design known, peers
// by the same judge, spreads, the published problem, remeshing. The best peer leaves out the strong runs (finer,
// projected), the best known has them. "to 1 %" is the first iterate from which on a run stays within 1 % of its last
// value.

#include "bench/optimize/optimize.hpp"
#include "bench/optimize/optimize_peers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

std::string cell(double value, const char* format) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

std::string ratio(const DesignRun& run, const DesignRun* other) {
  return other ? cell(run.value / other->value, "{:.4f}") : "-";
}

std::string own_table(const std::vector<Row>& all) {
  if (all.empty()) return {};
  std::string out = fmt::format(
      "kerf with default settings. J judged on fine meshes; processor seconds; d: J on half the mesh size against its "
      "own\n{:<32}{:>10}{:>9}{:>9}{:>7}{:>8}{:>9}{:>9}{:>9}{:>9}{:>10}  {}\n",
      "scenario", "J", "/ peer", "/ best", "solves", "seconds", "to 1 %", "SIMP 50", "a", "b", "d", "end");
  for (const Row& row : all) {
    const DesignRun& r = *row.run;
    const DesignVerdict& c = r.verdict;
    out += fmt::format("{:<32}{:>10}{:>9}{:>9}{:>7}{:>8.1f}{:>9}{:>9}{:>9}{:>9}{:>10}  {}{}\n",
                       r.problem + (r.variant.empty() ? "" : ", " + r.variant), cell(r.value, "{:.5g}"),
                       ratio(r, row.peer), ratio(r, row.known), r.state_solves, r.seconds,
                       cell(r.near.seconds, "{:.1f}"), row.usual ? cell(row.usual->seconds, "{:.1f}") : "-",
                       cell(c.residual, "{:.2g}"), cell(c.margin, "{:.2g}"), cell(100 * c.change, "{:+.2f} %"),
                       word(c.ending), c.feasible ? "" : ", infeasible");
  }
  return out;
}

std::string peer_table(const std::vector<DesignRun>& runs) {
  std::string out;
  for (const DesignRun& r : runs)
    if (!r.own)
      out += fmt::format("{:<16}{:<32}{:>11.4f}{:>9.5f}{:>7}{:>9.1f}\n", r.problem, r.tool, r.value, r.last.volume,
                         r.state_solves, r.seconds);
  if (out.empty()) return out;
  return fmt::format("Other programs, by the same judge:\n{:<16}{:<32}{:>11}{:>9}{:>7}{:>9}\n", "scenario", "program",
                     "J", "volume", "solves", "seconds") +
         out;
}

/// With a body force, J at the larger volume must not be the worse one.
std::string monotone(const std::vector<DesignRun>& runs) {
  std::string out;
  for (const DesignRun& r : runs)
    for (const DesignRun& less : runs)
      if (r.own && less.own && r.problem == less.problem && r.variant.empty() && !less.variant.empty())
        out += fmt::format("{}: J {:.5g}, {} {:.5g}: {}\n", r.problem, r.value, less.variant, less.value,
                           r.value <= less.value * (1 + 1e-3) ? "monotone" : "NOT monotone");
  return out;
}

std::string spread_table(const OptimizeBench& bench) {
  std::string out;
  for (const Spread& spread : bench.spreads) {
    const SpreadSummary s = summarize(spread);
    double simp = nan;
    for (const DesignRun& r : bench.runs)
      if (r.problem == spread.problem && r.tool == simp_name(usual_cells)) simp = r.value;
    out += fmt::format(
        "spread of {}: {} runs, {} infeasible; J {:.5g} to {:.5g} ({:.2f} %); default / best {:.4f}; worst / SIMP 50 "
        "{}; loads times 1 + 1e-12: {}\n",
        spread.problem, s.count, s.infeasible, s.least, s.most, 100 * (s.most / s.least - 1), s.usual / s.least,
        cell(s.most / simp, "{:.4f}"), cell(100 * s.rounding, "{:.3f} %"));
  }
  return out;
}

std::string published_table(const OptimizeBench& bench) {
  if (bench.published.empty()) return {};
  std::string out =
      fmt::format("Compliance + 100 area, published {:.2f} to {:.2f} with {} to {} solves:\n", published.least_value,
                  published.most_value, published.fewest_solves, published.most_solves);
  for (const PublishedRun& r : bench.published)
    out += fmt::format("{:<34}{:<10}J {:.2f} ({}), {} solves, {:.1f} s\n", r.method, r.start, r.objective,
                       std::isfinite(r.judged) ? fmt::format("{:.2f} on a fine mesh", r.judged) : "weak phase",
                       r.state_solves, r.seconds);
  return out;
}

std::string meshing(const OptimizeBench& bench) {
  std::string out;
  if (bench.remeshing)
    out +=
        fmt::format("remeshing: {:.1f} % of an iteration at {} triangles (carve {:.3f} s, mesh {:.3f} s of {:.3f} s)\n",
                    100 * bench.remeshing->share(), bench.remeshing->triangles, bench.remeshing->carve_s,
                    bench.remeshing->mesh_s, bench.remeshing->iteration_s);
  if (bench.random)
    out += fmt::format("random designs: {} of {} meshed, {} refused with a named reason, {} failed; slowest {:.2g} s\n",
                       bench.random->meshed, bench.random->count, bench.random->refused, bench.random->failures.size(),
                       bench.random->slowest);
  return out;
}

}  // namespace

std::vector<Row> rows(const OptimizeBench& bench) {
  std::vector<Row> all;
  for (const DesignRun& own : bench.runs) {
    if (!own.own) continue;
    Row row{.run = &own};
    for (const DesignRun& r : bench.runs) {
      if (r.own || r.problem != own.problem || !own.variant.empty() || !std::isfinite(r.value)) continue;
      if (r.tool == simp_name(usual_cells)) row.usual = &r;
      if (!r.strong && (!row.peer || r.value < row.peer->value)) row.peer = &r;
      if (!row.known || r.value < row.known->value) row.known = &r;
    }
    all.push_back(row);
  }
  return all;
}

std::string run_name(const DesignRun& run) {
  return run.variant.empty() ? run.tool : fmt::format("{}, {}", run.tool, run.variant);
}

std::string summary(const OptimizeBench& bench) {
  std::string out = own_table(rows(bench)) + monotone(bench.runs) + peer_table(bench.runs) + spread_table(bench) +
                    published_table(bench) + meshing(bench);
  for (const std::string& note : bench.notes) out += "note: " + note + '\n';
  if (bench.stopped) out += "stopped before the end\n";
  return out;
}

}  // namespace kerf
