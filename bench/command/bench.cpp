// What all benches share: which cases are wanted, stops, folders, runs of other programs and times to given errors.

#include "bench/command/bench.hpp"

#include "kerf/stop.hpp"
#include "kerf/types.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kerf {

bool is_wanted(const std::vector<std::string>& names, std::string_view name) {
  return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

bool stop_asked(const BenchOptions& options) {
  return stop_requested() || (options.stop_asked && options.stop_asked());
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed)
    throw Error(Fault::Files, fmt::format("cannot make the folder {}: {}", folder.string(), failed.message()));
}

void add_peers(const BenchOptions& options, PeerTask task, Comparison& bench) {
  if (options.peers.empty() || stop_asked(options)) return;
  PeerRuns peers = run_peers({.task = task,
                              .scripts = options.peers,
                              .work = options.folder / "peers",
                              .seconds = options.peer_seconds,
                              .quick = options.quick,
                              .problems = options.cases,
                              .stop_asked = options.stop_asked,
                              .on_phase = options.on_phase});
  bench.peers = std::move(peers.runs);
  bench.notes.insert(bench.notes.end(), peers.notes.begin(), peers.notes.end());
}

void compare(const Sequences& own, std::span<const double> errors, Comparison& bench) {
  Sequences others;
  for (const PeerRun& p : bench.peers) others.add(p.problem, p.poisson, p.name, {p.error, p.work});
  bench.best = own.fastest(errors);
  bench.best_peers = others.fastest(errors);
}

}  // namespace kerf
