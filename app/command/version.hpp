#pragma once
// What `kerf --version` says.

#include <string>

namespace kerf {

/// "kerf 0.1.0", and for bug reports a line each: the compiler, the libraries, the BLAS in use, the modules that are
/// there.
std::string version_text();

}  // namespace kerf
