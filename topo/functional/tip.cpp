// Functionals of one crack tip as integrals over a ring, q = 1 inside and 0 beyond it, a = the direction of the crack:
//   G   = int s : (grad u grad theta) - 1/2 s : eps div theta - f . (grad u theta),  theta = a q
//         [Destuynder, Djaoua 1981; theory: T.24],
//   K   = E'/2 int (grad u' a) . (s grad q) + (grad u a) . (s' grad q) - (s : grad u') a . grad q - q f . (grad u' a)
//         + int_faces q p sqrt(2/(pi r)) for K_I, p the pressure of contact
//         [Yau, Wang, Corten 1980; theory: T.39], with the fields s', u' of a tip under unit K,
//   K_e = sqrt(E' G).
// grad u = A s + Gamma(omega): they see stress and rotation, so that the loads of their adjoints live in the ring. K is
// linear in the state, its stress without the skew part. Derived in docs/theory/topological_derivatives.md, sections
// "Energy release rate" and "Stress intensity of a tip".

#include "topo/functional/tip.hpp"

#include "kerf/recover.hpp"
#include "solver/system.hpp"
#include "solver/tip_fields.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

struct CutOff {
  Vec2 tip;
  TipRing ring;

  double value(double r) const {
    return cut_off(ring, r);
  }
  Vec2 gradient(const Vec2& d, double r) const {
    return r > ring.inner ? Vec2(cut_off_slope(ring, r) / r * d) : Vec2(Vec2::Zero());
  }
};

Mat2 gradient_of(const FieldPoint& p, const Mat2& strain) {
  Mat2 gradient = strain;
  gradient(0, 1) += p.rotation;
  gradient(1, 0) -= p.rotation;
  return gradient;
}

/// By the gradient: through A s, A symmetric, and the rotation.
void add_by_gradient(const FieldPoint& p, const Mat2& by, Density& d) {
  d.by_stress += strain(p.material, by);
  d.by_rotation += by(0, 1) - by(1, 0);
}

Term ring_term(const char* kind, const OfTip& of, const CutOff& q, bool loaded) {
  Term term{.kind = kind};
  term.uses_stress = term.uses_rotation = true;
  term.feature = q.tip;
  term.feature_radius = q.ring.outer;
  term.tip = of;
  // With a body force q itself counts and the disc inside the ring has a density.
  term.somewhere = [=](const Vec2& center, double radius) {
    const double r = (center - q.tip).norm();
    return r - radius < q.ring.outer && (loaded || r + radius > q.ring.inner);
  };
  return term;
}

/// The integrand of G and its derivative.
Density release(const FieldPoint& p, const CutOff& q, const Vec2& along, const VectorField& body) {
  const Vec2 d = p.x - q.tip;
  const double r = d.norm();
  if (r >= q.ring.outer) return Density{};
  const Vec2 grad_q = q.gradient(d, r);
  const Mat2& s = p.stress;
  const Mat2 e = strain(p.material, s);
  const Vec2 moved = gradient_of(p, e) * along;  // du/d(along)
  const double div = along.dot(grad_q);
  const Vec2 traction = s * grad_q;
  Density g;
  g.value = moved.dot(traction) - 0.5 * s.cwiseProduct(e).sum() * div;
  // Through s in s grad q, through grad u = A s in both, and through the energy.
  g.by_stress = moved * grad_q.transpose();
  add_by_gradient(p, traction * along.transpose(), g);
  g.by_stress -= div * e;
  if (body) {
    const Vec2 force = q.value(r) * body(p.x);
    g.value -= force.dot(moved);
    add_by_gradient(p, -force * along.transpose(), g);
  }
  return g;
}

/// The integrand of K, mode 0 or 1, and its derivative.
Density intensity(const FieldPoint& p, const CutOff& q, const Vec2& along, int mode, const VectorField& body) {
  const Vec2 d = p.x - q.tip;
  const double r = d.norm();
  if (r >= q.ring.outer) return Density{};
  const Mat2 frame = (Mat2() << along.x(), -along.y(), along.y(), along.x()).finished();
  const Vec2 at = frame.transpose() * d;
  const LocalState unit = tip_fields(p.material, at, std::atan2(at.y(), at.x()))[static_cast<std::size_t>(mode)];
  const Mat2 of_unit = frame * unit.gradient * frame.transpose();
  const Vec2 grad_q = q.gradient(d, r), traction = frame * unit.stress * frame.transpose() * grad_q,
             moved = of_unit * along;
  const Mat2 s = 0.5 * (p.stress + p.stress.transpose());
  const double half = plane_modulus(p.material) / 2, div = along.dot(grad_q);
  Density k;
  k.value = half * (moved.dot(s * grad_q) + (gradient_of(p, strain(p.material, s)) * along).dot(traction) -
                    div * s.cwiseProduct(of_unit).sum());
  k.by_stress = half * (moved * grad_q.transpose() - div * of_unit);
  add_by_gradient(p, half * traction * along.transpose(), k);
  k.by_stress = 0.5 * (k.by_stress + k.by_stress.transpose()).eval();
  if (body) k.value -= half * q.value(r) * body(p.x).dot(moved);
  return k;
}

/// What a pressure between the faces does to K_I.
std::function<CrackDensity(const CrackState&)> wedging(const CutOff& q) {
  return [q](const CrackState& c) {
    const double r = (c.x - q.tip).norm();
    const double by = r > 0 ? q.value(r) * std::sqrt(2 / (pi * r)) : 0;
    return CrackDensity{.value = by * c.pressure, .by_pressure = by};
  };
}

}  // namespace

bool at_closed_tip(const Term& term, const Model& m, const Field& s) {
  if (!term.tip || term.tip->quantity != TipQuantity::OpeningMode || term.crack == none) return false;
  const std::vector<CrackEdge>& path = m.mesh.cracks[static_cast<std::size_t>(term.crack)];
  if (path.empty()) return false;
  const std::vector<CrackPoint> profile = crack_profile(m, s, term.crack);
  const auto distance = [&](const CrackPoint& p) { return (p.at - term.feature).norm(); };
  const bool at_start = distance(profile.front()) < distance(profile.back());
  const std::size_t tip = at_start ? 0 : path.size() - 1, count = std::min<std::size_t>(path.size(), 2),
                    points = count * (profile.size() / path.size());
  if (m.mesh.sides[path[tip].edge][1] >= own_triangles(m)) return false;
  const std::span<const CrackPoint> near = std::span(profile).subspan(at_start ? 0 : profile.size() - points, points);
  return std::ranges::all_of(near, [](const CrackPoint& p) { return p.status == CrackPoint::Status::Closed; });
}

Term energy_release_rate(const Vec2& tip, const Vec2& direction, const std::array<double, 2>& ring, VectorField body) {
  const CutOff q{tip, {ring[0], ring[1]}};
  const OfTip of{.along = direction.normalized()};
  Term term = ring_term("energy_release_rate", of, q, static_cast<bool>(body));
  term.density = [q, along = of.along, body = std::move(body)](const FieldPoint& p) {
    return release(p, q, along, body);
  };
  return term;
}

Term stress_intensity(const OfTip& given, const Vec2& tip, const std::array<double, 2>& ring, VectorField body,
                      Index crack) {
  const CutOff q{tip, {ring[0], ring[1]}};
  const OfTip of{given.quantity, given.along.normalized()};
  Term term = ring_term("stress_intensity", of, q, static_cast<bool>(body));
  if (of.quantity == TipQuantity::Equivalent) {
    term.power = 0.5;
    term.density = [q, along = of.along, body = std::move(body)](const FieldPoint& p) {
      const double modulus = plane_modulus(p.material);
      Density d = release(p, q, along, body);
      return Density{
          .value = modulus * d.value, .by_stress = modulus * d.by_stress, .by_rotation = modulus * d.by_rotation};
    };
    return term;
  }
  term.linear = true;
  const int mode = of.quantity == TipQuantity::SlidingMode ? 1 : 0;
  term.density = [q, mode, along = of.along, body = std::move(body)](const FieldPoint& p) {
    return intensity(p, q, along, mode, body);
  };
  if (mode == 0 && crack != none) {
    term.crack = crack;
    term.on_crack = wedging(q);
  }
  return term;
}

}  // namespace kerf
