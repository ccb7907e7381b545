#pragma once
// What a run will take, before it is begun: small runs of the same case on this machine, continued to its mesh.

#include "app/run.hpp"

#include <optional>

namespace kerf {

struct Forecast {
  double triangles = 0;
  bool exact = false;  // they were counted on the mesh itself
  double memory_mb = 0, seconds = 0;
  std::optional<double> single_mb = {};  // with the factor in single precision, where the case leaves that open
  bool single = false;                   // that is what it takes
  bool at_most = false;                  // an optimization or a refinement may end earlier
  bool by_one = false;                   // what one process takes, where several share the run
  double taken = 0;                      // seconds for the forecast itself
};

/// Runs the jobs on coarser meshes in a folder of their own, the largest with a twelfth of the triangles. Throws what
/// these throw; Stopped.
Forecast forecast(const Case& c, Job job, int threads);

/// Triangles by area and size alone.
double rough_triangles(const Case& c);

/// "about 94800 triangles, 0.66 GB of memory, 12 s"
std::string in_words(const Forecast& f);

/// Memory that can be had now: of the machine, or what a container is allowed.
double available_memory_mb();

struct Allowed {
  std::optional<double> memory_mb, seconds;  // as asked for; memory otherwise: what there is
};
/// Throws Error(Numerics) when it would take more, with the size that would fit. Takes the factor in single precision
/// where double does not fit.
void refuse_larger(Forecast& f, const Allowed& limits, const Case& c);

/// What the run will take, where it is asked for or limits are given; of long runs that of the state at least, for the
/// memory that there is. Throws Error(Numerics) when it is more than there is or may be used.
std::optional<Forecast> forecast_where_needed(const Case& c, Job job, int threads, const Allowed& limits,
                                              bool asked = false);

}  // namespace kerf
