// UMFPACK, for the indefinite systems: elements with stresses at vertices, and the saddle point without elimination
// [theory: C.13].

#include "solver/system/lu.hpp"

#include "kerf/stop.hpp"
#include "solver/system/blas.hpp"

#include <umfpack.h>

namespace kerf {

struct Lu::Impl {
  Index size = 0;
  std::vector<Index> start, rows;
  std::vector<double> values;
  void* numeric = nullptr;

  ~Impl() {
    if (numeric) umfpack_di_free_numeric(&numeric);
  }
};

namespace {

// A singular matrix is a warning of UMFPACK, with which it would go on: it is an error here.
void check(int status) {
  if (status == UMFPACK_OK) return;
  if (status == UMFPACK_ERROR_out_of_memory) out_of_memory();
  throw Error(Fault::Numerics,
              "the system of the state is singular: the supports or the crack contacts do not hold "
              "the body, or an incompressible body is wholly enclosed");
}

}  // namespace

Lu::Lu(const LowerTriangle& lower) : impl_(std::make_unique<Impl>()) {
  check_stop();
  Impl& m = *impl_;
  m.size = lower.size;
  if (m.size == 0) return;
  // Both triangles.
  m.start.assign(m.size + 1, 0);
  for (Index j = 0; j < m.size; ++j)
    for (Index p = lower.start[j]; p < lower.start[j + 1]; ++p) {
      ++m.start[j + 1];
      if (lower.rows[p] != j) ++m.start[lower.rows[p] + 1];
    }
  for (Index j = 0; j < m.size; ++j) m.start[j + 1] += m.start[j];
  m.rows.resize(m.start.back());
  m.values.resize(m.start.back());
  // Row by row of the lower triangle: the upper part of a column comes first and sorted.
  std::vector<Index> next(m.start.begin(), m.start.end() - 1);
  const auto put = [&](Index row, Index column, double value) {
    m.rows[next[column]] = row;
    m.values[next[column]++] = value;
  };
  for (Index j = 0; j < m.size; ++j)
    for (Index p = lower.start[j]; p < lower.start[j + 1]; ++p)
      if (lower.rows[p] != j) put(j, lower.rows[p], lower.values[p]);
  for (Index j = 0; j < m.size; ++j)
    for (Index p = lower.start[j]; p < lower.start[j + 1]; ++p) put(lower.rows[p], j, lower.values[p]);

  const BlasCall in_blas;
  void* symbolic = nullptr;
  double info[UMFPACK_INFO];
  check(umfpack_di_symbolic(m.size, m.size, m.start.data(), m.rows.data(), m.values.data(), &symbolic, nullptr, info));
  const int status =
      umfpack_di_numeric(m.start.data(), m.rows.data(), m.values.data(), symbolic, &m.numeric, nullptr, info);
  umfpack_di_free_symbolic(&symbolic);
  check(status);
}

Lu::~Lu() = default;
Lu::Lu(Lu&&) noexcept = default;
Lu& Lu::operator=(Lu&&) noexcept = default;

Eigen::VectorXd Lu::solve(const Eigen::VectorXd& b) const {
  check_stop();
  const Impl& m = *impl_;
  Eigen::VectorXd x(b.size());
  if (m.size == 0) return x;
  const BlasCall in_blas;
  check(umfpack_di_solve(UMFPACK_A, m.start.data(), m.rows.data(), m.values.data(), x.data(), b.data(), m.numeric,
                         nullptr, nullptr));
  return x;
}

}  // namespace kerf
