// The module kerf_petsc.so. PETSc and MPI live here and nowhere else; ranks.cpp gets a table of functions with plain C
// data, each of which returns null or what is wrong, in words. A process gives its part of the matrix with numbers of
// its rows among all (MATIS); PETSc solves by conjugate gradients with BDDC [theory: E.30; Zampini 2016],
//   K x = b to a share of the residual that is left once the insides of the parts are solved (UIRNorm),
// where a part that nothing holds gets a shift on the diagonal of what it shares, for the set-up of the preconditioner
// alone. Sums to all go through the first process and are sent back, so that all processes have the same bits; messages
// beyond 2^30 bytes are sent in pieces, since MPI counts in int. PETSc reads no options from files or the environment
// and catches no signals. docs/theory/elements.md, "Solving in parts".

#include "app/parts/petsc_module.hpp"

#include <petscksp.h>
#include <petscmat.h>

#include <dlfcn.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
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

const char* start(int* rank, int* count) {
  // Open MPI loads parts of its own that look for its names among all that is loaded.
  dlopen("libmpi.so.40", RTLD_NOW | RTLD_GLOBAL);
  setenv("SCOTCH_PTHREAD_NUMBER", "1", 1);  // its threads would make another partition in every run
  int there = 0, level = 0;
  MPI_Initialized(&there);
  if (!there && MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &level) != MPI_SUCCESS)
    return said("MPI does not start");
  // No options from the environment or from files, no catching of signals, no talk.
  if (const PetscErrorCode code = PetscInitializeNoPointers(0, nullptr, nullptr, nullptr)) return failed(code);
  PetscPopSignalHandler();
  PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
  MPI_Comm_rank(PETSC_COMM_WORLD, rank);
  MPI_Comm_size(PETSC_COMM_WORLD, count);
  return nullptr;
}

void finish() {
  PetscOptionsClear(nullptr);
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
  std::copy_n(values, nodes, part);
  KERF_TRY(ISRestoreIndices(found, &values));
  KERF_TRY(ISDestroy(&found));
  KERF_TRY(MatPartitioningDestroy(&how));
  return MatDestroy(&graph);
}

const char* partition(int nodes, const int* start, const int* neighbors, int parts, int* part) {
  const PetscErrorCode code = scotch(nodes, start, neighbors, parts, part);
  return code ? failed(code) : nullptr;
}

const char* options(const char* words) {
  const PetscErrorCode code = PetscOptionsInsertString(nullptr, words);
  return code ? failed(code) : nullptr;
}

const char* unused(const char* words) {
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr;
  if (PetscOptionsLeftGet(nullptr, &count, &names, &values)) return nullptr;
  std::string left;
  const std::string all = std::string(" ") + words + " ";
  for (PetscInt k = 0; k < count; ++k)
    if (all.find(std::string(" -") + names[k] + " ") != std::string::npos) left += std::string("-") + names[k] + "\n";
  PetscOptionsLeftRestore(nullptr, &count, &names, &values);
  return left.empty() ? nullptr : said(left);
}

struct Solver {
  Mat matrix = nullptr;
  KSP ksp = nullptr;
  Vec right = nullptr, x = nullptr;
};

PetscErrorCode fill(const KerfPetscPart& p, Solver& s) {
  ISLocalToGlobalMapping map = nullptr;
  KERF_TRY(ISLocalToGlobalMappingCreate(PETSC_COMM_WORLD, 1, p.rows, p.number, PETSC_COPY_VALUES, &map));
  KERF_TRY(MatCreateIS(PETSC_COMM_WORLD, 1, p.owned, p.owned, p.total, p.total, map, map, &s.matrix));
  KERF_TRY(ISLocalToGlobalMappingDestroy(&map));
  Mat local = nullptr;
  KERF_TRY(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, p.rows, p.rows, p.start, p.columns, p.values, &local));
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

PetscErrorCode make_solver(const KerfPetscPart& p, double tolerance, Solver& s) {
  KERF_TRY(fill(p, s));
  KERF_TRY(KSPCreate(PETSC_COMM_WORLD, &s.ksp));
  KERF_TRY(KSPSetType(s.ksp, KSPCG));
  KERF_TRY(KSPSetOperators(s.ksp, s.matrix, s.matrix));
  PC pc = nullptr;
  KERF_TRY(KSPGetPC(s.ksp, &pc));
  KERF_TRY(PCSetType(pc, PCBDDC));
  KERF_TRY(PCBDDCSetLocalAdjacencyGraph(pc, p.rows, p.near_start, p.near_rows, PETSC_COPY_VALUES));
  constexpr int most = 500;
  KERF_TRY(KSPSetTolerances(s.ksp, tolerance, 1e-300, 1e10, most));
  // BDDC begins with what the insides of the parts do under their loads, so that the right-hand side that is left says
  // nothing of the size of the solution.
  KERF_TRY(KSPConvergedDefaultSetUIRNorm(s.ksp));
  KERF_TRY(KSPSetResidualHistory(s.ksp, nullptr, most + 1, PETSC_TRUE));
  KERF_TRY(KSPSetComputeSingularValues(s.ksp, PETSC_TRUE));
  KERF_TRY(KSPSetFromOptions(s.ksp));
  // A part that nothing holds is free to move: what BDDC inverts of it alone needs the shift, on what it shares. (BDDC
  // counts on the insides being those of the matrix.) What it made stays.
  std::vector<std::pair<int, double>> there;  // place of a value, the value
  ISLocalToGlobalMapping map = nullptr;
  KERF_TRY(MatISGetLocalToGlobalMapping(s.matrix, &map, nullptr));
  PetscInt rows = 0, *counts = nullptr, **sharing = nullptr;
  KERF_TRY(ISLocalToGlobalMappingGetNodeInfo(map, &rows, &counts, &sharing));
  for (int row = 0; row < p.rows; ++row)
    if (counts[row] > 1) {
      const auto at = std::lower_bound(p.columns + p.start[row], p.columns + p.start[row + 1], row) - p.columns;
      there.emplace_back(static_cast<int>(at), p.values[at]);
      p.values[at] += p.shift[row];
    }
  KERF_TRY(ISLocalToGlobalMappingRestoreNodeInfo(map, &rows, &counts, &sharing));
  KERF_TRY(KSPSetUp(s.ksp));
  for (const auto& [at, value] : there) p.values[at] = value;
  return KSPSetReusePreconditioner(s.ksp, PETSC_TRUE);
}

void drop(void* solver) {
  const std::unique_ptr<Solver> s(static_cast<Solver*>(solver));
  KSPDestroy(&s->ksp);
  MatDestroy(&s->matrix);
  VecDestroy(&s->right);
  VecDestroy(&s->x);
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

const char* make(const KerfPetscPart* part, double tolerance, void** solver, int* interface_rows, int* primal) {
  auto s = std::make_unique<Solver>();
  PetscErrorCode code = make_solver(*part, tolerance, *s);
  if (!code) code = read_sizes(*s, *interface_rows, *primal);
  *solver = s.release();
  return code ? failed(code) : nullptr;
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
  PetscReal largest = 1, smallest = 1, rest = 0;
  KERF_TRY(KSPGetResidualNorm(s.ksp, &rest));
  const PetscReal* history = nullptr;
  PetscInt count = 0;
  KERF_TRY(KSPGetResidualHistory(s.ksp, &history, &count));
  if (iterations > 0) KERF_TRY(KSPComputeExtremeSingularValues(s.ksp, &largest, &smallest));
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  const double seconds = MPI_Wtime() - begin, peak = peak_mb();
  double own[3] = {(petsc_send_len + petsc_isend_len - sent) / std::max<PetscInt>(iterations, 1), seconds,
                   rank == 0 ? 0 : peak};
  double most[3];
  MPI_Allreduce(own, most, 3, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  how = {static_cast<int>(iterations),
         static_cast<int>(reason),
         smallest > 0 ? largest / smallest : 0,
         count > 0 && history[0] > 0 ? rest / history[0] : 0,
         most[0],
         most[1],
         peak,
         most[2]};
  return 0;
}

const char* solve(void* solver, const double* right, double* x, KerfPetscSolved* how) {
  const PetscErrorCode code = solve_with(*static_cast<Solver*>(solver), right, x, *how);
  return code ? failed(code) : nullptr;
}

std::vector<int> offsets(const int* counts) {
  int processes = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &processes);
  std::vector<int> first(static_cast<std::size_t>(processes), 0);
  for (int p = 1; counts && p < processes; ++p) first[p] = first[p - 1] + counts[p - 1];
  return first;
}

void scatter(const double* all, const int* counts, double* own, int owned) {
  const std::vector<int> first = offsets(counts);
  MPI_Scatterv(all, counts, first.data(), MPI_DOUBLE, own, owned, MPI_DOUBLE, 0, PETSC_COMM_WORLD);
}

void gather(const double* own, int owned, double* all, const int* counts) {
  const std::vector<int> first = offsets(counts);
  MPI_Gatherv(own, owned, MPI_DOUBLE, all, counts, first.data(), MPI_DOUBLE, 0, PETSC_COMM_WORLD);
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

constexpr KerfPetsc table{start, finish, abort_all, send,    wait,   receive, partition, options, unused,
                          make,  solve,  drop,      scatter, gather, sum,     largest,   sizes,   swap};

}  // namespace

extern "C" __attribute__((visibility("default"))) const KerfPetsc* kerf_petsc() {
  return &table;
}
