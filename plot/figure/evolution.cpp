#include "plot/evolution.hpp"

#include "io/text.hpp"
#include "plot/figure/pen.hpp"
#include "plot/figure/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

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

void add(Snapshots& snapshots, Snapshot snapshot) {
  constexpr std::size_t most = 32;
  if (snapshot.iteration % snapshots.stride == 0) {
    std::erase_if(snapshots.kept, [&](const Snapshot& s) { return s.iteration == snapshot.iteration; });
    const auto after = std::find_if(snapshots.kept.begin(), snapshots.kept.end(),
                                    [&](const Snapshot& s) { return s.iteration > snapshot.iteration; });
    snapshots.kept.insert(after, snapshot);
  }
  if (!snapshots.last || snapshots.last->iteration <= snapshot.iteration) snapshots.last = std::move(snapshot);
  while (snapshots.kept.size() > most) {
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
  std::vector<std::vector<Vec2>> lines;
  for (Eigen::Index i = 0; i < values.size();) {
    const double length = values[i++];
    if (!(length >= 0 && length <= static_cast<double>(values.size()))) break;
    const auto count = static_cast<Eigen::Index>(length);
    std::vector<Vec2> line;
    for (Eigen::Index k = 0; k < count && i + 1 < values.size(); ++k, i += 2)
      line.emplace_back(values[i], values[i + 1]);
    lines.push_back(std::move(line));
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
  const auto& numbers = checkpoint.numbers;
  const auto get = [&](const std::string& name) -> std::optional<Snapshot> {
    const auto head = numbers.find(name), boundary = numbers.find(name + ".boundary"),
               cracks = numbers.find(name + ".cracks");
    if (head == numbers.end() || head->second.size() != 3 || boundary == numbers.end() || cracks == numbers.end())
      return std::nullopt;
    return Snapshot{static_cast<int>(head->second[0]),
                    head->second[1],
                    head->second[2],
                    {unpack(boundary->second), unpack(cracks->second)}};
  };
  Snapshots out;
  if (const auto stride = numbers.find("stride"); stride != numbers.end() && stride->second.size() == 1)
    out.stride = std::max(1, static_cast<int>(stride->second[0]));
  for (std::size_t i = 0;; ++i) {
    auto s = get(fmt::format("{:04}", i));
    if (!s) break;
    out.kept.push_back(std::move(*s));
  }
  out.last = get("last");
  return out;
}

namespace {

constexpr std::uint32_t material = 0x2f3d4c, crack_red = 0xe0232e, frame_fill = 0xeff2f5, frame_line = 0xc9d1d8;
constexpr double margin = 34, gap = 30, widest = 1600;
const Font caption{24, true}, words{21};

struct View {
  Vec2 low, high;
};

View view_of(const std::vector<Snapshot>& snapshots) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  View v{Vec2::Constant(infinite), Vec2::Constant(-infinite)};
  for (const Snapshot& s : snapshots)
    for (const auto& loop : s.contours.boundary)
      for (const Vec2& p : loop)
        if (p.allFinite()) v = {v.low.cwiseMin(p), v.high.cwiseMax(p)};
  if (!v.low.allFinite()) v = {Vec2::Zero(), Vec2::Ones()};
  const double size = std::max((v.high - v.low).maxCoeff(), 1e-300);
  v.high = v.high.cwiseMax(v.low + Vec2::Constant(1e-3 * size));
  return v;
}

struct Grid {
  std::size_t columns = 1;
  double width = 0, height = 0;  // of a drawing
};

/// As large as they can be on a page not much higher than wide.
Grid arrange(std::size_t count, double aspect, double heading) {
  Grid best;
  double largest = 0;
  for (std::size_t columns = 1; columns <= std::min<std::size_t>(count, 6); ++columns) {
    const double rows = std::ceil(static_cast<double>(count) / static_cast<double>(columns));
    const double room = widest - 2 * margin - gap * static_cast<double>(columns - 1);
    double width = room / static_cast<double>(columns), height = width / aspect;
    const double most = (1450 - margin - rows * (heading + gap)) / rows;
    if (height > most) {
      height = most;
      width = height * aspect;
    }
    if (height > 760) height = 760, width = height * aspect;
    // An empty place in the last row counts against it.
    const double full = static_cast<double>(count) / (rows * static_cast<double>(columns));
    if (width * height * full * full > largest) {
      largest = width * height * full * full;
      best = {columns, width, height};
    }
  }
  return best;
}

}  // namespace

void draw(const std::filesystem::path& path, const Evolution& evolution) {
  const Measure measure = ruler();
  const std::vector<Snapshot>& all = evolution.snapshots;
  const View view = view_of(all);
  const Vec2 size = view.high - view.low;
  const double heading = 1.3 * caption.size + 1.3 * words.size + 10;
  const double aspect = std::clamp(size.x() / size.y(), 0.1, 10.0);
  const Grid grid = arrange(std::max<std::size_t>(all.size(), 1), aspect, heading);
  const std::size_t rows = (std::max<std::size_t>(all.size(), 1) + grid.columns - 1) / grid.columns;
  const double used = static_cast<double>(grid.columns) * (grid.width + gap) - gap;
  const double page_width = std::max(900.0, used + 2 * margin);
  const Lines title = wrap(evolution.title, {34, true}, 22, page_width - 2 * margin, 2, measure);
  const Lines subtitle = wrap(evolution.subtitle, {24}, 18, page_width - 2 * margin, 3, measure);
  const double top = margin + title.height() + subtitle.height() + 22;
  const double pitch = heading + grid.height + gap;
  const Sheet page = sheet(static_cast<int>(std::ceil(page_width)),
                           static_cast<int>(std::ceil(top + static_cast<double>(rows) * pitch - gap + margin)));
  cairo_t* pen = page.pen();
  color(pen, paper);
  cairo_paint(pen);
  write_block(pen, {margin, margin}, title, 0);
  write_block(pen, {margin, margin + title.height()}, subtitle, 0, gray);

  const double scale = std::min(grid.width / size.x(), grid.height / size.y());
  const double left = 0.5 * (page_width - used);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double x = left + static_cast<double>(i % grid.columns) * (grid.width + gap);
    const double y = top + static_cast<double>(i / grid.columns) * pitch;
    write(pen, {x, y + 0.65 * caption.size}, all[i].iteration == 0 ? "start" : fmt::format("{}", all[i].iteration),
          caption, 0);
    const std::string text = fmt::format("J = {}, volume {:.3f}", pretty(all[i].objective, 5), all[i].volume_fraction);
    const Lines line = wrap(text, words, 13, grid.width, 1, measure);
    write_block(pen, {x, y + 1.3 * caption.size}, line, 0, gray);

    const Vec2 corner(x + 0.5 * (grid.width - scale * size.x()),
                      y + heading + 0.5 * (grid.height + scale * size.y()));  // lower left
    const auto place = [&](const Vec2& p) {
      return Vec2(corner.x() + (p.x() - view.low.x()) * scale, corner.y() - (p.y() - view.low.y()) * scale);
    };
    const auto trace = [&](const std::vector<std::vector<Vec2>>& lines, bool close) {
      cairo_new_path(pen);
      for (const auto& points : lines) {
        cairo_new_sub_path(pen);
        for (const Vec2& p : points) {
          const Vec2 at = place(p);
          if (at.allFinite()) cairo_line_to(pen, at.x(), at.y());
        }
        if (close) cairo_close_path(pen);
      }
    };
    cairo_set_line_join(pen, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(pen, CAIRO_LINE_CAP_ROUND);
    trace(all.front().contours.boundary, true);
    cairo_set_fill_rule(pen, CAIRO_FILL_RULE_EVEN_ODD);
    color(pen, frame_fill);
    cairo_fill_preserve(pen);
    stroke(pen, 1.2, frame_line);
    trace(all[i].contours.boundary, true);
    color(pen, material);
    cairo_fill_preserve(pen);
    stroke(pen, 1.2, material);
    trace(all[i].contours.cracks, false);
    stroke(pen, 4.5, paper, 0.9);
    trace(all[i].contours.cracks, false);
    stroke(pen, 2.4, crack_red);
  }
  save(path, page);
}

}  // namespace kerf
