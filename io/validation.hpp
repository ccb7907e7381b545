#pragma once
// A validation in words and as a table.

#include "io/result.hpp"

namespace kerf {

/// One sentence to quote: the expansion with its numbers, or what is wrong with it. ASCII unless the reason is not.
std::string sentence(const Validation& validation);

/// validate.csv: point (counted from 1),x,y,radius,J,J0,difference,predicted,remainder,order,coefficient,intercept,
/// on_mesh,bar,independent,c2,c2_predicted,predicted_second,remainder_second,order_second,verdict,reason.
void write_validation_csv(const std::filesystem::path& path, const ValidationResult& result);

}  // namespace kerf
