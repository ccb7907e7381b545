// Designs on the way of an optimization, kept for pictures: boundaries as loops with the body on their left, cracks as
// lines. At most 32 are kept, those whose iteration is a multiple of a stride that doubles when there are more, and the
// last one. So the memory is bounded however long a run is. pick() takes those nearest to evenly spread iterations.
// They go to a file and back as numbers, beside the checkpoint of the optimization; what is read is checked against the
// rules by which it was kept.

#include "plot/evolution.hpp"

#include "optimize/checkpoint_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

Contours contours(const Mesh& mesh) {
  Contours out;
  // Boundary edges as they run around the triangle they belong to: the body lies to their left.
  std::vector<std::pair<Index, Index>> steps;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto [a, b] = mesh.edges[e];
    if (mesh.sides[e][1] == none) steps.emplace_back(a, b);
    if (mesh.sides[e][0] == none) steps.emplace_back(b, a);
  }
  std::sort(steps.begin(), steps.end());
  std::vector<bool> done(steps.size(), false);
  const auto next = [&](Index from) {
    auto at = std::lower_bound(steps.begin(), steps.end(), std::pair(from, none));
    while (at != steps.end() && at->first == from && done[static_cast<std::size_t>(at - steps.begin())]) ++at;
    return at != steps.end() && at->first == from ? at : steps.end();
  };
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (done[i]) continue;
    std::vector<Vec2> loop;
    for (auto at = steps.begin() + static_cast<std::ptrdiff_t>(i); at != steps.end(); at = next(at->second)) {
      done[static_cast<std::size_t>(at - steps.begin())] = true;
      loop.push_back(mesh.points[static_cast<std::size_t>(at->first)]);
    }
    out.boundary.push_back(std::move(loop));
  }
  for (const auto& crack : mesh.cracks) {
    std::vector<Vec2> line;
    for (const CrackEdge& c : crack) {
      const auto& edge = mesh.edges[static_cast<std::size_t>(c.edge)];
      if (line.empty()) line.push_back(mesh.points[static_cast<std::size_t>(edge[c.forward ? 0 : 1])]);
      line.push_back(mesh.points[static_cast<std::size_t>(edge[c.forward ? 1 : 0])]);
    }
    if (!line.empty()) out.cracks.push_back(std::move(line));
  }
  return out;
}

constexpr std::size_t most_kept = 32;

void add(Snapshots& snapshots, Snapshot snapshot) {
  if (snapshot.iteration % snapshots.stride == 0) {
    std::erase_if(snapshots.kept, [&](const Snapshot& s) { return s.iteration == snapshot.iteration; });
    const auto after = std::find_if(snapshots.kept.begin(), snapshots.kept.end(),
                                    [&](const Snapshot& s) { return s.iteration > snapshot.iteration; });
    snapshots.kept.insert(after, snapshot);
  }
  if (!snapshots.last || snapshots.last->iteration <= snapshot.iteration) snapshots.last = std::move(snapshot);
  while (snapshots.kept.size() > most_kept) {
    snapshots.stride *= 2;
    std::erase_if(snapshots.kept, [&](const Snapshot& s) { return s.iteration % snapshots.stride != 0; });
  }
}

std::vector<Snapshot> pick(const Snapshots& snapshots, std::size_t most) {
  std::vector<Snapshot> all = snapshots.kept;
  if (snapshots.last && (all.empty() || all.back().iteration != snapshots.last->iteration))
    all.push_back(*snapshots.last);
  if (all.size() <= most) return all;
  // Those nearest to evenly spread iterations, each once.
  std::vector<Snapshot> out;
  const double first = all.front().iteration, last = all.back().iteration;
  std::size_t from = 0;
  for (std::size_t k = 0; k < most; ++k) {
    const double wanted = first + (last - first) * static_cast<double>(k) / static_cast<double>(most - 1);
    std::size_t best = from;
    for (std::size_t i = from; i < all.size(); ++i)
      if (std::abs(all[i].iteration - wanted) < std::abs(all[best].iteration - wanted)) best = i;
    best = std::min(best, all.size() - (most - k));  // enough are left for the rest
    out.push_back(all[best]);
    from = best + 1;
  }
  return out;
}

namespace {

/// Numbers of points and the points of each line, one after the other.
Eigen::VectorXd pack(const std::vector<std::vector<Vec2>>& lines) {
  std::vector<double> values;
  for (const auto& line : lines) {
    values.push_back(static_cast<double>(line.size()));
    for (const Vec2& p : line) values.insert(values.end(), {p.x(), p.y()});
  }
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

std::vector<std::vector<Vec2>> unpack(const Eigen::VectorXd& values) {
  NumberReader in(values);
  std::vector<std::vector<Vec2>> lines;
  while (!in.empty()) {
    const Eigen::VectorXd line = in.take_finite(2 * static_cast<Eigen::Index>(in.count()));
    std::vector<Vec2>& points = lines.emplace_back();
    for (Eigen::Index k = 0; k < line.size(); k += 2) points.emplace_back(line[k], line[k + 1]);
  }
  return lines;
}

}  // namespace

Checkpoint to_checkpoint(const Snapshots& snapshots, const std::string& fingerprint) {
  Checkpoint out{fingerprint, {}, {}};
  const auto put = [&](const std::string& name, const Snapshot& s) {
    out.numbers[name] = Eigen::Vector3d(s.iteration, s.objective, s.volume_fraction);
    out.numbers[name + ".boundary"] = pack(s.contours.boundary);
    out.numbers[name + ".cracks"] = pack(s.contours.cracks);
  };
  out.numbers["stride"] = Eigen::VectorXd::Constant(1, snapshots.stride);
  for (std::size_t i = 0; i < snapshots.kept.size(); ++i) put(fmt::format("{:04}", i), snapshots.kept[i]);
  if (snapshots.last) put("last", *snapshots.last);
  return out;
}

Snapshots from_checkpoint(const Checkpoint& checkpoint) {
  const auto get = [&](const std::string& name) {
    NumberReader head(numbers_of(checkpoint, name));
    Snapshot s;
    s.iteration = head.count();
    s.objective = head.any();
    s.volume_fraction = head.any();
    head.end();
    s.contours = {unpack(numbers_of(checkpoint, name + ".boundary")), unpack(numbers_of(checkpoint, name + ".cracks"))};
    return s;
  };
  const auto name = [](std::size_t i) { return fmt::format("{:04}", i); };
  Snapshots out;
  NumberReader stride(numbers_of(checkpoint, "stride"));
  out.stride = stride.count(most_counted, 1);
  stride.end();
  while (checkpoint.numbers.contains(name(out.kept.size()))) {
    Snapshot s = get(name(out.kept.size()));
    if (s.iteration % out.stride != 0 || (!out.kept.empty() && s.iteration <= out.kept.back().iteration) ||
        out.kept.size() == most_kept)
      throw broken_checkpoint();
    out.kept.push_back(std::move(s));
  }
  if (checkpoint.numbers.contains("last")) out.last = get("last");
  return out;
}

}  // namespace kerf
