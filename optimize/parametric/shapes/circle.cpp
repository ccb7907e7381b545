// A circular hole: center x, y, radius.

#include "optimize/parametric/shapes/round.hpp"

namespace kerf {

namespace {

using Eigen::VectorXd;

std::vector<std::string> circle_names(Eigen::Index) {
  return {"x", "y", "radius"};
}

bool circle_fits(Eigen::Index count) {
  return count == 3;
}

void check_circle(const Drawn& d, const Problem&) {
  require_radius(d);
}

void draw_circle(const Drawn& d, const VectorXd& v, const Problem&, DrawnBody& body) {
  body.shape.holes.push_back(circle(d.name, v.head<2>(), v[2], hole_label(body.shape, d.name)));
}

void add_area_of_circle(const VectorXd& v, double& area, VectorXd* gradient) {
  area += pi * v[2] * v[2];
  if (gradient) (*gradient)[2] = 2 * pi * v[2];
}

// The start's radius is what a map without data is made for.
Sought seek_circle(const Drawn& d, const Problem&) {
  return {
      .low = d.lower.head<2>(), .high = d.upper.head<2>(), .least = d.lower[2], .most = d.upper[2], .size = d.start[2]};
}

VectorXd guessed_circle(const Guess& g, const Drawn&) {
  return Eigen::Vector3d(g.at.x(), g.at.y(), g.size);
}

}  // namespace

constinit const DrawnShape circle_shape{.kind = Drawn::Kind::Circle,
                                        .part = BodyPart::Hole,
                                        .names = circle_names,
                                        .fits = circle_fits,
                                        .asks = "a circle has 3 variables: center x, y, radius",
                                        .check = check_circle,
                                        .draw = draw_circle,
                                        .locate = locate_on_disc,
                                        .position = position_on_disc,
                                        .pull = pull_disc,
                                        .add_area = add_area_of_circle,
                                        .boundary = disc_boundary,
                                        .box = box_of_disc,
                                        .seek = seek_circle,
                                        .guessed = guessed_circle,
                                        .guess_in_words = radius_in_words};

}  // namespace kerf
