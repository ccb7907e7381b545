#pragma once
// The validation manual as data: benchmarks with published or closed-form values, one file each in
// bench/verify/cases, which travel inside the program.

#include "kerf/types.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kerf {

/// The case of a benchmark with some of its keys changed.
struct ManualRun {
  std::string name;                    // empty: the case as it is
  std::vector<std::string> overrides;  // as --set takes them
};

/// A number that kerf finds, and what it is published to be.
struct ManualValue {
  enum class Relation { Equal, AtLeast, AtMost };
  std::string name;
  std::size_t run = 0;  // in the runs of the benchmark
  // Names of numbers, and where they stand: a JSON pointer into result.json ("/cracks/0/tips/1/K_I"), a place of a path
  // that has grown (bench/verify/paths.hpp), or "probe_line.csv:ROW:COLUMN". ROW: a number from 0; max, min or last of
  // the column; "a=1.5", linear between the rows beside that value of a column. With "c:end@" before it, of growth.csv
  // the rows of that tip alone.
  struct Take {
    std::string name, where;
    std::size_t run = 0;  // that of the value, unless the text begins with "@name of a run "
  };
  std::vector<Take> takes;
  std::string quantity;             // an expression in those names
  std::optional<double> published;  // none: a number that kerf is the first to print
  std::string formula;              // the expression that `published` was given as; empty: it was given as a number
  double tolerance = 0;             // relative, or of the value itself when `absolute`
  bool absolute = false;
  Relation relation = Relation::Equal;
  std::string reason;  // for the tolerance
};

/// Points of a path by somebody else.
struct ManualReference {
  std::string name;   // without blanks: of places
  std::string title;  // in the picture
  std::vector<Vec2> points;
};

struct ManualEntry {
  std::string id, title, group, setup;
  std::string source;      // where the value is published, so that a reader finds it
  std::string check;       // what else confirms it: a second source, or a computation of another kind
  std::string impossible;  // why kerf cannot run it; empty: it can
  std::string picture;     // the picture of the first run that the page shows; "paths": of cracks that have grown
  std::string case_text;
  bool quick = false;
  std::vector<ManualRun> runs;     // at least one
  std::vector<std::string> again;  // overrides of a second, usually coarser computation: the error bar
  std::vector<ManualValue> values;
  std::vector<ManualReference> references;
};

/// The names of the files, in alphabetical order; they are the ids.
std::vector<std::string> manual_ids();

/// A benchmark by its file. Throws Error(Usage) naming file, line and what is wrong or missing, Error(Files).
ManualEntry read_manual_file(const std::filesystem::path& path);

/// One of those that travel inside the program; its file is put into `folder` to be read.
ManualEntry read_manual(const std::string& id, const std::filesystem::path& folder);

/// The value of an expression in named numbers and pi. Throws Error(Usage).
double value_of(const std::string& expression, const std::vector<std::pair<std::string, double>>& numbers = {});

}  // namespace kerf
