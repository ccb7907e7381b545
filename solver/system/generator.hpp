#pragma once
// What METIS takes from the process, made a matter of each thread: random numbers and signals.

namespace kerf {

/// Whether libraries draw from a generator of the thread that they run in: in programs. In a module of Python they find
/// the C library's, one for all threads.
bool has_generator_per_thread();

}  // namespace kerf
