#pragma once
// A family of hard cases: one knob, a case file per value of it, the truth that its results are compared with.

#include "bench/hard.hpp"
#include "io/result.hpp"

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace kerf {

/// What is written to disk and run: a case file and the files that it names.
struct HardCase {
  std::string text;
  std::vector<std::pair<std::string, std::string>> files = {};  // name, bytes
};

/// A row of a probe's table.
struct ProbeRow {
  Vec2 at = Vec2::Zero(), displacement = Vec2::Zero();
  Eigen::Vector3d stress = Eigen::Vector3d::Zero();  // 11, 22, 12
};

/// What a run left: all its numbers, and its probe "p".
struct HardRun {
  Result result;
  std::vector<ProbeRow> probe = {};
};

/// A run beside what it is judged by: the run at the benign value of the knob, and that of the reference if there is
/// one.
struct Compared {
  const HardRun& seen;
  double knob;
  const HardRun& benign;
  const HardRun* reference = nullptr;
};

struct HardFamily {
  std::string name, title, knob;  // what is turned, as the axis of the picture says it
  std::string truth;              // what the error is against
  std::string limit;              // why so many digits may be lost
  std::vector<double> values, quick;
  double benign = 0;
  std::function<HardCase(double knob)> make = {};
  std::function<HardCase(double knob)> reference = {};  // a finer computation of another kind; empty: none
  std::function<double(const Compared& c)> error = {};  // relative
  std::function<double(double knob)> digits = {};       // that may be lost against the benign error
  double floor = 1e-13;                                 // a smaller benign error counts as this
  std::function<HardVerdict(double knob)> record = {};  // the worst that may become of a row; empty: held
  std::string why = {};                                 // and why it is not better
  std::function<std::string(double)> label = {};        // what it is called; empty: "%.3g"
};

/// All of them, in the order of the report.
const std::vector<HardFamily>& hard_families();

/// Adds a row per value: the benign one is run first, the others are judged against it.
void run_hard_family(const HardFamily& family, const BenchOptions& options, HardBench& bench);

// By what is turned.
std::vector<HardFamily> material_families();
std::vector<HardFamily> scale_families();
std::vector<HardFamily> shape_families();
std::vector<HardFamily> crack_families();
std::vector<HardFamily> contact_families();
std::vector<HardFamily> support_families();
std::vector<HardFamily> mesh_families();

}  // namespace kerf
