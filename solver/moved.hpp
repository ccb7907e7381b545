#pragma once
// A body whose mesh moves while its topology stays.

#include "kerf/model.hpp"

#include <span>

namespace kerf {

/// The vertices by nested dissection, in the order of elimination: a function of the topology alone.
std::vector<Index> vertex_sequence(const Mesh& mesh, int threads = 1);

/// `prepare` (kerf/model.hpp), bit for bit. Where `before` has the same triangles, cracks and supports, what follows
/// from these alone is taken over: the order and, unless somebody else holds it, memory and analysis of its factor.
/// `sequence`: vertex_sequence(mesh), where it is known.
Model prepare_moved(Mesh mesh, const Element& e, Scene scene, int threads, Model before,
                    std::span<const Index> sequence = {});

}  // namespace kerf
