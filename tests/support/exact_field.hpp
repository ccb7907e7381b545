#pragma once
// Exact plane-elastic fields. The frame of a crack: t from its start to its end, n = t turned by +90 degrees,
// s = (x - center) . t in [-half, half].

#include "kerf/scene.hpp"

#include <string>
#include <string_view>

namespace kerf::exact {

struct ExactTip {
  Vec2 at;
  double k1 = 0, k2 = 0;  // stress intensity factors, in the frame that looks out of the crack
};

/// `side` names the face when x lies on the crack: +1 the one on the side of n, -1 the other, 0 when x lies elsewhere.
/// Rigid motions are those of the tables. Close to a tip only the rounding of x itself costs digits.
struct ExactField {
  std::string name;
  Material material;
  std::function<Vec2(const Vec2& x, int side)> displacement = {};
  std::function<Mat2(const Vec2& x, int side)> stress = {};      // not finite at a singular tip itself
  std::function<double(const Vec2& x, int side)> rotation = {};  // (d2 u1 - d1 u2)/2
  std::function<Vec2(const Vec2& x)> body = {};                  // empty: zero
  // Along the crack, empty without one: jumps of the displacement, face +1 minus face -1, along n and t; -n.sigma n.
  std::function<double(double s)> opening = {}, slip = {}, pressure = {};
  std::vector<ExactTip> tips = {};              // start and end of the crack, or none
  std::vector<double> transitions = {};         // s where contact begins or ends
  std::function<int(const Vec2& x)> side = {};  // of the crack; empty: of the line through the two tips
};

bool is_open(const ExactField& field, double s);
Vec2 crack_point(const ExactField& field, double s);
/// The side of the crack (its line, its circle) that x lies on; 0 without a crack.
int side_of(const ExactField& field, const Vec2& x);
/// Topological derivative of the potential energy for a small free hole, from the stress.
double hole_derivative(const Material& material, const Mat2& stress);

/// Straight frictionless crack under the far field s_nn = p0 + p1 s, s_tt, s_tn (uniform) in its own frame; any p0, p1:
/// open, closed, or partly so. `westergaard`: s_tt grows by p0 + p1 s and s_tn by -p1 n, as in a Westergaard function
/// alone. No rotation at infinity; `rotation` is added.
struct LineCrack {
  Vec2 center = Vec2::Zero();
  double angle = 0, half = 1;  // radians
  double p0 = 0, p1 = 0, s_tt = 0, s_tn = 0;
  bool westergaard = false;
  double rotation = 0;
};
ExactField line_crack(std::string name, const Material& material, const LineCrack& crack);
LineCrack under(const Mat2& far_stress, double angle, double half = 1, const Vec2& center = Vec2::Zero());

/// Far field s_nn = p0 - p2 s^2, s_tt + p2 n^2, 0 < p0 < p2 half^2/2: open on |s| < sqrt(2 p0/p2), smooth at the tips.
/// `westergaard`: Z alone plus s_tt, s_nn = p0 - p2 (s^2 + n^2), s_tt + p0 - p2 (s^2 - 3 n^2), s_tn = 2 p2 s n.
struct LensCrack {
  Vec2 center = Vec2::Zero();
  double angle = 0, half = 1;
  double p0 = 0.25, p2 = 1, s_tt = 0;
  bool westergaard = false;
};
ExactField lens_crack(std::string name, const Material& material, const LensCrack& crack);

/// Circular hole under a pressure, uniform far stress.
ExactField kirsch(const Material& material, const Mat2& far_stress, double radius, double pressure = 0,
                  const Vec2& center = Vec2::Zero());

// Smooth fields on the unit square, mu = 1, plane strain, 0 < nu <= 1/2.
ExactField trig_field(double poisson);    // c10_trig; zero displacement on the boundary
ExactField exp_field(double poisson);     // c10_exp
ExactField wave_field(double poisson);    // `smooth_solution` of elements.json
ExactField vortex_field(double poisson);  // the manufactured solution of the bench; zero displacement on the boundary

/// `crack_cases` I, II, III, IV of elements.json, crack (-1, 0) to (1, 0) turned about the origin.
ExactField crack_case(std::string_view name, double angle = 0, const Material& material = {1, 0.1});
/// The field of a table of data/exact by the name of its file, "c01_modeI"; E = 1000, nu = 0.3 except in c10.
ExactField table_field(const std::string& id, double poisson = 0.3);

}  // namespace kerf::exact
