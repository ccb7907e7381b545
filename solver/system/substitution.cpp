// Substitutions with the panels of a multifrontal factor, up the tree with L and down it with L',
//   y_s = L_ss^-1 x_s,   x_p <- x_p - L_ps y_s;     z_s = L_ss^-T (y_s - L_ps' z_p)   [theory: E.29],
// for one right-hand side or many, each panel read once for all of them. On the way up a subtree adds what concerns
// rows above it to an array of its own; these arrays are added in the order of the subtrees, so that subtrees run side
// by side with the same bits. Fronts above are cut into strips of rows (up) and columns (down). Backwards some fronts
// may be left out, where few rows of the solution are wanted. Derived in docs/theory/elements.md, section The factor.

#include "base/parallel.hpp"
#include "kerf/stop.hpp"
#include "solver/system/memory_pool.hpp"
#include "solver/system/multifrontal.hpp"

#include <algorithm>
#include <memory>

namespace kerf {

namespace {

constexpr Index block = FrontPanel<double>::together, tile = 128, strip = 512;

// By hand: sums of Eigen's begin where the memory is aligned, and their bits depend on that.

/// y -= rows row .. of columns from .. of the panel, times a.
template <typename Scalar>
void push(const FrontPanel<Scalar>& panel, Index from, Index step, Index row, Index rows, const double* a,
          double* __restrict y) {
  const auto column = [&](Index k) { return panel.column(from + k) + row; };
  Index k = 0;
  for (; k + 4 <= step; k += 4) {
    const Scalar *p0 = column(k), *p1 = column(k + 1), *p2 = column(k + 2), *p3 = column(k + 3);
    const double a0 = a[k], a1 = a[k + 1], a2 = a[k + 2], a3 = a[k + 3];
    for (Index i = 0; i < rows; ++i) y[i] -= p0[i] * a0 + p1[i] * a1 + p2[i] * a2 + p3[i] * a3;
  }
  for (; k < step; ++k) {
    const Scalar* p0 = column(k);
    const double a0 = a[k];
    for (Index i = 0; i < rows; ++i) y[i] -= p0[i] * a0;
  }
}

/// a -= rows row .. of columns from .. of the panel, transposed, times y; four columns together, each in four sums.
template <typename Scalar>
void pull(const FrontPanel<Scalar>& panel, Index from, Index step, Index row, Index rows, const double* y, double* a) {
  using Four = Eigen::Array4d;
  const auto four = [](const auto* at) {
    return Four(Eigen::Map<const Eigen::Array<std::remove_cvref_t<decltype(*at)>, 4, 1>>(at).template cast<double>());
  };
  const auto column = [&](Index k) { return panel.column(from + k) + row; };
  const auto whole = [](const Four& sum) { return (sum[0] + sum[2]) + (sum[1] + sum[3]); };
  Index k = 0;
  for (; k + 4 <= step; k += 4) {
    const Scalar *p0 = column(k), *p1 = column(k + 1), *p2 = column(k + 2), *p3 = column(k + 3);
    Four s0 = Four::Zero(), s1 = s0, s2 = s0, s3 = s0;
    Index i = 0;
    for (; i + 4 <= rows; i += 4) {
      const Four at = four(y + i);
      s0 += four(p0 + i) * at;
      s1 += four(p1 + i) * at;
      s2 += four(p2 + i) * at;
      s3 += four(p3 + i) * at;
    }
    Four sums(whole(s0), whole(s1), whole(s2), whole(s3));
    for (; i < rows; ++i) sums += Four(p0[i], p1[i], p2[i], p3[i]) * y[i];
    for (Index j = 0; j < 4; ++j) a[k + j] -= sums[j];
  }
  for (; k < step; ++k) {
    const Scalar* p0 = column(k);
    Four s0 = Four::Zero();
    Index i = 0;
    for (; i + 4 <= rows; i += 4) s0 += four(p0 + i) * four(y + i);
    double sum = whole(s0);
    for (; i < rows; ++i) sum += p0[i] * y[i];
    a[k] -= sum;
  }
}

/// x <- l^-1 x for the diagonal block of columns from .. from + n, of one eight.
/// Forward substitution with an eight of columns: y_k = x_k/l_kk, then x_i -= l_ik y_k.
template <typename Scalar>
void divide_panel(const FrontPanel<Scalar>& panel, Index from, Index n, double* x) {
  for (Index k = 0; k < n; ++k) {
    const Scalar* column = panel.column(from + k) + from;
    const double value = x[k] /= column[k];
    for (Index i = k + 1; i < n; ++i) x[i] -= column[i] * value;
  }
}
/// x <- l^-T x.
template <typename Scalar>
void divide_transposed(const FrontPanel<Scalar>& panel, Index from, Index n, double* x) {
  for (Index k = n - 1; k >= 0; --k) {
    const Scalar* column = panel.column(from + k) + from;
    double value = x[k];
    for (Index i = k + 1; i < n; ++i) value -= column[i] * x[i];
    x[k] = value / column[k];
  }
}

}  // namespace

template <typename Scalar>
struct Multifrontal::Substitution {
  struct ConstFront : Front {
    FrontPanel<Scalar> panel;
  };
  const Multifrontal& of;
  const Scalar* values;
  double* x;  // of.columns_ x count
  Eigen::Index count;
  Team& team;
  const std::vector<bool>* marked = nullptr;  // fronts to go through backwards, or all

  struct Room {  // of one thread
    std::vector<Index> place;
    std::vector<double> own;  // the rows of a front
  };
  MemoryPool<Room> free = {};

  ConstFront front(Index s) const {
    const Front f = of.front(s);
    return {f, {values + of.place_[static_cast<std::size_t>(s)], f.height, f.width}};
  }
  double* columns_of(Room& room, const ConstFront& f) const {
    const std::size_t size = static_cast<std::size_t>(f.height) * static_cast<std::size_t>(count);
    if (room.own.size() < size) room.own.resize(size);
    return room.own.data();
  }

  /// Rows row .. of `w` less what columns from .. make of them.
  void push_from(const ConstFront& f, double* w, Index from, Index step, Index row, Index rows) const {
    for (Eigen::Index c = 0; c < count; ++c)
      push(f.panel, from, step, row, rows, w + c * f.height + from, w + c * f.height + row);
  }
  /// Rows of the own block, then all rows behind it up to `end`, take what an eight makes: each panel column is read
  /// once.
  void forward_in_blocks(const ConstFront& f, double* w, Index from, Index to, Index end) const {
    for (; from < to; from += block) {
      const Index step = std::min(block, to - from), behind = from + step;
      for (Eigen::Index c = 0; c < count; ++c) divide_panel(f.panel, from, step, w + c * f.height + from);
      if (behind < end) push_from(f, w, from, step, behind, end - behind);
    }
  }
  /// Rows from .. of `w` less what those behind .. end, seen through their columns, make of them.
  void pull_from(const ConstFront& f, double* w, Index from, Index step, Index behind, Index end) const {
    for (Eigen::Index c = 0; c < count; ++c)
      pull(f.panel, from, step, behind, end - behind, w + c * f.height + behind, w + c * f.height + from);
  }
  void backward_in_blocks(const ConstFront& f, double* w, Index from, Index to, Index end) const {
    for (Index at = from + (to - from - 1) / block * block; at >= from; at -= block) {
      const Index step = std::min(block, to - at);
      pull_from(f, w, at, step, at + step, end);
      for (Eigen::Index c = 0; c < count; ++c) divide_transposed(f.panel, at, step, w + c * f.height + at);
    }
  }

  /// Smaller panels are gone through by eight columns; larger ones in tiles, whose rows or columns threads share.
  bool is_large(const ConstFront& f) const {
    return std::int64_t{f.width} * f.height > 200000;
  }
  /// Of a front above the subtrees by the team: subtrees are the work of one thread each.
  void each(Index items, bool together, const std::function<void(Index)>& body) const {
    if (together) return team.run(items, body);
    for (Index i = 0; i < items; ++i) body(i);
  }

  /// Forwards each row behind the tile is changed by itself: threads take strips of rows.
  void forward_in_front(const ConstFront& f, double* w, bool together) const {
    if (!is_large(f)) return forward_in_blocks(f, w, 0, f.width, f.height);
    for (Index from = 0; from < f.width; from += tile) {
      const Index to = std::min(f.width, from + tile), rows = f.height - to;
      forward_in_blocks(f, w, from, to, to);
      each((rows + strip - 1) / strip, together,
           [&](Index i) { push_from(f, w, from, to - from, to + i * strip, std::min(strip, rows - i * strip)); });
    }
  }
  /// Backwards each column of the tile is a sum over all rows below: threads take columns, 32 at a time, and sums keep
  /// their order.
  void backward_in_front(const ConstFront& f, double* w, bool together) const {
    if (!is_large(f)) return backward_in_blocks(f, w, 0, f.width, f.height);
    constexpr Index few = 32;
    for (Index from = (f.width - 1) / tile * tile; from >= 0; from -= tile) {
      const Index to = std::min(f.width, from + tile);
      each((to - from + few - 1) / few, together, [&](Index i) {
        const Index at = from + i * few;
        pull_from(f, w, at, std::min(few, to - at), to, f.height);
      });
      backward_in_blocks(f, w, from, to, to);
    }
  }

  void load_own(const ConstFront& f, double* w) const {
    for (Eigen::Index c = 0; c < count; ++c) std::copy_n(x + c * of.columns_ + f.first, f.width, w + c * f.height);
  }
  void store_own(const ConstFront& f, const double* w) const {
    for (Eigen::Index c = 0; c < count; ++c) std::copy_n(w + c * f.height, f.width, x + c * of.columns_ + f.first);
  }

  /// What the front adds to rows from `limit` on, which others have, too, goes into `outside`.
  /// `limit`: the first row behind the subtree. Rows are increasing, so that those of others come last.
  void forward_front(Index s, Room& room, Index limit, double* outside, Index apart, bool together) const {
    const ConstFront f = front(s);
    double* w = columns_of(room, f);
    load_own(f, w);
    for (Eigen::Index c = 0; c < count; ++c) std::fill_n(w + c * f.height + f.width, f.rest(), 0.0);
    forward_in_front(f, w, together);
    store_own(f, w);
    for (Eigen::Index c = 0; c < count; ++c) {
      double *to = x + c * of.columns_, *beyond = outside + c * apart;
      const double* from = w + c * f.height;
      Index i = f.width;
      for (; i < f.height && f.rows[i] < limit; ++i) to[f.rows[i]] += from[i];
      for (; i < f.height; ++i) beyond[room.place[static_cast<std::size_t>(f.rows[i])]] += from[i];
    }
  }
  void backward_front(Index s, Room& room, bool together) const {
    const ConstFront f = front(s);
    double* w = columns_of(room, f);
    load_own(f, w);
    for (Eigen::Index c = 0; c < count; ++c)
      for (Index i = f.width; i < f.height; ++i) w[c * f.height + i] = x[c * of.columns_ + f.rows[i]];
    backward_in_front(f, w, together);
    store_own(f, w);
  }

  std::vector<const Unit*> subtrees() const {
    std::vector<const Unit*> all;
    for (const Unit& u : of.units_)
      if (u.subtree) all.push_back(&u);
    return all;
  }

  void forward() {
    const std::vector<const Unit*> all = subtrees();
    std::vector<std::vector<double>> outside(all.size());
    team.run(static_cast<Index>(all.size()), [&](Index k) {
      check_stop();
      const Unit& u = *all[static_cast<std::size_t>(k)];
      const ConstFront root = front(of.sequence_[u.end - 1]);
      std::unique_ptr<Room> room = free.take([] { return std::make_unique<Room>(); });
      room->place.resize(static_cast<std::size_t>(of.columns_));
      for (Index i = root.width; i < root.height; ++i)
        room->place[static_cast<std::size_t>(root.rows[i])] = i - root.width;
      std::vector<double>& beyond = outside[static_cast<std::size_t>(k)];
      beyond.assign(static_cast<std::size_t>(root.rest()) * static_cast<std::size_t>(count), 0.0);
      for (Index i = u.begin; i < u.end; ++i)
        forward_front(of.sequence_[i], *room, root.first + root.width, beyond.data(), root.rest(), false);
      free.give(std::move(room));
    });
    for (std::size_t k = 0; k < all.size(); ++k) {
      const ConstFront root = front(of.sequence_[all[k]->end - 1]);
      for (Eigen::Index c = 0; c < count; ++c)
        for (Index i = 0; i < root.rest(); ++i)
          x[c * of.columns_ + root.rows[root.width + i]] += outside[k][static_cast<std::size_t>(c * root.rest() + i)];
    }
    Room room;
    for (const Unit& u : of.units_)
      if (!u.subtree) forward_front(of.sequence_[u.begin], room, of.columns_, nullptr, 0, true);
  }

  /// From the root down; the rows of others are read, never written, so that subtrees need no arrays.
  void backward() {
    const auto wanted = [&](Index s) { return !marked || (*marked)[static_cast<std::size_t>(s)]; };
    Room top;
    for (auto u = of.units_.rbegin(); u != of.units_.rend(); ++u)
      if (!u->subtree && wanted(of.sequence_[u->begin])) backward_front(of.sequence_[u->begin], top, true);
    const std::vector<const Unit*> all = subtrees();
    team.run(static_cast<Index>(all.size()), [&](Index k) {
      check_stop();
      const Unit& u = *all[static_cast<std::size_t>(k)];
      std::unique_ptr<Room> room = free.take([] { return std::make_unique<Room>(); });
      for (Index i = u.end - 1; i >= u.begin; --i)
        if (wanted(of.sequence_[i])) backward_front(of.sequence_[i], *room, false);
      free.give(std::move(room));
    });
  }
};

int Multifrontal::threads_worth(int threads) const {
  constexpr std::int64_t worth_threads = 1000000;
  return entries() > worth_threads ? threads : 1;
}

template <typename Scalar>
void Multifrontal::forward(const Scalar* values, Eigen::Ref<Eigen::MatrixXd> x, int threads) const {
  if (s_.count() == 0 || x.cols() == 0) return;
  Team team(threads_worth(threads));
  Substitution<Scalar>{*this, values, x.data(), x.cols(), team}.forward();
}

template <typename Scalar>
void Multifrontal::backward(const Scalar* values, Eigen::Ref<Eigen::MatrixXd> x, int threads,
                            const std::vector<bool>* marked) const {
  if (s_.count() == 0 || x.cols() == 0) return;
  Team team(threads_worth(threads));
  Substitution<Scalar>{*this, values, x.data(), x.cols(), team, marked}.backward();
}

template void Multifrontal::forward(const double*, Eigen::Ref<Eigen::MatrixXd>, int) const;
template void Multifrontal::forward(const float*, Eigen::Ref<Eigen::MatrixXd>, int) const;
template void Multifrontal::backward(const double*, Eigen::Ref<Eigen::MatrixXd>, int, const std::vector<bool>*) const;
template void Multifrontal::backward(const float*, Eigen::Ref<Eigen::MatrixXd>, int, const std::vector<bool>*) const;

std::vector<bool> Multifrontal::fronts_above(const std::vector<Index>& columns) const {
  std::vector<bool> marked(static_cast<std::size_t>(s_.count()), false);
  for (const Index column : columns) {
    Index s = static_cast<Index>(std::ranges::upper_bound(s_.first, column) - s_.first.begin()) - 1;
    for (; s != none && !marked[static_cast<std::size_t>(s)]; s = parent_[static_cast<std::size_t>(s)])
      marked[static_cast<std::size_t>(s)] = true;
  }
  return marked;
}

}  // namespace kerf
