// An elliptic hole: center x, y, semi-axes a, b, angle of the first (radians). A vertex of the mesh keeps its place in
// the axes, x = center + R(angle) diag(a, b) local, so that dx/dangle = R (-b local_2, a local_1) and the other
// derivatives are columns of R times local. Constraints see 64 points on it, equidistant in the parameter, and their
// derivatives. Its area is pi a b. A guess is a circular hole: the semi-axes begin equal, and the angle as the start
// has it. docs/theory/inverse.md has the guess, docs/theory/shape_gradient.md the derivative by the vertices.

#include "optimize/parametric/shapes/round.hpp"

#include <cmath>

namespace kerf {

namespace {

using Eigen::VectorXd;

Mat2 rotation(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return Mat2{{c, -s}, {s, c}};
}

Mat2 axes(const VectorXd& v) {
  return rotation(v[4]) * v.segment<2>(2).asDiagonal();
}

std::vector<std::string> ellipse_names(Eigen::Index) {
  return {"x", "y", "a", "b", "angle"};
}

bool ellipse_fits(Eigen::Index count) {
  return count == 5;
}

void check_ellipse(const Drawn& d, const Problem&) {
  require(d.lower.segment<2>(2).minCoeff() > 0, d, "the semi-axes must not vanish; give them positive lower bounds");
}

void draw_ellipse(const Drawn& d, const VectorXd& v, const Problem&, DrawnBody& body) {
  body.shape.holes.push_back(ellipse(d.name, v.head<2>(), v.segment<2>(2), v[4], hole_label(body.shape, d.name)));
}

std::function<Spot(const Vec2& x)> locate_on_ellipse(const VectorXd& v, double) {
  return locate_in(v.head<2>(), axes(v));
}

Vec2 position_on_ellipse(const Spot& spot, const VectorXd& v) {
  return v.head<2>() + axes(v) * spot.local;
}

void pull_ellipse(const Spot& spot, const VectorXd& v, const Vec2& force, Eigen::Ref<VectorXd> sum) {
  sum.head<2>() += force;
  const Mat2 turn = rotation(v[4]);
  const Vec2 scaled = v.segment<2>(2).cwiseProduct(spot.local);
  sum[2] += force.dot(turn.col(0)) * spot.local.x();
  sum[3] += force.dot(turn.col(1)) * spot.local.y();
  sum[4] += force.dot(turn * Vec2(-scaled.y(), scaled.x()));
}

void add_area_of_ellipse(const VectorXd& v, double& area, VectorXd* gradient) {
  area += pi * v[2] * v[3];
  if (gradient) gradient->segment<2>(2) = pi * Vec2(v[3], v[2]);
}

// x = c + a cos t e1 + b sin t e2, with de1/dangle = e2 and de2/dangle = -e1.
DesignCurve ellipse_boundary(const Drawn&, const VectorXd& v, bool) {
  DesignCurve c = fixed_polyline({}, true);
  const Vec2 first(std::cos(v[4]), std::sin(v[4])), second(-first.y(), first.x());
  for (Index i = 0; i < samples; ++i) {
    const double t = 2 * pi * i / samples, a = std::cos(t), b = std::sin(t);
    c.points.push_back(v.head<2>() + v[2] * a * first + v[3] * b * second);
    Eigen::Matrix2Xd by(2, 5);
    by << Mat2::Identity(), a * first, b * second, v[2] * a * second - v[3] * b * first;
    c.by.push_back(std::move(by));
  }
  return c;
}

CoordinateBox box(const Drawn& d) {
  return box_around_center(d, std::max(d.upper[2], d.upper[3]));
}

Sought seek_ellipse(const Drawn& d, const Problem&) {
  Sought s{.low = d.lower.head<2>(),
           .high = d.upper.head<2>(),
           .least = std::sqrt(d.lower[2] * d.lower[3]),
           .most = std::sqrt(d.upper[2] * d.upper[3])};
  s.size = std::sqrt(s.least * s.most);
  return s;
}

VectorXd guessed_ellipse(const Guess& g, const Drawn& d) {
  VectorXd v = d.start;
  v.head<2>() = g.at;
  v[2] = v[3] = g.size;
  return v;
}

}  // namespace

constinit const DrawnShape ellipse_shape{.kind = Drawn::Kind::Ellipse,
                                         .part = BodyPart::Hole,
                                         .names = ellipse_names,
                                         .fits = ellipse_fits,
                                         .asks = "an ellipse has 5 variables: center x, y, semi-axes, angle",
                                         .check = check_ellipse,
                                         .draw = draw_ellipse,
                                         .locate = locate_on_ellipse,
                                         .position = position_on_ellipse,
                                         .pull = pull_ellipse,
                                         .add_area = add_area_of_ellipse,
                                         .boundary = ellipse_boundary,
                                         .box = box,
                                         .seek = seek_ellipse,
                                         .guessed = guessed_ellipse,
                                         .guess_in_words = radius_in_words};

}  // namespace kerf
