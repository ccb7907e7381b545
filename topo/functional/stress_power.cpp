#include "kerf/functional.hpp"
#include "topo/formulas/kind.hpp"
#include "topo/formulas/von_mises.hpp"

#include <map>
#include <memory>
#include <mutex>

namespace kerf {

namespace {

// One table per material, perturbation and kind: made when first asked for.
class Tables {
 public:
  Tables(double p, bool plane_strain) : p_(p), plane_strain_(plane_strain) {}

  const PowerTable& operator()(const Perturbation& change, const Material& m) {
    const std::array<double, 5> key{m.mu, m.c, static_cast<double>(change.kind), change.inclusion.mu,
                                    change.inclusion.c};
    const std::scoped_lock lock(mutex_);
    const auto found = tables_.find(key);
    if (found != tables_.end()) return found->second;
    return tables_.emplace(key, tabulate(law(m), p_, inside(change, m), law(change.inclusion))).first->second;
  }

 private:
  VonMises law(const Material& m) const {
    return plane_strain_ ? von_mises_plane_strain(m) : VonMises{};
  }
  double p_;
  bool plane_strain_;
  std::map<std::array<double, 5>, PowerTable> tables_;
  std::mutex mutex_;
};

}  // namespace

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
    if (!row(change).inside)
      throw Error(
          Fault::Usage,
          "functionals of the stress have expansions for circular holes and inclusions only; use perturbation = "
          "\"hole\" or { young, poisson }");
    if (row(change).becomes == Becomes::Material && change.inclusion.mu == at.material.mu &&
        change.inclusion.c == at.material.c)
      return 0.0;
    return local_term((*tables)(change, at.material), at.stress, weigh(at.x));
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
