// The processes that mpiexec started. The first one gives the others tasks as bytes behind a letter; all of them work
// at a task by the interface of the solver, Communicator (what processes do together): sums, largest values, an
// exchange of bytes of all with all, a solver of a shared system, which is kerf's BDDC or, where options ask for it,
// PETSc's [theory: E.30; Zampini 2016]. MPI and PETSc lie behind the table of functions of petsc_module.cpp. A process
// that cannot go on ends all of them (MPI_Abort), since the others would wait for it; only what all of them find alike,
// such as a solve that does not converge, is an error that all throw. run_by_mpiexec() starts the same program as many
// processes and passes signals on to mpiexec. docs/theory/elements.md, "Solving in parts".

#include "app/processes.hpp"

#include "app/parts/petsc_module.hpp"
#include "base/kept_memory.hpp"
#include "io/module.hpp"
#include "io/words.hpp"
#include "kerf/stop.hpp"
#include "solver/factor.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
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

// What the first process tells the others; with Options these follow.
enum class Order : char { Options, Task, End };

constexpr double shift_of_shear = 1e-5;  // far above the rounding of K_p, far below what holds the body

/// One process cannot go on: none can. What all fail in the first one says, and ends the others while they wait for it.
[[noreturn]] void end_all(int rank, const std::string& words, Fault fault) {
  constexpr unsigned patience = 2;  // seconds
  if (rank > 0) {
    std::signal(SIGTERM, SIG_DFL);  // by which the launcher ends those that wait
    sleep(patience);
  }
  const std::string line = fmt::format("kerf: {}\n", words);
  [[maybe_unused]] const auto written = write(STDERR_FILENO, line.data(), line.size());
  loaded().call->abort(static_cast<int>(fault));
  _exit(static_cast<int>(fault));
}

/// What PETSc fails in on one process the others wait for.
void need(int rank, const char* wrong) {
  if (wrong) end_all(rank, wrong, Fault::Numerics);
}
/// `mistaken`: the options are what is wrong.
void need(int rank, const char* wrong, bool mistaken) {
  if (wrong && mistaken)
    end_all(rank, fmt::format("options of PETSc (solver.petsc, after --, PETSC_OPTIONS): {}", wrong), Fault::Usage);
  need(rank, wrong);
}

/// What all processes do together: one that leaves it would keep the others waiting.
template <typename Work>
auto together(int rank, const Work& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    end_all(0, fmt::format("out of memory on process {}; start more of them", rank), Fault::Numerics);
  } catch (const Error& e) {
    end_all(rank, e.what(), e.fault);
  } catch (const std::exception& e) {
    end_all(rank, e.what(), Fault::Numerics);
  }
}

/// Throws Error(Numerics), on all processes, for a solve that has not come far enough, or is not what it seems.
void require_solved(const KerfPetscSolved& how, int parts) {
  constexpr double enough = 1e-6;  // rounding ends the rest of it, and the rounds of the state go on from there
  if (how.indefinite || (how.diverged && !(how.left <= enough)))
    throw Error(Fault::Numerics,
                fmt::format("PETSc's solver ends on {} parts with {} after {} iterations, {:.1e} of the residual is "
                            "left; kerf's own preconditioner (-pc_type kerf, the default) may serve, other options of "
                            "PETSc, or backend = \"cholmod\"",
                            parts, how.reason, how.iterations, how.left));
}

/// KSP on what the parts share.
class KspIteration : public SharedIteration {
 public:
  KspIteration(SharedSystem system, int rank, int parts) : system_(std::move(system)), rank_(rank) {
    const KerfPetscShared view{.rows = static_cast<int>(system_.counted.size()),
                               .context = this,
                               .multiply = multiply,
                               .precondition = precondition,
                               .parts = parts,
                               .primal = system_.primal};
    KerfPetscMade made{};
    const char* const wrong = loaded().call->make_shared(&view, tolerance, enough, most, &solver_, &made);
    need(rank_, wrong, made.mistaken != 0);
  }
  KspIteration(const KspIteration&) = delete;
  KspIteration& operator=(const KspIteration&) = delete;
  ~KspIteration() override {
    loaded().call->drop(solver_);
  }

  SharedSolved solve(const Eigen::VectorXd& b) override {
    SharedSolved found{.x = Eigen::VectorXd::Zero(b.size())};
    KerfPetscSolved how{};
    const char* const wrong = loaded().call->solve(solver_, b.data(), found.x.data(), &how);
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
    need(rank_, wrong);
    found.iterations = how.iterations;
    found.condition = how.condition;
    found.left = how.left;
    // Where little is left, rounding makes the products of what is left with itself less than nothing.
    found.failed = how.diverged && !(how.left <= enough);
    if (how.diverged) found.ended = how.reason;
    return found;
  }

 private:
  using Map = SharedSystem::Map;
  int apply(const Map& map, const double* from, double* to) {
    try {
      const Eigen::Index n = system_.counted.size();
      Eigen::Map<Eigen::VectorXd>(to, n) = map(Eigen::Map<const Eigen::VectorXd>(from, n));
      return 0;
    } catch (...) {  // C has no exceptions
      thrown_ = std::current_exception();
      return 1;
    }
  }
  static int multiply(void* self, const double* x, double* y) {
    auto& s = *static_cast<KspIteration*>(self);
    return s.apply(s.system_.multiply, x, y);
  }
  static int precondition(void* self, const double* r, double* z) {
    auto& s = *static_cast<KspIteration*>(self);
    return s.apply(s.system_.precondition, r, z);
  }

  SharedSystem system_;
  int rank_;
  void* solver_ = nullptr;
  std::exception_ptr thrown_;
};

/// By what PETSc has for K.
class PetscSolver : public SharedSolver {
 public:
  PetscSolver(std::string packed, int total, int rank, int parts) : rank_(rank) {
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
    KerfPetscMade made{};
    const char* const wrong = loaded().call->make(&view, SharedIteration::tolerance, &solver_, &made);
    need(rank_, wrong, made.mistaken != 0);
    effort_.interface_rows = made.interface_rows;
    effort_.primal = made.primal;
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
    need(rank_, loaded().call->solve(solver_, own.data(), x.data(), &how));
    ++effort_.solves;
    if (how.diverged) {
      ++effort_.unfinished;
      effort_.ended = how.reason;
    }
    effort_.iterations = std::max(effort_.iterations, how.iterations);
    effort_.condition = std::max(effort_.condition, how.condition);
    effort_.sent = std::max(effort_.sent, how.sent);
    effort_.seconds += how.seconds;
    effort_.first_mb = how.first_mb;
    effort_.other_mb = how.other_mb;
    require_solved(how, effort_.parts);
    return x;
  }
  SharedEffort effort() const override {
    return effort_;
  }
  double stiffest() const override {
    return largest_diagonal(part_);
  }

 private:
  int rank_;
  PartMatrix part_;  // the solver looks at its matrix
  void* solver_ = nullptr;
  SharedEffort effort_;
};

/// Of the first process, after a solve: throws Error(Usage) for options that nothing has asked for. `where`: who gave
/// them.
void refuse_unused(const std::string& options, const char* where) {
  const char* names = loaded().call->unused(options.c_str());
  if (!names) return;
  std::string list(names);
  list.pop_back();
  std::ranges::replace(list, '\n', ' ');
  throw Error(
      Fault::Usage,
      fmt::format("{}: PETSc has no use here for {}; its manual pages of KSPCG, PCBDDC and MUMPS list their options{}",
                  where, list,
                  list.find("-pc_bddc") == std::string::npos ? "" : " (those of PCBDDC go with -pc_type bddc)"));
}

class MpiCommunicator : public Communicator {
 public:
  MpiCommunicator(int rank, int count) : rank_(rank), count_(count) {}
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
    if (loaded().call->by_kerf()) return Communicator::solver(std::move(packed), total, threads, precision);
    return std::make_unique<PetscSolver>(std::move(packed), total, rank_, count_);
  }
  std::unique_ptr<SharedIteration> iteration(SharedSystem system) override {
    return std::make_unique<KspIteration>(std::move(system), rank_, count_);
  }
  void log(PartsWork work, bool begins) override {
    loaded().call->log(static_cast<int>(work), begins);
  }

 private:
  int rank_, count_;
};

std::string order(Order what, std::string_view more = {}) {
  return std::string(1, static_cast<char>(what)).append(more);
}
void tell(int process, const std::string& bytes) {
  loaded().call->send(process, bytes.data(), bytes.size());
}

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

namespace {

/// The first of these that the environment has, and its number.
struct Counted {
  const char* name = nullptr;
  int count = 1;
};
Counted counted_by(std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (const char* count = std::getenv(name)) return {name, std::max(1, std::atoi(count))};
  return {};
}
/// Launchers of MPI: Open MPI, MPICH and Intel, MVAPICH.
Counted by_launcher() {
  return counted_by({"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE"});
}

}  // namespace

int started_processes() {
  return by_launcher().count;
}

bool is_launched() {
  return by_launcher().name || std::getenv("PMIX_RANK");  // srun --mpi=pmix says no number
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
  std::vector<const char*> words{mpiexec.c_str(), "--oversubscribe", "--bind-to", "none", "-n", processes.c_str()};
  if (geteuid() == 0) words.push_back("--allow-run-as-root");  // as containers do; kerf is no setuid program
  words.push_back(unknown ? argv[0] : program.c_str());
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

void Processes::require() {
  require_module();
}

int Processes::start() {
  if (rank_ >= 0) return rank_;
  require_module();
  // Of Slurm, where PETSc was asked for: one process of an srun whose MPI it does not know would be as good as alone.
  Counted by = by_launcher();
  if (!by.name && !std::getenv("PMIX_RANK")) by = counted_by({"SLURM_STEP_NUM_TASKS"});
  std::vector<const char*> words;
  for (const std::string& word : words_) words.push_back(word.c_str());
  int rank = 0;
  if (const char* wrong = loaded().call->start(static_cast<int>(words.size()), words.data(), &rank, &count_))
    throw Error(Fault::Usage, wrong);
  rank_ = rank;
  if (by.name && by.count != count_)
    throw Error(Fault::Usage, fmt::format("a launcher started {} processes ({}), and MPI knows of {}: it is not the "
                                          "launcher of the MPI that kerf uses; start kerf by the mpiexec of that one, "
                                          "or by srun --mpi=pmix",
                                          by.count, by.name, count_));
  return rank_;
}

void Processes::check_words() const {
  const std::vector<std::string>& words = words_;
  if (!words.empty() && !(words[0].size() > 1 && words[0][0] == '-' && std::isalpha(words[0][1])))
    throw Error(Fault::Usage, fmt::format("{} behind -- is no option of PETSc, which begins with a dash and a letter",
                                          quote(words[0])));
}

bool Processes::by_kerf() const {
  return loaded().call->by_kerf() != 0;
}

void Processes::end_what_waits(const std::string& words) const {
  if (at_work_ && count_ > 1) end_all(0, words, Fault::Numerics);
}

void Processes::refuse_unused_options() const {
  refuse_unused(options_, "solver.petsc");
  std::string words;
  for (const std::string& word : words_) words += word + " ";
  refuse_unused(words, "the words behind --");
}

void Processes::serve(const std::function<void(std::string_view task, Communicator&)>& with,
                      const std::function<std::optional<std::string>()>& why) {
  const KerfPetsc& call = *loaded().call;
  const auto next = [&call] {
    std::string bytes(call.wait(), '\0');
    call.receive(bytes.data(), bytes.size());
    return bytes;
  };
  const auto obey = [&] {
    const std::string bytes = next();
    const auto what = static_cast<Order>(bytes[0]);
    if (what == Order::Options) need(rank_, call.options(bytes.c_str() + 1));
    if (what == Order::Task) {
      MpiCommunicator comm(rank_, count_);
      with(next(), comm);
    }
    return what != Order::End;
  };
  try {
    while (together(rank_, obey)) {
    }
  } catch (const Stopped&) {
    const std::optional<std::string> words = why ? why() : std::nullopt;
    end_all(words ? 0 : rank_, words.value_or(fmt::format("process {} was stopped, and with it all others", rank_)),
            Fault::Numerics);
  }
}

void Processes::take_options(const std::string& options) {
  start();
  options_ = options;
  if (count_ == 1) return;  // its factor is better than any iteration
  for (int p = 1; p < count_; ++p) tell(p, order(Order::Options, options));
  need(0, loaded().call->options(options.c_str()));
}

std::vector<Index> Processes::partition(const std::vector<Index>& start, const std::vector<Index>& neighbors) const {
  std::vector<Index> part(start.size() - 1, 0);
  if (count_ > 1 && !part.empty())
    if (const char* wrong = loaded().call->partition(static_cast<int>(part.size()), start.data(), neighbors.data(),
                                                     count_, part.data()))
      throw Error(Fault::Numerics, wrong);
  return part;
}

void Processes::work(const std::string& task, const std::function<void(Communicator&)>& own) {
  for (int p = 1; p < count_; ++p) {
    tell(p, order(Order::Task));
    tell(p, task);
  }
  MpiCommunicator comm(rank_, count_);
  at_work_ = true;
  together(rank_, [&] { own(comm); });
  at_work_ = false;
  refuse_unused_options();
}

Processes::~Processes() {
  if (rank_ < 0) return;
  if (at_work_ && count_ > 1) loaded().call->abort(static_cast<int>(Fault::Numerics));
  for (int p = 1; rank_ == 0 && p < count_; ++p) tell(p, order(Order::End));
  loaded().call->finish();
}

}  // namespace kerf
