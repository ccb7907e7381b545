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

/// What is to be printed. With a folder: case-files.md (its tables of keys), kerf.schema.json and kerf.bash in it are
/// made anew. Throws Error(Usage) for a name or a shell that there is not, Error(Files) where the folder has no
/// case-files.md.
std::string keys(const KeysRequest& request, const std::vector<CommandWords>& commands);

}  // namespace kerf
