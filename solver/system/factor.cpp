// A factor of K behind one interface, in three forms. Definite: K = L L' by the multifrontal method on an order that is
// given, rows in contact last, so that with y = L^-1 (F, G)
//   L = (L_11 0; L_21 L_22):   S = L_22 L_22',   r = L_22 y_2,   x = L^-T (y_1, L_22' j)   [theory: C.7],
// the condensed matrix of contact costs nothing beyond the factorization. Indefinite (stresses at vertices): LU. By a
// `LeadingSolver` of the rows without contact: block elimination [theory: E.31]; forward
// then gives (K_II^-1 b_I, L_22^-1 (b_C - K_CI K_II^-1 b_I)), and backward undoes it. Derived in
// docs/theory/contact.md, section The small problem, and docs/theory/elements.md, section The factor.

#include "solver/factor.hpp"

#include "base/kept_memory.hpp"
#include "kerf/stop.hpp"
#include "solver/system/blas.hpp"
#include "solver/system/lost_definiteness.hpp"
#include "solver/system/multifrontal.hpp"
#include "solver/system/symbolic.hpp"

#include <dlfcn.h>
#include <fmt/core.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>

namespace kerf {

// OpenBLAS and CHOLMOD each start threads of their own for every supernode, which costs more than it gives (400k
// triangles: half the time went into yielding), and sums in another order. Looked up by name, so that any BLAS and any
// OpenMP will do.
void use_one_thread() {
  const auto set = [](const char* name, int value) {
    if (const auto found = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, name))) found(value);
  };
  set("omp_set_max_active_levels", 0);
  set("openblas_set_num_threads", 1);
}

struct Factor::Impl {
  Index size = 0;
  double entries = 0, flops = 0;
  Eigen::MatrixXd contact_factor, interface_factor;
  std::vector<Index> order;  // order[k] is the k-th row to be eliminated
  bool permuted = false;     // by the factor, not by whoever made the matrix
  std::optional<Lu> lu;      // instead of a Cholesky factor
  std::optional<Multifrontal> numeric;
  KeptBlock values;                        // L
  std::unique_ptr<LeadingSolver> leading;  // instead of both, with the rows of the matrix that are in contact
  LowerTriangle coupling;                  // its entries in these rows, by columns
  int threads = 1;

  // An order that the caller gives may be changed within the rules of elimination (subtrees together): K is reordered
  // then before each factorization.
  void analyze(const LowerTriangle& lower, std::span<const Index> sequence) {
    permuted = !sequence.empty();
    Symbolic found = analyze_pattern(lower, sequence);
    order = std::move(found.order);
    entries = found.entries;
    flops = found.flops;
    numeric.emplace(std::move(found.supernodes));
  }

  // `values` is kept between factorizations of one pattern: no other block of memory is as large.
  void factorize(const LowerTriangle& lower, Index last) {
    check_stop();
    if (!values) values = KeptBlock(static_cast<std::size_t>(numeric->entries()));
    interface_factor.setZero(last, last);
    const auto made = [&](const LowerTriangle& k) {
      return numeric->factorize(k, values.get(), interface_factor, threads);
    };
    if (!(permuted ? made(reordered(lower, order)) : made(lower)))
      throw LostDefiniteness(
          "rounding has eaten the stiffness of the body: it is slender or nearly free to move, triangles are very "
          "flat, or materials differ too much; support it more firmly, or refine the mesh there");
  }

  /// In the order of the factor, and back.
  template <typename Dense>
  Dense permute(const Dense& b, bool back) const {
    Dense out(b.rows(), b.cols());
    for (Eigen::Index c = 0; c < b.cols(); ++c)
      for (Index k = 0; k < size; ++k)
        if (back)
          out(order[static_cast<std::size_t>(k)], c) = b(k, c);
        else
          out(k, c) = b(order[static_cast<std::size_t>(k)], c);
    return out;
  }

  Eigen::Index contact_rows() const {
    return contact_factor.rows();
  }

  /// K_CI x, K_IC j: C the rows in contact, I the leading ones.
  Eigen::VectorXd on_contact(const Eigen::VectorXd& x) const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(contact_rows());
    const Index first = size - static_cast<Index>(contact_rows());
    for (Index j = 0; j < first; ++j)
      for (Index p = coupling.start[j]; p < coupling.start[j + 1]; ++p)
        force[coupling.rows[p] - first] += coupling.values[p] * x[j];
    return force;
  }
  Eigen::VectorXd on_leading(const Eigen::VectorXd& jump) const {
    const Index first = size - static_cast<Index>(contact_rows());
    Eigen::VectorXd force = Eigen::VectorXd::Zero(first);
    for (Index j = 0; j < first; ++j)
      for (Index p = coupling.start[j]; p < coupling.start[j + 1]; ++p)
        force[j] += coupling.values[p] * jump[coupling.rows[p] - first];
    return force;
  }

  // y = (K_II^-1 b_I, L^-1 (b_C - K_CI K_II^-1 b_I)), L the Cholesky factor of S.
  Eigen::VectorXd lead_forward(const Eigen::VectorXd& b) const {
    const Eigen::Index contact = contact_rows(), first = size - contact;
    Eigen::VectorXd y(size);
    y.head(first) = leading->solve(b.head(first));
    if (contact > 0)
      y.tail(contact) =
          contact_factor.triangularView<Eigen::Lower>().solve(b.tail(contact) - on_contact(y.head(first)));
    return y;
  }
  // x_C = L^-T y_C, x_I = y_I - K_II^-1 K_IC x_C.
  Eigen::VectorXd lead_backward(Eigen::VectorXd y) const {
    const Eigen::Index contact = contact_rows(), first = size - contact;
    if (contact == 0) return y;
    y.tail(contact) = contact_factor.transpose().triangularView<Eigen::Upper>().solve(y.tail(contact)).eval();
    y.head(first) -= leading->solve(on_leading(y.tail(contact)));
    return y;
  }

  // The complement is symmetric for exact solves; what iterative ones leave of asymmetry is taken to the mean of both
  // halves.
  void lead(const LowerTriangle& lower, Index contact) {
    const Index first = size - contact;
    contact_factor.setZero(contact, contact);
    coupling.size = size;
    coupling.start.assign(1, 0);
    for (Index j = 0; j < size; ++j) {
      for (Index p = lower.start[j]; p < lower.start[j + 1]; ++p) {
        if (lower.rows[p] < first) continue;
        coupling.rows.push_back(lower.rows[p]);
        coupling.values.push_back(lower.values[p]);
      }
      coupling.start.push_back(static_cast<Index>(coupling.rows.size()));
    }
    if (contact == 0) return;
    contact_factor = interface_factor = leading->contact_factor();
  }

  template <typename Dense>
  Dense forward(const Dense& b) const {
    check_stop();
    Dense x = permuted ? permute(b, false) : b;
    numeric->forward(values.get(), x, threads);
    return x;
  }

  template <typename Dense>
  Dense backward(Dense x, const std::vector<bool>* fronts = nullptr) const {
    check_stop();
    numeric->backward(values.get(), x, threads, fronts);
    return permuted ? permute(x, true) : x;
  }
};

Factor::Factor(const LowerTriangle& lower, Index contact_rows, bool definite, Index interface_rows, int threads)
    : impl_(std::make_unique<Impl>()) {
  use_one_thread();
  impl_->size = lower.size;
  impl_->threads = threads;
  if (impl_->size == 0) return;
  if (!definite) {
    if (contact_rows + interface_rows > 0)
      throw std::invalid_argument("Factor: rows in contact or on an interface need a definite matrix");
    impl_->lu.emplace(lower);
    return;
  }
  impl_->analyze(lower, {});
  impl_->factorize(lower, contact_rows + interface_rows);
  impl_->contact_factor = impl_->interface_factor.bottomRightCorner(contact_rows, contact_rows);
}

// No rows in contact: `sequence` may put any row anywhere.
Factor::Factor(const LowerTriangle& lower, std::span<const Index> sequence, int threads)
    : impl_(std::make_unique<Impl>()) {
  use_one_thread();
  impl_->size = lower.size;
  impl_->threads = threads;
  if (impl_->size == 0) return;
  impl_->analyze(lower, sequence);
  impl_->factorize(lower, 0);
}

Factor::Factor(const LowerTriangle& lower, Index contact_rows, std::unique_ptr<LeadingSolver> leading)
    : impl_(std::make_unique<Impl>()) {
  use_one_thread();
  impl_->size = lower.size;
  impl_->leading = std::move(leading);
  impl_->lead(lower, contact_rows);
}

void Factor::refactor(const LowerTriangle& lower) {
  if (impl_->lu || impl_->leading || lower.size != impl_->size)
    throw std::invalid_argument("Factor: refactor with another pattern");
  if (impl_->size == 0) return;
  const Eigen::Index rows = impl_->interface_factor.rows(), contact = impl_->contact_factor.rows();
  impl_->factorize(lower, static_cast<Index>(rows));
  impl_->contact_factor = impl_->interface_factor.bottomRightCorner(contact, contact);
}

Factor::~Factor() = default;
Factor::Factor(Factor&&) noexcept = default;
Factor& Factor::operator=(Factor&&) noexcept = default;

namespace {
// L L' by blocks: a third of the work of a full product.
// Block (i, j) needs the first j + width columns of l alone, since l is lower triangular.
Eigen::MatrixXd square(const Eigen::MatrixXd& l) {
  const Eigen::Index n = l.rows(), block = 128;
  Eigen::MatrixXd s(n, n);
  for (Eigen::Index i = 0; i < n; i += block) {
    const Eigen::Index height = std::min(block, n - i);
    for (Eigen::Index j = 0; j <= i; j += block) {
      const Eigen::Index width = std::min(block, n - j);
      s.block(i, j, height, width).noalias() =
          l.block(i, 0, height, j + width) * l.block(j, 0, width, j + width).transpose();
      if (j < i) s.block(j, i, width, height) = s.block(i, j, height, width).transpose();
    }
  }
  return s;
}
}  // namespace

Eigen::MatrixXd Factor::contact_complement() const {
  return square(impl_->contact_factor);
}

Eigen::MatrixXd Factor::interface_complement() const {
  return square(impl_->interface_factor);
}

const Eigen::MatrixXd& Factor::interface_factor() const {
  return impl_->interface_factor;
}

Eigen::VectorXd Factor::forward(const Eigen::VectorXd& b) const {
  if (impl_->lu) return impl_->lu->solve(b);
  if (impl_->size == 0) return b;
  if (impl_->leading) return impl_->lead_forward(b);
  return impl_->forward(b);
}

// With LU the whole solve is in the first half.
Eigen::VectorXd Factor::backward(const Eigen::VectorXd& y) const {
  if (impl_->size == 0 || impl_->lu) return y;
  return impl_->leading ? impl_->lead_backward(y) : impl_->backward(y);
}

namespace {
template <typename Each>
Eigen::MatrixXd by_columns(const Eigen::MatrixXd& b, const Each& each) {
  Eigen::MatrixXd x(b.rows(), b.cols());
  for (Eigen::Index c = 0; c < b.cols(); ++c) x.col(c) = each(b.col(c));
  return x;
}
}  // namespace

Eigen::MatrixXd Factor::backward(const Eigen::MatrixXd& y) const {
  if (impl_->size == 0 || y.cols() == 0) return y;
  if (impl_->leading) return by_columns(y, [&](const Eigen::VectorXd& c) { return impl_->lead_backward(c); });
  return impl_->backward(y);
}

Eigen::VectorXd Factor::backward(const Eigen::VectorXd& y, const std::vector<bool>& fronts) const {
  if (!impl_->numeric) throw std::invalid_argument("Factor: fronts of a definite matrix only");
  return impl_->backward(y, &fronts);
}

// Rows of K to places in the order of elimination.
std::vector<bool> Factor::fronts_above(const std::vector<Index>& rows) const {
  if (!impl_->numeric) throw std::invalid_argument("Factor: fronts of a definite matrix only");
  std::vector<bool> asked(static_cast<std::size_t>(impl_->size), false);
  for (const Index row : rows) asked[static_cast<std::size_t>(row)] = true;
  std::vector<Index> columns;
  for (Index k = 0; k < impl_->size; ++k)
    if (asked[static_cast<std::size_t>(impl_->order[static_cast<std::size_t>(k)])]) columns.push_back(k);
  return impl_->numeric->fronts_above(columns);
}

Eigen::VectorXd Factor::solve(const Eigen::VectorXd& b) const {
  return backward(forward(b));
}

Eigen::MatrixXd Factor::solve_all(const Eigen::MatrixXd& b) const {
  if (impl_->lu) throw std::invalid_argument("Factor: many right-hand sides need a definite matrix");
  if (impl_->leading) return by_columns(b, [&](const Eigen::VectorXd& c) { return solve(c); });
  return impl_->size == 0 || b.cols() == 0 ? b : impl_->backward(impl_->forward(b));
}

// b'K^-1 b = |L^-1 b|^2. With a leading solver the leading part is b_I'K_II^-1 b_I, and S has the rest.
double Factor::energy(const Eigen::VectorXd& b) const {
  if (impl_->size == 0) return 0;
  const Eigen::VectorXd half = forward(b);
  if (impl_->lu) return b.dot(half);
  if (!impl_->leading) return half.squaredNorm();
  const Eigen::Index contact = impl_->contact_rows(), first = b.size() - contact;
  return b.head(first).dot(half.head(first)) + half.tail(contact).squaredNorm();
}

const LeadingSolver* Factor::leading() const {
  return impl_->leading.get();
}

const Eigen::MatrixXd& Factor::contact_factor() const {
  return impl_->contact_factor;
}

Factor::Columns Factor::columns() const {
  if (!impl_->numeric) throw std::invalid_argument("Factor: columns of a definite matrix only");
  return {*impl_->numeric, impl_->values.get(), impl_->order};
}

double Factor::entries() const {
  return impl_->entries;
}

double Factor::flops() const {
  return impl_->flops;
}

}  // namespace kerf
