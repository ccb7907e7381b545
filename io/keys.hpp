#pragma once
// The keys of a case file for people, editors and shells, all from one table.

#include <string>
#include <string_view>
#include <vector>

namespace kerf {

/// Plain text of at most 100 columns: all keys, or one key or table ("mesh", "mesh.size", "hole[].circle", "size").
/// Throws Error(Usage) for a name that there is not, with the nearest one.
std::string keys_as_text(std::string_view name = {});

/// The tables of keys in Markdown. `tables`: those of the document, "mesh"; empty: all.
std::string keys_as_markdown(const std::vector<std::string>& tables = {});

/// A document with its tables of keys made anew: what stands between lines `<!-- keys: mesh solver -->` and
/// `<!-- end of keys -->`. Throws Error(Usage) where a line of the second kind is missing.
std::string with_key_tables(std::string_view document);

/// A JSON Schema, draft 2020-12, of case files, for editors.
std::string keys_as_schema();

/// A command of the program and its options, "--set".
struct CommandWords {
  std::string name;
  std::vector<std::string> options;
};

/// A script for bash that completes commands, options, case files and the keys after --set.
std::string keys_as_completion(const std::vector<CommandWords>& commands);

}  // namespace kerf
