// The processes that mpiexec started, behind two interfaces of the solver. Ranks (what the first process asks of the
// others): orders as bytes, a letter and the name of a solver, upon which all of them build, use or drop their share of
// a system that the first one has as a whole. Peers (what processes do together): sums, largest values, an exchange of
// bytes of all with all, a solver of a shared system, which is kerf's BDDC or, where options ask for it, PETSc's
// [theory: E.30; Zampini 2016]. MPI and PETSc lie behind the table of functions of petsc_module.cpp. A process that
// cannot go on ends all of them (MPI_Abort), since the others would wait for it; only what all of them find alike, such
// as a solve that does not converge, is an error that all throw. run_by_mpiexec() starts the same program as many
// processes and passes signals on to mpiexec. docs/theory/elements.md, "Solving in parts".

#include "app/ranks.hpp"

#include "app/parts/petsc_module.hpp"
#include "base/kept_memory.hpp"
#include "io/module.hpp"
#include "solver/factor.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

namespace kerf {

namespace {

struct Module {
  const KerfPetsc* call = nullptr;
  std::string reason = {};
};

const Module& loaded() {
  static const Module module = [] {
    const LoadedModule found = load_module("kerf_petsc.so", KERF_PETSC_FOLDER, {"kerf_petsc"});
    if (!found.handle) return Module{.reason = found.reason};
    return Module{reinterpret_cast<KerfPetscModule>(dlsym(found.handle, "kerf_petsc"))()};
  }();
  return module;
}

// What the first process asks the others for; then the name of a solver, and what belongs to it.
enum class Order : char { Options, Make, Solve, Drop, Task, End };

constexpr double tolerance = 1e-10;  // of the residual of a solve; the rounds of the state refine it

constexpr double shift_of_shear = 1e-5;  // far above the rounding of K_p, far below what holds the body

// BDDC [theory: E.30]. Of what parts share, all motions go into the small problem of which the energy of a part, the
// rest relaxed, differs from their average by more than the threshold: the condition is bounded by it, whatever the
// materials, cracks and shapes of parts are.
constexpr const char* defaults =
    "-pc_bddc_use_local_mat_graph 0 -pc_bddc_use_faces "
    "-pc_bddc_use_deluxe_scaling -pc_bddc_adaptive_threshold 5 -sub_schurs_mat_solver_type mumps "
    "-pc_bddc_dirichlet_pc_type cholesky -pc_bddc_dirichlet_pc_factor_mat_solver_type mumps "
    "-pc_bddc_neumann_pc_type cholesky -pc_bddc_neumann_pc_factor_mat_solver_type mumps "
    "-pc_bddc_coarse_pc_type redundant";

/// One process cannot go on: none can.
[[noreturn]] void end_all(const std::string& words, Fault fault) {
  const std::string line = fmt::format("kerf: {}\n", words);
  [[maybe_unused]] const auto written = write(STDERR_FILENO, line.data(), line.size());
  loaded().call->abort(static_cast<int>(fault));
  _exit(static_cast<int>(fault));
}

/// What PETSc fails in on one process the others wait for.
void need(const char* wrong) {
  if (wrong) end_all(wrong, Fault::Numerics);
}

/// What all processes do together: one that leaves it would keep the others waiting.
template <typename Work>
auto together(int rank, const Work& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    end_all(fmt::format("out of memory on process {}; start more of them", rank), Fault::Numerics);
  } catch (const std::exception& e) {
    end_all(e.what(), Fault::Numerics);
  }
}

/// Throws Error(Numerics), on all processes, for a solve that has not come far enough.
void require_solved(const KerfPetscSolved& how, int parts) {
  constexpr double enough = 1e-6;  // rounding ends the rest of it, and the rounds of the state go on from there
  if (how.reason < 0 && !(how.left <= enough))
    throw Error(Fault::Numerics,
                fmt::format("backend = \"petsc\": conjugate gradients do not converge on {} parts (reason {} of "
                            "KSPConvergedReason after {} iterations); use fewer parts or backend = \"cholmod\"",
                            parts, how.reason, how.iterations));
}

/// By PETSc's BDDC.
class PetscSolver : public SharedSolver {
 public:
  PetscSolver(std::string packed, int total, int parts) {
    part_ = condensed_part(packed);
    packed = {};
    packed.shrink_to_fit();
    return_freed_memory();
    std::vector<double> shift = std::exchange(part_.shear, {});
    for (double& s : shift) s *= shift_of_shear;
    const KerfPetscPart view{.rows = part_.rows,
                             .start = part_.start.data(),
                             .columns = part_.columns.data(),
                             .values = part_.values.data(),
                             .shift = shift.data(),
                             .number = part_.number.data(),
                             .owned = part_.owned,
                             .total = total,
                             .near_start = part_.near_start.data(),
                             .near_rows = part_.near_rows.data()};
    effort_.parts = parts;
    need(loaded().call->make(&view, tolerance, &solver_, &effort_.interface_rows, &effort_.primal));
    part_.near_start = part_.near_rows = part_.number = {};
  }
  PetscSolver(const PetscSolver&) = delete;
  PetscSolver& operator=(const PetscSolver&) = delete;
  ~PetscSolver() override {
    loaded().call->drop(solver_);
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& own) override {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(own.size());
    double size = own.size() > 0 ? own.cwiseAbs().maxCoeff() : 0;
    loaded().call->largest(&size, 1);
    if (size == 0) return x;
    KerfPetscSolved how{};
    need(loaded().call->solve(solver_, own.data(), x.data(), &how));
    ++effort_.solves;
    effort_.iterations = std::max(effort_.iterations, how.iterations);
    effort_.condition = std::max(effort_.condition, how.condition);
    effort_.sent = std::max(effort_.sent, how.sent);
    effort_.seconds += how.seconds;
    effort_.first_mb = how.first_mb;
    effort_.other_mb = how.other_mb;
    require_solved(how, effort_.parts);
    return x;
  }
  PartedEffort effort() const override {
    return effort_;
  }

 private:
  RankPart part_;  // the solver looks at its matrix
  void* solver_ = nullptr;
  PartedEffort effort_;
};

/// Of the first process, after a solve: throws Error(Usage) for options that nothing has asked for.
void refuse_unused(const std::string& options) {
  const char* names = loaded().call->unused(options.c_str());
  if (!names) return;
  std::string list(names);
  list.pop_back();
  std::ranges::replace(list, '\n', ' ');
  throw Error(Fault::Usage, fmt::format("solver.petsc: PETSc has no use here for {}; its manual pages of KSPCG, PCBDDC "
                                        "and MUMPS list their options",
                                        list));
}

class MpiPeers : public Peers {
 public:
  /// `by_petsc`: its BDDC, for which there are options, instead of ours.
  MpiPeers(int rank, int count, bool by_petsc) : rank_(rank), count_(count), by_petsc_(by_petsc) {}
  Index here() const override {
    return static_cast<Index>(rank_);
  }
  Index count() const override {
    return static_cast<Index>(count_);
  }
  void sum(std::span<double> values) override {
    loaded().call->sum(values.data(), values.size());
  }
  void largest(std::span<double> values) override {
    loaded().call->largest(values.data(), values.size());
  }
  std::vector<std::string> exchange(const std::vector<std::string>& to) override {
    const auto n = static_cast<std::size_t>(count_);
    std::vector<std::size_t> out(n), in(n);
    for (std::size_t p = 0; p < n; ++p) out[p] = to[p].size();
    loaded().call->sizes(out.data(), in.data());
    std::vector<std::string> from(n);
    std::vector<const void*> sent(n);
    std::vector<void*> got(n);
    for (std::size_t p = 0; p < n; ++p) {
      from[p].resize(in[p]);
      sent[p] = to[p].data();
      got[p] = from[p].data();
    }
    loaded().call->swap(sent.data(), out.data(), got.data(), in.data());
    return from;
  }
  std::unique_ptr<SharedSolver> solver(std::string packed, Index total, int threads, Precision precision) override {
    if (!by_petsc_) return Peers::solver(std::move(packed), total, threads, precision);
    return std::make_unique<PetscSolver>(std::move(packed), total, count_);
  }

 private:
  int rank_, count_;
  bool by_petsc_;
};

/// The part of this process in a system that the first one has as a whole.
class Share {
 public:
  Share(std::string packed, int total, int owned, int rank, int count, bool by_petsc)
      : peers_(rank, count, by_petsc),
        owned_(owned),
        solver_(peers_.solver(std::move(packed), total, 1, Precision::Double)) {}

  /// `b`, `x`, `counts`: of the first process, of all; else null. Throws Error(Numerics) on all processes.
  void solve(const double* b, double* x, const int* counts) {
    const KerfPetsc& call = *loaded().call;
    Eigen::VectorXd right(owned_);
    call.scatter(b, counts, right.data(), owned_);
    const Eigen::VectorXd own = solver_->solve(right);
    call.gather(own.data(), owned_, x, counts);
  }
  PartedEffort effort() const {
    return solver_->effort();
  }

 private:
  MpiPeers peers_;
  int owned_;
  std::unique_ptr<SharedSolver> solver_;
};

/// What a solve fails in all processes fail in.
std::optional<Error> solved(Share& share, int rank, const double* b, double* x, const int* counts) {
  return together(rank, [&]() -> std::optional<Error> {
    try {
      share.solve(b, x, counts);
    } catch (const Error& e) {
      return e;
    }
    return std::nullopt;
  });
}

std::string order(Order what, int name, std::string_view more = {}) {
  std::string bytes(1, static_cast<char>(what));
  bytes.append(reinterpret_cast<const char*>(&name), sizeof name);
  return bytes.append(more);
}

class MpiRanks : public Ranks, public std::enable_shared_from_this<MpiRanks> {
 public:
  MpiRanks(int count, std::string options) : count_(count), options_(std::move(options)) {
    tell_all(order(Order::Options, 0, options_));
    need(loaded().call->options(options_.c_str()));
  }

  int count() const override {
    return count_;
  }

  std::vector<Index> partition(const std::vector<Index>& start, const std::vector<Index>& neighbors) override {
    const std::scoped_lock lock(one_at_a_time_);
    std::vector<Index> part(start.size() - 1, 0);
    if (count_ > 1 && !part.empty())
      if (const char* wrong = loaded().call->partition(static_cast<int>(part.size()), start.data(), neighbors.data(),
                                                       count_, part.data()))
        throw Error(Fault::Numerics, wrong);
    return part;
  }

  std::unique_ptr<PartedSolver> solver(const std::function<std::string(Index)>& part,
                                       std::vector<Index> owned) override {
    return std::make_unique<Solver>(shared_from_this(), part, std::move(owned));
  }

 private:
  void tell_all(const std::string& bytes) const {
    for (int p = 1; p < count_; ++p) loaded().call->send(p, bytes.data(), bytes.size());
  }

  class Solver : public PartedSolver {
   public:
    Solver(std::shared_ptr<MpiRanks> ranks, const std::function<std::string(Index)>& part, std::vector<Index> owned)
        : ranks_(std::move(ranks)), owned_(std::move(owned)) {
      const std::scoped_lock lock(ranks_->one_at_a_time_);
      name_ = ranks_->next_name_++;
      const int total = std::reduce(owned_.begin(), owned_.end());
      for (int p = 1; p < ranks_->count_; ++p) {
        const std::array<int, 2> sizes{total, owned_[static_cast<std::size_t>(p)]};
        const std::string head = order(Order::Make, name_, {reinterpret_cast<const char*>(sizes.data()), sizeof sizes});
        const std::string bytes = together(0, [&] { return part(p); });
        loaded().call->send(p, head.data(), head.size());
        loaded().call->send(p, bytes.data(), bytes.size());
      }
      share_ = together(0, [&] {
        return std::make_unique<Share>(part(0), total, owned_[0], 0, ranks_->count_, !ranks_->options_.empty());
      });
    }
    ~Solver() override {
      const std::scoped_lock lock(ranks_->one_at_a_time_);
      ranks_->tell_all(order(Order::Drop, name_));
      share_.reset();
    }

    Eigen::VectorXd solve(const Eigen::VectorXd& b) override {
      const std::scoped_lock lock(ranks_->one_at_a_time_);
      if (b.isZero(0)) return b;
      ranks_->tell_all(order(Order::Solve, name_));
      Eigen::VectorXd x(b.size());
      const std::optional<Error> failed = solved(*share_, 0, b.data(), x.data(), owned_.data());
      ranks_->check_options();
      if (failed) throw *failed;
      return x;
    }
    PartedEffort effort() const override {
      return share_->effort();
    }

   private:
    std::shared_ptr<MpiRanks> ranks_;
    std::vector<Index> owned_;
    int name_ = 0;
    std::unique_ptr<Share> share_;
  };

  /// After the first solve: what nothing has asked for is misspelt, or not for this solver.
  void check_options() {
    if (!options_checked_) refuse_unused(options_);
    options_checked_ = true;
  }

  int count_;
  std::string options_;
  bool options_checked_ = false;
  int next_name_ = 0;
  std::mutex one_at_a_time_;
};

/// One process: nothing to start, and its factor is better than any iteration.
class Alone : public Ranks {
 public:
  int count() const override {
    return 1;
  }
  std::vector<Index> partition(const std::vector<Index>& start, const std::vector<Index>&) override {
    return std::vector<Index>(start.size() - 1, 0);
  }
  std::unique_ptr<PartedSolver> solver(const std::function<std::string(Index)>&, std::vector<Index>) override {
    throw std::logic_error("one process has no parts");
  }
};

void require_module() {
  const Module& module = loaded();
  if (!module.call)
    throw Error(
        Fault::Usage,
        fmt::format("PETSc is needed for backend = \"petsc\" and under mpiexec, and kerf was built without it or does "
                    "not find its module kerf_petsc.so ({}); ./dev petsc builds it (package libpetsc-real-dev, option "
                    "KERF_PETSC), or use backend = \"cholmod\" without mpiexec",
                    module.reason));
}

}  // namespace

int started_processes() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* count = std::getenv(name)) return std::max(1, std::atoi(count));
  return 1;
}

namespace {

pid_t launcher = 0;
volatile std::sig_atomic_t asked_to_stop = 0;

// mpiexec ends its processes, and itself as if it had not started them.
extern "C" void pass_on(int signal) {
  asked_to_stop = 1;
  kill(launcher, signal);
}

}  // namespace

int run_by_mpiexec(int count, char** argv) {
  require_module();
  std::error_code unknown;
  const std::string program = std::filesystem::read_symlink("/proc/self/exe", unknown).string(),
                    processes = std::to_string(count);
  // More processes than cores is for the user to say; they are not tied to cores that others have been given, too.
  const std::string mpiexec = find_program("mpiexec").string();
  if (mpiexec.empty())
    throw Error(Fault::Files,
                "there is no mpiexec on the PATH; ./dev petsc installs it, or start kerf with your own launcher");
  std::vector<const char*> words{mpiexec.c_str(),
                                 "--oversubscribe",
                                 "--bind-to",
                                 "none",
                                 "-n",
                                 processes.c_str(),
                                 unknown ? argv[0] : program.c_str()};
  for (char** word = argv + 1; *word; ++word) words.push_back(*word);
  words.push_back(nullptr);
  launcher = fork();
  if (launcher == 0) {
    execv(words[0], const_cast<char**>(words.data()));
    _exit(127);
  }
  if (launcher < 0) throw Error(Fault::Files, "no further process can be started");
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action = {};
    action.sa_handler = pass_on;
    sigaction(signal, &action, nullptr);
  }
  int status = 0;
  while (waitpid(launcher, &status, 0) < 0 && errno == EINTR) {
  }
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (code == 127) throw Error(Fault::Files, "mpiexec cannot be started; is openmpi-bin installed?");
  constexpr int killed = 128;
  if (asked_to_stop && (code == 1 || code > killed))
    throw Error(Fault::Numerics,
                fmt::format("stopped, and with it {} processes; what was written before stays", count));
  // kerf itself has no code 1.
  if (code == 1) throw Error(Fault::Files, "mpiexec did not start the processes; it says why above");
  if (code > killed)
    throw Error(Fault::Files,
                fmt::format("one of {} processes was killed (signal {}), which ends all of them; what was "
                            "written before stays",
                            count, code - killed));
  return code;
}

int Processes::start() {
  if (rank_ >= 0) return rank_;
  require_module();
  int rank = 0;
  if (const char* wrong = loaded().call->start(&rank, &count_)) throw Error(Fault::Usage, wrong);
  rank_ = rank;
  need(loaded().call->options(defaults));
  return rank_;
}

void Processes::serve(const std::function<void(std::string_view task, Peers&)>& with) {
  const KerfPetsc& call = *loaded().call;
  std::map<int, std::unique_ptr<Share>> shares;
  const auto next = [&call] {
    std::string bytes(call.wait(), '\0');
    call.receive(bytes.data(), bytes.size());
    return bytes;
  };
  const auto obey = [&] {
    std::string bytes = next();
    const auto what = static_cast<Order>(bytes[0]);
    int name = 0;
    std::memcpy(&name, bytes.data() + 1, sizeof name);
    bytes.erase(0, 1 + sizeof name);
    if (what == Order::Options) {
      options_ = bytes;
      need(call.options(bytes.c_str()));
    }
    if (what == Order::Make) {
      std::array<int, 2> sizes{};
      std::memcpy(sizes.data(), bytes.data(), sizeof sizes);
      shares[name] = std::make_unique<Share>(next(), sizes[0], sizes[1], rank_, count_, !options_.empty());
    }
    if (what == Order::Solve) solved(*shares.at(name), rank_, nullptr, nullptr, nullptr);  // the first one says so
    if (what == Order::Drop) shares.erase(name);
    if (what == Order::Task) {
      MpiPeers peers(rank_, count_, !options_.empty());
      with(next(), peers);
    }
    return what != Order::End;
  };
  while (together(rank_, obey)) {
  }
}

std::shared_ptr<Ranks> Processes::ranks(const std::string& options) {
  if (started_processes() == 1) {
    require_module();
    return std::make_shared<Alone>();
  }
  start();
  options_ = options;
  return std::make_shared<MpiRanks>(count_, options);
}

void Processes::work(const std::string& task, const std::function<void(Peers&)>& own) {
  const std::string head = order(Order::Task, 0);
  for (int p = 1; p < count_; ++p) {
    loaded().call->send(p, head.data(), head.size());
    loaded().call->send(p, task.data(), task.size());
  }
  MpiPeers peers(rank_, count_, !options_.empty());
  together(rank_, [&] { own(peers); });
  refuse_unused(options_);
}

Processes::~Processes() {
  if (rank_ < 0) return;
  if (rank_ == 0) {
    const std::string end = order(Order::End, 0);
    for (int p = 1; p < count_; ++p) loaded().call->send(p, end.data(), end.size());
  }
  loaded().call->finish();
}

}  // namespace kerf
