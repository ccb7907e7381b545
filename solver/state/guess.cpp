// A first set for contact from another mesh of the same body: what the faces do along the share of each crack's length,
// open or closed and the sign of the slide. Contact ends between two points of that mesh, where the pressure, which
// falls like the root of the distance from the end, has fallen to nothing: with the last two pressures p_1 < p_2 at
// distance s
//   d_1 = s p_1^2/(p_2^2 - p_1^2)   [theory: C.33].
// Many cracks and large contact need few sets then. Derived in docs/theory/contact.md, section Large contact.

#include "solver/state/guess.hpp"

#include <algorithm>

namespace kerf {

namespace {

/// Every Gauss point of a crack along its path: its normal jump and the share of the length.
template <typename Visit>
void along(const Mesh& mesh, const Skeleton& s, const Kernel& k, Index crack, const Visit& visit,
           const PartOfPaths* part = nullptr) {
  double whole = 0, begin = 0;
  for (const CrackEdge& c : mesh.cracks[crack]) whole += length(mesh, c.edge);
  if (part) whole = part->whole[crack];
  const int points = s.per_edge / 2;
  for (std::size_t n = 0; n < mesh.cracks[crack].size(); ++n) {
    const CrackEdge& c = mesh.cracks[crack][n];
    const double size = length(mesh, c.edge);
    if (part) begin = part->from[crack][n];
    for (int i = 0; i < points && s.jump[c.edge] != none; ++i) {
      const int g = c.forward ? i : points - 1 - i;
      const double at = c.forward ? k.trace.s[g] : 1 - k.trace.s[g];
      visit(s.jump[c.edge] + 2 * g, (begin + at * size) / whole, size * k.trace.w[g]);
    }
    begin += size;
  }
}

struct FacePoint {
  double at, pressure;
  FaceMotion does;
};

std::vector<FacePoint> face_points(const Model& m, const Field& state, Index crack) {
  const Skeleton& s = m.inner->skeleton;
  std::vector<FacePoint> points;
  along(m.mesh, s, m.inner->kernel, crack, [&](Index normal, double at, double weight) {
    const double slide = s.frictional[normal + 1] ? state.skeleton[normal + 1] : 0;
    points.push_back({at,
                      state.force[normal] / weight,
                      {at, !(state.force[normal] > 0), static_cast<signed char>((slide > 0) - (slide < 0))}});
  });
  return points;
}

bool alike(const FaceMotion& a, const FaceMotion& b) {
  return a.open == b.open && a.slide == b.slide;
}

/// Where contact ends beyond `last`, by the pressure there and at the point before it, and before `open`.
/// p^2 is linear in the distance from the end: d_1 = s p_1^2/(p_2^2 - p_1^2), at most up to the open point. Where the
/// pressure does not fall towards the end it is put half way.
double end_of_contact(const FacePoint& before, const FacePoint& last, const FacePoint& open) {
  const double p = last.pressure * last.pressure, fall = before.pressure * before.pressure - p,
               room = open.at - last.at, step = last.at - before.at;
  if (before.does.open || !(fall > 0)) return last.at + 0.5 * room;
  return last.at + std::copysign(std::min(std::abs(step) * p / fall, std::abs(room)), room);
}

}  // namespace

ContactGuess contact_guess(const Model& m, const Field& state) {
  ContactGuess guess(m.mesh.cracks.size());
  for (Index c = 0; c < static_cast<Index>(guess.size()); ++c) {
    if (!is_unilateral(m.scene.laws[c])) continue;
    const std::vector<FacePoint> all = face_points(m, state, c);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i > 0 && alike(all[i].does, all[i - 1].does)) continue;
      FaceMotion next = all[i].does;
      next.from = i == 0 ? 0 : 0.5 * (all[i - 1].at + all[i].at);
      if (i > 1 && next.open && !all[i - 1].does.open) next.from = end_of_contact(all[i - 2], all[i - 1], all[i]);
      if (i > 0 && i + 1 < all.size() && !next.open && all[i - 1].does.open)
        next.from = end_of_contact(all[i + 1], all[i], all[i - 1]);
      guess[c].push_back(next);
    }
  }
  return guess;
}

/// A guess of another number of cracks is none.
std::vector<Motion> motions_of(const Mesh& mesh, const Skeleton& s, const Ordering& o, const Kernel& k,
                               const ContactGuess& guess, const PartOfPaths* part) {
  if (guess.size() != mesh.cracks.size()) return {};
  const Index leading = o.leading();
  std::vector<Motion> motion(o.contact_rows, Motion::Held);
  for (Index c = 0; c < static_cast<Index>(guess.size()); ++c) {
    const auto set = [&](Index normal, double at, double) {
      const auto after = std::upper_bound(guess[c].begin(), guess[c].end(), at,
                                          [](double x, const FaceMotion& f) { return x < f.from; });
      if (after == guess[c].begin()) return;
      const FaceMotion& does = *(after - 1);
      if (s.bounded[normal]) motion[o.row[normal] - leading] = does.open ? Motion::Forward : Motion::Held;
      if (s.frictional[normal + 1]) motion[o.row[normal + 1] - leading] = static_cast<Motion>(does.slide);
    };
    along(mesh, s, k, c, set, part);
  }
  return motion;
}

}  // namespace kerf
