// The Cholesky factorization of the first columns of a dense front, and the update of the rest [theory: E.28]:
//   for each block of 96 columns: L_bb L_bb' = F_bb;  L_ib = F_ib L_bb^-T for the rows i behind;  F_ij -= L_ib L_jb'.
// The rows of a block are copied in strips of twelve, column after column, so that the innermost product, twelve rows
// by four columns, runs through memory in order and keeps its sums in registers: twelve vectors of four doubles, what
// AVX2 leaves room for. Tiles of strips are independent and may run side by side; each sum runs over the columns of a
// block in order and over blocks in order, so that its bits depend on nothing else. Derived in docs/theory/elements.md,
// section The factor.

#include "solver/system/front_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace kerf {

namespace {

// Rows and columns of a tile in registers: twelve sums of four, three vectors of rows and one number fill those of
// AVX2.
constexpr Index rows = 12, columns = 4;
constexpr Index panel_columns = 96;  // columns that are eliminated together, a multiple of rows
constexpr Index strip_size = rows * panel_columns;

using Four [[gnu::vector_size(32)]] = double;

void load(const double* from, Four& x) {  // no value returned: without AVX that would be an ABI of its own
  std::memcpy(&x, from, sizeof x);
}
void store(double* to, const Four& x) {
  std::memcpy(to, &x, sizeof x);
}

/// Columns of three vectors each.
struct Tile {
  Four at[columns][3];
};

/// The sum over k of a(:, k) b(:, k)', a of a strip, b of four of its rows.
/// Both factors are read from packed strips: a in vectors, b as numbers that are spread over a vector.
Tile tile_product(Index depth, const double* a, const double* b) {
  Tile t = {};
  for (Index k = 0; k < depth; ++k, a += rows, b += rows) {
    Four top, middle, bottom;
    load(a, top);
    load(a + 4, middle);
    load(a + 8, bottom);
#pragma GCC unroll 4
    for (Index c = 0; c < columns; ++c) {
      t.at[c][0] += top * b[c];
      t.at[c][1] += middle * b[c];
      t.at[c][2] += bottom * b[c];
    }
  }
  return t;
}

/// Strips of packed rows: of each `rows` numbers of a column, column after column.
const double* strip_at(const double* packed, Index row) {
  return packed + std::int64_t{row / rows} * strip_size + row % rows;
}

/// A block of columns from .. from + width, and the rows behind.
/// `diagonal` and `below`: L_bb and L_ib as strips.
struct Block {
  const FrontMatrix& f;
  Index from, width;
  double *diagonal, *below;       // packed
  double inverse[panel_columns];  // of the pivots
  Index begin() const {
    return from + width;
  }
};

/// Columns at .. of the block, at most four, of the rows row .. of a strip, to `end` at most, into the panel and the
/// strip: what is there, x, less what the block's columns before make of it, times l^-T. With `pivots` they are the
/// strip's own, and l is made, too: the rows above the diagonal become zero. Returns whether the pivots are positive.
template <bool pivots>
bool divide_block(Block& b, Index row, Index end, Index at, double* strip) {
  const Index wide = std::min(columns, b.width - at), count = std::min(rows, end - row);
  double* panel[columns];
  Tile x = {};
  for (Index c = 0; c < wide; ++c) {
    panel[c] = b.f.column(b.from + at + c) + row;
    std::memcpy(x.at[c], panel[c], static_cast<std::size_t>(count) * sizeof(double));
  }
  const Tile made = tile_product(at, strip, strip_at(b.diagonal, at));
  for (Index c = 0; c < wide; ++c) {
    Four* column = x.at[c];
    for (Index v = 0; v < 3; ++v) column[v] -= made.at[c][v];
    const double* own_row = strip_at(b.diagonal, at + c);
    for (Index k = 0; k < c; ++k)
      for (Index v = 0; v < 3; ++v) column[v] -= x.at[k][v] * own_row[(at + k) * rows];
    if constexpr (pivots) {
      const Index top = at % rows;
      double numbers[rows];
      std::memcpy(numbers, column, sizeof numbers);
      std::fill_n(numbers, top + c, 0.0);
      if (!(numbers[top + c] > 0)) return false;
      std::memcpy(column, numbers, sizeof numbers);
      b.inverse[at + c] = 1 / std::sqrt(numbers[top + c]);
    }
    for (Index v = 0; v < 3; ++v) {
      column[v] *= b.inverse[at + c];
      store(strip + (at + c) * rows + 4 * v, column[v]);
    }
    std::memcpy(panel[c], column, static_cast<std::size_t>(count) * sizeof(double));
  }
  return true;
}

/// The block's own rows.
/// Four columns at a time through all strips of the block: the next four need the pivots of these.
bool factor_diagonal(Block& b) {
  for (Index at = 0; at < b.width; at += columns) {
    const Index first = at / rows * rows;
    for (Index row = first; row < b.width; row += rows) {
      double* strip = b.diagonal + std::int64_t{row / rows} * strip_size;
      if (row > first)
        divide_block<false>(b, b.from + row, b.begin(), at, strip);
      else if (!divide_block<true>(b, b.from + row, b.begin(), at, strip))
        return false;
    }
  }
  return true;
}

/// A strip of the rows behind.
void divide_strip(Block& b, Index strip) {
  for (Index at = 0; at < b.width; at += columns)
    divide_block<false>(b, b.begin() + strip * rows, b.f.height, at, b.below + std::int64_t{strip} * strip_size);
}

/// Rows of a strip, columns of a four, both behind the block: less what the block makes of them.
/// Tiles on the diagonal write their lower half alone; others are whole unless they end the front.
void update(const Block& b, Index strip, Index four) {
  const Index row = strip * rows, column = four * columns, behind = b.f.height - b.begin();
  const Index count = std::min(rows, behind - row), wide = std::min(columns, behind - column);
  const auto column_at = [&](Index c) { return b.f.column(b.begin() + column + c) + b.begin() + row; };
  for (Index c = 0; c < wide; ++c) {
    __builtin_prefetch(column_at(c), 1);
    __builtin_prefetch(column_at(c) + rows - 1, 1);
  }
  const Tile made = tile_product(b.width, b.below + std::int64_t{strip} * strip_size, strip_at(b.below, column));
  if (count == rows && wide == columns && row > column) {
    for (Index c = 0; c < columns; ++c) {
      double* to = column_at(c);
      for (Index v = 0; v < 3; ++v) {
        Four x;
        load(to + 4 * v, x);
        store(to + 4 * v, x - made.at[c][v]);
      }
    }
    return;
  }
  double sum[columns][rows];
  std::memcpy(sum, made.at, sizeof sum);
  for (Index c = 0; c < wide; ++c) {
    double* to = column_at(c);
    for (Index r = std::max<Index>(0, column + c - row); r < count; ++r) to[r] -= sum[c][r];
  }
}

constexpr Index strips_together = 16, fours_together = strips_together * rows / columns, fours_near = 6;

/// Tile (i, j) of the rows and columns behind, i >= j: few columns at a time, whose rows stay near.
void update_tile(const Block& b, Index i, Index j) {
  const Index behind = b.f.height - b.begin(), strips = (behind + rows - 1) / rows,
              fours = (behind + columns - 1) / columns;
  const Index last_strip = std::min(strips, (i + 1) * strips_together),
              last_four = std::min(fours, (j + 1) * fours_together);
  for (Index four = j * fours_together; four < last_four; four += fours_near)
    for (Index strip = i * strips_together; strip < last_strip; ++strip) {
      const Index own = std::min({last_four, four + fours_near, (strip + 1) * rows / columns});
      for (Index k = four; k < own; ++k) update(b, strip, k);
    }
}

}  // namespace

/// Two strips more than the rows need: the diagonal block and the rows behind are each rounded up to whole strips.
std::size_t packed_size(Index height) {
  return static_cast<std::size_t>(panel_columns + height + 2 * rows) * static_cast<std::size_t>(panel_columns);
}

/// The tiles of the lower half are numbered column by column, k -> (i, j), so that one loop serves them.
bool eliminate(const FrontMatrix& f, double* packed, const Each& each) {
  for (Index from = 0; from < f.width; from += panel_columns) {
    Block b{.f = f,
            .from = from,
            .width = std::min(panel_columns, f.width - from),
            .diagonal = packed,
            .below = packed + panel_columns * panel_columns,
            .inverse = {}};
    if (!factor_diagonal(b)) return false;
    const Index strips = (f.height - b.begin() + rows - 1) / rows,
                tiles = (strips + strips_together - 1) / strips_together;
    each(tiles, [&](Index i) {
      for (Index s = i * strips_together; s < std::min(strips, (i + 1) * strips_together); ++s) divide_strip(b, s);
    });
    each(tiles * (tiles + 1) / 2, [&](Index k) {
      Index j = 0, i = k;  // column after column
      while (i >= tiles - j) i -= tiles - j, ++j;
      update_tile(b, i + j, j);
    });
  }
  return true;
}

}  // namespace kerf
