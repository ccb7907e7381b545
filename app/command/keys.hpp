#pragma once
// kerf keys: the keys of a case file for people, editors and shells.

#include "io/keys.hpp"

namespace kerf {

struct KeysRequest {
  std::string name;  // of one key or table; empty: all
  bool markdown = false, schema = false;
  std::string completion;  // of which shell
  std::string folder;      // where the files that are made from the table are made anew
};

/// The text to print. With a folder: its pages case-files/*.md (between their marks), kerf.schema.json and kerf.bash
/// are made anew. Throws Error(Usage) for an unknown name or shell, Error(Files) for a folder without case-files.
std::string keys(const KeysRequest& request, const std::vector<CommandWords>& commands);

}  // namespace kerf
