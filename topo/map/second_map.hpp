#pragma once
// The second term over the body: the reply of the body from samples, the rest from the fields at every point [theory:
// Q.13].

#include "kerf/second_order.hpp"
#include "topo/map/green.hpp"

namespace kerf {

struct SecondMap {
  Eigen::VectorXd c2;      // NaN where not known
  Eigen::VectorXd parts;   // the sum of its parts without their signs
  Eigen::VectorXd unsure;  // what the interpolation leaves of the reply there, and how far two discs differ
  Eigen::VectorXd clear;   // distance to the next feature
  std::string note;        // why it is not known anywhere
  double error = 0;  // of the reply by interpolation: the largest at the last samples, predicted from those before
  Index samples = 0;
};
SecondMap second_everywhere(const Analysis& a, const Functional& j, const Perturbation& p, const Candidates& points);

}  // namespace kerf
