#pragma once
// [[interface]]: borders of regions as cracks.

#include "io/case/sections.hpp"

namespace kerf {

/// The tables, by their names: nothing hangs on how they stand.
std::vector<Value> interface_tables(const Value& document);

/// As cracks after those of the shape, a run of them per table, the first one of the table's name. After the regions.
void read_interfaces(const Value& document, Case& c);

}  // namespace kerf
