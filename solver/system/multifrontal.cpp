// The numeric phase of a sparse Cholesky factorization, front by front [Duff, Reid 1983]. With s the columns of a
// supernode, p the rows below them and U_c what its children in the tree of elimination leave,
//   (F_ss; F_ps F_pp) = (K_ss; K_ps 0) + sum_c U_c,  L_ss L_ss' = F_ss,  L_ps = F_ps L_ss^-T,  U_s = F_pp - L_ps L_ps'
// [theory: E.28]. Fronts come in depth-first order, so that what they leave waits on a stack whose size is known
// before. The tree is cut by work alone: subtrees with less than a 64th of all flops are tasks of one thread each, the
// fronts above them come one after the other, their tiles on all threads. Every sum has one order, so that the bits do
// not depend on the number of threads. Large fronts go through the kernels of front_kernels.cpp, small ones column by
// column. Derived in docs/theory/elements.md, section The factor.

#include "solver/system/multifrontal.hpp"

#include "base/parallel.hpp"
#include "kerf/stop.hpp"
#include "solver/system/front_kernels.hpp"
#include "solver/system/memory_pool.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>

namespace kerf {

namespace {

/// A few columns of length `height`, the first `width` rows their own: for fronts too small for tiles.
bool small_panel(Index height, Index width, double* a) {
  const auto column = [=](Index k) { return a + std::int64_t{k} * height; };
  for (Index j = 0; j < width; ++j) {
    double* __restrict to = column(j);
    Index k = 0;
    for (; k + 4 <= j; k += 4) {
      const double *p = column(k), *q = column(k + 1), *r = column(k + 2), *s = column(k + 3);
      const double at_p = p[j], at_q = q[j], at_r = r[j], at_s = s[j];
      for (Index i = j; i < height; ++i) to[i] -= p[i] * at_p + q[i] * at_q + r[i] * at_r + s[i] * at_s;
    }
    for (; k < j; ++k) {
      const double* p = column(k);
      const double at_p = p[j];
      for (Index i = j; i < height; ++i) to[i] -= p[i] * at_p;
    }
    if (!(to[j] > 0)) return false;
    const double pivot = std::sqrt(to[j]), inverse = 1 / pivot;
    to[j] = pivot;
    for (Index i = j + 1; i < height; ++i) to[i] *= inverse;
  }
  return true;
}

/// The rest less a a', a the panel's narrow part below its own rows, two columns by four at a time.
void small_rest(const FrontMatrix& f) {
  const Index n = f.height - f.width, width = f.width;
  const auto column = [&](Index k) { return f.panel + width + std::int64_t{k} * f.height; };
  const auto next = [&](double* first, Index j) { return first + (f.square ? n : n - j - 1); };  // where row 0 would be
  double* first = f.rest;
  Index j = 0;
  for (; j + 2 <= n; j += 2) {
    double* __restrict left = first;
    double* __restrict right = next(left, j);
    first = next(right, j + 1);
    Index t = 0;
    for (; t + 4 <= width; t += 4) {
      const double *p = column(t), *q = column(t + 1), *r = column(t + 2), *s = column(t + 3);
      const double p0 = p[j], q0 = q[j], r0 = r[j], s0 = s[j], p1 = p[j + 1], q1 = q[j + 1], r1 = r[j + 1],
                   s1 = s[j + 1];
      left[j] -= p0 * p0 + q0 * q0 + r0 * r0 + s0 * s0;
      for (Index i = j + 1; i < n; ++i) {
        left[i] -= p[i] * p0 + q[i] * q0 + r[i] * r0 + s[i] * s0;
        right[i] -= p[i] * p1 + q[i] * q1 + r[i] * r1 + s[i] * s1;
      }
    }
    for (; t < width; ++t) {
      const double *p = column(t), p0 = p[j], p1 = p[j + 1];
      left[j] -= p0 * p0;
      for (Index i = j + 1; i < n; ++i) {
        left[i] -= p[i] * p0;
        right[i] -= p[i] * p1;
      }
    }
  }
  for (; j < n; ++j)
    for (Index t = 0; t < width; ++t) {
      const double* p = column(t);
      for (Index i = j; i < n; ++i) first[i] -= p[i] * p[j];
    }
}

}  // namespace

/// What one thread needs: where each row of L is in the front, the stack of what fronts leave, the front's panel, and
/// what its elimination copies.
struct Multifrontal::Arena {
  std::vector<Index> place;
  std::unique_ptr<double[]> stack, panel, packed;
  Arena(Index columns, const Room& room)
      : place(static_cast<std::size_t>(columns)),
        stack(new double[room.stack]),
        panel(new double[room.panel]),
        packed(new double[packed_size(room.height)]) {}
};

/// One factorization.
template <typename Scalar>
struct Multifrontal::Run {
  struct Work : Front {  // in the making
    double* panel;       // height x width
    FrontMatrix matrix(double* rest, bool square) const {
      return {height, width, panel, rest, square};
    }
  };
  const Multifrontal& of;
  const LowerTriangle& K;
  Scalar* values;
  Eigen::MatrixXd& last;  // rows and columns of L
  Team& team;
  std::vector<double*> left = {};                    // per front what it leaves, a LowerHalf
  std::vector<std::unique_ptr<double[]>> kept = {};  // of roots of subtrees
  MemoryPool<Arena> free = {};
  std::atomic<bool> definite = true;

  Run(const Multifrontal& m, const LowerTriangle& k, Scalar* v, Eigen::MatrixXd& l, Team& t)
      : of(m),
        K(k),
        values(v),
        last(l),
        team(t),
        left(static_cast<std::size_t>(m.s_.count()), nullptr),
        kept(left.size()) {}

  /// Where each row of L is in the front: an array of the size of L's rows, which is never cleared.
  static void find_places(const Front& f, std::vector<Index>& place) {
    for (Index i = 0; i < f.height; ++i) place[static_cast<std::size_t>(f.rows[i])] = i;
  }

  /// Columns from .. to of the front's own part of K.
  void add_entries(const Work& f, const std::vector<Index>& place, Index from, Index to) const {
    for (Index j = from; j < to; ++j) {
      double* column = f.panel + std::int64_t{j} * f.height;
      std::fill_n(column, f.height, 0.0);
      for (Index p = K.start[f.first + j]; p < K.start[f.first + j + 1]; ++p)
        column[place[static_cast<std::size_t>(K.rows[p])]] = K.values[p];
    }
  }

  /// Columns from .. to of what the child leaves; `places`: of its rows in the front.
  /// The extend-add: rows of a child are rows of its parent, in the same order, so that the lower half goes to the
  /// lower half.
  static void add_child(const FrontMatrix& matrix, const double* child, const std::vector<Index>& places, Index from,
                        Index to) {
    const auto m = static_cast<Index>(places.size());
    for (Index j = from; j < to; ++j) {
      const Index at = places[static_cast<std::size_t>(j)];
      const double* source = child + LowerHalf::place(m, j);
      double* target = matrix.column(at);
      for (Index i = j; i < m; ++i) target[places[static_cast<std::size_t>(i)]] += source[i];
    }
  }
  /// arena.place is filled for the rows of the present front alone; what stands elsewhere is of earlier fronts.
  std::vector<Index> places_of(Index child, const std::vector<Index>& place) const {
    const Front c = of.front(child);
    std::vector<Index> places(static_cast<std::size_t>(c.rest()));
    for (Index i = 0; i < c.rest(); ++i)
      places[static_cast<std::size_t>(i)] = place[static_cast<std::size_t>(c.rows[c.width + i])];
    return places;
  }

  /// Tiles cost copies of the rows (packing), which few flops do not pay for.
  bool eliminate_front(const FrontMatrix& f, double* packed, bool together) const {
    constexpr double little = 5e5;  // flops below which columns alone are faster than tiles
    const Index height = f.height, width = f.width;
    if (double(width) * height * height < little) {
      if (!small_panel(height, width, f.panel)) return false;
      small_rest(f);
      return true;
    }
    return eliminate(f, packed,
                     [&](Index count, const std::function<void(Index)>& body) { each(count, together, body); });
  }

  /// What the root leaves is copied out of the arena, which the next subtree takes.
  void subtree(const Unit& unit) {
    if (!definite) return;
    check_stop();
    std::unique_ptr<Arena> arena = free.take([&] { return std::make_unique<Arena>(of.columns_, of.subtree_room_); });
    std::size_t top = 0;
    for (Index k = unit.begin; k < unit.end; ++k)
      if (!perform(of.sequence_[k], *arena, top, false, false)) {
        definite = false;
        break;
      }
    const Index root = of.sequence_[unit.end - 1];
    const std::size_t size = of.front(root).rest_size();
    if (definite) {
      kept[root].reset(new double[size]);
      std::copy_n(left[root], size, kept[root].get());
      left[root] = kept[root].get();
    }
    free.give(std::move(arena));
  }

  static constexpr Index strip = 64;

  /// Whether threads are worth waking.
  static bool is_large(const Front& f) {
    constexpr double flops = 4e6;
    return double(f.width) * f.height * f.height > flops;
  }
  void each(Index count, bool together, const std::function<void(Index)>& body) const {
    if (together) return team.run(count, body);
    for (Index i = 0; i < count; ++i) body(i);
  }
  template <typename Body>
  void in_strips(Index columns, bool together, const Body& body) const {
    each((columns + strip - 1) / strip, together,
         [&](Index i) { body(i * strip, std::min(columns, (i + 1) * strip)); });
  }

  /// Columns begin .. end of the front's panel, into L.
  /// Rounded to Scalar here and nowhere before: S and what fronts leave are double.
  void store(const Work& f, Index s, Index begin, Index end) const {
    Scalar* panel = values + of.place_[static_cast<std::size_t>(s)];
    for (Index j = begin; j < end; ++j) {
      const Index top = j / FrontPanel<double>::together * FrontPanel<double>::together;
      const double* from = f.panel + std::int64_t{j} * f.height + top;
      std::transform(from, from + f.height - top, panel + FrontPanel<double>::place(f.height, j) + top,
                     [](double value) { return static_cast<Scalar>(value); });
    }
  }
  void store_last(const Work& f) const {
    const Index first = of.columns_ - static_cast<Index>(last.rows());
    for (Index j = std::max<Index>(0, first - f.first); j < f.width; ++j)
      for (Index i = j; i < f.height; ++i)
        last(f.rows[i] - first, f.first + j - first) = f.panel[std::int64_t{j} * f.height + i];
  }

  /// Columns that are kept, before anything is eliminated.
  void begin_last() const {
    const Index first = of.columns_ - of.kept_;
    for (Index j = first; of.kept_ > 0 && j < of.columns_; ++j)
      for (Index p = K.start[j]; p < K.start[j + 1]; ++p) last(K.rows[p] - first, j - first) = K.values[p];
  }
  /// What a front below no other leaves of columns that are kept.
  void add_to_last(const Front& f, const double* rest) const {
    const Index first = of.columns_ - of.kept_;
    for (Index j = 0; j < f.rest(); ++j)
      for (Index i = j; i < f.rest(); ++i)
        last(f.rows[f.width + i] - first, f.rows[f.width + j] - first) += rest[LowerHalf::place(f.rest(), j) + i];
  }

  /// What the front leaves is made on top of the stack, then moved down to where that of its children was; `in_last`:
  /// in `last`.
  /// Steps: entries of K, what children leave, elimination, store. The rest is made on top of the stack while the
  /// children's lie below it, then moved down over them.
  bool perform(Index s, Arena& arena, std::size_t& top, bool together, bool in_last) {
    const Work f{of.front(s), arena.panel.get()};
    double *lowest = arena.stack.get() + top, *rest = in_last ? last.data() : lowest;
    find_places(f, arena.place);
    in_strips(f.width, together, [&](Index from, Index to) { add_entries(f, arena.place, from, to); });
    const FrontMatrix matrix = f.matrix(rest, in_last);
    in_strips(in_last ? 0 : f.rest(), together, [&](Index from, Index to) {
      std::fill(rest + LowerHalf::start(f.rest(), from), rest + LowerHalf::start(f.rest(), to), 0.0);
    });
    for (Index c = of.first_child_[s]; c != none; c = of.next_[c]) {
      const std::vector<Index> places = places_of(c, arena.place);
      in_strips(static_cast<Index>(places.size()), together,
                [&](Index from, Index to) { add_child(matrix, left[c], places, from, to); });
      if (kept[c])
        kept[c].reset();
      else
        lowest = std::min(lowest, left[c]);
    }
    if (!eliminate_front(matrix, arena.packed.get(), together)) return false;
    in_strips(f.width, together, [&](Index from, Index to) { store(f, s, from, to); });
    store_last(f);
    if (in_last) {
      top = static_cast<std::size_t>(lowest - arena.stack.get());
      return true;
    }
    if (lowest != rest) std::memmove(lowest, rest, f.rest_size() * sizeof(double));
    left[s] = lowest;
    top = static_cast<std::size_t>(lowest - arena.stack.get()) + f.rest_size();
    return true;
  }

  /// A front with no parent whose rest is not empty sees kept columns: that goes to `last`.
  void single(Index s, Arena& arena, std::size_t& top) {
    if (!definite) return;
    check_stop();
    const Front f = of.front(s);
    const bool in_last = of.leaves_all(s);
    definite = perform(s, arena, top, is_large(f), in_last);
    if (!definite || in_last || f.rest() == 0 || of.parent_[s] != none) return;
    add_to_last(f, left[s]);
    top = static_cast<std::size_t>(left[s] - arena.stack.get());
  }

  /// With one thread subtrees run in the order of the units, their results waiting; with more the heaviest first, since
  /// the last one to end decides.
  bool operator()() {
    begin_last();
    Arena arena(of.columns_, of.top_room_);
    std::size_t top = 0;
    if (team.size() > 1) {
      std::vector<const Unit*> heavy_first;
      for (const Unit& u : of.units_)
        if (u.subtree) heavy_first.push_back(&u);
      std::stable_sort(heavy_first.begin(), heavy_first.end(),
                       [](const Unit* a, const Unit* b) { return a->work > b->work; });
      team.run(static_cast<Index>(heavy_first.size()),
               [&](Index i) { subtree(*heavy_first[static_cast<std::size_t>(i)]); });
      free.clear();
    }
    for (const Unit& u : of.units_)
      if (!u.subtree)
        single(of.sequence_[u.begin], arena, top);
      else if (team.size() == 1)
        subtree(u);
    for (const Unit& u : of.units_) {
      const Index root = of.sequence_[u.end - 1];
      if (definite && u.subtree && of.parent_[root] == none && kept[root])
        add_to_last(of.front(root), kept[root].get());
    }
    return definite;
  }
};

/// Supernodes whose columns are all kept are dropped; one that is cut by the border keeps its columns before it, and
/// sees those behind as rows.
Multifrontal::Multifrontal(Supernodes supernodes, Index kept) : s_(std::move(supernodes)), kept_(kept) {
  if (s_.count() == 0) return;
  columns_ = s_.first.back();
  const Index eliminated = columns_ - kept_;
  while (s_.count() > 0 && s_.first[static_cast<std::size_t>(s_.count()) - 1] >= eliminated) {
    s_.first.pop_back();
    s_.rows_start.pop_back();
  }
  if (s_.count() == 0) return;
  s_.first.back() = eliminated;  // of a front on both sides the rest is what it sees
  const auto count = static_cast<std::size_t>(s_.count());
  std::vector<Index> of(static_cast<std::size_t>(columns_), none);
  for (Index s = 0; s < s_.count(); ++s) {
    const Front f = front(s);
    std::fill_n(of.begin() + f.first, f.width, s);
    place_.push_back(place_.back() + FrontPanel<double>::size(f.height, f.width));
  }
  parent_.assign(count, none);
  first_child_.assign(count, none);
  next_.assign(count, none);
  for (Index s = s_.count() - 1; s >= 0; --s) {
    const Front f = front(s);
    if (f.rest() == 0) continue;
    const Index p = parent_[s] = of[static_cast<std::size_t>(f.rows[f.width])];
    if (p == none) continue;
    next_[s] = first_child_[p];
    first_child_[p] = s;
  }
  order_depth_first();
  cut();
}

// The given order has children before parents, yet not always subtrees together, which the stack needs.
void Multifrontal::order_depth_first() {
  sequence_.reserve(static_cast<std::size_t>(s_.count()));
  std::vector<Index> open;
  for (Index root = 0; root < s_.count(); ++root) {
    if (parent_[root] != none) continue;
    Index s = root;
    while (true) {
      for (; s != none; s = first_child_[s]) open.push_back(s);
      while (true) {
        s = open.back();
        open.pop_back();
        sequence_.push_back(s);
        if (open.empty() || next_[s] != none) break;
      }
      if (open.empty()) break;
      s = next_[s];
    }
  }
}

// The stack of a subtree begins anew at its root, that of the fronts above passes them by.
void Multifrontal::cut() {
  constexpr double per_front = 2e4, share = 1.0 / 64;  // flops that a front costs besides its own
  const auto count = static_cast<std::size_t>(s_.count());
  std::vector<double> work(count, 0);
  std::vector<Index> size(count, 1);  // fronts of the subtree
  double whole = 0;
  for (const Index s : sequence_) {
    const Front f = front(s);
    double own = per_front;
    for (Index j = 0; j < f.width; ++j) own += double(f.height - j) * double(f.height - j);
    whole += own;
    work[s] += own;
    if (parent_[s] == none) continue;
    work[parent_[s]] += work[s];
    size[parent_[s]] += size[s];
  }
  const auto above = [&](Index s) { return work[s] > share * whole; };
  work_ = whole;
  std::vector<std::size_t> leaves(count, 0);  // on the stack, by the fronts of a subtree that are done
  std::size_t top = 0;
  for (Index k = 0; k < s_.count(); ++k) {
    const Index s = sequence_[k];
    const bool is_above = above(s);
    if (is_above)
      units_.push_back({k, k + 1, false, work[s]});
    else if (parent_[s] == none || above(parent_[s]))
      units_.push_back({k + 1 - size[s], k + 1, true, work[s]});
  }
  const auto push = [&](Index s, Room& room, bool only_above) {
    const Front f = front(s);
    const std::size_t rest = only_above && leaves_all(s) ? 0 : f.rest_size();
    room.stack = std::max(room.stack, top + rest);
    room.panel = std::max(room.panel, static_cast<std::size_t>(f.width) * static_cast<std::size_t>(f.height));
    room.height = std::max(room.height, f.height);
    for (Index c = first_child_[s]; c != none; c = next_[c])
      if (!only_above || above(c)) top -= leaves[c];
    if (parent_[s] != none) top += leaves[s] = rest;
  };
  for (const Unit& u : units_) {
    if (!u.subtree) continue;
    top = 0;
    for (Index k = u.begin; k < u.end; ++k) push(sequence_[k], subtree_room_, false);
  }
  top = 0;
  for (const Unit& u : units_)
    if (!u.subtree) push(sequence_[u.begin], top_room_, true);
}

/// Below 3e7 flops waking threads costs more than they gain.
template <typename Scalar>
bool Multifrontal::factorize(const LowerTriangle& K, Scalar* values, Eigen::MatrixXd& last, int threads) const {
  constexpr double worth_threads = 3e7;  // flops
  if (columns_ == 0) return true;
  Team team(work_ > worth_threads ? threads : 1);
  return Run<Scalar>(*this, K, values, last, team)();
}

template bool Multifrontal::factorize(const LowerTriangle&, double*, Eigen::MatrixXd&, int) const;
template bool Multifrontal::factorize(const LowerTriangle&, float*, Eigen::MatrixXd&, int) const;

}  // namespace kerf
