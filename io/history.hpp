#pragma once
// An optimization as tables and words.

#include "io/result.hpp"

namespace kerf {

/// Of the bounded functionals, and of the variables of a design: "h.x", "h.radius", ... (angles in radians).
OptimizeNames optimize_names(const OptimizeRequest& request);

/// The columns of history.csv: iteration, objective, merit, volume_fraction, violation, step, optimality, holes,
/// triangles, state_solves, the bounded functionals, the variables, note; and a row of it, each with its line end.
std::string history_header(const OptimizeNames& names);
std::string history_line(const Iteration& row, const OptimizeNames& names);

/// history.csv.
void write_history_csv(const std::filesystem::path& path, const std::vector<Iteration>& history,
                       const OptimizeNames& names);

/// optimize.pvd: a ParaView collection of files beside it, each with its iteration as time. Replaced as a whole.
void write_collection(const std::filesystem::path& path, const std::vector<std::pair<int, std::string>>& files);

/// One sentence: how it ended and what it reached.
std::string sentence(const OptimizeResult& result);

}  // namespace kerf
