// The module kerf_petsc.so. PETSc and MPI live here and nowhere else.
//
// PETSc's KSP drives all solves in parts [theory: E.36]. By default it iterates on what the parts share, a MATSHELL,
// preconditioned by kerf's BDDC, which is registered as -pc_type kerf. With another -pc_type it solves the condensed
// system of all parts: bddc and nn take it as parts (MATIS), all others as one sparse matrix (AIJ).
// A vector of shared rows has each of them twice, with the same value on both processes: all products come out twice
// as large, all ratios as they are, and no values are moved between numberings.

#include "app/parts/petsc_module.hpp"

#include <petsc/private/kspimpl.h>
#include <petsc/private/pcimpl.h>
#include <petscksp.h>
#include <petscmat.h>

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

std::string text;  // the last answer in words

const char* said(std::string words) {
  text = std::move(words);
  return text.c_str();
}

const char* failed(PetscErrorCode code) {
  const char* general = nullptr;
  char* special = nullptr;
  PetscErrorMessage(code, &general, &special);
  return said(std::string("PETSc: ") + (special && *special ? special : general ? general : "unknown failure"));
}

// The first call that fails ends the function.
#define KERF_TRY(call)                                     \
  do {                                                     \
    if (const PetscErrorCode code_ = (call)) return code_; \
  } while (0)

constexpr int tag = 77;

constexpr const char* own_type = "kerf";
PetscErrorCode create_preconditioner(PC pc);

/// What -log_view shows besides PETSc's own events: Communicator::Work, in its order.
constexpr std::array<const char*, 4> event_names{"KerfAssembly", "KerfSetUp", "KerfApply", "KerfContact"};
std::array<PetscLogEvent, event_names.size()> events{};

PetscErrorCode register_own() {
  PetscClassId own = 0;
  KERF_TRY(PetscClassIdRegister("kerf", &own));
  for (std::size_t i = 0; i < events.size(); ++i) KERF_TRY(PetscLogEventRegister(event_names[i], own, &events[i]));
  return PCRegister("kerf", create_preconditioner);
}

const char* start(int argc, const char* const* argv, int* rank, int* count) {
  // Open MPI loads parts of its own that look for its names among all that is loaded.
  dlopen("libmpi.so.40", RTLD_NOW | RTLD_GLOBAL);
  setenv("SCOTCH_PTHREAD_NUMBER", "1", 1);  // its threads would make another partition in every run
  int there = 0, level = 0;
  MPI_Initialized(&there);
  if (!there && MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &level) != MPI_SUCCESS)
    return said("MPI does not start");
  // Of a user are its words and PETSC_OPTIONS; files named .petscrc may be anybody's. No catching of signals.
  static std::vector<std::string> words;
  words = {"kerf", "-skip_petscrc", "true", "-no_signal_handler", "true"};
  words.insert(words.end(), argv, argv + argc);
  static std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  int words_count = static_cast<int>(pointers.size());
  pointers.push_back(nullptr);
  char** all = pointers.data();
  if (const PetscErrorCode code = PetscInitialize(&words_count, &all, nullptr, nullptr)) return failed(code);
  PetscPopSignalHandler();
  PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
  MPI_Comm_rank(PETSC_COMM_WORLD, rank);
  MPI_Comm_size(PETSC_COMM_WORLD, count);
  if (const PetscErrorCode code = register_own()) return failed(code);
  return nullptr;
}

void finish() {
  PetscFinalize();
  MPI_Finalize();
}

void abort_all(int code) {
  MPI_Abort(MPI_COMM_WORLD, code);
}

void send(int to, const void* bytes, std::size_t count) {
  constexpr std::size_t most = std::size_t{1} << 30;
  MPI_Send(&count, sizeof count, MPI_BYTE, to, tag, PETSC_COMM_WORLD);
  for (std::size_t at = 0; at < count; at += most)
    MPI_Send(static_cast<const char*>(bytes) + at, static_cast<int>(std::min(most, count - at)), MPI_BYTE, to, tag,
             PETSC_COMM_WORLD);
}

std::size_t wait() {
  int there = 0;
  while (true) {
    MPI_Iprobe(0, tag, PETSC_COMM_WORLD, &there, MPI_STATUS_IGNORE);
    if (there) break;
    constexpr timespec pause{0, 200000};  // MPI would look all the time
    nanosleep(&pause, nullptr);
  }
  std::size_t count = 0;
  MPI_Recv(&count, sizeof count, MPI_BYTE, 0, tag, PETSC_COMM_WORLD, MPI_STATUS_IGNORE);
  return count;
}

void receive(void* bytes, std::size_t count) {
  constexpr std::size_t most = std::size_t{1} << 30;
  for (std::size_t at = 0; at < count; at += most)
    MPI_Recv(static_cast<char*>(bytes) + at, static_cast<int>(std::min(most, count - at)), MPI_BYTE, 0, tag,
             PETSC_COMM_WORLD, MPI_STATUS_IGNORE);
}

PetscErrorCode scotch(int nodes, const int* start, const int* neighbors, int parts, int* part) {
  // PETSc frees these.
  PetscInt *i = nullptr, *j = nullptr;
  KERF_TRY(PetscMalloc1(nodes + 1, &i));
  KERF_TRY(PetscMalloc1(std::max(start[nodes], 1), &j));
  std::copy_n(start, nodes + 1, i);
  std::copy_n(neighbors, start[nodes], j);
  Mat graph = nullptr;
  KERF_TRY(MatCreateMPIAdj(PETSC_COMM_SELF, nodes, nodes, i, j, nullptr, &graph));
  MatPartitioning how = nullptr;
  KERF_TRY(MatPartitioningCreate(PETSC_COMM_SELF, &how));
  KERF_TRY(MatPartitioningSetAdjacency(how, graph));
  KERF_TRY(MatPartitioningSetType(how, MATPARTITIONINGPTSCOTCH));
  KERF_TRY(MatPartitioningSetNParts(how, parts));
  IS found = nullptr;
  KERF_TRY(MatPartitioningApply(how, &found));
  const PetscInt* values = nullptr;
  KERF_TRY(ISGetIndices(found, &values));
  std::transform(values, values + nodes, part, [](PetscInt of) { return static_cast<int>(of); });
  KERF_TRY(ISRestoreIndices(found, &values));
  KERF_TRY(ISDestroy(&found));
  KERF_TRY(MatPartitioningDestroy(&how));
  return MatDestroy(&graph);
}

const char* partition(int nodes, const int* start, const int* neighbors, int parts, int* part) {
  const PetscErrorCode code = scotch(nodes, start, neighbors, parts, part);
  return code ? failed(code) : nullptr;
}

/// An option and its value, or none.
struct Option {
  std::string name, value;
};
/// A word with a dash and a letter behind it is a name, one without a value.
std::vector<Option> options_of(const char* words) {
  std::vector<Option> all;
  std::istringstream in(words);
  for (std::string word; in >> word;)
    if (word.size() > 1 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1])) != 0)
      all.push_back({word, {}});
    else if (!all.empty())
      all.back().value = word;
  return all;
}

PetscErrorCode add_options(const char* words) {
  for (const Option& option : options_of(words)) {
    PetscBool there = PETSC_FALSE;
    KERF_TRY(PetscOptionsHasName(nullptr, nullptr, option.name.c_str(), &there));
    if (!there)
      KERF_TRY(
          PetscOptionsSetValue(nullptr, option.name.c_str(), option.value.empty() ? nullptr : option.value.c_str()));
  }
  PetscBool logs = PETSC_FALSE;
  KERF_TRY(PetscOptionsHasName(nullptr, nullptr, "-log_view", &logs));
  return logs ? PetscLogDefaultBegin() : 0;  // it is shown in the end; nothing if it has begun
}

const char* options(const char* words) {
  const PetscErrorCode code = add_options(words);
  return code ? failed(code) : nullptr;
}

/// What the end of PETSc looks at.
bool is_of_the_end(const std::string& name) {
  constexpr std::array<const char*, 8> beginnings{"options_", "log_",     "malloc", "memory_",
                                                  "info",     "objects_", "skip_",  "citations"};
  return std::any_of(beginnings.begin(), beginnings.end(), [&](const char* b) { return name.rfind(b, 0) == 0; });
}

const char* unused(const char* words) {
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr;
  if (PetscOptionsLeftGet(nullptr, &count, &names, &values)) return nullptr;
  std::string left;
  const std::string all = std::string(" ") + words + " ";
  for (PetscInt k = 0; k < count; ++k)
    if (!is_of_the_end(names[k]) && all.find(std::string(" -") + names[k] + " ") != std::string::npos)
      left += std::string("-") + names[k] + "\n";
  PetscOptionsLeftRestore(nullptr, &count, &names, &values);
  return left.empty() ? nullptr : said(left);
}

/// The value of -pc_type.
std::string preconditioner_type() {
  std::array<char, 128> type{};
  PetscBool given = PETSC_FALSE;
  PetscOptionsGetString(nullptr, nullptr, "-pc_type", type.data(), type.size(), &given);
  return given ? type.data() : own_type;
}

int by_kerf() {
  return preconditioner_type() == own_type ? 1 : 0;
}

struct Solver {
  KerfPetscShared shared{};  // of kerf's interface
  Mat matrix = nullptr;
  KSP ksp = nullptr;
  Vec right = nullptr, x = nullptr;
  std::vector<PetscInt> start, columns;  // of the part
  void* convergence = nullptr;           // of KSPConvergedDefault
  // Of a solve: the residual at its least, how many iterations ago that was; small enough, of that at first.
  double least = 0, enough = 0;
  int without = 0;
  PetscBool lanczos = PETSC_FALSE;  // whether there is an estimate of the condition
};

/// For PETSc: of integers that are ours.
std::vector<PetscInt> widened(const int* from, std::size_t count) {
  return {from, from + count};
}

// On the interface.

using SharedFunction = int (*)(void*, const double*, double*);
PetscErrorCode apply_shared(const Solver& s, SharedFunction function, Vec x, Vec y) {
  const PetscScalar* from = nullptr;
  PetscScalar* to = nullptr;
  KERF_TRY(VecGetArrayRead(x, &from));
  KERF_TRY(VecGetArrayWrite(y, &to));
  const int wrong = function(s.shared.context, from, to);
  KERF_TRY(VecRestoreArrayWrite(y, &to));
  KERF_TRY(VecRestoreArrayRead(x, &from));
  return wrong ? PETSC_ERR_USER : 0;
}
Solver* owner_of(Mat shell) {
  void* context = nullptr;
  return MatShellGetContext(shell, &context) ? nullptr : static_cast<Solver*>(context);
}
PetscErrorCode multiply_shared(Mat A, Vec x, Vec y) {
  const Solver* s = owner_of(A);
  return apply_shared(*s, s->shared.multiply, x, y);
}

// -pc_type kerf.

PetscErrorCode solver_of(PC pc, Solver*& s) {
  Mat matrix = nullptr;
  KERF_TRY(PCGetOperators(pc, nullptr, &matrix));
  PetscBool is_shell = PETSC_FALSE;
  KERF_TRY(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(matrix), MATSHELL, &is_shell));
  s = is_shell ? owner_of(matrix) : nullptr;
  if (!s) SETERRQ(PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG, "-pc_type kerf is for what kerf's parts share alone");
  return 0;
}
PetscErrorCode precondition_shared(PC pc, Vec r, Vec z) {
  Solver* s = nullptr;
  KERF_TRY(solver_of(pc, s));
  return apply_shared(*s, s->shared.precondition, r, z);
}
PetscErrorCode view_preconditioner(PC pc, PetscViewer viewer) {
  Solver* s = nullptr;
  KERF_TRY(solver_of(pc, s));
  return PetscViewerASCIIPrintf(viewer, "  BDDC of kerf: %d parts, %d unknowns of the small problem\n", s->shared.parts,
                                s->shared.primal);
}
PetscErrorCode create_preconditioner(PC pc) {
  pc->ops->apply = precondition_shared;
  pc->ops->applytranspose = precondition_shared;
  pc->ops->view = view_preconditioner;
  return 0;
}

/// PETSc's own test, and besides: where the residual is small and has not fallen for a while, rounding has ended it.
/// In the energy the first guess, the best of a space, is orthogonal to its residual r: |b|^2 = x'b + |r|^2.
PetscErrorCode converged(KSP ksp, PetscInt iteration, PetscReal norm, KSPConvergedReason* reason, void* context) {
  auto& s = *static_cast<Solver*>(context);
  constexpr int patience = 6;
  const double gain = std::sqrt(0.1);
  if (iteration == 0 && ksp->normtype == KSP_NORM_NATURAL && !ksp->guess_zero) {
    PetscScalar energy = 0;
    KERF_TRY(VecDot(ksp->vec_sol, ksp->vec_rhs, &energy));
    ksp->rnorm0 = std::sqrt(norm * norm + std::max(energy, 0.0));
    ksp->ttol = std::max(ksp->rtol * ksp->rnorm0, ksp->abstol);
    *reason = norm <= ksp->ttol ? KSP_CONVERGED_RTOL : KSP_CONVERGED_ITERATING;
  } else {
    KERF_TRY(KSPConvergedDefault(ksp, iteration, norm, reason, s.convergence));
  }
  const bool falls = iteration == 0 || norm < gain * s.least;
  s.without = falls ? 0 : s.without + 1;
  if (falls) s.least = norm;
  if (s.without >= patience && norm <= s.enough * ksp->rnorm0 && *reason == KSP_CONVERGED_ITERATING)
    *reason = KSP_CONVERGED_ITS;
  return 0;
}

/// What the options say, of which the user's go before these.
PetscErrorCode set_up(Solver& s, double tolerance, int most, bool natural, KerfPetscMade& made) {
  KERF_TRY(KSPSetTolerances(s.ksp, tolerance, 1e-300, 1e10, most));
  KERF_TRY(KSPConvergedDefaultCreate(&s.convergence));
  KERF_TRY(KSPSetConvergenceTest(s.ksp, converged, &s, nullptr));
  made.mistaken = 1;
  KERF_TRY(KSPSetFromOptions(s.ksp));
  PetscBool normed = PETSC_FALSE, in_energy = PETSC_FALSE;
  KERF_TRY(PetscOptionsHasName(nullptr, nullptr, "-ksp_norm_type", &normed));
  KERF_TRY(PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(s.ksp), &in_energy, KSPCG, KSPPIPECG, KSPPIPECGRR,
                                     KSPGROPPCG, KSPFCG, KSPPIPEFCG, KSPCR, KSPPIPECR, ""));
  if (natural && in_energy && !normed) KERF_TRY(KSPSetNormType(s.ksp, KSP_NORM_NATURAL));
  // Others have no estimate of the condition, or end in a fault when asked for it (fcg of PETSc 3.18).
  KERF_TRY(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(s.ksp), KSPCG, &s.lanczos));
  KERF_TRY(KSPSetComputeSingularValues(s.ksp, s.lanczos));
  KERF_TRY(KSPSetUp(s.ksp));
  made.mistaken = 0;
  return KSPSetReusePreconditioner(s.ksp, PETSC_TRUE);
}

PetscErrorCode make_shared_solver(const KerfPetscShared& shared, double tolerance, double enough, int most, Solver& s,
                                  KerfPetscMade& made) {
  s.shared = shared;
  s.enough = enough;
  KERF_TRY(MatCreateShell(PETSC_COMM_WORLD, shared.rows, shared.rows, PETSC_DETERMINE, PETSC_DETERMINE, &s, &s.matrix));
  KERF_TRY(MatShellSetOperation(s.matrix, MATOP_MULT, reinterpret_cast<void (*)()>(multiply_shared)));
  KERF_TRY(MatShellSetOperation(s.matrix, MATOP_MULT_TRANSPOSE, reinterpret_cast<void (*)()>(multiply_shared)));
  KERF_TRY(MatSetOption(s.matrix, MAT_SYMMETRIC, PETSC_TRUE));
  KERF_TRY(MatSetOption(s.matrix, MAT_SPD, PETSC_TRUE));
  KERF_TRY(MatCreateVecs(s.matrix, &s.x, &s.right));
  KERF_TRY(KSPCreate(PETSC_COMM_WORLD, &s.ksp));
  KERF_TRY(KSPSetType(s.ksp, KSPCG));
  KERF_TRY(KSPSetOperators(s.ksp, s.matrix, s.matrix));
  PC pc = nullptr;
  KERF_TRY(KSPGetPC(s.ksp, &pc));
  KERF_TRY(PCSetType(pc, own_type));
  // Right-hand sides of one matrix are like those before.
  KSPGuess guess = nullptr;
  KERF_TRY(KSPGetGuess(s.ksp, &guess));
  KERF_TRY(KSPGuessSetType(guess, KSPGUESSFISCHER));
  constexpr int kept = 40;
  KERF_TRY(KSPGuessFischerSetModel(guess, 1, kept));
  return set_up(s, tolerance, most, true, made);
}

const char* made_or_wrong(PetscErrorCode code, std::unique_ptr<Solver> s, void** solver) {
  *solver = s.release();
  return code ? failed(code) : nullptr;
}

const char* make_shared(const KerfPetscShared* shared, double tolerance, double enough, int most, void** solver,
                        KerfPetscMade* made) {
  auto s = std::make_unique<Solver>();
  const PetscErrorCode code = make_shared_solver(*shared, tolerance, enough, most, *s, *made);
  return made_or_wrong(code, std::move(s), solver);
}

// K of the parts.

PetscErrorCode fill(const KerfPetscPart& p, Solver& s) {
  const auto rows = static_cast<std::size_t>(p.rows);
  ISLocalToGlobalMapping map = nullptr;
  KERF_TRY(ISLocalToGlobalMappingCreate(PETSC_COMM_WORLD, 1, p.rows, widened(p.number, rows).data(), PETSC_COPY_VALUES,
                                        &map));
  KERF_TRY(MatCreateIS(PETSC_COMM_WORLD, 1, p.owned, p.owned, p.total, p.total, map, map, &s.matrix));
  KERF_TRY(ISLocalToGlobalMappingDestroy(&map));
  s.start = widened(p.start, rows + 1);
  s.columns = widened(p.columns, static_cast<std::size_t>(p.start[p.rows]));
  Mat local = nullptr;
  KERF_TRY(
      MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, p.rows, p.rows, s.start.data(), s.columns.data(), p.values, &local));
  KERF_TRY(MatSetOption(local, MAT_SYMMETRIC, PETSC_TRUE));
  KERF_TRY(MatSetOption(local, MAT_SPD, PETSC_TRUE));
  KERF_TRY(MatISSetLocalMat(s.matrix, local));
  KERF_TRY(MatDestroy(&local));
  KERF_TRY(MatAssemblyBegin(s.matrix, MAT_FINAL_ASSEMBLY));
  KERF_TRY(MatAssemblyEnd(s.matrix, MAT_FINAL_ASSEMBLY));
  KERF_TRY(MatSetOption(s.matrix, MAT_SYMMETRIC, PETSC_TRUE));
  KERF_TRY(MatSetOption(s.matrix, MAT_SPD, PETSC_TRUE));
  return MatCreateVecs(s.matrix, &s.x, &s.right);
}

// BDDC [theory: E.30]. Of what parts share, all motions go into the small problem of which the energy of a part, the
// rest relaxed, differs from their average by more than the threshold: the condition is bounded by it, whatever the
// materials, cracks and shapes of parts are.
constexpr const char* bddc_options =
    "-pc_bddc_use_local_mat_graph 0 -pc_bddc_use_faces "
    "-pc_bddc_use_deluxe_scaling -pc_bddc_adaptive_threshold 5 -sub_schurs_mat_solver_type mumps "
    "-pc_bddc_dirichlet_pc_type cholesky -pc_bddc_dirichlet_pc_factor_mat_solver_type mumps "
    "-pc_bddc_neumann_pc_type cholesky -pc_bddc_neumann_pc_factor_mat_solver_type mumps "
    "-pc_bddc_coarse_pc_type redundant";

/// A part that nothing holds is free to move: what BDDC inverts of it alone needs the shift, on what it shares. (BDDC
/// counts on the insides being those of the matrix.) Returns places of values that changed, and what they were.
PetscErrorCode shift_shared_rows(const KerfPetscPart& p, const Solver& s,
                                 std::vector<std::pair<std::ptrdiff_t, double>>& there) {
  ISLocalToGlobalMapping map = nullptr;
  KERF_TRY(MatISGetLocalToGlobalMapping(s.matrix, &map, nullptr));
  PetscInt rows = 0, *counts = nullptr, **sharing = nullptr;
  KERF_TRY(ISLocalToGlobalMappingGetNodeInfo(map, &rows, &counts, &sharing));
  for (int row = 0; row < p.rows; ++row)
    if (counts[row] > 1) {
      const auto at = std::lower_bound(p.columns + p.start[row], p.columns + p.start[row + 1], row) - p.columns;
      there.emplace_back(at, p.values[at]);
      p.values[at] += p.shift[row];
    }
  return ISLocalToGlobalMappingRestoreNodeInfo(map, &rows, &counts, &sharing);
}

PetscErrorCode make_solver(const KerfPetscPart& p, double tolerance, Solver& s, KerfPetscMade& made) {
  KERF_TRY(fill(p, s));
  const std::string type = preconditioner_type();
  const bool by_parts = type == PCBDDC || type == PCNN;
  if (!by_parts) {
    Mat sum = nullptr;
    KERF_TRY(MatConvert(s.matrix, MATAIJ, MAT_INITIAL_MATRIX, &sum));
    KERF_TRY(MatDestroy(&s.matrix));
    s.matrix = sum;
    s.start = s.columns = {};
    KERF_TRY(MatSetOption(s.matrix, MAT_SYMMETRIC, PETSC_TRUE));
    KERF_TRY(MatSetOption(s.matrix, MAT_SPD, PETSC_TRUE));
  }
  KERF_TRY(KSPCreate(PETSC_COMM_WORLD, &s.ksp));
  KERF_TRY(KSPSetType(s.ksp, KSPCG));
  KERF_TRY(KSPSetOperators(s.ksp, s.matrix, s.matrix));
  PC pc = nullptr;
  KERF_TRY(KSPGetPC(s.ksp, &pc));
  constexpr int most = 500;
  std::vector<std::pair<std::ptrdiff_t, double>> there;
  if (by_parts) {
    if (type == PCBDDC) {
      KERF_TRY(add_options(bddc_options));
      KERF_TRY(PCSetType(pc, PCBDDC));
      KERF_TRY(PCBDDCSetLocalAdjacencyGraph(
          pc, p.rows, widened(p.near_start, static_cast<std::size_t>(p.rows) + 1).data(),
          widened(p.near_rows, static_cast<std::size_t>(p.near_start[p.rows])).data(), PETSC_COPY_VALUES));
    }
    KERF_TRY(shift_shared_rows(p, s, there));
  }
  const PetscErrorCode code = set_up(s, tolerance, most, false, made);
  for (const auto& [at, value] : there) p.values[at] = value;
  if (code) return code;
  // BDDC begins with what the insides of the parts do under their loads, so that the right-hand side that is left says
  // nothing of the size of the solution.
  if (type == PCBDDC) static_cast<KSPConvergedDefaultCtx*>(s.convergence)->initialrtol = PETSC_TRUE;
  return 0;
}

void drop(void* solver) {
  const std::unique_ptr<Solver> s(static_cast<Solver*>(solver));
  KSPDestroy(&s->ksp);
  MatDestroy(&s->matrix);
  VecDestroy(&s->right);
  VecDestroy(&s->x);
  if (s->convergence) KSPConvergedDefaultDestroy(s->convergence);
}

// BDDC keeps its sizes to itself, but prints them: "Global dofs sizes: all 840 interface 112 coarse 24".
PetscErrorCode read_sizes(const Solver& s, int& interface_rows, int& primal) {
  PC pc = nullptr;
  KERF_TRY(KSPGetPC(s.ksp, &pc));
  char* words = nullptr;
  std::size_t length = 0;
  std::FILE* const file = open_memstream(&words, &length);
  if (!file) return 0;
  PetscViewer viewer = nullptr;
  KERF_TRY(PetscViewerASCIIOpenWithFILE(PETSC_COMM_WORLD, file, &viewer));
  KERF_TRY(PCView(pc, viewer));
  KERF_TRY(PetscViewerDestroy(&viewer));
  std::fclose(file);
  if (const char* at = length > 0 ? std::strstr(words, "Global dofs sizes") : nullptr) {
    int all = 0;
    if (std::sscanf(at, "Global dofs sizes: all %d interface %d coarse %d", &all, &interface_rows, &primal) != 3)
      interface_rows = primal = 0;
  }
  std::free(words);
  return 0;
}

const char* make(const KerfPetscPart* part, double tolerance, void** solver, KerfPetscMade* made) {
  auto s = std::make_unique<Solver>();
  s->enough = 1e-6;  // rounding ends the rest of it, and the rounds of the state go on from there
  PetscErrorCode code = make_solver(*part, tolerance, *s, *made);
  if (!code) code = read_sizes(*s, made->interface_rows, made->primal);
  return made_or_wrong(code, std::move(s), solver);
}

/// The largest resident memory of this process so far.
double peak_mb() {
  double kilobytes = 0;
  if (std::FILE* const status = std::fopen("/proc/self/status", "r")) {
    char line[256];
    while (std::fgets(line, sizeof line, status))
      if (std::sscanf(line, "VmHWM: %lf", &kilobytes) == 1) break;
    std::fclose(status);
  }
  return kilobytes / 1024;
}

PetscErrorCode solve_with(Solver& s, const double* right, double* x, KerfPetscSolved& how) {
  const double sent = petsc_send_len + petsc_isend_len, begin = MPI_Wtime();
  PetscScalar* values = nullptr;
  PetscInt owned = 0;
  KERF_TRY(VecGetLocalSize(s.right, &owned));
  KERF_TRY(VecGetArray(s.right, &values));
  std::copy_n(right, owned, values);
  KERF_TRY(VecRestoreArray(s.right, &values));
  KERF_TRY(KSPSolve(s.ksp, s.right, s.x));
  KERF_TRY(VecGetArray(s.x, &values));
  std::copy_n(values, owned, x);
  KERF_TRY(VecRestoreArray(s.x, &values));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  KERF_TRY(KSPGetConvergedReason(s.ksp, &reason));
  PetscInt iterations = 0;
  KERF_TRY(KSPGetIterationNumber(s.ksp, &iterations));
  PetscReal largest = 0, smallest = 0;
  if (s.lanczos && iterations > 0) KERF_TRY(KSPComputeExtremeSingularValues(s.ksp, &largest, &smallest));
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  const double seconds = MPI_Wtime() - begin, peak = peak_mb();
  double own[3] = {(petsc_send_len + petsc_isend_len - sent) / std::max<double>(iterations, 1), seconds,
                   rank == 0 ? 0 : peak};
  double most[3];
  MPI_Allreduce(own, most, 3, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  how = {.iterations = static_cast<int>(iterations),
         .diverged = reason < 0,
         .indefinite = reason == KSP_DIVERGED_INDEFINITE_PC || reason == KSP_DIVERGED_INDEFINITE_MAT ||
                       reason == KSP_DIVERGED_NANORINF || reason == KSP_DIVERGED_PC_FAILED,
         .reason = KSPConvergedReasons[reason],
         .condition = smallest > 0 ? largest / smallest : 0,
         .left = s.ksp->rnorm0 > 0 ? s.ksp->rnorm / s.ksp->rnorm0 : 0,
         .sent = most[0],
         .seconds = most[1],
         .first_mb = peak,
         .other_mb = most[2]};
  return 0;
}

const char* solve(void* solver, const double* right, double* x, KerfPetscSolved* how) {
  const PetscErrorCode code = solve_with(*static_cast<Solver*>(solver), right, x, *how);
  return code ? failed(code) : nullptr;
}

// A reduction to all may add in another order on each process.
void sum(double* values, std::size_t count) {
  constexpr std::size_t most = std::size_t{1} << 27;
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  for (std::size_t at = 0; at < count; at += most) {
    const int n = static_cast<int>(std::min(most, count - at));
    MPI_Reduce(rank == 0 ? MPI_IN_PLACE : values + at, values + at, n, MPI_DOUBLE, MPI_SUM, 0, PETSC_COMM_WORLD);
    MPI_Bcast(values + at, n, MPI_DOUBLE, 0, PETSC_COMM_WORLD);
  }
}

void largest(double* values, std::size_t count) {
  MPI_Allreduce(MPI_IN_PLACE, values, static_cast<int>(count), MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
}

void sizes(const std::size_t* to, std::size_t* from) {
  MPI_Alltoall(to, sizeof *to, MPI_BYTE, from, sizeof *from, MPI_BYTE, PETSC_COMM_WORLD);
}

void swap(const void* const* to, const std::size_t* to_count, void* const* from, const std::size_t* from_count) {
  constexpr std::size_t most = std::size_t{1} << 30;
  int rank = 0, processes = 1;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &processes);
  std::vector<MPI_Request> waiting;
  for (int p = 0; p < processes; ++p) {
    if (p == rank) {
      if (to_count[p] > 0) std::memcpy(from[p], to[p], to_count[p]);
      continue;
    }
    for (std::size_t at = 0; at < from_count[p]; at += most)
      MPI_Irecv(static_cast<char*>(from[p]) + at, static_cast<int>(std::min(most, from_count[p] - at)), MPI_BYTE, p,
                tag, PETSC_COMM_WORLD, &waiting.emplace_back());
    for (std::size_t at = 0; at < to_count[p]; at += most)
      MPI_Isend(static_cast<const char*>(to[p]) + at, static_cast<int>(std::min(most, to_count[p] - at)), MPI_BYTE, p,
                tag, PETSC_COMM_WORLD, &waiting.emplace_back());
  }
  MPI_Waitall(static_cast<int>(waiting.size()), waiting.data(), MPI_STATUSES_IGNORE);
}

/// Where nothing asked for MPI's start, nothing is logged.
void log_event(int event, int begins) {
  const PetscLogEvent of = events[static_cast<std::size_t>(event)];
  if (begins)
    PetscLogEventBegin(of, 0, 0, 0, 0);
  else
    PetscLogEventEnd(of, 0, 0, 0, 0);
}

constexpr KerfPetsc table{.start = start,
                          .finish = finish,
                          .abort = abort_all,
                          .send = send,
                          .wait = wait,
                          .receive = receive,
                          .partition = partition,
                          .options = options,
                          .unused = unused,
                          .by_kerf = by_kerf,
                          .make = make,
                          .make_shared = make_shared,
                          .solve = solve,
                          .drop = drop,
                          .log = log_event,
                          .sum = sum,
                          .largest = largest,
                          .sizes = sizes,
                          .swap = swap};

}  // namespace

extern "C" __attribute__((visibility("default"))) const KerfPetsc* kerf_petsc() {
  return &table;
}
