#pragma once
// Scripts for other programs that are kerf's own; the text of the files in bench/peers.

#include <string_view>

namespace kerf {

extern const std::string_view map_crack_script;
extern const std::string_view simp_trace_script;

}  // namespace kerf
