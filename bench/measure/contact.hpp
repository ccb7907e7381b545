#pragma once
// `kerf bench contact`: what contact costs beside the same body with open cracks.

#include "bench/command/bench.hpp"
#include "kerf/types.hpp"

namespace kerf {

struct ContactRow {
  std::string family;
  double knob = 0, friction = 0;
  Index triangles = 0, unknowns = 0;   // of contact
  int sets = 0, solves = 0;            // linear ones; of the finest mesh
  double linear_s = 0, contact_s = 0;  // processor seconds without meshing; contact with its coarser meshes
  double memory_mb = 0;                // peak, less that of open cracks
  double kkt = nan;
  bool certified = false;
  std::string refused = {};  // why there is no state
  double ratio() const {
    return contact_s / linear_s;
  }
};

struct ContactBench {
  std::vector<ContactRow> rows;
  bool quick = false, stopped = false;
};

/// "unknowns": one partly closed crack, edges ever shorter; "cracks": ever more of them at random; "depth": one ever
/// closer beneath a side, pressed and pulled, and "bending": the same under a bending of the body, which leaves its
/// faces nearly unloaded. Each without and with Coulomb's friction. On one thread, open cracks and contact in one run.
/// Writes contact.csv, contact.json and contact.md. Throws Error(Files).
ContactBench run_contact_bench(const BenchOptions& options);

std::string summary(const ContactBench& bench);

/// Names that --case takes.
std::vector<std::string> contact_case_names();

}  // namespace kerf
