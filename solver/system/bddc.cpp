// Balancing domain decomposition by constraints [Dohrmann 2003; Mandel, Dohrmann, Tezaur 2005], one part per process.
// Insides are eliminated exactly; conjugate gradients run on the rows that parts share, with S_p the dense complement
// of part p. On each piece F of the interface, shared by p and q,
//   f_p = S_p (S_p + S_q)^-1 r,   z = sum_p D_p' (answer of p under f_p)   ("deluxe" weights),
// and the forces g with (Z_p + Z_q) g = lambda (X_p + X_q) g, lambda > 5, have continuous moments [theory: E.35]; X_p,
// Z_p are the compliances of part p on F with all else that it shares held and free. A part with its moments u answers
//   S^_p^-1 f + V_p G_p^-1 (u - V_p' f),   S^_p = S_p + C_p C_p',  V_p = S^_p^-1 C_p,  G_p = C_p' V_p   [theory: E.36],
// and the moments follow from a small sparse problem on all processes. The bound on lambda bounds the condition
// whatever materials and shapes are. All processes call the same functions. Derived in docs/theory/elements.md, section
// Solving in parts.

#include "solver/system/bddc.hpp"

#include "base/dense.hpp"
#include "base/packer.hpp"
#include "base/stopwatch.hpp"
#include "kerf/stop.hpp"
#include "solver/system/coarse.hpp"
#include "solver/system/complement.hpp"
#include "solver/system/gradients.hpp"
#include "solver/system/inside.hpp"
#include "solver/system/lost_definiteness.hpp"
#include "solver/system/pieces.hpp"
#include "solver/system/primal.hpp"

#include <fmt/core.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace kerf {

namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

constexpr double threshold = 5;  // of the eigenvalues of a piece whose moments are continuous
// Shares of the diagonal of K_p, which rounding of S is a small part of. What moves a part by itself has no more than
// the first one, so that its moments are found, too, where all that holds a piece is not above the second one.
constexpr double shift_free = 1e-12, held_to_free = 100;

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

VectorXd diagonal_of(const PartMatrix& part, const std::vector<Index>& rows) {
  VectorXd d(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto begin = part.columns.begin() + part.start[rows[k]], end = part.columns.begin() + part.start[rows[k] + 1];
    d[static_cast<Eigen::Index>(k)] = part.values[std::lower_bound(begin, end, rows[k]) - part.columns.begin()];
  }
  return d;
}

template <typename Matrix>
void put_lower(const Matrix& m, Packer& to) {
  for (Eigen::Index j = 0; j < m.cols(); ++j)
    for (Eigen::Index i = j; i < m.rows(); ++i) to.put(m(i, j));
}
MatrixXd get_lower(Unpacker& from, Eigen::Index n) {
  MatrixXd m(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = j; i < n; ++i) m(i, j) = m(j, i) = from.get<double>();
  return m;
}

/// The Cholesky factor of a matrix plus a share of a diagonal, the first of 0, `least`, 100 `least`, .. with which it
/// is definite.
Eigen::LLT<MatrixXd> definite(const MatrixXd& m, const VectorXd& diagonal, double least) {
  constexpr double most = 1e-2;
  for (double shift = 0; shift < most; shift = std::max(least, 100 * shift)) {
    MatrixXd shifted = m;
    shifted.diagonal() += shift * diagonal;
    Eigen::LLT<MatrixXd> llt = cholesky(shifted);
    if (llt.info() == Eigen::Success) return llt;
  }
  throw LostDefiniteness("rounding has eaten the stiffness of what two parts of the body share; refine the mesh there");
}

/// Columns with the same span, orthonormal where each row is taken relative to the root of the diagonal.
MatrixXd orthonormal(const MatrixXd& columns, const VectorXd& diagonal) {
  if (columns.cols() == 0) return columns;
  const VectorXd size = diagonal.cwiseSqrt();
  const MatrixXd scaled = size.cwiseInverse().asDiagonal() * columns,
                 lengths = scaled.colwise().norm().cwiseInverse().asDiagonal();
  constexpr double dependent = 1e-9;
  const Eigen::ColPivHouseholderQR<MatrixXd> qr = pivoted_qr(kerf::multiply(scaled, lengths), dependent);
  return size.asDiagonal() * kerf::orthonormal(qr, qr.rank());
}

// Members are made in their order: the interface must be known before the inside is eliminated, and S goes from the
// inside to the complement.
class Bddc : public SharedSolver {
 public:
  Bddc(PartMatrix part, Communicator& comm, int threads, Precision precision)
      : peers_(comm),
        interface_(find_interface(part, comm)),
        diagonal_(diagonal_of(part, interface_.rows)),
        stiffest_(largest_diagonal(part)),
        rows_(part.rows),
        own_(rows_owned(part)),
        inside_(part, interface_.rows, threads, precision, given_),
        S_(std::move(given_)) {
    effort_.parts = static_cast<int>(comm.count());
    share_pieces();
    set_primal();
    std::array<double, 1> rows{counted().sum()};
    comm.sum(rows);
    effort_.interface_rows = static_cast<int>(rows[0]);
    effort_.primal = static_cast<int>(coarse_.size());
    if (effort_.interface_rows > 0)
      iteration_ = comm.iteration({.counted = counted(),
                                   .multiply = [this](const VectorXd& x) { return multiply(x); },
                                   .precondition = [this](const VectorXd& r) { return precondition(r); },
                                   .primal = coarse_.size()});
  }

  /// b on own rows alone: each row counts once in the sum over the processes. Inside rows are eliminated before and
  /// found after the gradients.
  VectorXd solve(const VectorXd& own) override {
    Stopwatch watch;
    VectorXd b = VectorXd::Zero(rows_);
    for (std::size_t i = 0; i < own_.size(); ++i) b[own_[i]] = own[static_cast<Eigen::Index>(i)];
    VectorXd y = inside_.forward(b), on_interface = y.tail(S_.size());
    add_sides(on_interface);
    sent_ = 0;
    const SharedSolved solved = iteration_ ? iteration_->solve(on_interface) : SharedSolved{.x = on_interface};
    y.tail(S_.size()) = solved.x;
    const VectorXd x = inside_.backward(std::move(y));
    tell(solved, watch.lap());
    if (solved.failed)
      throw Error(Fault::Numerics,
                  fmt::format("the iteration does not converge on {} parts ({}{} iterations, {:.1e} of the error is "
                              "left); use fewer processes or backend = \"cholmod\"",
                              effort_.parts, solved.ended.empty() ? "" : solved.ended + " after ", solved.iterations,
                              solved.left));
    VectorXd found(own.size());
    for (std::size_t i = 0; i < own_.size(); ++i) found[static_cast<Eigen::Index>(i)] = x[own_[i]];
    return found;
  }
  SharedEffort effort() const override {
    return effort_;
  }
  double stiffest() const override {
    return stiffest_;
  }

 private:
  /// On both sides of a piece the same.
  struct Side {
    Eigen::LLT<MatrixXd> both;  // S_p + S_q on the piece
    MatrixXd primal;            // columns: forces whose moments are continuous
    Index first = 0;            // of them in the small problem
  };

  /// Numbers of process p are consecutive, those of lower processes before.
  std::vector<Index> rows_owned(const PartMatrix& part) const {
    const std::vector<Index> counts = gathered(peers_, std::vector<Index>{part.owned});
    const Index first = std::reduce(counts.begin(), counts.begin() + peers_.here());
    std::vector<Index> own;
    for (Index row = 0; row < part.rows; ++row)
      if (part.number[row] >= first && part.number[row] < first + part.owned) own.push_back(row);
    if (static_cast<Index>(own.size()) != part.owned) throw std::logic_error("a process owns what it does not have");
    return own;
  }
  // The lower process of a piece solves its eigenproblem, and counts its rows in products.
  bool counts(const Border& piece) const {
    return peers_.here() < piece.with;
  }
  // A row is on two processes; products count it on the lower one.
  VectorXd counted() const {
    VectorXd c(static_cast<Eigen::Index>(interface_.rows.size()));
    for (const Border& piece : interface_.pieces)
      c.segment(piece.begin, piece.size()).setConstant(counts(piece) ? 1 : 0);
    return c;
  }
  std::vector<std::string> swap(std::vector<Packer> packers) {
    std::vector<std::string> to;
    for (Packer& p : packers) to.push_back(std::move(p).take());
    return peers_.exchange(to);
  }
  std::vector<Packer> packers() const {
    return std::vector<Packer>(static_cast<std::size_t>(peers_.count()));
  }
  static std::vector<Unpacker> readers(const std::vector<std::string>& from) {
    return {from.begin(), from.end()};
  }

  /// S + C C' + a share of the diagonal, as small as rounding lets it be, has a factor then. Returns that share.
  double factorize(double least, const std::vector<Complement::Forces>& held) {
    constexpr double most = 1e-2;
    for (double shift = least; shift < most; shift = std::max(shift_free, 100 * shift)) {
      check_stop();
      if (S_.factorize(shift * diagonal_, held)) return shift;
    }
    throw LostDefiniteness("rounding has eaten the stiffness of a part of the body; use fewer processes");
  }

  /// Tells the other side of each piece of S on it, and the higher side the lower one of what it does when free.
  /// The shift of the held compliances X is 100 times the largest shift of all processes, so that X has no motion that
  /// costs as little as the shift of Z: such motions are found.
  void share_pieces() {
    double held = factorize(shift_free, {});
    peers_.largest({&held, 1});
    held *= held_to_free;
    std::vector<Packer> to = packers();
    for (const Border& piece : interface_.pieces) {
      Packer& packer = to[piece.with];
      put_lower(S_.block(piece.begin, piece.size()), packer);
      packer.put(MatrixXd(diagonal_.segment(piece.begin, piece.size())));
      if (!counts(piece)) put_lower(S_.inverse_block(piece.begin, piece.size()), packer);
    }
    const std::vector<std::string> from = swap(std::move(to));
    std::vector<Unpacker> read = readers(from);
    for (const Border& piece : interface_.pieces) {
      Unpacker& unpacker = read[piece.with];
      const Eigen::Index n = piece.size();
      const MatrixXd here = S_.block(piece.begin, n).selfadjointView<Eigen::Lower>(), there = get_lower(unpacker, n);
      const VectorXd d = diagonal_.segment(piece.begin, n);
      VectorXd beyond(n);
      for (double& value : beyond) value = unpacker.get<double>();
      Side side{definite(here + there, d + beyond, shift_free), {}};
      if (counts(piece)) {
        const MatrixXd free = S_.inverse_block(piece.begin, n) + get_lower(unpacker, n);
        side.primal = orthonormal(primal_of(free, here, there, d, beyond, held), d + beyond);
      }
      sides_.push_back(std::move(side));
    }
  }

  /// Z of the free parts comes from both sides; X is made here from both blocks of S.
  static MatrixXd primal_of(const MatrixXd& free, const MatrixXd& here, const MatrixXd& there, const VectorXd& d,
                            const VectorXd& beyond, double shift) {
    const auto held = [shift](MatrixXd s, const VectorXd& diagonal) -> MatrixXd {
      s.diagonal() += shift * diagonal;
      return kerf::solve(definite(s, diagonal, shift), MatrixXd::Identity(s.rows(), s.cols()));
    };
    return soft_forces(free, held(here, d) + held(there, beyond), threshold);
  }

  /// Numbers the moments, and makes the small problem: the least energy that the part has with each of them 1, the
  /// others 0.
  /// The forces are scaled to length 1 relative to the diagonal, so that C C' is as large as S. G is symmetrized
  /// because its two halves round differently.
  void set_primal() {
    Index own = 0;
    for (const Side& s : sides_) own += static_cast<Index>(s.primal.cols());
    const std::vector<Index> all = gathered(peers_, std::vector<Index>{own});
    Index next = std::reduce(all.begin(), all.begin() + peers_.here());
    const Index total = std::reduce(all.begin(), all.end());
    std::vector<Packer> to = packers();
    for (std::size_t k = 0; k < sides_.size(); ++k)
      if (Side& s = sides_[k]; counts(interface_.pieces[k])) {
        s.first = next;
        next += static_cast<Index>(s.primal.cols());
        Packer& packer = to[interface_.pieces[k].with];
        packer.put(s.first);
        packer.put(s.primal.cols());
        packer.put(s.primal);
      }
    const std::vector<std::string> from = swap(std::move(to));
    std::vector<Unpacker> read = readers(from);
    std::vector<Complement::Forces> held;
    std::vector<Index> at;
    for (std::size_t k = 0; k < sides_.size(); ++k) {
      const Border& piece = interface_.pieces[k];
      Side& s = sides_[k];
      if (!counts(piece)) {
        s.first = read[piece.with].get<Index>();
        s.primal.resize(piece.size(), read[piece.with].get<Eigen::Index>());
        for (Eigen::Index i = 0; i < s.primal.size(); ++i) s.primal.data()[i] = read[piece.with].get<double>();
      }
      for (Index i = 0; i < static_cast<Index>(s.primal.cols()); ++i) at.push_back(s.first + i);
      const VectorXd root = diagonal_.segment(piece.begin, piece.size()).cwiseSqrt().cwiseInverse();
      const VectorXd size = (root.asDiagonal() * s.primal).colwise().norm().cwiseInverse();
      held.push_back({piece.begin, s.primal * size.asDiagonal()});
    }
    factorize(0, held);
    moved_ = MatrixXd::Zero(S_.size(), static_cast<Eigen::Index>(at.size()));
    Eigen::Index column = 0;
    for (std::size_t k = 0; k < sides_.size(); ++k) {
      const MatrixXd& primal = sides_[k].primal;
      moved_.block(interface_.pieces[k].begin, column, primal.rows(), primal.cols()) = primal;
      column += primal.cols();
    }
    for (Side& s : sides_) s.primal.resize(0, 0);
    held = {};
    if (at.empty()) {
      coarse_ = Coarse({}, at, total, peers_);
      return;
    }
    const MatrixXd forces = moved_;
    moved_ = S_.solve(std::move(moved_));
    MatrixXd moments = transposed_multiply(forces, moved_);
    moments = (0.5 * (moments + moments.transpose())).eval();
    moments_ = cholesky(moments);
    const MatrixXd basis = solve_from_right(moved_, moments_);
    MatrixXd energies = transposed_multiply(basis, S_.multiply(basis));
    energies = (0.5 * (energies + energies.transpose())).eval();
    coarse_ = Coarse(energies, at, total, peers_);
  }

  void add_sides(VectorXd& values) {
    add_both_sides(interface_, peers_, values);
    sent_ += static_cast<double>(values.size()) * sizeof(double);
  }
  VectorXd multiply(const VectorXd& x) {
    check_stop();
    VectorXd y = S_.multiply(x);
    add_sides(y);
    return y;
  }
  template <typename Each>
  void on_pieces(VectorXd& x, const Each& each) const {
    for (std::size_t k = 0; k < sides_.size(); ++k) {
      const Border& piece = interface_.pieces[k];
      auto of = x.segment(piece.begin, piece.size());
      of = each(sides_[k], piece, VectorXd(of));
    }
  }
  VectorXd times_here(const Border& piece, const VectorXd& x) const {
    return S_.block(piece.begin, piece.size()).template selfadjointView<Eigen::Lower>() * x;
  }
  /// The sum of D_p' (the least energy under D_p r, moments continuous), D_p = S_p (S_p + S_q)^-1 on each piece.
  /// Weights of both sides add up to the identity: D_p + D_q = (S_p + S_q)(S_p + S_q)^-1 on a piece. The moments u
  /// solve the small problem; z gets V G^-1 (u - V'f) on top of S^^-1 f (E.36).
  VectorXd precondition(const VectorXd& r) {
    const LoggedWork logged(peers_, PartsWork::Apply);
    VectorXd f = r;
    on_pieces(f, [&](const Side& s, const Border& piece, const VectorXd& of) {
      return times_here(piece, kerf::solve(s.both, of));
    });
    VectorXd moments(moved_.cols());
    if (moments.size() > 0) moments = transposed_multiply(moved_, f);
    const VectorXd common = coarse_.solve(solved_moments(moments));
    sent_ += static_cast<double>(coarse_.size()) * sizeof(double);
    VectorXd z = S_.solve(f);
    if (moments.size() > 0) z += kerf::multiply(moved_, solved_moments(common - moments));
    on_pieces(z, [&](const Side&, const Border& piece, const VectorXd& of) { return times_here(piece, of); });
    add_sides(z);
    on_pieces(z, [](const Side& s, const Border&, const VectorXd& of) -> VectorXd { return kerf::solve(s.both, of); });
    return z;
  }
  VectorXd solved_moments(const VectorXd& m) const {
    return m.size() > 0 ? kerf::solve(moments_, m) : m;
  }

  /// Times and memory are the largest of all processes; the first one's peak is told apart.
  void tell(const SharedSolved& solved, double seconds) {
    std::array<double, 3> most{sent_ / std::max(1, solved.iterations), seconds, peers_.here() == 0 ? 0 : peak_mb()};
    peers_.largest(most);
    ++effort_.solves;
    if (!solved.ended.empty()) {
      ++effort_.unfinished;
      effort_.ended = solved.ended;
    }
    effort_.iterations = std::max(effort_.iterations, solved.iterations);
    effort_.condition = std::max(effort_.condition, solved.condition);
    effort_.sent = std::max(effort_.sent, most[0]);
    effort_.seconds += most[1];
    effort_.first_mb = peak_mb();
    effort_.other_mb = most[2];
  }

  Communicator& peers_;
  Interface interface_;
  VectorXd diagonal_;  // of K_p, on the interface
  double stiffest_;
  Index rows_;
  std::vector<Index> own_;  // rows that this process owns
  MatrixXd given_;          // S, on its way to S_
  Inside inside_;
  Complement S_;
  std::vector<Side> sides_;       // per piece
  MatrixXd moved_;                // by forces on the moments, a column each, all moments held softly
  Eigen::LLT<MatrixXd> moments_;  // of these
  Coarse coarse_;
  std::unique_ptr<SharedIteration> iteration_;  // nothing where nothing is shared
  double sent_ = 0;
  SharedEffort effort_;
};

}  // namespace

std::unique_ptr<SharedSolver> bddc(PartMatrix part, Communicator& comm, int threads, Precision precision) {
  return std::make_unique<Bddc>(std::move(part), comm, threads, precision);
}

}  // namespace kerf
