#pragma once
// A state that no process has as a whole: each solves and writes its own part of the mesh, divided there (mesh.refine).

#include "app/run/findings.hpp"
#include "app/run/journal.hpp"
#include "solver/divided_body.hpp"

namespace kerf {

/// Of the first process: makes the mesh before it is divided, sends the others to work and works with them. Fills in
/// what `r` says of the mesh, and writes the files of fields. Throws Error(Usage) for what is not solved so.
RunState solve_in_parts(Case& c, bool with_map, Journal& journal, Result& r);

/// Of the others: their part of the task that solve_in_parts has begun.
void work_on_part(const Case& c, std::string_view task, Communicator& comm);

}  // namespace kerf
