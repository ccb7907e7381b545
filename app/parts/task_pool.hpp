#pragma once
// Tasks that several processes share.

#include "app/processes.hpp"
#include "kerf/case_file.hpp"
#include "optimize/task_pool.hpp"

namespace kerf {

/// Whether an optimization has something for several processes to do: its starts.
bool has_starts_to_share(const Case& c);

/// Of the first process: has starts tried by all, this one among them; none where there is one process.
TaskPool task_pool_of(const Case& c, Processes* processes);

/// Of the others: what the first one has begun, here or in solve_in_parts (app/parts/parts.hpp).
void work_on(const Case& c, std::string_view task, Communicator& comm);

}  // namespace kerf
