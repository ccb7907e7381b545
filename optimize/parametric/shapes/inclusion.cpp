// A disc of another material: center x, y, radius, Young's modulus.

#include "optimize/parametric/shapes/round.hpp"

#include <fmt/core.h>

#include <cmath>

namespace kerf {

namespace {

using Eigen::VectorXd;

Material material_of(const Drawn& d, double young, const Problem& p) {
  return p.plane_strain ? plane_strain(young, d.poisson) : plane_stress(young, d.poisson);
}

std::vector<std::string> inclusion_names(Eigen::Index) {
  return {"x", "y", "radius", "young"};
}

bool inclusion_fits(Eigen::Index count) {
  return count == 4;
}

void check_inclusion(const Drawn& d, const Problem& p) {
  require(d.poisson > -1 && (p.plane_strain ? d.poisson <= 0.5 : d.poisson < 1), d,
          fmt::format("Poisson's ratio {:g} belongs to no material", d.poisson));
  require_radius(d);
  require(d.lower[3] > 0, d, "Young's modulus must not vanish; give it a positive lower bound");
}

// A region has no label of its own; its material goes to the place of its number.
void draw_inclusion(const Drawn& d, const VectorXd& v, const Problem& p, DrawnBody& body) {
  body.shape.regions.push_back(circle(d.name, v.head<2>(), v[2], none));
  body.scene.regions.push_back(material_of(d, v[3], p));
}

/// Some stiffnesses, at equal ratios.
Sought seek_inclusion(const Drawn& d, const Problem& p) {
  const VectorXd &l = d.lower, &u = d.upper;
  Sought s{.low = l.head<2>(), .high = u.head<2>(), .least = l[2], .most = u[2], .size = d.start[2], .variants = {}};
  for (int i = 0, last = l[3] < u[3] ? 8 : 0; i <= last; ++i) {
    Variant v{.young = last > 0 ? l[3] * std::pow(u[3] / l[3], static_cast<double>(i) / last) : l[3]};
    v.what.kind = Perturbation::Kind::Inclusion;
    v.what.inclusion = material_of(d, v.young, p);
    s.variants.push_back(v);
  }
  return s;
}

VectorXd guessed_inclusion(const Guess& g, const Drawn&) {
  return Eigen::Vector4d(g.at.x(), g.at.y(), g.size, g.young);
}

std::string inclusion_guess_in_words(const Guess& g) {
  return fmt::format("{}, young {:.3g}", radius_in_words(g), g.young);
}

}  // namespace

constinit const DrawnShape inclusion_shape{.kind = Drawn::Kind::Inclusion,
                                           .part = BodyPart::Region,
                                           .names = inclusion_names,
                                           .fits = inclusion_fits,
                                           .asks = "an inclusion has 4 variables: center x, y, radius, Young's modulus",
                                           .check = check_inclusion,
                                           .draw = draw_inclusion,
                                           .locate = locate_on_disc,
                                           .position = position_on_disc,
                                           .pull = pull_disc,
                                           .boundary = disc_boundary,
                                           .box = box_of_disc,
                                           .seek = seek_inclusion,
                                           .guessed = guessed_inclusion,
                                           .guess_in_words = inclusion_guess_in_words,
                                           .young = 3};

}  // namespace kerf
