#pragma once
// TOML from a document.

#include "io/case/reader.hpp"

namespace kerf {

/// As few digits as read back to the same bits, and a point or an e, so that it is no integer.
std::string number(double x);

std::string quoted(const std::string& text);

/// A value as it stands behind "key = ", on one line.
std::string inline_text(const Node& node);

/// "key = value", "[key]" with its keys, or "[[key]]" for every table of a list: what stands at the top of a document.
void add_entry(const Entry& entry, std::string& out);

/// A whole document; single values first, where they have to be.
void add_entries(const std::vector<Entry>& entries, std::string& out);

}  // namespace kerf
