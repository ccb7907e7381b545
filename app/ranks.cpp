#include "app/ranks.hpp"

#include "app/petsc_module.hpp"
#include "io/module.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <numeric>

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
enum class Order : char { Options, Make, Solve, Drop, End };

constexpr double tolerance = 1e-10;  // of the residual of a solve; the rounds of the state refine it

// BDDC as measured for this matrix [theory: E.30].
constexpr const char* defaults =
    "-pc_bddc_use_local_mat_graph 0 -pc_bddc_use_faces -pc_bddc_use_change_of_basis -pc_bddc_use_change_on_faces "
    "-pc_bddc_use_deluxe_scaling -sub_schurs_mat_solver_type mumps "
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

/// The part of this process in one system.
class Share {
 public:
  Share(const std::string& packed, int total) {
    const RankPart part = condensed_part(packed);
    owned_ = part.owned;
    const KerfPetscPart view{
        part.rows, part.start.data(),      part.columns.data(),   part.values.data(), part.number.data(), part.owned,
        total,     part.near_start.data(), part.near_rows.data(), part.mode_count,    part.modes.data()};
    need(loaded().call->make(&view, tolerance, &solver_));
  }
  Share(const Share&) = delete;
  Share& operator=(const Share&) = delete;
  ~Share() {
    loaded().call->drop(solver_);
  }

  /// `b`, `x`, `counts`: of the first process, of all; else null.
  KerfPetscSolved solve(const double* b, double* x, const int* counts) {
    const KerfPetsc& call = *loaded().call;
    std::vector<double> right(static_cast<std::size_t>(owned_)), own(right.size());
    KerfPetscSolved how{};
    call.scatter(b, counts, right.data(), owned_);
    need(call.solve(solver_, right.data(), own.data(), &how));
    call.gather(own.data(), owned_, x, counts);
    return how;
  }

 private:
  Index owned_ = 0;
  void* solver_ = nullptr;
};

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

  std::unique_ptr<PartedSolver> solver(std::vector<std::string> parts, std::vector<Index> owned) override {
    return std::make_unique<Solver>(shared_from_this(), std::move(parts), std::move(owned));
  }

 private:
  void tell_all(const std::string& bytes) const {
    for (int p = 1; p < count_; ++p) loaded().call->send(p, bytes.data(), bytes.size());
  }

  class Solver : public PartedSolver {
   public:
    Solver(std::shared_ptr<MpiRanks> ranks, std::vector<std::string> parts, std::vector<Index> owned)
        : ranks_(std::move(ranks)), owned_(std::move(owned)) {
      const std::scoped_lock lock(ranks_->one_at_a_time_);
      effort_.parts = ranks_->count_;
      name_ = ranks_->next_name_++;
      const int total = std::reduce(owned_.begin(), owned_.end());
      const std::string size(reinterpret_cast<const char*>(&total), sizeof total);
      for (int p = 1; p < ranks_->count_; ++p) {
        std::string& part = parts[static_cast<std::size_t>(p)];
        const std::string bytes = order(Order::Make, name_, size + part);
        part = {};
        loaded().call->send(p, bytes.data(), bytes.size());
      }
      share_ = together(0, [&] { return std::make_unique<Share>(parts[0], total); });
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
      const KerfPetscSolved how = together(0, [&] { return share_->solve(b.data(), x.data(), owned_.data()); });
      ++effort_.solves;
      effort_.iterations = std::max(effort_.iterations, how.iterations);
      effort_.condition = std::max(effort_.condition, how.condition);
      ranks_->check_options();
      constexpr double enough = 1e-6;  // rounding ends the rest of it, and the rounds of the state go on from there
      if (how.reason < 0 && !(how.left <= enough))
        throw Error(Fault::Numerics,
                    fmt::format("backend = \"petsc\": conjugate gradients do not converge on {} parts (reason {} of "
                                "KSPConvergedReason after {} iterations); use fewer parts or backend = \"cholmod\"",
                                ranks_->count_, how.reason, how.iterations));
      return x;
    }
    PartedEffort effort() const override {
      return effort_;
    }

   private:
    std::shared_ptr<MpiRanks> ranks_;
    std::vector<Index> owned_;
    int name_ = 0;
    std::unique_ptr<Share> share_;
    PartedEffort effort_;
  };

  /// After the first solve: what nothing has asked for is misspelt, or not for this solver.
  void check_options() {
    if (options_checked_) return;
    options_checked_ = true;
    if (const char* names = loaded().call->unused(options_.c_str())) {
      std::string list(names);
      list.pop_back();
      std::ranges::replace(list, '\n', ' ');
      throw Error(Fault::Usage, fmt::format("solver.petsc: PETSc has no use here for {}; its manual pages of KSPCG, "
                                            "PCBDDC and MUMPS list their options",
                                            list));
    }
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
  std::unique_ptr<PartedSolver> solver(std::vector<std::string>, std::vector<Index>) override {
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

int Processes::start() {
  if (rank_ >= 0) return rank_;
  require_module();
  int rank = 0;
  if (const char* wrong = loaded().call->start(&rank, &count_)) throw Error(Fault::Usage, wrong);
  rank_ = rank;
  need(loaded().call->options(defaults));
  return rank_;
}

void Processes::serve() {
  const KerfPetsc& call = *loaded().call;
  std::map<int, std::unique_ptr<Share>> shares;
  const auto obey = [&] {
    std::string bytes(call.wait(), '\0');
    call.receive(bytes.data(), bytes.size());
    const auto what = static_cast<Order>(bytes[0]);
    int name = 0, total = 0;
    std::memcpy(&name, bytes.data() + 1, sizeof name);
    bytes.erase(0, 1 + sizeof name);
    if (what == Order::Options) need(call.options(bytes.c_str()));
    if (what == Order::Make) {
      std::memcpy(&total, bytes.data(), sizeof total);
      shares[name] = std::make_unique<Share>(bytes.substr(sizeof total), total);
    }
    if (what == Order::Solve) shares.at(name)->solve(nullptr, nullptr, nullptr);
    if (what == Order::Drop) shares.erase(name);
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
  return std::make_shared<MpiRanks>(count_, options);
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
