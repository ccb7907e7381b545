#pragma once
// What both ways to optimise start from: the body without its design, what acts on it, what is minimised.

#include "geometry/mesher.hpp"
#include "solver/contact.hpp"
#include "solver/scene.hpp"
#include "topo/functional.hpp"

#include <filesystem>

namespace kerf {

struct Problem {
  Shape frame;  // fixed holes, cracks and regions included
  Scene scene;  // of the frame: a law per crack, a material per region
  Sizing sizing;
  std::string element = "bdms";
  int degree = 1;
  Functional objective;
  ContactMethod contact = ContactMethod::DualQp;
  bool plane_strain = true;  // how Young's modulus and Poisson's ratio of a drawn inclusion become a Material
  int threads = 1;
};

/// Where a loop keeps what it needs to go on. An empty path: nowhere. `fingerprint`: of the case, made by the caller; a
/// checkpoint of another one is refused with Error(Usage).
struct CheckpointPlace {
  std::filesystem::path path;
  std::string fingerprint;
  bool resume = false;  // false: what lies there is overwritten
};

}  // namespace kerf
