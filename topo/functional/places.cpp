// Where the integrals of a term look. Weights, targets and directions may vary within a triangle or an edge more than a
// rule of fixed degree sees; where they are expressions, interval arithmetic encloses what the points may miss [Moore
// 1966; theory: D.2, D.4]. A piece has, per component of each datum, the integral of its size by the points and the
// enclosure of what is missed. Of the component with the largest missed share the piece that misses most is cut
// (triangles in four, edges at the places where an expression is not smooth or in half), until less than 1e-4 of each
// integral over the triangle or edge is missed, or 120 cells or 300 spans were looked at. `missed` tells what is left
// over the whole body, for a note. Derived in docs/theory/data.md.

#include "topo/functional/places.hpp"

#include "solver/cut_triangle.hpp"
#include "solver/data.hpp"
#include "solver/left_out.hpp"
#include "solver/system.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr int components = 2;
constexpr double seen = 1e-4;  // of the integral over a triangle or an edge: what may be left

/// A datum, and below what its values count for nothing: a share of the largest that it may have on the body.
template <typename Field>
struct Datum {
  const Field* f;
  Vec2 nothing = Vec2::Zero();
};
template <typename Field>
// Data that are expressions; for others nothing is known between points. Values below 1e-13 of the largest are
// rounding.
std::vector<Datum<Field>> data_of(const std::vector<Field>& fields, const Mesh& mesh) {
  std::vector<Datum<Field>> data;
  for (const Field& f : fields)
    if (f.known()) data.push_back({&f});
  if (data.empty()) return data;
  Interval x{infinity, -infinity}, y = x;
  for (const Vec2& p : mesh.points) {
    x = {std::min(x.low, p.x()), std::max(x.high, p.x())};
    y = {std::min(y.low, p.y()), std::max(y.high, p.y())};
  }
  constexpr double little = 1e-13;
  for (Datum<Field>& datum : data) {
    const std::array<Interval, 2> range = datum.f->known()->over(x, y);
    for (int d = 0; d < components; ++d) {
      const auto& [low, high] = range[static_cast<std::size_t>(d)];
      const double largest = std::max(std::abs(low), std::abs(high));
      if (std::isfinite(largest)) datum.nothing[d] = little * largest;
    }
  }
  return data;
}

/// A piece of a triangle or an edge; of each component of each datum the integral of its size, as the points see it,
/// and what they may miss of it.
struct PieceOfData {
  std::vector<double> size, error;
};

/// Cuts the piece with most of what is missed of the worst component, until all are seen.
template <typename Piece, typename Cut>
void cut_until_seen(std::vector<Piece>& pieces, int most, const Cut& cut) {
  for (int looks = 1; looks < most;) {
    double largest = seen;
    std::size_t worst = 0, worst_of = pieces[0].size.size();
    for (std::size_t i = 0; i < pieces[0].size.size(); ++i) {
      double size = 0, error = 0;
      std::size_t at = 0;
      for (std::size_t k = 0; k < pieces.size(); ++k) {
        size += pieces[k].size[i];
        error += pieces[k].error[i];
        if (pieces[k].error[i] > pieces[at].error[i]) at = k;
      }
      if (error > largest * size) {
        largest = size > 0 ? error / size : infinity;
        worst = at;
        worst_of = i;
        // A datum that the points do not see at all, or whose enclosure is infinite, is cut first.
        if (largest == infinity) break;
      }
    }
    if (worst_of == pieces[0].size.size()) return;
    std::vector<Piece> parts = cut(pieces[worst]);
    if (parts.empty()) return;
    looks += static_cast<int>(parts.size());
    pieces[worst] = std::move(parts[0]);
    for (std::size_t k = 1; k < parts.size(); ++k) pieces.push_back(std::move(parts[k]));
  }
}

// ---- triangles

struct CellOfData : PieceOfData {
  Vertices corners = {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};  // (l1, l2)
  double share() const {                                    // of the triangle
    return cross(corners[1] - corners[0], corners[2] - corners[0]);
  }
};

// Cells of one triangle in barycentric coordinates, cut until the points see the data.
class Cells {
 public:
  Cells(const std::vector<Datum<VectorField>>& data, const Triangle& shape) : shape_(shape), data_(data) {
    // A curved triangle lies within the box of its chords widened by what its sides bend.
    for (const EdgeCurvature* curvature : shape.curvature)
      if (curvature)
        for (const Vec2& q : curvature->q) beyond_ += 0.25 * q.norm();  // products of two coordinates are 1/4 at most
  }

  std::vector<CellOfData> cells() const {
    std::vector<CellOfData> cells(1);
    if (data_.empty()) return cells;
    look(cells[0]);
    constexpr int most = 120;
    cut_until_seen(cells, most, [this](const CellOfData& c) { return parts(c); });
    return cells;
  }

 private:
  // Four similar cells; nothing where they would be smaller than rounding.
  std::vector<CellOfData> parts(const CellOfData& c) const {
    constexpr double finest = 1e-12;
    std::vector<CellOfData> four;
    if (c.share() < finest) return four;
    for (const Vertices& corners : kerf::quarters(c.corners)) {
      four.emplace_back().corners = corners;
      look(four.back());
    }
    return four;
  }

  // Size by the rule of degree 5; what it may miss by enclosures over the box of the cell.
  void look(CellOfData& c) const {
    static const TriangleRule rule = triangle_rule(5);
    const auto place = [&](const Vec2& l) -> Vec2 {
      return (1 - l.x() - l.y()) * shape_.x[0] + l.x() * shape_.x[1] + l.y() * shape_.x[2];
    };
    Interval x{infinity, -infinity}, y = x;
    for (const Vec2& l : c.corners) {
      const Vec2 p = place(l);
      x = {std::min(x.low, p.x() - beyond_), std::max(x.high, p.x() + beyond_)};
      y = {std::min(y.low, p.y() - beyond_), std::max(y.high, p.y() + beyond_)};
    }
    const double share = c.share();
    const Points l = places(rule, c.corners);
    for (const auto& [f, nothing] : data_) {
      Vec2 size = Vec2::Zero();
      for (Eigen::Index q = 0; q < l.cols(); ++q) size += share * rule.w[q] * (*f)(place(l.col(q))).cwiseAbs();
      const Vec2 left =
          left_by_polynomial(*f->known(), x, y, f->known()->over(x, y), 0.1 * seen * size.maxCoeff() / share).of;
      for (int d = 0; d < components; ++d) {
        c.size.push_back(size[d]);
        c.error.push_back(left[d] <= nothing[d] ? 0 : std::isfinite(left[d]) ? share * left[d] : infinity);
      }
    }
  }

  const Triangle& shape_;
  const std::vector<Datum<VectorField>>& data_;
  double beyond_ = 0;
};

// ---- edges

struct SpanOfData : PieceOfData {
  double from = 0, to = 1;
  std::optional<Interval> cut = {};
};

// Parts of one edge, in shares of its length.
class Spans {
 public:
  Spans(const std::vector<Datum<BoundaryField>>& data, const Model& m, Index edge)
      : line_(edge_line({m.mesh, m.inner->skeleton.curvatures, edge})), data_(data) {}

  std::vector<SpanOfData> spans(int pieces) const {
    std::vector<SpanOfData> spans(static_cast<std::size_t>(pieces));
    for (std::size_t k = 0; k < spans.size(); ++k) {
      spans[k].from = static_cast<double>(k) / pieces;
      spans[k].to = static_cast<double>(k + 1) / pieces;
      look(spans[k]);
    }
    if (data_.empty()) return spans;
    constexpr int most = 300;
    cut_until_seen(spans, most, [this](const SpanOfData& s) { return parts(s); });
    std::ranges::sort(spans, {}, &SpanOfData::from);
    return spans;
  }
  /// The same, with what a rule of few points sees differently.
  std::vector<SpanOfData> against(const EdgeRule& few) const {
    std::vector<SpanOfData> spans = this->spans(1);
    for (std::size_t i = 0; i < spans[0].size.size(); ++i) {
      double size = 0, sampled = 0;
      for (const SpanOfData& s : spans) size += s.size[i];
      const auto component = static_cast<Eigen::Index>(i % components);
      for (Eigen::Index g = 0; g < few.s.size(); ++g)
        sampled += few.w[g] * std::abs(value(*data_[i / components].f, few.s[g])[component]);
      spans[0].error[i] += std::abs(sampled - size);
    }
    return spans;
  }

 private:
  // Where an expression has a kink or jump its place is known as an interval: cut on both sides of that, else in half.
  std::vector<SpanOfData> parts(const SpanOfData& s) const {
    constexpr double finest = 0x1p-48;
    std::vector<double> ends{s.from, 0.5 * (s.from + s.to), s.to};
    if (s.cut) ends = {s.from, s.cut->low, s.cut->high, s.to};
    std::vector<SpanOfData> parts;
    if (s.to - s.from < finest) return parts;
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
      if (!(ends[k + 1] > ends[k])) continue;
      SpanOfData& part = parts.emplace_back();
      part.from = ends[k];
      part.to = ends[k + 1];
      look(part);
    }
    return parts.size() > 1 ? parts : std::vector<SpanOfData>();
  }

  Vec2 value(const BoundaryField& f, double s) const {
    return f(line_.a + s * (line_.b - line_.a), line_.n);
  }

  // What eight points may miss follows from an enclosure of the eighth derivative.
  void look(SpanOfData& s) const {
    static const EdgeRule rule = gauss(data_points);
    const double h = s.to - s.from;
    for (const auto& [f, nothing] : data_) {
      const OnPiece known = f->known()->along(line_, s.from, s.to);
      if (known.cut && !s.cut) s.cut = known.cut;
      Vec2 size = Vec2::Zero();
      for (Eigen::Index q = 0; q < rule.s.size(); ++q)
        size += h * rule.w[q] * value(*f, s.from + h * rule.s[q]).cwiseAbs();
      for (int d = 0; d < components; ++d) {
        const auto& [low, high] = known.value[static_cast<std::size_t>(d)];
        // The enclosure of values bounds the error as well: on short spans it may be the smaller one.
        const double left = std::min(left_by_interpolation(known.eighth[static_cast<std::size_t>(d)], h), high - low);
        s.size.push_back(size[d]);
        s.error.push_back(left <= nothing[d] ? 0 : std::isfinite(left) ? 2 * h * left : infinity);
      }
    }
  }

  const EdgeLine line_;
  const std::vector<Datum<BoundaryField>>& data_;
};

Vec2 middle(const Mesh& mesh, Index edge) {
  const auto& [a, b] = mesh.edges[edge];
  return 0.5 * (mesh.points[a] + mesh.points[b]);
}

/// Sums of what pieces know, over triangles or edges.
class MissedShare {
 public:
  template <typename Piece>
  // Sums per component, and the triangle or edge that misses most of it.
  void add(const std::vector<Piece>& pieces, double measure, const Vec2& at) {
    std::vector<double> here(pieces[0].size.size(), 0);
    size_.resize(here.size(), 0);
    error_.resize(here.size(), 0);
    worst_.resize(here.size(), {-1, at});
    for (std::size_t i = 0; i < here.size(); ++i) {
      for (const Piece& p : pieces) {
        size_[i] += measure * p.size[i];
        here[i] += measure * p.error[i];
      }
      error_[i] += here[i];
      if (here[i] > worst_[i].first) worst_[i] = {here[i], at};
    }
  }
  Missed largest() const {
    Missed found;
    for (std::size_t i = 0; i < size_.size(); ++i)
      if (error_[i] > found.share * size_[i])
        found = {size_[i] > 0 ? std::min(1.0, error_[i] / size_[i]) : 1.0, worst_[i].second};
    return found;
  }

 private:
  std::vector<double> size_, error_;
  std::vector<std::pair<double, Vec2>> worst_;
};

}  // namespace

TriangleRule domain_rule(const Model& m) {
  return triangle_rule(8 + m.element.displacement);
}

// By the circle around the triangle.
bool wanted(const Term& term, const Triangle& t) {
  if (!term.somewhere) return true;
  const Vec2 center = centroid(t);
  double radius = 0;
  for (const Vec2& x : t.x) radius = std::max(radius, (x - center).norm());
  return term.somewhere(center, radius);
}

struct RulesOfTerm::Data {
  const Model& model;
  const TriangleRule usual;
  const std::vector<Datum<VectorField>> in_body;
  const std::vector<Datum<BoundaryField>> along;
};

RulesOfTerm::RulesOfTerm(const Term& term, const Model& m)
    : data_(std::make_unique<Data>(
          Data{m, domain_rule(m), data_of(term.varies, whole_mesh(m)), data_of(term.varies_along, whole_mesh(m))})) {}

RulesOfTerm::~RulesOfTerm() = default;

// Nothing where the usual rule sees enough.
std::optional<TriangleRule> RulesOfTerm::cut(Index t) const {
  if (data_->in_body.empty()) return std::nullopt;
  const Triangle shape = triangle(data_->model, t);
  const std::vector<CellOfData> cells = Cells(data_->in_body, shape).cells();
  if (cells.size() == 1) return std::nullopt;
  // In small cells the state hardly varies.
  static const TriangleRule small = triangle_rule(5);
  constexpr double is_small = 0.1;
  const auto of = [&](const CellOfData& c) -> const TriangleRule& {
    return c.share() < is_small ? small : data_->usual;
  };
  Eigen::Index count = 0, at = 0;
  for (const CellOfData& c : cells) count += of(c).w.size();
  TriangleRule all{Points(2, count), Eigen::VectorXd(count)};
  for (const CellOfData& c : cells) {
    const TriangleRule& each = of(c);
    all.x.middleCols(at, each.w.size()) = places(each, c.corners);
    all.w.segment(at, each.w.size()) = c.share() * each.w;
    at += each.w.size();
  }
  return all;
}

// The Gauss points of every span, ordered along the edge.
EdgeRule RulesOfTerm::along(Index edge, int pieces) const {
  static const EdgeRule rule = gauss(data_points);
  const std::vector<SpanOfData> spans = Spans(data_->along, data_->model, edge).spans(pieces);
  const Eigen::Index each = rule.s.size(), count = each * static_cast<Eigen::Index>(spans.size());
  EdgeRule all{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  Eigen::Index at = 0;
  for (const SpanOfData& s : spans) {
    all.s.segment(at, each) = s.from + (s.to - s.from) * rule.s.array();
    all.w.segment(at, each) = (s.to - s.from) * rule.w;
    at += each;
  }
  return all;
}

Missed missed(const Term& term, const Model& m) {
  const RulesOfTerm rules(term, m);
  const auto& [model, usual, in_body, along] = *rules.data_;
  MissedShare body, edges;
  if (term.density && !in_body.empty())
    for (Index t = 0; t < own_triangles(m); ++t) {
      const Triangle shape = triangle(m, t);
      if (wanted(term, shape)) body.add(Cells(in_body, shape).cells(), area(shape), centroid(shape));
    }
  if (term.on_boundary && !along.empty())
    for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e)
      if (m.mesh.label[e] == term.label) edges.add(Spans(along, m, e).spans(1), length(m.mesh, e), middle(m.mesh, e));
  if (term.on_crack && !along.empty())
    for (const CrackEdge& c : m.mesh.cracks[static_cast<std::size_t>(term.crack)])
      edges.add(Spans(along, m, c.edge).against(m.inner->kernel.trace), length(m.mesh, c.edge), middle(m.mesh, c.edge));
  const Missed a = body.largest(), b = edges.largest();
  return a.share > b.share ? a : b;
}

}  // namespace kerf
