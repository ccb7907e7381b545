// Color tables and the range of values that they span. The linear table is viridis, the diverging one goes from blue
// over white to red: straight lines in Msh, the polar coordinates (length, saturation, hue) of CIELAB, with the hue
// turned towards the unsaturated middle [Moreland 2009],
//   M = |Lab|, s = acos(L / M), h = atan2(b, a);  M and s are linear to M = 88, s = 0, and h to h + spin.
// Limits leave out the tails: low and high are quantiles of the values at corners, each weighted by the area of its
// triangle, since stresses at tips are any size on few triangles. Where a tail would stretch the scale by a tenth or
// less it stays in. A diverging scale has 0 in its middle. Values of no size get a scale of their own.

#include "plot/figure/colors.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

using Triple = Eigen::Vector3d;

std::uint32_t packed_rgb(const Triple& rgb) {  // components 0 .. 255
  std::uint32_t out = 0xff;
  for (int k = 0; k < 3; ++k) out = out << 8 | static_cast<std::uint32_t>(std::lround(std::clamp(rgb[k], 0.0, 255.0)));
  return out;
}

Triple components_of(std::uint32_t rgb) {
  return {double(rgb >> 16 & 255), double(rgb >> 8 & 255), double(rgb & 255)};
}

/// Catmull-Rom through sixteen equally spaced colors of viridis; no more than two of 255 steps away from its full
/// table.
Colors viridis() {
  constexpr std::array<std::uint32_t, 16> knots = {0x440154, 0x481a6c, 0x472f7d, 0x414487, 0x39568c, 0x31688e,
                                                   0x2a788e, 0x23888e, 0x1f988b, 0x22a884, 0x35b779, 0x54c568,
                                                   0x7ad151, 0xa5db36, 0xd2e21b, 0xfde725};
  constexpr int last = static_cast<int>(knots.size()) - 1;
  const auto knot = [&](int i) -> Triple {
    if (i < 0) return 2 * components_of(knots[0]) - components_of(knots[1]);
    if (i > last) return 2 * components_of(knots[last]) - components_of(knots[last - 1]);
    return components_of(knots[static_cast<std::size_t>(i)]);
  };
  Colors out;
  for (int k = 0; k < 256; ++k) {
    const int i = std::min(k / 17, last - 1);  // 255 = 15 x 17
    const double t = k / 17.0 - i;
    const Triple a = knot(i - 1), b = knot(i), c = knot(i + 1), d = knot(i + 2);
    out[static_cast<std::size_t>(k)] =
        packed_rgb(b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a))));
  }
  return out;
}

// sRGB (D65) <-> CIELAB.
constexpr std::array<double, 3> white = {0.95047, 1.0, 1.08883};

Triple lab(const Triple& rgb) {
  Triple linear;
  for (int k = 0; k < 3; ++k) {
    const double c = rgb[k] / 255;
    linear[k] = c > 0.04045 ? std::pow((c + 0.055) / 1.055, 2.4) : c / 12.92;
  }
  Eigen::Matrix3d to_xyz;
  to_xyz << 0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.0721750, 0.0193339, 0.1191920, 0.9503041;
  Triple f = to_xyz * linear;
  for (int k = 0; k < 3; ++k) {
    const double c = f[k] / white[static_cast<std::size_t>(k)];
    f[k] = c > 0.008856 ? std::cbrt(c) : 7.787 * c + 16.0 / 116;
  }
  return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

Triple rgb(const Triple& lab) {
  const double y = (lab[0] + 16) / 116;
  Triple xyz(y + lab[1] / 500, y, y - lab[2] / 200);
  for (int k = 0; k < 3; ++k) {
    const double c = xyz[k];
    xyz[k] = white[static_cast<std::size_t>(k)] * (c > 0.206893 ? c * c * c : (c - 16.0 / 116) / 7.787);
  }
  Eigen::Matrix3d from_xyz;
  from_xyz << 3.2404542, -1.5371385, -0.4985314, -0.9692660, 1.8760108, 0.0415560, 0.0556434, -0.2040259, 1.0572252;
  Triple out = from_xyz * xyz;
  for (int k = 0; k < 3; ++k) {
    out[k] = 255 * (out[k] > 0.0031308 ? 1.055 * std::pow(out[k], 1 / 2.4) - 0.055 : 12.92 * out[k]);
  }
  return out;
}

/// Length, saturation angle, hue: polar coordinates of Lab, in which the two halves of the map are straight lines.
Triple msh(const Triple& lab) {
  const double m = lab.norm();
  return {m, std::acos(lab[0] / m), std::atan2(lab[2], lab[1])};
}

Triple from_msh(const Triple& c) {
  return {c[0] * std::cos(c[1]), c[0] * std::sin(c[1]) * std::cos(c[2]), c[0] * std::sin(c[1]) * std::sin(c[2])};
}

Colors cool_warm() {
  const Triple cool = msh(lab({59, 76, 192})), warm = msh(lab({180, 4, 38}));
  const double middle = 88;  // length of the white in between
  // The hue turns on the way to the unsaturated middle, or the map would seem to bend.
  const auto half = [&](const Triple& end, double direction, double t) {
    const double spin = end[1] * std::sqrt(middle * middle - end[0] * end[0]) / (end[0] * std::sin(end[1])) * direction;
    const double hue = end[2] + spin;
    return Triple((1 - t) * end[0] + t * middle, (1 - t) * end[1], (1 - t) * end[2] + t * hue);
  };
  Colors out;
  for (int k = 0; k < 256; ++k) {
    const double x = k / 255.0;
    const Triple c = x < 0.5 ? half(cool, -1, 2 * x) : half(warm, 1, 2 - 2 * x);
    out[static_cast<std::size_t>(k)] = packed_rgb(rgb(from_msh(c)));
  }
  return out;
}

struct Weighted {
  double value, weight;
};

/// The largest value with at most `below` of the weight strictly under it. Linear time.
double quantile(std::vector<Weighted>& all, double below) {
  const auto less = [](const Weighted& a, const Weighted& b) { return a.value < b.value; };
  auto first = all.begin(), last = all.end();
  while (last - first > 1) {
    const auto middle = first + (last - first) / 2;
    std::nth_element(first, middle, last, less);
    double under = 0;
    for (auto i = first; i != middle; ++i) under += i->weight;
    if (under <= below) {
      below -= under;
      first = middle;
    } else {
      last = middle;
    }
  }
  return first->value;
}

}  // namespace

const Colors& colors(Scale scale) {
  static const Colors linear = viridis(), diverging = cool_warm();
  return scale == Scale::Linear ? linear : diverging;
}

Limits limits(const Picture& picture) {
  std::vector<Weighted> all;
  all.reserve(static_cast<std::size_t>(picture.values.size()));
  double total = 0, least = infinity, most = -infinity;
  for (Eigen::Index t = 0; t < picture.values.cols(); ++t) {
    const auto& corner = picture.triangles[static_cast<std::size_t>(t)];
    const Vec2 a = picture.points[static_cast<std::size_t>(corner[0])];
    const double area = 0.5 * std::abs(cross(picture.points[static_cast<std::size_t>(corner[1])] - a,
                                             picture.points[static_cast<std::size_t>(corner[2])] - a));
    if (!picture.values.col(t).allFinite() || !std::isfinite(area)) continue;
    for (int k = 0; k < 3; ++k) {
      const double value = picture.values(k, t);
      if (picture.range && !(value >= (*picture.range)[0] && value <= (*picture.range)[1])) continue;
      least = std::min(least, value);
      most = std::max(most, value);
      all.push_back({value, area});
      total += area;
    }
  }
  if (all.empty()) return picture.scale == Scale::Linear ? Limits{0, 1, 0, 0} : Limits{-1, 1, 0, 0};
  const auto [first, last] =
      std::minmax_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  const double low = first->value, high = last->value;
  Limits out{low, high, least, most};
  const double share = std::clamp(picture.clip, 0.0, 0.49) * total;
  out.low = quantile(all, share);
  for (Weighted& w : all) w.value = -w.value;
  out.high = -quantile(all, share);
  if (picture.scale == Scale::Diverging) {
    const double reach = std::max(std::abs(out.low), std::abs(out.high)),
                 whole = std::max(std::abs(low), std::abs(high));
    out.high = whole <= 1.1 * reach ? whole : reach;
    out.low = -out.high;
  } else {
    const double span = out.high - out.low;
    if (out.low - low <= 0.1 * span) out.low = low;
    if (high - out.high <= 0.1 * span) out.high = high;
  }
  // A constant, or a constant with rounding noise, sits in the middle of a scale of its own size.
  const double size = std::max(std::abs(out.low), std::abs(out.high));
  if (!(out.high - out.low > 1e-10 * size)) {
    const double center = 0.5 * (out.low + out.high), half = size > 0 ? 0.5 * size : 1;
    out.low = center - half;
    out.high = center + half;
  }
  return out;
}

}  // namespace kerf
