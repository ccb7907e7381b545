#include "solver/system/parted.hpp"

#include "kerf/stop.hpp"
#include "solver/system/lists.hpp"
#include "solver/system/rigid.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <type_traits>

namespace kerf {

namespace {

/// Bytes of plain values and of vectors of them, in the order in which they are written and read.
class Packer {
 public:
  template <typename T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <typename T>
  void put(const std::vector<T>& values) {
    put(values.size());
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  void put(const Eigen::MatrixXd& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) put(values.data()[i]);
  }
  std::string take() && {
    return std::move(bytes_);
  }

 private:
  std::string bytes_;
};

class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : bytes_(bytes) {}
  template <typename T>
  T get() {
    T value;
    copy(&value, sizeof value);
    return value;
  }
  template <typename T>
  std::vector<T> all() {
    std::vector<T> values(get<std::size_t>());
    copy(values.data(), values.size() * sizeof(T));
    return values;
  }
  template <typename Fixed>
  Fixed matrix() {
    Fixed values;
    for (Eigen::Index i = 0; i < values.size(); ++i) values.data()[i] = get<double>();
    return values;
  }

 private:
  void copy(void* to, std::size_t count) {
    if (bytes_.size() < count) throw std::logic_error("a packed part is too short");
    if (count > 0) std::memcpy(to, bytes_.data(), count);
    bytes_.remove_prefix(count);
  }
  std::string_view bytes_;
};

/// One triangle with its own copies of what Triangle points to.
struct PackedTriangle {
  Triangle shape;
  std::array<std::vector<Mat2>, 3> bent;
  std::array<Bow, 3> bow;
};

void put(const Triangle& t, int points, Packer& to) {
  for (int i = 0; i < 3; ++i) {
    to.put(Eigen::MatrixXd(t.x[i]));
    to.put(Eigen::MatrixXd(t.frame[i]));
    to.put(t.forward[i]);
    to.put(t.bent[i] != nullptr);
    for (int g = 0; t.bent[i] && g < points; ++g) to.put(Eigen::MatrixXd(t.bent[i][g]));
    to.put(t.bow[i] != nullptr);
    if (t.bow[i])
      for (const Vec2& q : t.bow[i]->q) to.put(Eigen::MatrixXd(q));
  }
}

void get(Unpacker& from, int points, PackedTriangle& t) {
  for (int i = 0; i < 3; ++i) {
    t.shape.x[i] = from.matrix<Vec2>();
    t.shape.frame[i] = from.matrix<Mat2>();
    t.shape.forward[i] = from.get<bool>();
    t.bent[i].clear();
    if (from.get<bool>())
      for (int g = 0; g < points; ++g) t.bent[i].push_back(from.matrix<Mat2>());
    t.shape.bent[i] = t.bent[i].empty() ? nullptr : t.bent[i].data();
    const bool curved = from.get<bool>();
    if (curved)
      for (Vec2& q : t.bow[i].q) q = from.matrix<Vec2>();
    t.shape.bow[i] = curved ? &t.bow[i] : nullptr;
  }
}

/// The unknown of a trace: of what a triangle sees of a skeleton unknown, its leading row, or none. What the right side
/// of a crack sees is an unknown of its own where the jump is a leading row, and that of the left side where the jump
/// is held or in contact.
Index seen_row(const Ordering& o, Index leading, Index base, Index jump) {
  if (jump != none && o.row[jump] != none && o.row[jump] < leading) return o.row[jump];
  return o.row[base];
}

// The partition, the numbers of the unknowns, what each part sees.
class Parts {
 public:
  Parts(const Assembly& from, double penalty, Ranks& ranks)
      : from_(from), penalty_(penalty), leading_(from.ordering.size - from.ordering.contact_rows) {
    part_ = in_one_piece(ranks.partition(graph_.start, graph_.neighbors));
    number(ranks.count());
  }

  std::vector<std::string> packed() const {
    const std::vector<Eigen::VectorXd> modes = orthonormal_modes();
    const Lists triangles = file_under(static_cast<Index>(owned_.size()), part_);
    std::vector<std::string> all;
    Index first = 0;
    for (Index p = 0; p < static_cast<Index>(owned_.size()); ++p) {
      all.push_back(pack(triangles[p], p, first, modes));
      first += owned_[p];
    }
    return all;
  }
  const std::vector<Index>& owned() const {
    return owned_;
  }
  const std::vector<Index>& number() const {
    return number_;
  }
  /// Pairs of leading rows: a trace u that both sides of a crack share and the jump there.
  std::vector<std::array<Index, 2>> split() const {
    const Skeleton& s = from_.skeleton;
    std::vector<std::array<Index, 2>> pairs;
    for (Index e = 0; e < static_cast<Index>(from_.mesh.edges.size()); ++e)
      for (int k = 0; s.jump[e] != none && k < s.per_edge; ++k) {
        const Index base = from_.ordering.row[edge_unknown(s, e) + k], jump = from_.ordering.row[s.jump[e] + k];
        if (base != none && jump != none && jump < leading_) pairs.push_back({base, jump});
      }
    return pairs;
  }

 private:
  struct Graph {
    std::vector<Index> start, neighbors;
  };

  // Triangles that hold on to each other, not across cracks that part freely.
  static Graph graph_of(const Assembly& from, Index leading) {
    Graph g;
    g.start.push_back(0);
    for (Index t = 0; t < static_cast<Index>(from.mesh.triangles.size()); ++t) {
      for (const Index e : from.mesh.edges_of[t]) {
        const auto& [left, right] = from.mesh.sides[e];
        if (left == none || right == none || parts_freely(from, leading, e)) continue;
        g.neighbors.push_back(left == t ? right : left);
      }
      g.start.push_back(static_cast<Index>(g.neighbors.size()));
    }
    return g;
  }
  static bool parts_freely(const Assembly& from, Index leading, Index e) {
    const Skeleton& s = from.skeleton;
    if (s.jump[e] == none) return false;
    for (int k = 0; k < s.per_edge; ++k)
      if (const Index row = from.ordering.row[s.jump[e] + k]; row == none || row >= leading) return false;
    return true;
  }

  // What is cut off from the largest piece of its part goes to the part that it has most edges with.
  std::vector<Index> in_one_piece(std::vector<Index> part) const {
    const Index n = static_cast<Index>(part.size());
    constexpr int most = 8;
    for (int sweep = 0; sweep < most; ++sweep) {
      std::vector<Index> piece(part.size(), none), size, of;
      std::vector<Index> stack;
      for (Index seed = 0; seed < n; ++seed) {
        if (piece[seed] != none) continue;
        const Index name = static_cast<Index>(size.size());
        size.push_back(0);
        of.push_back(part[seed]);
        piece[seed] = name;
        stack.push_back(seed);
        while (!stack.empty()) {
          const Index t = stack.back();
          stack.pop_back();
          ++size[name];
          for (Index p = graph_.start[t]; p < graph_.start[t + 1]; ++p)
            if (const Index o = graph_.neighbors[p]; piece[o] == none && part[o] == part[t]) {
              piece[o] = name;
              stack.push_back(o);
            }
        }
      }
      std::vector<Index> largest(static_cast<std::size_t>(*std::ranges::max_element(part)) + 1, none);
      for (Index i = 0; i < static_cast<Index>(size.size()); ++i)
        if (Index& l = largest[of[i]]; l == none || size[i] > size[l]) l = i;
      std::vector<std::vector<Index>> border(size.size());  // parts beyond the edges of pieces that move
      bool moved = false;
      for (Index t = 0; t < n; ++t)
        if (largest[part[t]] != piece[t])
          for (Index p = graph_.start[t]; p < graph_.start[t + 1]; ++p)
            if (const Index o = graph_.neighbors[p]; part[o] != part[t]) border[piece[t]].push_back(part[o]);
      std::vector<Index> to(size.size(), none);
      for (std::size_t i = 0; i < border.size(); ++i) {
        std::ranges::sort(border[i]);
        std::ptrdiff_t best = 0;
        for (auto at = border[i].begin(); at != border[i].end();) {
          const auto end = std::upper_bound(at, border[i].end(), *at);
          if (end - at > best) best = end - at, to[i] = *at;
          at = end;
        }
      }
      for (Index t = 0; t < n; ++t)
        if (to[piece[t]] != none && largest[part[t]] != piece[t]) part[t] = to[piece[t]], moved = true;
      if (!moved) break;
    }
    return part;
  }

  // Unknowns of the first part that sees them, part by part.
  void number(int count) {
    std::vector<Index> owner(static_cast<std::size_t>(leading_), none);
    const Index triangles = static_cast<Index>(from_.mesh.triangles.size());
    for (Index t = 0; t < triangles; ++t)
      for (const Index row : rows_of(t))
        if (row != none && (owner[row] == none || owner[row] > part_[t])) owner[row] = part_[t];
    owned_.assign(static_cast<std::size_t>(count), 0);
    for (Index& o : owner) {
      if (o == none) o = 0;
      ++owned_[o];
    }
    std::vector<Index> next(owned_.size(), 0);
    std::partial_sum(owned_.begin(), owned_.end() - 1, next.begin() + 1);
    number_.resize(owner.size());
    for (Index row = 0; row < leading_; ++row) number_[row] = next[owner[row]]++;
  }

  std::vector<Index> rows_of(Index t) const {
    const Seen view = seen(from_.mesh, from_.skeleton, t);
    std::vector<Index> rows(static_cast<std::size_t>(view.count));
    for (int i = 0; i < view.count; ++i) rows[i] = seen_row(from_.ordering, leading_, view.base[i], view.jump[i]);
    return rows;
  }

  // A value for each leading row from that of each base unknown: on both sides of a crack the same.
  Eigen::VectorXd on_leading(const Eigen::VectorXd& base) const {
    Eigen::VectorXd value = Eigen::VectorXd::Zero(leading_);
    const Skeleton& s = from_.skeleton;
    const auto set = [&](Index unknown, double v) {
      if (const Index row = from_.ordering.row[unknown]; row != none && row < leading_) value[row] = v;
    };
    for (Index e = 0; e < static_cast<Index>(from_.mesh.edges.size()); ++e)
      for (int k = 0; k < s.per_edge; ++k) {
        const Index unknown = edge_unknown(s, e) + k;
        set(unknown, base[unknown]);
        if (s.jump[e] != none) set(s.jump[e] + k, base[unknown]);
      }
    return value;
  }

  // Of the flux through what two parts share, out of the one of lower number.
  Eigen::VectorXd flux() const {
    const Skeleton& s = from_.skeleton;
    Eigen::VectorXd base = Eigen::VectorXd::Zero(s.base);
    for (Index e = 0; e < static_cast<Index>(from_.mesh.edges.size()); ++e) {
      const auto& [left, right] = from_.mesh.sides[e];
      if (left == none || right == none || part_[left] == part_[right]) continue;
      const double sign = part_[left] < part_[right] ? 1 : -1;
      for (int g = 0; g < s.per_edge / 2; ++g) {
        const Vec2 slope = on_edge(from_.mesh, s.bows, e, from_.kernel.trace.s[g]).slope;
        const Vec2 out(slope.y(), -slope.x());  // from left to right
        base.segment<2>(edge_unknown(s, e) + 2 * g) =
            sign * from_.kernel.trace.w[g] * (frame_at(s, e, g).transpose() * out);
      }
    }
    return on_leading(base);
  }

  // The rigid motions and the flux, per number.
  std::vector<Eigen::VectorXd> orthonormal_modes() const {
    std::vector<Eigen::VectorXd> all;
    Vec2 center = Vec2::Zero();
    for (const Vec2& x : from_.mesh.points) center += x / static_cast<double>(from_.mesh.points.size());
    for (const RigidMotion& motion :
         {RigidMotion{center, Vec2(1, 0), 0}, RigidMotion{center, Vec2(0, 1), 0}, RigidMotion{center, Vec2::Zero(), 1}})
      all.push_back(on_leading(trace(from_.mesh, from_.kernel, from_.skeleton, motion)));
    all.push_back(flux());
    std::vector<Eigen::VectorXd> kept;
    for (Eigen::VectorXd& mode : all) {
      const double size = mode.norm();
      for (int twice = 0; twice < 2; ++twice)
        for (const Eigen::VectorXd& other : kept) mode -= other.dot(mode) * other;
      if (const double rest = mode.norm(); rest > 1e-8 * size) kept.push_back(mode / rest);
    }
    for (Eigen::VectorXd& mode : kept) {
      Eigen::VectorXd numbered(mode.size());
      for (Index row = 0; row < leading_; ++row) numbered[number_[row]] = mode[row];
      mode = std::move(numbered);
    }
    return kept;
  }

  std::string pack(std::span<const Index> triangles, Index p, Index first,
                   const std::vector<Eigen::VectorXd>& modes) const {
    std::vector<Index> rows, local;  // leading rows that it sees, in the order of their numbers
    for (const Index t : triangles)
      for (const Index row : rows_of(t))
        if (row != none) rows.push_back(number_[row]);
    std::ranges::sort(rows);
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    const auto place = [&](Index row) {
      return row == none ? none : static_cast<Index>(std::ranges::lower_bound(rows, number_[row]) - rows.begin());
    };
    Packer to;
    const Element& e = from_.kernel.element;
    to.put(static_cast<Index>(
        std::ranges::find_if(elements,
                             [&](const Element& other) { return other.name == e.name && other.degree == e.degree; }) -
        elements.begin()));
    to.put(rows);
    to.put(owned_[p]);
    to.put(static_cast<Index>(modes.size()));
    for (const Eigen::VectorXd& mode : modes) to.put(Eigen::MatrixXd(mode.segment(first, owned_[p])));
    to.put(static_cast<Index>(triangles.size()));
    for (const Index t : triangles) {
      const Material& material = material_of(from_.mesh, from_.scene, t);
      put(triangle(from_.mesh, from_.skeleton, t), from_.skeleton.per_edge / 2, to);
      to.put(from_.mesh.triangles[t]);
      to.put(material);
      to.put(penalty_ / material.mu);
      for (const Index row : rows_of(t)) to.put(place(row));
    }
    return std::move(to).take();
  }

  const Assembly& from_;
  double penalty_;
  Index leading_;
  Graph graph_ = graph_of(from_, leading_);
  std::vector<Index> part_, owned_, number_;
};

class ByRanks : public LeadingSolver {
 public:
  ByRanks(const Parts& parts, std::shared_ptr<Ranks> ranks)
      : ranks_(std::move(ranks)), number_(parts.number()), split_(parts.split()) {
    solver_ = ranks_->solver(parts.packed(), parts.owned());
  }

  // With z = (u, u + jump) on cracks: forces on u and the jump are those on z.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const override {
    check_stop();
    Eigen::VectorXd forces = b;
    for (const auto& [base, jump] : split_) forces[base] -= forces[jump];
    Eigen::VectorXd right(b.size()), x(b.size());
    for (Eigen::Index row = 0; row < b.size(); ++row) right[number_[row]] = forces[row];
    const Eigen::VectorXd z = solver_->solve(right);
    for (Eigen::Index row = 0; row < b.size(); ++row) x[row] = z[number_[row]];
    for (const auto& [base, jump] : split_) x[jump] -= x[base];
    return x;
  }

  PartedEffort effort() const override {
    return solver_->effort();
  }

 private:
  std::shared_ptr<Ranks> ranks_;
  std::vector<Index> number_;
  std::vector<std::array<Index, 2>> split_;
  std::unique_ptr<PartedSolver> solver_;
};

/// The triangles of a part, one after the other.
struct Local {
  std::vector<Index> rows;
  std::array<Index, 3> vertices;
};

// For each row those of its own edge and of the edges that share a vertex with it.
void connect_rows(const std::vector<Local>& all, int per_edge, RankPart& part) {
  // Of each vertex the rows at edges that end there. Edge i of a triangle is opposite its vertex i.
  std::vector<std::pair<Index, Index>> at;  // vertex, row
  for (const Local& t : all)
    for (int e = 0; e < 3; ++e)
      for (int k = 0; k < per_edge; ++k)
        if (const Index row = t.rows[static_cast<std::size_t>(e * per_edge + k)]; row != none)
          for (const int end : {1, 2}) at.emplace_back(t.vertices[static_cast<std::size_t>((e + end) % 3)], row);
  std::ranges::sort(at);
  at.erase(std::unique(at.begin(), at.end()), at.end());
  std::vector<std::vector<Index>> near(static_cast<std::size_t>(part.rows));
  for (auto begin = at.begin(); begin != at.end();) {
    auto end = begin;
    while (end != at.end() && end->first == begin->first) ++end;
    for (auto i = begin; i != end; ++i)
      for (auto j = begin; j != end; ++j) near[i->second].push_back(j->second);
    begin = end;
  }
  part.near_start.assign(1, 0);
  for (std::vector<Index>& rows : near) {
    std::ranges::sort(rows);
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    part.near_rows.insert(part.near_rows.end(), rows.begin(), rows.end());
    part.near_start.push_back(static_cast<Index>(part.near_rows.size()));
  }
}

}  // namespace

bool can_be_parted(const Element& e) {
  return is_mixed(e) && e.at_vertices == AtVertices::Nothing && !has_unseen_traces(e) && is_definite(e);
}

std::unique_ptr<LeadingSolver> parted(const Assembly& from, double penalty, std::shared_ptr<Ranks> ranks) {
  const Parts parts(from, penalty, *ranks);
  return std::make_unique<ByRanks>(parts, std::move(ranks));
}

RankPart condensed_part(std::string_view packed) {
  use_one_thread();
  Unpacker from(packed);
  const Kernel k = kernel(elements[static_cast<std::size_t>(from.get<Index>())]);
  RankPart part;
  part.number = from.all<Index>();
  part.rows = static_cast<Index>(part.number.size());
  part.owned = from.get<Index>();
  part.mode_count = from.get<Index>();
  for (Index i = 0; i < part.mode_count * part.owned; ++i) part.modes.push_back(from.get<double>());
  const Index triangles = from.get<Index>();
  const int count = skeleton_count(k.element), per_edge = count / 3;
  std::vector<Local> all(static_cast<std::size_t>(triangles));
  std::vector<SkeletonMatrix> matrices;
  matrices.reserve(all.size());
  PackedTriangle t;
  for (Local& local : all) {
    get(from, per_edge / 2, t);
    local.vertices = from.get<std::array<Index, 3>>();
    const Material material = from.get<Material>();
    const double a = from.get<double>();
    for (int i = 0; i < count; ++i) local.rows.push_back(from.get<Index>());
    matrices.push_back(condense(k, t.shape, material, {}, {.a = a}).K);
  }
  // The pattern from triplets, row after row.
  std::vector<std::vector<std::pair<Index, double>>> rows(static_cast<std::size_t>(part.rows));
  for (std::size_t i = 0; i < all.size(); ++i)
    for (int p = 0; p < count; ++p)
      for (int q = 0; q < count; ++q)
        if (all[i].rows[p] != none && all[i].rows[q] != none)
          rows[all[i].rows[p]].emplace_back(all[i].rows[q], matrices[i](p, q));
  part.start.assign(1, 0);
  for (auto& row : rows) {
    std::ranges::stable_sort(row, {}, &std::pair<Index, double>::first);
    for (std::size_t p = 0; p < row.size(); ++p)
      if (p > 0 && row[p].first == row[p - 1].first) {
        part.values.back() += row[p].second;
      } else {
        part.columns.push_back(row[p].first);
        part.values.push_back(row[p].second);
      }
    part.start.push_back(static_cast<Index>(part.columns.size()));
    row = {};
  }
  connect_rows(all, per_edge, part);
  return part;
}

}  // namespace kerf
