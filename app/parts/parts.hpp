#pragma once
// A state that no process has as a whole: each solves and writes its own part of the mesh, divided there (mesh.refine).

#include "app/run/coarse_copy.hpp"
#include "app/run/journal.hpp"
#include "kerf/case_file.hpp"
#include "solver/divided_body.hpp"

namespace kerf {

/// Of the first process: makes the mesh before it is divided, sends the others to work and works with them. Fills in
/// mesh, solver, state, cracks, contact, functional and, where it is asked for, the map. Throws Error(Usage) for what
/// is not solved so. Returns what the page shows.
CoarseCopy solve_in_parts(const Case& c, bool with_map, Processes& processes, Journal& journal, Result& r);

/// Of the others: their part of the task that solve_in_parts has begun.
void work_on_part(const Case& c, std::string_view task, Communicator& comm);

}  // namespace kerf
