// Integrals of a Term over body, boundary and crack, their derivative by the unknowns, and their change.
//   I = int_body j(x, s, u*, omega) + int_label b(x, n, m) ds + int_crack c(x, [m]_n, p) ds + edge_crack_norm.cpp
// s and omega are the element's own, u* is recovered [theory: R.1], m the trace, pressures are forces over lengths at
// the Gauss points of the trace. The derivative is exact for the quadrature of the value: densities are differentiated
// at the same points and go back through the transposes of the evaluations, u* through that of its recovery. Changes of
// J by a change of the state are summed density by density, j(z + w) - j(z), so that small ones keep their digits
// [theory: V.6]. Beside a singular field in closed form, triangles and edges are divided until they are small against
// their distance from it [theory: T.30]. Of a part of a body all triangles are evaluated and own ones summed, in the
// order of the triangles: no sum depends on the number of threads.

#include "topo/functional/integrate.hpp"
#include "kerf/adjoint.hpp"
#include "solver/recovery.hpp"
#include "solver/system.hpp"
#include "topo/functional/edge_crack_norm.hpp"
#include "topo/functional/places.hpp"

#include "base/parallel.hpp"
#include "geometry/plane.hpp"
#include "kerf/recover.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kerf {

namespace {

struct Sampled {
  Points x;
  const Material& material;
  Fields fields = {};  // displacement: u*
};
struct InTriangle {
  Index t;
  const Triangle& shape;
  const Points& x;
  double eigenstrain = 0;  // Field::eigenstrain
};
// Fields that the term does not use stay empty.
Sampled sample(const Term& term, const Model& m, const Eigen::Ref<const Eigen::VectorXd>& interior,
               const InTriangle& at) {
  Sampled p{at.x, material_of(m.mesh, m.scene, at.t)};
  if (term.uses_stress || term.uses_rotation) p.fields = evaluate(m.inner->kernel, at.shape, interior, p.x);
  if (term.uses_displacement) p.fields.displacement = recovered_displacement(m, interior, at.t, p.x, at.eigenstrain);
  return p;
}

FieldPoint field_point(const Term& term, const Sampled& p, Eigen::Index q) {
  FieldPoint f{.x = p.x.col(q), .material = p.material};
  if (term.uses_stress) f.stress = tensor(p.fields.stress.col(q));
  if (term.uses_displacement) f.displacement = p.fields.displacement.col(q);
  if (term.uses_rotation) f.rotation = p.fields.rotation[q];
  return f;
}

// Sum over own triangles of what `value` says of each, in their order whoever computes it; all are asked.
double sum_over(const Model& m, const std::vector<bool>& use, const std::function<double(Index)>& value) {
  const Index n = static_cast<Index>(m.mesh.triangles.size());
  std::vector<double> part(static_cast<std::size_t>(n), 0);
  parallel_for(n, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t)
      if (use.empty() || use[t]) part[t] = value(t);
  });
  return std::accumulate(part.begin(), part.begin() + own_triangles(m), 0.0);
}

// Whether the sum over an edge of boundary or crack is of this process: that of its triangle, or of the one on its
// right.
bool counts(const Model& m, Index edge) {
  const auto& [left, right] = m.mesh.sides[edge];
  return (right != none ? right : left) < own_triangles(m);
}

// Calls at(x, n, weight, unknowns' basis values) at the quadrature points of the labeled edges.
struct BoundaryPoint {
  Vec2 x, n;
  double weight;
  Index edge;
  Eigen::VectorXd basis;  // per Gauss point
  const Skeleton& skeleton;
  Index first(Eigen::Index g) const {  // unknown
    return edge_unknown(skeleton, edge) + 2 * static_cast<Index>(g);
  }
  const Mat2& frame(Eigen::Index g) const {
    return frame_at(skeleton, edge, static_cast<int>(g));
  }
};
// n is the unit normal of the curve at the point, the weight includes |dx/ds|.
void along_label(const Term& term, const Model& m, const std::function<void(const BoundaryPoint&)>& at,
                 const Vec2* singular = nullptr) {
  require(m.element, can_integrate_boundaries);
  const RulesOfTerm rules(term, m);
  for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e) {
    if (m.mesh.label[e] != term.label) continue;
    const Vec2& a = m.mesh.points[m.mesh.edges[e][0]];
    const Vec2 side = m.mesh.points[m.mesh.edges[e][1]] - a;
    const Vec2 outward = outward_normal(m.mesh, e);
    const EdgeRule rule = rules.along(e, singular ? pieces_beside(*singular, a, a + side) : 1);
    for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
      const OnEdge p = on_edge(m.mesh, m.inner->skeleton.curvatures, e, rule.s[q]);
      const double speed = p.slope.norm();
      const Vec2 n = curvature_at(m.inner->skeleton.curvatures, e) ? Vec2(normal_at(p, outward) / speed) : outward;
      at({p.x, n, speed * rule.w[q], e, trace_basis(m.inner->kernel.trace, rule.s[q]), m.inner->skeleton});
    }
  }
}
Vec2 displacement(const BoundaryPoint& p, const Eigen::VectorXd& skeleton) {
  Vec2 u = Vec2::Zero();
  for (Eigen::Index g = 0; g < p.basis.size(); ++g) u += p.basis[g] * (p.frame(g) * skeleton.segment<2>(p.first(g)));
  return u;
}

struct JumpPoint {
  Vec2 x;
  double share;  // of the crack's length
  Index edge, unknown;
};
// At the Gauss points of the trace, where jump and force are unknowns; edges without a jump are left out.
void along_crack(const Model& m, Index crack, const std::function<void(const JumpPoint&)>& at) {
  for (const CrackEdge& c : m.mesh.cracks[crack]) {
    if (m.inner->skeleton.jump[c.edge] == none) continue;
    for (Eigen::Index g = 0; g < m.inner->kernel.trace.s.size(); ++g) {
      const OnEdge p = on_edge(m.mesh, m.inner->skeleton.curvatures, c.edge, m.inner->kernel.trace.s[g]);
      at({p.x, p.slope.norm() * m.inner->kernel.trace.w[g], c.edge,
          m.inner->skeleton.jump[c.edge] + 2 * static_cast<Index>(g)});
    }
  }
}
CrackState crack_state(const Field& s, const JumpPoint& p) {
  return {p.x, s.skeleton[p.unknown], s.force[p.unknown] / p.share};
}

Field sum(const Field& a, const Field& b) {
  Field s;
  s.skeleton = a.skeleton + b.skeleton;
  s.force = a.force + b.force;
  return s;
}

// Degree of the usual rule, or the points of a divided triangle where data vary.
double over_body(const Term& term, const Model& m, const Field& s, const std::vector<bool>& use) {
  const TriangleRule usual = domain_rule(m);
  const RulesOfTerm rules(term, m);
  return sum_over(m, use, [&](Index t) {
    const Triangle shape = triangle(m, t);
    if (!wanted(term, shape)) return 0.0;
    const std::optional<TriangleRule> cut = rules.cut(t);
    const TriangleRule& rule = cut ? *cut : usual;
    const Sampled p = sample(term, m, s.interior.col(t), {t, shape, rule_points(rule, shape), s.eigenstrain});
    const Eigen::VectorXd w = rule_weights(rule, shape);
    double value = 0;
    for (Eigen::Index q = 0; q < rule.w.size(); ++q) value += w[q] * term.density(field_point(term, p, q)).value;
    return area(shape) * value;
  });
}

double on_surfaces(const Term& term, const Model& m, const Field& s) {
  double sum = 0;
  if (term.on_boundary)
    along_label(term, m, [&](const BoundaryPoint& p) {
      if (counts(m, p.edge)) sum += p.weight * term.on_boundary(p.x, p.n, displacement(p, s.skeleton)).value;
    });
  if (term.on_crack)
    along_crack(m, term.crack, [&](const JumpPoint& p) {
      if (counts(m, p.edge)) sum += p.share * term.on_crack(crack_state(s, p)).value;
    });
  if (term.edge_cracks) sum += edge_crack_integral(*term.edge_cracks, m, s);
  return sum;
}

// Points and weights (shares of its area) of a triangle that resolve a singularity.
struct Divided {
  std::vector<Vec2> x;
  std::vector<double> w;
};
void divide(const Triangle& shape, double share, const Singular& added, const TriangleRule& rule, Divided& points) {
  const Vec2 center = centroid(shape);
  double size = 0;
  for (const Vec2& x : shape.x) size = std::max(size, (x - center).norm());
  const double away = (center - added.center).norm();
  // A triangle is whole enough when its size is a quarter of its distance from the center; or inside the disc, which is
  // no part of the body; or an eighth of the disc's radius, for those that its rim cuts.
  constexpr double far = 4, fine = 0.125;
  if (away > far * size || away + size < added.radius || size < fine * added.radius) {
    const Points x = rule_points(rule, shape);
    for (Eigen::Index q = 0; q < x.cols(); ++q) {
      points.x.emplace_back(x.col(q));
      points.w.push_back(share * rule.w[q]);
    }
    return;
  }
  const std::array<Vec2, 3> middle = {0.5 * (shape.x[1] + shape.x[2]), 0.5 * (shape.x[2] + shape.x[0]),
                                      0.5 * (shape.x[0] + shape.x[1])};
  Triangle part = shape;
  // The middle triangle and one at each corner, a quarter of the area each.
  part.x = middle;
  divide(part, 0.25 * share, added, rule, points);
  for (int i = 0; i < 3; ++i) {
    part.x = {shape.x[i], middle[(i + 2) % 3], middle[(i + 1) % 3]};
    divide(part, 0.25 * share, added, rule, points);
  }
}

// To where the points of the chords' triangle lie in the curved one.
void bend(const Triangle& shape, const Triangle& chords, Divided& points) {
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    const CellMap map = cell_map(shape, cell_coordinates(chords, points.x[i]));
    points.x[i] = map.x;
    points.w[i] *= map.J;
  }
}

}  // namespace

// Pieces about as long as the distance; 64 where the point lies on the edge.
int pieces_beside(const Vec2& singular, const Vec2& a, const Vec2& b) {
  const Vec2 side = b - a;
  const double along = foot(singular, a, b);
  constexpr double most = 64;
  return static_cast<int>(std::clamp(std::ceil(side.norm() / (singular - a - along * side).norm()), 1.0, most));
}

// A power below 1 has no slope at 0: the norm of nothing counts as constant.
double slope(const Term& term, double integral) {
  if (term.power == 1) return term.factor;
  return integral > 0 ? term.factor * term.power * std::pow(integral, term.power - 1) : 0;
}

double integral_over(const Term& term, const Model& m, const Field& s, const std::vector<bool>& use) {
  return term.density ? over_body(term, m, s, use) : 0;
}

double integral(const Term& term, const Model& m, const Field& s) {
  if (term.energy) return potential_energy(m, s);
  if (term.work) return work_of_loads(m, s);
  return (term.density ? over_body(term, m, s, {}) : 0) + on_surfaces(term, m, s);
}

namespace {

// The domain integral over a triangle; its derivative by the interior coefficients goes to `column`.
// w are the weights of the fields at the points: share of the area times the derivative of the density.
double differentiate_on(const Term& term, const Model& m, const Field& s, const RulesOfTerm& rules,
                        const TriangleRule& usual, Index t, Eigen::Ref<Eigen::VectorXd> column) {
  const Triangle shape = triangle(m, t);
  if (!wanted(term, shape)) return 0;
  const std::optional<TriangleRule> cut = rules.cut(t);
  const TriangleRule& rule = cut ? *cut : usual;
  const Sampled p = sample(term, m, s.interior.col(t), {t, shape, rule_points(rule, shape), s.eigenstrain});
  const Eigen::Index n = rule.w.size();
  const Eigen::VectorXd weight = rule_weights(rule, shape);
  Fields w{Eigen::Matrix4Xd::Zero(4, n), Points::Zero(2, n), Eigen::RowVectorXd::Zero(n)};
  double value = 0;
  for (Eigen::Index q = 0; q < n; ++q) {
    const double share = area(shape) * weight[q];
    const Density by = term.density(field_point(term, p, q));
    value += weight[q] * by.value;
    w.stress.col(q) =
        share * Eigen::Vector4d(by.by_stress(0, 0), by.by_stress(0, 1), by.by_stress(1, 0), by.by_stress(1, 1));
    w.displacement.col(q) = share * by.by_displacement;
    w.rotation[q] = share * by.by_rotation;
  }
  if (term.uses_displacement) {
    column += weigh_recovered(m, t, p.x, w.displacement);
    w.displacement.setZero();
  }
  if (term.uses_stress || term.uses_rotation) column += weigh(m.inner->kernel, shape, p.x, w);
  return area(shape) * value;
}

// By the unknowns of boundary and crack, and by the stress beneath the boundary.
void differentiate_on_surfaces(const Term& term, const Model& m, const Field& s, Sensitivity& d) {
  if (term.on_boundary) {
    d.skeleton.setZero(m.inner->skeleton.total);
    along_label(term, m, [&](const BoundaryPoint& p) {
      const Vec2 by = p.weight * term.on_boundary(p.x, p.n, displacement(p, s.skeleton)).by_displacement;
      for (Eigen::Index g = 0; g < p.basis.size(); ++g)
        d.skeleton.segment<2>(p.first(g)) += p.basis[g] * (p.frame(g).transpose() * by);
    });
  }
  if (term.on_crack) {
    if (d.skeleton.size() == 0) d.skeleton.setZero(m.inner->skeleton.total);
    d.force.setZero(m.inner->skeleton.total);
    along_crack(m, term.crack, [&](const JumpPoint& p) {
      const CrackDensity by = term.on_crack(crack_state(s, p));
      d.skeleton[p.unknown] += p.share * by.by_jump_n;
      d.force[p.unknown] += by.by_pressure;
    });
  }
  if (term.edge_cracks) differentiate_edge_cracks(*term.edge_cracks, m, s, d);
}

// The work of the loads is linear: its derivative is the loads, on the trace and on the displacements of triangles.
Sensitivity derivative_of_work(const Model& m) {
  Sensitivity d;
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  d.skeleton = traction_loads(m.mesh, m.inner->kernel, m.inner->skeleton, m.inner->data);
  if (m.inner->system.force.cols() > 0) {
    const int first = stress_count(m.element), count = displacement_count(m.element);
    d.interior.setZero(interior_count(m.element), triangles);
    for (Index t = 0; t < triangles; ++t)
      d.interior.col(t).segment(first, count) = area(m.mesh, t) * m.inner->system.force.col(t).head(count);
  }
  return d;
}

// A density that sees no field has an integral and no derivative.
bool has_domain_derivative(const Term& term) {
  return !term.work && term.density && (term.uses_stress || term.uses_displacement || term.uses_rotation);
}

// The derivative, and the domain integral where that has one.
Sensitivity differentiate(const Term& term, const Model& m, const Field& s, double& over_body) {
  if (term.work) return derivative_of_work(m);
  Sensitivity d;
  if (has_domain_derivative(term)) {
    const TriangleRule usual = domain_rule(m);
    const RulesOfTerm rules(term, m);
    d.interior.setZero(interior_count(m.element), static_cast<Eigen::Index>(m.mesh.triangles.size()));
    over_body =
        sum_over(m, {}, [&](Index t) { return differentiate_on(term, m, s, rules, usual, t, d.interior.col(t)); });
  }
  differentiate_on_surfaces(term, m, s, d);
  return d;
}

}  // namespace

Sensitivity derivative(const Term& term, const Model& m, const Field& s) {
  double over_body = 0;
  return differentiate(term, m, s, over_body);
}

Differentiated differentiated(const Term& term, const Model& m, const Field& s) {
  Differentiated d;
  double over_body = 0;
  d.derivative = differentiate(term, m, s, over_body);
  d.value = has_domain_derivative(term) && !term.energy ? over_body + on_surfaces(term, m, s) : integral(term, m, s);
  return d;
}

// Linear densities could take the change alone; this holds for all.
double surface_difference(const Term& term, const Model& m, const Field& s, const Field& change) {
  double total = 0;
  if (term.on_boundary || term.on_crack) {
    const Field after = sum(s, change);
    if (term.on_boundary)
      along_label(term, m, [&](const BoundaryPoint& p) {
        total += p.weight * (term.on_boundary(p.x, p.n, displacement(p, after.skeleton)).value -
                             term.on_boundary(p.x, p.n, displacement(p, s.skeleton)).value);
      });
    if (term.on_crack)
      along_crack(m, term.crack, [&](const JumpPoint& p) {
        total += p.share * (term.on_crack(crack_state(after, p)).value - term.on_crack(crack_state(s, p)).value);
      });
  }
  return total;
}

namespace {

FieldPoint operator+(FieldPoint before, const FieldPoint& by) {
  before.stress += by.stress;
  before.displacement += by.displacement;
  before.rotation += by.rotation;
  return before;
}

// Mean change of the density over the points of a rule.
double mean_change(const Term& term, const Sampled& state, const Sampled& change, const Eigen::VectorXd& weights) {
  double mean = 0;
  for (Eigen::Index q = 0; q < weights.size(); ++q) {
    const FieldPoint before = field_point(term, state, q), by = field_point(term, change, q);
    mean += weights[q] * (term.density(before + by).value - term.density(before).value);
  }
  return mean;
}

}  // namespace

// Of many changes of one triangle, by a rule of degree 5: the state is evaluated once.
Eigen::VectorXd changes_on(const Term& term, const Model& m, const Field& s, Index t, const Eigen::MatrixXd& changes) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(changes.cols());
  const Triangle shape = triangle(m, t);
  if (!term.density || !wanted(term, shape)) return sum;
  const TriangleRule rule = triangle_rule(5);
  const Points x = rule_points(rule, shape);
  const Eigen::VectorXd weights = rule_weights(rule, shape);
  const Sampled p = sample(term, m, s.interior.col(t), {t, shape, x, s.eigenstrain});
  for (Eigen::Index k = 0; k < changes.cols(); ++k) {
    const Sampled d = sample(term, m, changes.col(k), {t, shape, x});
    sum[k] = area(shape) * mean_change(term, p, d, weights);
  }
  return sum;
}

// j(z + w) - j(z) - j'(z) w at the centroid: what is left beyond first order.
Eigen::VectorXd second_order(const Term& term, const Model& m, const Field& s, Index t,
                             const Eigen::MatrixXd& changes) {
  Eigen::VectorXd rest = Eigen::VectorXd::Zero(changes.cols());
  const Triangle shape = triangle(m, t);
  if (!term.density || !wanted(term, shape)) return rest;
  const Points x = centroid(shape);
  const auto at = [&](const auto& interior) {
    const Fields f = evaluate(m.inner->kernel, shape, interior, x);
    return FieldPoint{.x = x.col(0),
                      .stress = tensor(f.stress.col(0)),
                      .displacement = f.displacement.col(0),
                      .rotation = f.rotation[0],
                      .material = material_of(m.mesh, m.scene, t)};
  };
  const FieldPoint before = at(s.interior.col(t));
  const Density first = term.density(before);
  for (Eigen::Index k = 0; k < changes.cols(); ++k) {
    const FieldPoint by = at(changes.col(k));
    rest[k] =
        area(shape) * (term.density(before + by).value - first.value - first.by_stress.cwiseProduct(by.stress).sum() -
                       first.by_displacement.dot(by.displacement) - first.by_rotation * by.rotation);
  }
  return rest;
}

// Densities that see no field do not change.
double domain_difference(const Term& term, const Model& m, const Field& s, const Field& change,
                         const std::vector<bool>& use) {
  double total = 0;
  if (term.density && (term.uses_stress || term.uses_displacement || term.uses_rotation)) {
    const TriangleRule usual = domain_rule(m);
    const RulesOfTerm rules(term, m);
    total += sum_over(m, use, [&](Index t) {
      const Triangle shape = triangle(m, t);
      if (!wanted(term, shape)) return 0.0;
      const std::optional<TriangleRule> cut = rules.cut(t);
      const TriangleRule& rule = cut ? *cut : usual;
      const Sampled p = sample(term, m, s.interior.col(t), {t, shape, rule_points(rule, shape), s.eigenstrain}),
                    d = sample(term, m, change.interior.col(t), {t, shape, rule_points(rule, shape)});
      return area(shape) * mean_change(term, p, d, rule_weights(rule, shape));
    });
  }
  return total;
}

// Inside the disc of the singular field there is no body after the change: only what was there counts, negatively.
double difference(const Term& term, const Model& m, const Field& s, const Field& change, const Singular& added) {
  double total = 0;
  if (term.density) {
    const TriangleRule rule = domain_rule(m);
    total += sum_over(m, {}, [&](Index t) {
      const Triangle shape = triangle(m, t);
      if (!wanted(term, shape)) return 0.0;
      Divided points;
      const Triangle chords = chords_of(shape);
      divide(chords, 1, added, rule, points);
      if (is_curved(shape)) bend(shape, chords, points);
      const Eigen::Index n = static_cast<Eigen::Index>(points.x.size());
      Points x(2, n);
      for (Eigen::Index q = 0; q < n; ++q) x.col(q) = points.x[static_cast<std::size_t>(q)];
      const Sampled p = sample(term, m, s.interior.col(t), {t, shape, x, s.eigenstrain}),
                    d = sample(term, m, change.interior.col(t), {t, shape, x});
      double value = 0;
      for (Eigen::Index q = 0; q < n; ++q) {
        const FieldPoint before = field_point(term, p, q);
        double changed = -term.density(before).value;
        if ((before.x - added.center).norm() > added.radius) {
          const FieldPoint by = field_point(term, d, q), more = added.at(before.x);
          FieldPoint after = before;
          after.stress += by.stress + more.stress;
          after.displacement += by.displacement + more.displacement;
          after.rotation += by.rotation + more.rotation;
          changed += term.density(after).value;
        }
        value += points.w[static_cast<std::size_t>(q)] * changed;
      }
      return area(shape) * value;
    });
  }
  if (term.on_boundary) {
    const Eigen::VectorXd after = s.skeleton + change.skeleton;
    const auto add = [&](const BoundaryPoint& p) {
      const Vec2 more = added.at(p.x).displacement;
      total += p.weight * (term.on_boundary(p.x, p.n, displacement(p, after) + more).value -
                           term.on_boundary(p.x, p.n, displacement(p, s.skeleton)).value);
    };
    along_label(term, m, add, &added.center);
  }
  if (term.on_crack) {
    const Field after = sum(s, change);
    along_crack(m, term.crack, [&](const JumpPoint& p) {
      total += p.share * (term.on_crack(crack_state(after, p)).value - term.on_crack(crack_state(s, p)).value);
    });
  }
  return total;
}

}  // namespace kerf
