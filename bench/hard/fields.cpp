// Texts of case files for hard cases, and the fields that they know exactly. Numbers have 17 digits, so that the case
// is the same to the bit. The linear stress field, in coordinates (p, q) of a body that is placed, turned and scaled,
// is
//   s_pp = p/2 + 1/4,  s_qq = 3 p/2 + 3/4,  s_pq = -q/2,
// in equilibrium without body force, with displacements of degree 2 by Kolosov's kappa = 3 - 4 nu: the default element
// has it exactly at degree 1, and what a run misses of it is rounding.

#include "bench/hard/fields.hpp"

#include <fmt/format.h>

#include <cmath>

namespace kerf {

std::string decimal(double value) {
  std::string text = fmt::format("{:.17g}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string decimal(const Vec2& x) {
  return fmt::format("[{}, {}]", decimal(x.x()), decimal(x.y()));
}

std::string decimals(const std::vector<Vec2>& points) {
  std::string text;
  for (const Vec2& x : points) text += (text.empty() ? "" : ", ") + decimal(x);
  return "[" + text + "]";
}

Vec2 Placed::at(const Vec2& local) const {
  return origin + length * (Eigen::Rotation2Dd(angle) * local);
}

Vec2 Placed::local(const Vec2& x) const {
  return Eigen::Rotation2Dd(-angle) * (x - origin) / length;
}

Eigen::Vector3d linear_stress(const Placed& placed, const Vec2& x) {
  const Vec2 p = placed.local(x);
  const double sum = 2 * p.x() + 1, difference = p.x() + 0.5;
  Mat2 s;
  s << (sum - difference) / 2, -p.y() / 2, -p.y() / 2, (sum + difference) / 2;
  const Mat2 turn = Eigen::Rotation2Dd(placed.angle).toRotationMatrix();
  const Mat2 t = placed.load * (turn * s * turn.transpose());
  return {t(0, 0), t(1, 1), t(0, 1)};
}

std::string local_frame(const Placed& placed) {
  return fmt::format("[define]\nc = \"{}\"\ns = \"{}\"\np = \"((x - ({})) * c + (y - ({})) * s) / {}\"\n",
                     decimal(std::cos(placed.angle)), decimal(std::sin(placed.angle)), decimal(placed.origin.x()),
                     decimal(placed.origin.y()), decimal(placed.length));
}

std::string linear_frame(const Placed& placed) {
  return local_frame(placed) + fmt::format("q = \"((y - ({})) * c - (x - ({})) * s) / {}\"\n",
                                           decimal(placed.origin.y()), decimal(placed.origin.x()),
                                           decimal(placed.length));
}

namespace {

// [c a - s b, s a + c b] as text: a vector of the local frame.
std::string turned(const std::string& a, const std::string& b) {
  return fmt::format("[\"c * ({0}) - s * ({1})\", \"s * ({0}) + c * ({1})\"]", a, b);
}

}  // namespace

std::string linear_traction(const Placed& placed) {
  const std::string n = "(c * nx + s * ny)", m = "(c * ny - s * nx)", load = decimal(placed.load);
  return turned(fmt::format("{} * ((0.5 * p + 0.25) * {} - 0.5 * q * {})", load, n, m),
                fmt::format("{} * ((1.5 * p + 0.75) * {} - 0.5 * q * {})", load, m, n));
}

std::string linear_displacement(const Placed& placed, double young, double poisson, double turn) {
  const std::string kappa = decimal(3 - 4 * poisson),
                    factor = decimal(placed.load * placed.length * (1 + poisson) / young), by = decimal(turn);
  return turned(
      fmt::format("{} * 0.25 * ({} * (p * p - q * q + p) - 2 * (p * p + q * q) - 2 * p) - {} * q", factor, kappa, by),
      fmt::format("{} * 0.25 * ({} * (2 * p * q + q)) + {} * p", factor, kappa, by));
}

double stress_error(const HardRun& seen, const std::function<Eigen::Vector3d(const Vec2&)>& exact) {
  double worst = 0, largest = 0;
  for (const ProbeRow& row : seen.probe) {
    const Eigen::Vector3d s = exact(row.at);
    const double off = (row.stress - s).cwiseAbs().maxCoeff();
    worst = std::isfinite(off) ? std::max(worst, off) : infinity;
    largest = std::max(largest, s.cwiseAbs().maxCoeff());
  }
  return largest > 0 ? worst / largest : infinity;
}

std::string material(double young, double poisson) {
  return fmt::format("[material]\nyoung = {}\npoisson = {}\nstate = \"plane strain\"\n", decimal(young),
                     decimal(poisson));
}

std::string boundary(const std::string& on, const std::string& what) {
  return fmt::format("[[boundary]]\non = \"{}\"\n{}\n", on, what);
}

std::string outline(const std::vector<Vec2>& points, const std::vector<std::string>& sides) {
  std::string names;
  for (const std::string& side : sides) names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", side);
  return fmt::format("[domain]\noutline = {}\nsides = [{}]\n", decimals(points), names);
}

std::string probe(const std::vector<Vec2>& points) {
  return fmt::format("[[probe]]\nname = \"p\"\npoints = {}\n", decimals(points));
}

std::string mesh_and_output(double size, const std::string& more) {
  return fmt::format("[mesh]\nsize = {}\n{}[output]\nvtk = false\npng = false\nhtml = false\n", decimal(size), more);
}

}  // namespace kerf
