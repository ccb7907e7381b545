// The time that a sequence of runs takes to a given error: on the line between two runs in the logarithms of both,
// beyond the last one by at most a factor of 12, or not at all; and the fastest of several sequences.

#include "bench/measure/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

std::optional<TimeTo> time_to(std::vector<WorkPoint> points, double error) {
  std::erase_if(points, [](const WorkPoint& p) {
    return !(std::isfinite(p.error) && std::isfinite(p.seconds) && p.error > 0 && p.seconds > 0);
  });
  if (points.empty()) return std::nullopt;
  std::stable_sort(points.begin(), points.end(),
                   [](const WorkPoint& a, const WorkPoint& b) { return a.error > b.error; });
  const auto on_line = [&](const WorkPoint& a, const WorkPoint& b) {
    const double share = std::log(error / a.error) / std::log(b.error / a.error);
    return a.seconds * std::pow(b.seconds / a.seconds, share);
  };
  if (points.front().error <= error) return TimeTo{TimeTo::Kind::AtMost, points.front().seconds, error};
  for (std::size_t i = 1; i < points.size(); ++i)
    if (points[i].error <= error) return TimeTo{TimeTo::Kind::Interpolated, on_line(points[i - 1], points[i]), error};
  const WorkPoint& last = points.back();
  if (points.size() > 1 && error > last.error / 12) {
    const WorkPoint& before = points[points.size() - 2];
    const double seconds = last.error < before.error ? on_line(before, last) : 0;
    if (seconds > last.seconds && seconds < 3600) return TimeTo{TimeTo::Kind::Extrapolated, seconds, error};
  }
  return TimeTo{TimeTo::Kind::Missed, last.seconds, last.error};
}

bool faster(const TimeTo& a, const TimeTo& b) {
  const auto rank = [](const TimeTo& t) {
    return t.kind == TimeTo::Kind::Missed ? 2 : t.kind == TimeTo::Kind::Extrapolated ? 1 : 0;
  };
  if (rank(a) != rank(b)) return rank(a) < rank(b);
  return a.kind == TimeTo::Kind::Missed ? a.error < b.error : a.seconds < b.seconds;
}

std::string text(const std::optional<TimeTo>& time) {
  if (!time) return "-";
  switch (time->kind) {
    case TimeTo::Kind::Interpolated:
      return fmt::format("{:.2g}", time->seconds);
    case TimeTo::Kind::AtMost:
      return fmt::format("<={:.2g}", time->seconds);
    case TimeTo::Kind::Extrapolated:
      return fmt::format("~{:.2g}", time->seconds);
    case TimeTo::Kind::Missed:
      break;
  }
  return fmt::format(">{:.2g} ({:.0e})", time->seconds, time->error);
}

void Sequences::add(const std::string& problem, double poisson, const std::string& name, const WorkPoint& run) {
  auto race = std::find_if(races_.begin(), races_.end(),
                           [&](const Race& r) { return r.problem == problem && r.poisson == poisson; });
  if (race == races_.end()) race = races_.insert(races_.end(), {problem, poisson, {}});
  auto& all = race->sequences;
  auto sequence = std::find_if(all.begin(), all.end(), [&](const Sequence& s) { return s.name == name; });
  if (sequence == all.end()) sequence = all.insert(all.end(), {name, {}});
  sequence->runs.push_back(run);
}

std::vector<Fastest> Sequences::fastest(std::span<const double> errors) const {
  std::vector<Fastest> all;
  for (const Race& race : races_)
    for (const double error : errors) {
      std::optional<Fastest> best;
      for (const Sequence& s : race.sequences)
        if (const auto time = time_to(s.runs, error); time && (!best || faster(*time, best->time)))
          best = Fastest{race.problem, race.poisson, error, s.name, *time};
      if (best) all.push_back(*best);
    }
  return all;
}

const Fastest* find(const std::vector<Fastest>& all, const Fastest& like) {
  const auto at = std::find_if(all.begin(), all.end(), [&](const Fastest& f) {
    return f.problem == like.problem && f.poisson == like.poisson && f.error == like.error;
  });
  return at == all.end() ? nullptr : &*at;
}

std::string ratio(const TimeTo& peer, const TimeTo& own) {
  if (peer.kind == TimeTo::Kind::Missed || own.kind == TimeTo::Kind::Missed) return "-";
  const bool guessed = peer.kind == TimeTo::Kind::Extrapolated || own.kind == TimeTo::Kind::Extrapolated;
  const bool most = peer.kind == TimeTo::Kind::AtMost, least = own.kind == TimeTo::Kind::AtMost;
  const char* bound = guessed || (most && least) ? "~" : most ? "<=" : least ? ">=" : "";
  return fmt::format("{}{:.2g}", bound, peer.seconds / own.seconds);
}

}  // namespace kerf
