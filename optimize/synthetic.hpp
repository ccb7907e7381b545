#pragma once
// Measurements that are made up: the displacements of a true body on its boundary, with noise.

#include "geometry/mesher.hpp"
#include "solver/scene.hpp"
#include "topo/functional.hpp"

#include <vector>

namespace kerf {

/// The body that measurements are made up from: an inverse problem whose answer is known. Another mesh and another
/// element than those of the search: no inverse crime.
struct Synthetic {
  Shape true_shape;  // what the case draws, and what it looks for
  Scene true_scene;  // of it
  std::string element = "afw";
  int degree = 1;
  Sizing sizing;
  double noise = 0;    // standard deviation of each component at each sensor, relative to the root mean square of all
  double spacing = 0;  // of the sensors along the boundary; 0: the edge length of the mesh
  unsigned seed = 1;
  Index label = none;  // where they are measured
};

/// What sensors read, and the field between them.
struct Measurement {
  std::vector<Vec2> at, exact, displacement;  // per sensor: place, u of the true body, the same with noise
  double scale = 0;                           // root mean square of the components of `exact`
  BoundaryField field;
};

/// Sensors lie at equal distances from corner to corner of the label, both corners included. Between them the field is
/// the cubic through the next four (Catmull and Rom; parabolas at corners), so that noise is limited to the band that
/// the sensors resolve: noise at every point would have an infinite energy, and the misfit measures energies. Noise is
/// normal, independent from sensor to sensor, and none where the label ends at a support, which is known. It comes from
/// the seed by a generator of our own, the same numbers on every machine.
/// Throws Error(Usage) for an unknown label or element, Error(Numerics) when the true body cannot be solved.
Measurement measure(const Synthetic& s, int threads = 1);

/// The functional with these data for all its misfits on the label.
Functional with_measured(Functional j, Index label, const BoundaryField& measured);

/// Independent normal numbers with deviation 1: Box and Muller on mt19937, rounded to 1e-9 so that the last digit of
/// somebody's logarithm does not show.
std::vector<double> normal_numbers(unsigned seed, std::size_t count);

}  // namespace kerf
