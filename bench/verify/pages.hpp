#pragma once
// The validation manual as pages of Markdown.

#include "bench/verify/verify.hpp"

namespace kerf {

/// index.md with a row per benchmark, and <id>.md: setup, source, second check, values, picture, case. The pictures lie
/// there already. Throws Error(Files).
void write_pages(const std::filesystem::path& folder, const VerifyBench& bench);

}  // namespace kerf
