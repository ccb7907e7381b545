#pragma once
// The leading rows of K, those that no contact law acts on, in parts: one for each process.

#include "solver/factor.hpp"
#include "solver/ranks.hpp"
#include "solver/system/assemble.hpp"

namespace kerf {

/// Whether the unknowns of an element live on edges alone, so that its matrix can be solved in parts.
bool can_be_parted(const Element& e);

/// Solves with the leading rows of K by `ranks`. `penalty`: System::penalty. On the two sides of a crack that parts
/// freely the unknowns are what each side sees, u and u + jump: then no part holds on to what it does not touch
/// [theory: E.30].
std::unique_ptr<LeadingSolver> parted(const Assembly& from, double penalty, std::shared_ptr<Ranks> ranks);

}  // namespace kerf
