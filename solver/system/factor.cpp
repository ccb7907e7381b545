#include "solver/factor.hpp"

#include "kerf/stop.hpp"
#include "solver/system/blas.hpp"
#include "solver/system/lost_definiteness.hpp"
#include "solver/system/multifrontal.hpp"

#include <cholmod.h>
#include <dlfcn.h>
#include <fmt/core.h>
#include <malloc.h>
#include <omp.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <mutex>
#include <numeric>
#include <optional>

namespace kerf {

namespace {

// Views of arrays that Eigen or a vector owns; CHOLMOD only reads them.
cholmod_sparse view(Index n, Index* start, Index* rows, double* values, int stype) {
  cholmod_sparse a{};
  a.nrow = a.ncol = static_cast<std::size_t>(n);
  a.nzmax = static_cast<std::size_t>(start[n]);
  a.p = start;
  a.i = rows;
  a.x = values;
  a.stype = stype;
  a.itype = CHOLMOD_INT;
  a.xtype = values ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = 1;
  a.packed = 1;
  return a;
}

struct Session {  // a CHOLMOD workspace with its lifetime
  cholmod_common c{};
  Session() {
    cholmod_start(&c);
    c.print = 0;
    c.error_handler = nullptr;
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session() {
    cholmod_finish(&c);
  }
};

}  // namespace

// OpenBLAS and CHOLMOD each start threads of their own for every supernode, which costs more than it gives (400k
// triangles: half the time went into yielding), and sums in another order. Looked up by name, so that any BLAS will do.
void use_one_thread() {
  omp_set_max_active_levels(0);
  using Set = void (*)(int);
  if (const auto set = reinterpret_cast<Set>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"))) set(1);
}

std::vector<Index> dissection(const std::vector<Index>& start, const std::vector<Index>& neighbors) {
  check_stop();
  const Index n = static_cast<Index>(start.size()) - 1;
  std::vector<Index> order(n);
  if (n == 0) return order;
  // METIS seeds and draws from the C library's generator: two orderings at once would disturb each other.
  static std::mutex one_at_a_time;
  const std::scoped_lock lock(one_at_a_time);
  Session session;
  // An unsymmetric pattern stands for A A' in CHOLMOD; stype 1 with both triangles stored reads the upper one.
  std::vector<Index> upper_start(n + 1, 0), upper;
  upper.reserve(neighbors.size() / 2);
  for (Index j = 0; j < n; ++j) {
    for (Index p = start[j]; p < start[j + 1]; ++p)
      if (neighbors[p] < j) upper.push_back(neighbors[p]);
    upper_start[j + 1] = static_cast<Index>(upper.size());
  }
  if (upper.empty()) upper.push_back(0);
  cholmod_sparse a = view(n, upper_start.data(), upper.data(), nullptr, 1);
  a.sorted = 0;
  if (!cholmod_metis(&a, nullptr, 0, 1, order.data(), &session.c)) out_of_memory();
  return order;
}

void return_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

struct Factor::Impl {
  Session session;
  cholmod_factor* factor = nullptr;
  Index size = 0;
  double entries = 0, flops = 0;
  Eigen::MatrixXd contact_factor, interface_factor;
  bool permuted = false;  // by the factor, not by whoever made the matrix
  std::optional<Lu> lu;   // instead of a Cholesky factor
  std::optional<Multifrontal> numeric;
  std::unique_ptr<LeadingSolver> leading;  // instead of both, with the rows of the matrix that are in contact
  LowerTriangle coupling;                  // its entries in these rows, by columns
  int threads = 1;

  ~Impl() {
    if (factor) cholmod_free_factor(&factor, &session.c);
  }

  void analyze(const LowerTriangle& lower, std::span<const Index> sequence) {
    cholmod_common& c = session.c;
    c.supernodal = CHOLMOD_SUPERNODAL;
    c.nmethods = 1;
    c.method[0].ordering = sequence.empty() ? CHOLMOD_NATURAL : CHOLMOD_GIVEN;
    // Fewer zeros in merged supernodes than by default: 4 to 7 % less memory; speed within the noise of the
    // measurement. Small matrices spend their time on the calls per supernode, not inside: 6600 unknowns of a lattice
    // take 9.2 ms with the narrow ones, 6.1 by default, 4.7 with wide ones.
    constexpr std::array<std::size_t, 3> narrow{1, 4, 12}, wide{8, 32, 96};
    std::copy_n((size < 30000 ? wide : narrow).begin(), 3, c.nrelax);
    // `dissection` is a postorder already, and last rows must stay where they are.
    permuted = !sequence.empty();
    c.postorder = permuted ? 1 : 0;
    cholmod_sparse a = view(size, const_cast<Index*>(lower.start.data()), const_cast<Index*>(lower.rows.data()),
                            const_cast<double*>(lower.values.data()), -1);
    factor = cholmod_analyze_p(&a, permuted ? const_cast<Index*>(sequence.data()) : nullptr, nullptr, 0, &c);
    if (!factor) out_of_memory();
    entries = c.lnz;
    flops = c.fl;
    numeric.emplace(supernodes());
  }

  Supernodes supernodes() const {
    return {static_cast<Index>(factor->nsuper), static_cast<const Index*>(factor->super),
            static_cast<const Index*>(factor->pi), static_cast<const Index*>(factor->px),
            static_cast<const Index*>(factor->s)};
  }

  /// In the order of the factor.
  LowerTriangle reordered(const LowerTriangle& lower) const {
    const auto* order = static_cast<const Index*>(factor->Perm);
    std::vector<Index> place(static_cast<std::size_t>(size));
    for (Index k = 0; k < size; ++k) place[static_cast<std::size_t>(order[k])] = k;
    LowerTriangle r{size, std::vector<Index>(lower.start.size(), 0), std::vector<Index>(lower.rows.size()),
                    std::vector<double>(lower.values.size())};
    const auto each = [&](const auto& visit) {
      for (Index j = 0; j < size; ++j)
        for (Index p = lower.start[j]; p < lower.start[j + 1]; ++p)
          visit(p, place[static_cast<std::size_t>(lower.rows[p])], place[static_cast<std::size_t>(j)]);
    };
    each([&](Index, Index row, Index column) { ++r.start[std::min(row, column) + 1]; });
    std::partial_sum(r.start.begin(), r.start.end(), r.start.begin());
    std::vector<Index> next(r.start.begin(), r.start.end() - 1);
    each([&](Index p, Index row, Index column) {
      const Index to = next[std::min(row, column)]++;
      r.rows[to] = std::max(row, column);
      r.values[to] = lower.values[p];
    });
    return r;
  }

  void factorize(const LowerTriangle& lower) {
    check_stop();
    if (!factor->x && !cholmod_change_factor(CHOLMOD_REAL, 1, 1, 1, 1, factor, &session.c)) out_of_memory();
    auto* values = static_cast<double*>(factor->x);
    if (!(permuted ? numeric->factorize(reordered(lower), values, threads)
                   : numeric->factorize(lower, values, threads)))
      throw LostDefiniteness(
          "rounding has eaten the stiffness of the body: it is slender or nearly free to move, triangles are very "
          "flat, or materials differ too much; support it more firmly, or refine the mesh there");
  }

  const double* values() const {
    return static_cast<const double*>(factor->x);
  }

  /// In the order of the factor, and back.
  template <typename Dense>
  Dense permute(const Dense& b, bool back) const {
    Dense out(b.rows(), b.cols());
    const auto* order = static_cast<const Index*>(factor->Perm);
    for (Eigen::Index c = 0; c < b.cols(); ++c)
      for (Index k = 0; k < size; ++k)
        if (back)
          out(order[k], c) = b(k, c);
        else
          out(k, c) = b(order[k], c);
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
  Eigen::VectorXd lead_backward(Eigen::VectorXd y) const {
    const Eigen::Index contact = contact_rows(), first = size - contact;
    if (contact == 0) return y;
    y.tail(contact) = contact_factor.transpose().triangularView<Eigen::Upper>().solve(y.tail(contact)).eval();
    y.head(first) -= leading->solve(on_leading(y.tail(contact)));
    return y;
  }

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
    Eigen::MatrixXd S(contact, contact);
    for (Index i = 0; i < contact; ++i) {
      check_stop();
      S.col(i) = -on_contact(leading->solve(on_leading(Eigen::VectorXd::Unit(contact, i))));
    }
    S = (0.5 * (S + S.transpose())).eval();  // of the rounding of solves that are not exact
    for (Index j = first; j < size; ++j)
      for (Index p = coupling.start[j]; p < coupling.start[j + 1]; ++p) {
        const Index r = coupling.rows[p] - first, c = j - first;
        S(r, c) += coupling.values[p];
        if (r != c) S(c, r) += coupling.values[p];
      }
    const Eigen::LLT<Eigen::MatrixXd> factored(S);
    if (factored.info() != Eigen::Success)
      throw LostDefiniteness(
          "rounding has eaten the stiffness of the cracks in contact: the body is slender or nearly free to move; use "
          "backend = \"cholmod\"");
    contact_factor = factored.matrixL();
    interface_factor = contact_factor;
  }

  template <typename Dense>
  Dense forward(const Dense& b) const {
    check_stop();
    Dense x = permuted ? permute(b, false) : b;
    numeric->forward(values(), x, threads);
    return x;
  }

  template <typename Dense>
  Dense backward(Dense x, const std::vector<bool>* fronts = nullptr) const {
    check_stop();
    numeric->backward(values(), x, threads, fronts);
    return permuted ? permute(x, true) : x;
  }

  // The supernodes hold the columns of L as dense blocks; the last one may begin before these columns.
  Eigen::MatrixXd last_block(Index count) const {
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(count, count);
    const Index first = size - count;
    const auto* super = static_cast<const Index*>(factor->super);
    const auto* rows_start = static_cast<const Index*>(factor->pi);
    const auto* values_start = static_cast<const Index*>(factor->px);
    const auto* rows = static_cast<const Index*>(factor->s);
    const auto* values = static_cast<const double*>(factor->x);
    for (std::size_t s = 0; s < factor->nsuper; ++s) {
      if (super[s + 1] <= first) continue;
      const Index height = rows_start[s + 1] - rows_start[s];
      for (Index j = std::max(super[s], first); j < super[s + 1]; ++j) {
        const double* column = values + values_start[s] + std::int64_t{j - super[s]} * height;
        for (Index i = j - super[s]; i < height; ++i) {
          const Index row = rows[rows_start[s] + i];
          if (row >= j) block(row - first, j - first) = column[i];
        }
      }
    }
    return block;
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
  impl_->factorize(lower);
  if (impl_->factor->ordering != CHOLMOD_NATURAL) throw std::logic_error("CHOLMOD did not keep the given order");
  impl_->interface_factor = impl_->last_block(contact_rows + interface_rows);
  impl_->contact_factor = impl_->interface_factor.bottomRightCorner(contact_rows, contact_rows);
}

Factor::Factor(const LowerTriangle& lower, std::span<const Index> sequence, int threads)
    : impl_(std::make_unique<Impl>()) {
  use_one_thread();
  impl_->size = lower.size;
  impl_->threads = threads;
  if (impl_->size == 0) return;
  impl_->analyze(lower, sequence);
  impl_->factorize(lower);
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
  impl_->factorize(lower);
  if (impl_->permuted) return;
  impl_->interface_factor = impl_->last_block(static_cast<Index>(rows));
  impl_->contact_factor = impl_->interface_factor.bottomRightCorner(contact, contact);
}

Factor::~Factor() = default;
Factor::Factor(Factor&&) noexcept = default;
Factor& Factor::operator=(Factor&&) noexcept = default;

namespace {
// L L' by blocks: a third of the work of a full product.
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

std::vector<bool> Factor::fronts_above(const std::vector<Index>& rows) const {
  if (!impl_->numeric) throw std::invalid_argument("Factor: fronts of a definite matrix only");
  const auto* order = static_cast<const Index*>(impl_->factor->Perm);
  std::vector<bool> asked(static_cast<std::size_t>(impl_->size), false);
  for (const Index row : rows) asked[static_cast<std::size_t>(row)] = true;
  std::vector<Index> columns;
  for (Index k = 0; k < impl_->size; ++k)
    if (asked[static_cast<std::size_t>(order[k])]) columns.push_back(k);
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
  if (!impl_->factor) throw std::invalid_argument("Factor: columns of a definite matrix only");
  return {impl_->supernodes(), static_cast<const double*>(impl_->factor->x),
          static_cast<const Index*>(impl_->factor->Perm)};
}

double Factor::entries() const {
  return impl_->entries;
}

double Factor::flops() const {
  return impl_->flops;
}

}  // namespace kerf
