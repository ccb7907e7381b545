#pragma once
// What METIS takes from the process, made a matter of each thread: random numbers and signals.

namespace kerf {

/// How often METIS has seeded the generator of this thread. Where an order does not raise it, METIS draws from a
/// generator of its own, which may be one for all threads.
unsigned seeds_of_metis();

}  // namespace kerf
