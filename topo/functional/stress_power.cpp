// J = int w V^(p/2) of the von Mises stress and its p-norm (int w V^(p/2))^(1/p): density, derivative, and what a small
// change does to the density around itself [Amstutz, Novotny 2010; theory: T.17, T.18, T.19, T.34]. The local term is
// local_term of von_mises.hpp for circles; (p - 1) Phi + Psi for ellipses, Psi alone for cracks, open or closed, with
// Psi of exterior.hpp. Both are tables that depend on the material and the shape, not on the point: made once, shared
// by copies of the term and by threads. Clamped holes are refused: the stress around them is not integrable to a power.
// Derived in docs/theory/topological_derivatives.md, section "Functionals of the stress".

#include "kerf/functional.hpp"
#include "topo/formulas/exterior.hpp"
#include "topo/formulas/kind.hpp"
#include "topo/formulas/von_mises.hpp"

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>

namespace kerf {

namespace {

// Tables per material and perturbation: made when first asked for.
class Tables {
 public:
  Tables(double p, bool plane_strain) : p_(p), plane_strain_(plane_strain) {}

  const PowerTable& circle(const Perturbation& change, const Material& m) {
    return found(circles_, {m.mu, m.c, static_cast<double>(change.kind), change.inclusion.mu, change.inclusion.c},
                 [&] { return tabulate(law(m), p_, inside(change, m), law(change.inclusion)); });
  }
  const CutTable& cut(const CutShape& cut, const Material& m) {
    return found(cuts_, {law(m).share, static_cast<double>(cut.kind), cut.aspect},
                 [&] { return tabulate(law(m), p_, cut); });
  }
  VonMises law(const Material& m) const {
    return plane_strain_ ? von_mises_plane_strain(m) : VonMises{};
  }

 private:
  // References stay valid: a map does not move its entries. A table is made under the lock, so that it is made once.
  template <class Key, class Table, class Make>
  const Table& found(std::map<Key, Table>& tables, const Key& key, const Make& make) {
    const std::scoped_lock lock(mutex_);
    const auto known = tables.find(key);
    return known != tables.end() ? known->second : tables.emplace(key, make()).first->second;
  }
  double p_;
  bool plane_strain_;
  std::map<std::array<double, 5>, PowerTable> circles_;
  std::map<std::array<double, 3>, CutTable> cuts_;
  std::mutex mutex_;
};

// What a change at a point of a body adds to T, for weight 1. A directed one has its angle.
double around(Tables& tables, double p, const Perturbation& change, const FieldPoint& at) {
  switch (row(change).becomes) {
    case Becomes::Clamp:
      throw Error(Fault::Usage,
                  "functionals of the stress have no expansion for clamped holes, around which the stress is singular; "
                  "use another perturbation");
    case Becomes::Slit: {
      // Open or closed as the stress of the state presses the faces.
      const Vec2 n(-std::sin(*change.angle), std::cos(*change.angle));
      const CutShape cut{n.dot(at.stress * n) > 0 ? CutShape::Kind::Open : CutShape::Kind::Closed};
      return exterior(tables.cut(cut, at.material), at.stress, *change.angle);
    }
    case Becomes::Material:
      if (change.inclusion.mu == at.material.mu && change.inclusion.c == at.material.c) return 0;
      break;
    case Becomes::Nothing:
      if (is_directed(change))
        return (p - 1) * power(tables.law(at.material), p, at.stress) +
               exterior(tables.cut({CutShape::Kind::Ellipse, change.aspect}, at.material), at.stress, *change.angle);
  }
  return local_term(tables.circle(change, at.material), at.stress);
}

}  // namespace

// Copies of the term share the tables of its local part.
Term stress_power(double p, ScalarField weight, bool plane_strain) {
  Term term{.kind = "stress_power"};
  term.uses_stress = true;
  term.stress_power = p;
  term.uses_place = static_cast<bool>(weight);
  const auto weigh = [weight = std::move(weight)](const Vec2& x) { return weight ? weight(x) : 1; };
  const auto law = [plane_strain](const Material& m) { return plane_strain ? von_mises_plane_strain(m) : VonMises{}; };
  term.density = [=](const FieldPoint& at) {
    const double w = weigh(at.x);
    const VonMises v = law(at.material);
    return Density{.value = w * power(v, p, at.stress), .by_stress = w * power_derivative(v, p, at.stress)};
  };
  term.local = [=, tables = std::make_shared<Tables>(p, plane_strain)](const Perturbation& change,
                                                                       const FieldPoint& at) {
    const double w = weigh(at.x);
    return w == 0 ? 0 : w * around(*tables, p, change, at);
  };
  return term;
}

Term stress_pnorm(double p, ScalarField weight, bool plane_strain) {
  Term term = stress_power(p, std::move(weight), plane_strain);
  term.kind = "stress_pnorm";
  term.power = 1 / p;
  return term;
}

}  // namespace kerf
