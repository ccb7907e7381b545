#pragma once
// Paths of cracks that have grown, for the manual: their points, their distances, and the picture of them over the
// points of a reference.

#include "bench/verify/manual.hpp"

namespace kerf {

/// A place "path:CRACK:WHAT" of a folder with grown.toml. WHAT: "y@x=1.5" and "x@y=1.5", where the path first passes
/// there (its length there: "s@x=1.5"); "x@end", "y@start"; "length"; "to:NAME", the largest distance of a point of
/// that reference to the path; "turned:CRACK", the largest distance of a vertex, turned by half a turn about the
/// middle between the starts of both paths (of a path and itself: between its ends), to the path of the other.
/// Throws Error(Usage) naming what is not there, Error(Files).
double read_path_number(const std::filesystem::path& folder, const std::string& where,
                        const std::vector<ManualReference>& references);

/// The body at the end of the first run, in it the paths of all runs in colors of their own, and the points of
/// references as rings. `runs`: folders of results. Throws Error(Files).
void draw_paths(const std::filesystem::path& png, const ManualEntry& entry,
                const std::vector<std::filesystem::path>& runs);

}  // namespace kerf
