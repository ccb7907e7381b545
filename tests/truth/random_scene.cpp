// Case files from a seed: star-shaped bodies, cracks, materials and loads that nobody chose. The standard's generator
// with distributions of our own gives the same scenes on every machine.

#include "tests/truth/random_scene.hpp"

#include "kerf/types.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

namespace kerf {

namespace {

/// Numbers of our own: the distributions of the standard differ between libraries.
class Dice {
 public:
  explicit Dice(unsigned seed) : bits_(seed) {
    bits_.discard(64);
  }
  double between(double a, double b) {
    return a + (b - a) * (static_cast<double>(bits_()) / 4294967296.0);
  }
  int below(int n) {
    return static_cast<int>(between(0, n));
  }
  bool chance(double share) {
    return between(0, 1) < share;
  }

 private:
  std::mt19937 bits_;
};

std::string point(const Vec2& x) {
  return fmt::format("[{:.6f}, {:.6f}]", x.x(), x.y());
}

std::string path(const std::vector<Vec2>& points) {
  std::string out;
  for (const Vec2& x : points) out += (out.empty() ? "" : ", ") + point(x);
  return "[" + out + "]";
}

/// A function of the place s along the side from a to b, s = 0 .. 1, in the words of a case file.
std::string load(Dice& dice, const Vec2& a, const Vec2& b) {
  const Vec2 d = (b - a) / (b - a).squaredNorm();
  const std::string s = fmt::format("((x - {:.6f})*{:.6f} + (y - {:.6f})*{:.6f})", a.x(), d.x(), a.y(), d.y());
  const double size = dice.between(-2, 2), at = dice.between(0.1, 0.9);
  switch (dice.below(7)) {
    case 0:
    case 1:
      return fmt::format("{:.4f}", size);
    case 2:
      return fmt::format("{:.4f} + {:.4f}*{}", size, dice.between(-2, 2), s);
    case 3:
      return fmt::format("{} < {:.4f} ? {:.4f} : 0", s, at, size);
    case 4:
      return fmt::format("abs({} - {:.4f}) < {:.5f} ? {:.4f} : 0", s, at, dice.between(0.002, 0.1), 5 * size);
    case 5:
      return fmt::format("{:.4f}*exp(-({} - {:.4f})^2/{:.6f})", 2 * size, s, at, dice.between(1e-4, 1e-2));
    default:
      return fmt::format("{:.4f}*abs({} - {:.4f})^{:.2f}", size, s, at, dice.between(0.3, 0.9));
  }
}

std::vector<Vec2> star(Dice& dice) {
  const int n = 4 + dice.below(4);
  const double turn = dice.between(0, 2 * pi), flat = dice.between(0.5, 1);
  std::vector<Vec2> points;
  for (int k = 0; k < n; ++k) {
    const double angle = turn + 2 * pi * (k + dice.between(-0.2, 0.2)) / n, r = dice.between(0.75, 1.1);
    points.push_back({r * std::cos(angle), flat * r * std::sin(angle)});
  }
  return points;
}

std::string boundary(Dice& dice, const std::vector<Vec2>& outline) {
  const int n = static_cast<int>(outline.size()), held = dice.below(n);
  std::string out = fmt::format("[[boundary]]\non = \"s{}\"\ndisplacement = [0, 0]\n", held);
  const int loads = 1 + dice.below(2);
  for (int k = 0; k < loads; ++k) {
    const int side = (held + 1 + (n / 2 + k) % (n - 1)) % n;
    const Vec2 &a = outline[static_cast<std::size_t>(side)], &b = outline[static_cast<std::size_t>((side + 1) % n)];
    const std::string first = load(dice, a, b);
    out += fmt::format("[[boundary]]\non = \"s{}\"\ntraction = [\"{}\", \"{}\"]\n", side, first, load(dice, a, b));
  }
  if (dice.chance(0.2)) {
    const double at = dice.between(-0.3, 0.3);
    out += fmt::format("[body]\nforce = [\"{:.3f}\", \"{}\"]\n", dice.between(-1, 1),
                       dice.chance(0.5) ? fmt::format("x < {:.3f} ? {:.3f} : 0", at, dice.between(-1, 1))
                                        : fmt::format("{:.3f}*x*y", dice.between(-1, 1)));
  }
  return out;
}

}  // namespace

std::string random_scene(unsigned seed) {
  Dice dice(seed);
  const std::vector<Vec2> outline = star(dice);
  std::string sides;
  for (std::size_t k = 0; k < outline.size(); ++k) sides += fmt::format("{}\"s{}\"", k > 0 ? ", " : "", k);
  std::string out = fmt::format("[domain]\noutline = {}\nsides = [{}]\n", path(outline), sides);
  constexpr double low = -0.18, high = 0.18;  // holes, cracks and regions lie in squares of their own
  const std::vector<Vec2> middle = {{-0.2, 0}, {0.2, 0}};
  for (int k = 0; k < 2; ++k) {
    const Vec2& c = middle[static_cast<std::size_t>(k)];
    const auto inside = [&] { return Vec2(c + Vec2(dice.between(low, high), dice.between(0.8 * low, 0.8 * high))); };
    switch (dice.below(4)) {
      case 0: {
        Vec2 a = inside(), b = inside();
        while ((b - a).norm() < 0.12) b = inside();
        static constexpr const char* laws[] = {"unilateral", "unilateral", "open", "bonded"};
        out += fmt::format("[[crack]]\nname = \"c{}\"\npath = {}\ncontact = \"{}\"\n", k, path({a, b}),
                           laws[dice.below(4)]);
        break;
      }
      case 1: {
        const double r = dice.between(0.03, 0.12);
        out += fmt::format("[[hole]]\nname = \"h{}\"\npolygon = {}\n", k,
                           path({c + Vec2(-r, -r), c + Vec2(r, -r), c + Vec2(r, r), c + Vec2(-r, r)}));
        break;
      }
      case 2: {
        const double r = dice.between(0.05, 0.15);
        out += fmt::format("[[region]]\nname = \"r{}\"\npolygon = {}\nyoung = {:.4f}\npoisson = 0.2\n", k,
                           path({c + Vec2(-r, -r), c + Vec2(r, -r), c + Vec2(0, r)}), dice.between(0.1, 10));
        break;
      }
      default:
        break;
    }
  }
  static constexpr double poisson[] = {0.0, 0.3, 0.3, 0.45, 0.4999, 0.5};
  out += fmt::format("[material]\nyoung = 100\npoisson = {}\n", poisson[dice.below(6)]);
  return out + boundary(dice, outline);
}

unsigned number(const char* name, unsigned otherwise) {
  const char* text = std::getenv(name);
  return text ? static_cast<unsigned>(std::strtoul(text, nullptr, 10)) : otherwise;
}

}  // namespace kerf
