#pragma once
// The numbers of a run, and the tables of the manual. In this wing nlohmann-json lives in records.cpp.

#include "bench/verify/verify.hpp"

namespace kerf {

/// What a take of the manual names among the files of a run. Throws Error(Usage) naming what is not there.
double read_number(const std::filesystem::path& folder, const std::string& where,
                   const std::vector<ManualReference>& references = {});

void write_verify_csv(const std::filesystem::path& path, const VerifyBench& bench);
void write_verify_json(const std::filesystem::path& path, const VerifyBench& bench);

}  // namespace kerf
