#pragma once
// The dense kernels of the elimination for packs, in blocks that stay in registers: row by row, as numbers do it, a
// pack would be loaded and stored for every product.

#include "solver/element/number.hpp"

#include <utility>

namespace kerf {

namespace packs {

inline constexpr int wide = 4;  // columns of a block; two rows of it take half of the registers

/// body(first, width) with the width as a constant, over blocks of `wide` columns and what remains.
template <int Columns, class Body>
inline __attribute__((always_inline)) void for_each_block(const Body& body) {
  for (int c = 0; c + wide <= Columns; c += wide) body(c, std::integral_constant<int, wide>{});
  if constexpr (Columns % wide != 0) body(Columns - Columns % wide, std::integral_constant<int, Columns % wide>{});
}

/// The first `rows` rows of x <- U'^-1 x, in `Width` columns from c on; the diagonal of U holds its inverse.
template <int Width, bool Odd, int N, int Columns>
inline __attribute__((always_inline)) void forward_block(const PackGrid<N, N>& u, PackGrid<N, Columns>& x, int c,
                                                         int rows) {
  int i = 0;
  for (; i + 1 < rows; i += 2) {
    Pack first[Width], second[Width];
    for (int j = 0; j < Width; ++j) first[j] = x(i, c + j), second[j] = x(i + 1, c + j);
    for (int k = 0; k < i; ++k) {
      const Pack by_first = u(k, i), by_second = u(k, i + 1);
      for (int j = 0; j < Width; ++j) {
        const Pack known = x(k, c + j);
        first[j] -= by_first * known;
        second[j] -= by_second * known;
      }
    }
    const Pack own = u(i, i), across = u(i, i + 1), next = u(i + 1, i + 1);
    for (int j = 0; j < Width; ++j) {
      first[j] *= own;
      second[j] = (second[j] - across * first[j]) * next;
      x(i, c + j) = first[j];
      x(i + 1, c + j) = second[j];
    }
  }
  if constexpr (Odd) {
    const int last = rows - 1;
    for (int j = 0; j < Width; ++j) {
      Pack sum = x(last, c + j);
      for (int k = 0; k < last; ++k) sum -= u(k, last) * x(k, c + j);
      x(last, c + j) = sum * u(last, last);
    }
  }
}

}  // namespace packs

/// As `forward` of numbers.
template <int N, int Columns>
inline void forward_packs(const PackGrid<N, N>& u, PackGrid<N, Columns>& x) {
  packs::for_each_block<Columns>([&](int c, auto width) { packs::forward_block<width(), N % 2 == 1>(u, x, c, N); });
}

/// As `cholesky` of numbers: column blocks from left to right.
template <int N>
inline void cholesky_packs(PackGrid<N, N>& a) {
  packs::for_each_block<N>([&](int c, auto width) {
    constexpr int W = width();
    packs::forward_block<W, false>(a, a, c, c);
    Pack block[W][W];
    for (int i = 0; i < W; ++i)
      for (int j = i; j < W; ++j) block[i][j] = a(c + i, c + j);
    for (int k = 0; k < c; ++k)
      for (int i = 0; i < W; ++i)
        for (int j = i; j < W; ++j) block[i][j] -= a(k, c + i) * a(k, c + j);
    for (int k = 0; k < W; ++k) {
      const Pack inverse = one_over_root(block[k][k]);
      block[k][k] = inverse;
      for (int j = k + 1; j < W; ++j) block[k][j] *= inverse;
      for (int i = k + 1; i < W; ++i)
        for (int j = i; j < W; ++j) block[i][j] -= block[k][i] * block[k][j];
    }
    for (int i = 0; i < W; ++i)
      for (int j = i; j < W; ++j) a(c + i, c + j) = block[i][j];
  });
}

/// What is on and above the diagonal alone is wanted, or all.
enum class Wanted { Upper, All };

/// to += factor sum_k of(k, i, j) over blocks of two rows and four columns.
template <Wanted W, int Rows, int Columns, class Left, class Right>
inline void add_products(PackGrid<Rows, Columns>& to, int terms, const Left& left, const Right& right,
                         const Pack& factor) {
  packs::for_each_block<Columns>([&](int c, auto width) {
    constexpr int B = width();
    static_assert(W == Wanted::All || Rows == Columns);
    const int rows = W == Wanted::Upper ? c + B : Rows;
    int i = 0;
    for (; i + 1 < rows; i += 2) {
      Pack first[B], second[B];
      for (int j = 0; j < B; ++j) first[j] = second[j] = Pack{};
      for (int k = 0; k < terms; ++k) {
        const Pack by_first = left(k, i), by_second = left(k, i + 1);
        for (int j = 0; j < B; ++j) {
          const Pack other = right(k, c + j);
          first[j] += by_first * other;
          second[j] += by_second * other;
        }
      }
      for (int j = 0; j < B; ++j) {
        to(i, c + j) += factor * first[j];
        to(i + 1, c + j) += factor * second[j];
      }
    }
    if constexpr ((W == Wanted::Upper ? B : Rows) % 2 == 1)
      for (int j = 0; j < B; ++j) {
        Pack sum{};
        for (int k = 0; k < terms; ++k) sum += left(k, rows - 1) * right(k, c + j);
        to(rows - 1, c + j) += factor * sum;
      }
  });
}

}  // namespace kerf
