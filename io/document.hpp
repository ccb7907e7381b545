#pragma once
// Documents: the readers of TOML and of expressions, for data files that are no cases, and cases that are no files.

#include "io/case/expression.hpp"
#include "io/case/reader.hpp"
#include "io/case/write.hpp"
#include "kerf/case_file.hpp"

namespace kerf {

/// Where a document comes from: what its case is called, where files lie that it names, how messages call the whole.
struct Origin {
  std::string name;
  std::filesystem::path folder;
  std::string place;
};

/// As read_case of a file; positions are those of the nodes.
Case read_case(Node document, const Origin& origin, std::span<const std::string> overrides = {});

/// Whether something in it is a function, which no file can have.
bool has_functions(const Node& document);

}  // namespace kerf
