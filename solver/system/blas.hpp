#pragma once
// What OpenBLAS needs of its callers.

namespace kerf {

/// Held around calls that reach the BLAS (UMFPACK). OpenBLAS takes 128 MB of address space for every thread
/// that is inside at once, keeps it, and where it gets none asks again for ever: so it is asked for before, where it
/// can be refused. Another BLAS needs nothing of it. Throws std::bad_alloc when there is too little address space.
class BlasCall {
 public:
  BlasCall();
  ~BlasCall();
  BlasCall(const BlasCall&) = delete;
  BlasCall& operator=(const BlasCall&) = delete;
};

/// Throws std::bad_alloc: an Error would be taken for a body that cannot be solved, where loops try another.
[[noreturn]] void out_of_memory();

}  // namespace kerf
