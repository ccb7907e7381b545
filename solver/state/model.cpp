// A body made ready to be solved, in the order of the data: what acts is integrated with proofs (solver/data), unknowns
// are numbered, supports checked, pieces that contact alone holds found, rows ordered, the condensed system assembled
// and factorized. Where supports leave motions r_i free the loads must balance on them to 1e-3; the body force
//   f - sum_i share_i r_i,   share = G^-1 (work of the loads on r_i),   G_ij = int r_i . r_j   [theory: A.7]
// takes out what is left, and pins fix as many unknowns. The matrix goes to one of these: the Cholesky factor with rows
// in contact last (C.7); with springs where contact alone holds pieces (C.24); a factor for each set of held rows where
// there are too many for a dense S (C.31); a factor in single precision with conjugate gradients (E.32); LU where K is
// indefinite. A part of a divided body has no matrix of its own (E.34). Also here: models under other loads by the same
// factor, energies and works of a field. Derived in docs/theory/elements.md and docs/theory/contact.md.

#include "kerf/model.hpp"

#include "base/kept_memory.hpp"
#include "geometry/adapt.hpp"
#include "geometry/topology.hpp"
#include "solver/divided_body.hpp"
#include "solver/history.hpp"
#include "solver/moved.hpp"
#include "solver/state/guess.hpp"
#include "solver/system.hpp"
#include "solver/system/corner_loads.hpp"
#include "solver/system/lost_definiteness.hpp"
#include "solver/system/parted.hpp"
#include "solver/system/rounded.hpp"

#include "base/parallel.hpp"
#include "base/stopwatch.hpp"

#include <fmt/core.h>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// A scene whose body force may change, and its data.
struct Loaded {
  Scene& scene;
  SceneData data;
  int threads;
  const EdgeCurvatures& curvatures;
};

// Loads in equilibrium hold a body that is in one piece by themselves.
// After balancing, body force and its data are integrated anew, so that what is called balanced is balanced in the
// solve.
std::vector<RigidMotion> check_supports(const Mesh& mesh, const Kernel& k, const Skeleton& s, Loaded& loaded,
                                        std::vector<std::string>& notes) {
  Scene& scene = loaded.scene;
  const std::vector<Index> piece(mesh.triangles.size(), 0);
  const auto motions = free_motions(mesh, k, s, piece, 0);
  std::string free;
  double worst = 0;
  Eigen::VectorXd work(static_cast<Eigen::Index>(motions.size()));
  for (std::size_t i = 0; i < motions.size(); ++i) {
    // Polygons for arcs and quadrature of the data leave balanced loads slightly unbalanced.
    constexpr double balanced = 1e-3;
    const Work w = work_on(mesh, k, s, {scene, loaded.data}, motions[i], static_cast<Index>(mesh.triangles.size()));
    if (w.relative() > balanced)
      throw Error(
          Fault::Numerics,
          fmt::format("nothing holds the body against {}, and the loads push it that way (their net work is {:.3g} of "
                      "the sum of its parts); add a [[boundary]] with a displacement that stops it, or loads in "
                      "equilibrium",
                      describe(motions[i]), w.relative()));
    free += (free.empty() ? "" : ", ") + describe(motions[i]);
    worst = std::max(worst, w.relative());
    work[static_cast<Eigen::Index>(i)] = w.value;
  }
  if (motions.empty()) return motions;
  std::string note = "the supports leave " + free +
                     " free; the loads are in equilibrium, and the rigid motion is fixed by zero mean displacement and "
                     "rotation";
  constexpr double exact = 1e-12;
  if (worst > exact) {
    scene = balanced(std::move(scene), motions, shares(mesh, k, s, motions, work));
    loaded.data = scene_data(mesh, scene, k.load, loaded.threads, loaded.curvatures);
    note +=
        fmt::format("; their remaining imbalance, {:.2g} of their absolute work, is balanced by a body force", worst);
  }
  notes.push_back(note);
  return motions;
}

// Symmetric stresses with P_3 traces do not see some combinations of traces at singular vertices: K is singular there,
// consistently. A small shift makes it definite; the iterations of the solve undo what else it does.
LowerTriangle lifted(LowerTriangle k, const Skeleton& s, const Ordering& o) {
  constexpr double shift = 1e-11;
  for (Index u = 0; u < s.total; ++u)
    if (s.unseen[u] && o.row[u] != none) k.values[k.start[o.row[u]]] *= 1 + shift;
  return k;
}

// Very slender bodies: the rounding of K is larger than what it takes to bend them, and K may have lost its
// definiteness. With a shift above that rounding its factor still is the preconditioner of the exact products.
Factor factor_of(const LowerTriangle& k, const Element& e, const Ordering& o, int threads) {
  if (!is_definite(e)) return Factor(k, o.contact_rows, false, o.interface_rows);
  try {
    return Factor(k, o.contact_rows, true, o.interface_rows, threads);
  } catch (const LostDefiniteness&) {
    constexpr double shift = 1e-13;
    LowerTriangle raised = k;
    for (Index row = 0; row < k.size; ++row) raised.values[raised.start[row]] *= 1 + shift;
    return Factor(raised, o.contact_rows, true, o.interface_rows, threads);
  }
}

/// Says where tractions are changed because no symmetric stress has them.
void note_corner_loads(const Mesh& mesh, const Kernel& k, const Scene& scene, const Skeleton& s, const SceneData& data,
                       std::vector<std::string>& notes) {
  if (!has_unseen_traces(k.element)) return;
  Eigen::VectorXd loads = traction_loads(mesh, k, s, data);
  for (const CornerLoad& corner : fit_corner_loads(mesh, k, scene, s, loads))
    notes.push_back(
        fmt::format("the tractions at ({:.6g}, {:.6g}) are those of no symmetric stress: they differ by {:.3g} there. "
                    "Element \"{}\" bears them only changed next to that corner, in the mean of squares",
                    corner.at.x(), corner.at.y(), corner.misfit, k.element.name));
}

/// Where the small matrix of contact has to be dense. Throws Error(Numerics) that names where the many edges are.
/// The dense S takes rows^2 numbers and rows^3 work.
void check_contact(const Mesh& mesh, const Scene& scene, Index rows) {
  constexpr Index most = 9000;  // half a minute and two gigabytes
  if (rows <= most) return;
  double shortest = infinity;
  Vec2 at = Vec2::Zero();
  Index edges = 0;
  for (std::size_t c = 0; c < mesh.cracks.size(); ++c)
    if (is_unilateral(scene.laws[c]))
      for (const CrackEdge& crack_edge : mesh.cracks[c]) {
        const double size = length(mesh, crack_edge.edge);
        const auto& [a, b] = mesh.edges[crack_edge.edge];
        ++edges;
        if (size >= shortest) continue;
        shortest = size;
        at = (mesh.points[a] + mesh.points[b]) / 2;
      }
  throw Error(Fault::Numerics,
              fmt::format("the cracks in contact have {} unknowns on {} edges; at most {} can be solved for. Edges are "
                          "as short as {:.2g}, near ({:.6g}, {:.6g}). Beside a gap they are half as long as the gap is "
                          "wide, whatever mesh.size says: move the crack away from what it nearly touches, or use "
                          "contact = \"open\"; elsewhere raise mesh.size or mesh.crack_tip_size",
                          rows, edges, most, shortest, at.x(), at.y()));
}

// What comes before the matrix: the loads checked against the supports, the unknowns numbered.
// Moved into a Model in the end. `held`, `start` and `own` are filled by those who need them.
struct Prepared {
  /// `like`: of the same body under other loads, or null.
  /// Under other loads the pins must be those of `like`: its factor has no rows for them. Semicoercive pieces come
  /// last, because they may add rows in contact to the numbering.
  Prepared(Mesh of, Kernel by, Scene under, int on, const Skeleton* like = nullptr)
      : mesh(std::move(of)), kernel(std::move(by)), scene(std::move(under)), threads(on) {
    const EdgeCurvatures curvatures = curvatures_of(mesh, kernel.element);
    Loaded loaded{scene, scene_data(mesh, scene, kernel.load, threads, curvatures), threads, curvatures};
    skeleton = number(mesh, kernel, {scene, loaded.data}, curvatures);
    note_corner_loads(mesh, kernel, scene, skeleton, loaded.data, notes);
    floating = check_supports(mesh, kernel, skeleton, loaded, notes);
    if (!floating.empty() && like && like->total == skeleton.total)
      skeleton.fixed = with_pins(like->fixed);
    else if (!floating.empty())
      for (const Index pin : pins(mesh, kernel, skeleton, floating, pieces_of(mesh, scene))) skeleton.fixed[pin] = true;
    semicoercive = semicoercive_pieces(mesh, kernel, scene, skeleton);
    data = std::move(loaded.data);
  }

  /// Part of a body: whether it is held is known of the whole alone.
  struct Part {};
  Prepared(Mesh of, Kernel by, Scene under, int on, Part)
      : mesh(std::move(of)), kernel(std::move(by)), scene(std::move(under)), threads(on) {
    const EdgeCurvatures curvatures = curvatures_of(mesh, kernel.element);
    data = scene_data(mesh, scene, kernel.load, threads, curvatures);
    skeleton = number(mesh, kernel, {scene, data}, curvatures);
  }

  /// As many more are fixed there as there are motions: the pins, which are those of the supports alone.
  std::vector<bool> with_pins(const std::vector<bool>& there) const {
    std::vector<bool> all = skeleton.fixed;
    std::size_t more = 0;
    for (std::size_t u = 0; u < all.size(); ++u)
      if (there[u] && !all[u]) all[u] = true, ++more;
    if (more != floating.size()) throw std::invalid_argument("with_loads: the supports differ");
    return all;
  }

  /// Whether contact goes without its dense matrix.
  /// Interfaces are read off the last block of a factor and springs act on it, which a factor per set does not have.
  bool is_large(Index contact_rows, const Preparation& how) const {
    return how.factorize && contact_rows > how.most_dense && how.interface_edges.empty() && semicoercive.empty() &&
           skeleton.unseen.empty() && is_definite(kernel.element);
  }

  Model model(Ordering ordering, System system, std::shared_ptr<const Factor> factor, const ModelSeconds& seconds) && {
    const Element element = kernel.element;
    return {.mesh = std::move(mesh),
            .element = element,
            .scene = std::move(scene),
            .notes = std::move(notes),
            .threads = threads,
            .seconds = seconds,
            .inner = std::make_shared<Inner>(Inner{std::move(kernel), std::move(skeleton), std::move(ordering),
                                                   std::move(system), std::move(factor), std::move(floating),
                                                   std::move(data), std::move(semicoercive), std::move(held),
                                                   std::move(start), std::move(own)})};
  }

  Mesh mesh;
  Kernel kernel;
  Scene scene;
  int threads;
  Skeleton skeleton;
  std::vector<std::string> notes;
  std::vector<RigidMotion> floating;
  SceneData data;
  Semicoercive semicoercive;
  std::shared_ptr<HeldFactors> held;
  std::vector<Motion> start;
  std::optional<OwnShare> own;
};

constexpr const char* stays_double =
    "a factor in single precision does not serve here: the factor is kept in double precision";

/// Whether its matrix is definite as it is, and nobody asks for the factor itself.
/// Rows of an interface are read off the last block of the factor, which a leading solver does not have.
bool can_be_rounded(const Prepared& made, const Element& e, const Preparation& how) {
  return is_definite(e) && made.skeleton.unseen.empty() && how.interface_edges.empty();
}

/// With the springs that hold what contact alone holds.
/// The first entry of a column is its diagonal.
LowerTriangle sprung(const LowerTriangle& k, const Ordering& o, const Semicoercive& semicoercive) {
  LowerTriangle held = k;
  for (Index i = 0; i < o.contact_rows; ++i) held.values[held.start[o.leading() + i]] += semicoercive.springs[i];
  return held;
}

}  // namespace

namespace {

/// All that `order` looks at.
/// Compared in full, which costs little beside an order.
bool same_topology(const Mesh& m, const Skeleton& s, const Mesh& n, const Skeleton& o) {
  const auto same_cracks = [&] {
    return std::ranges::equal(m.cracks, n.cracks, [](const auto& a, const auto& b) {
      return std::ranges::equal(
          a, b, [](const CrackEdge& c, const CrackEdge& d) { return c.edge == d.edge && c.forward == d.forward; });
    });
  };
  return m.points.size() == n.points.size() && m.triangles == n.triangles && m.edges == n.edges && m.sides == n.sides &&
         m.edges_of == n.edges_of && s.per_edge == o.per_edge && s.per_vertex == o.per_vertex && s.total == o.total &&
         s.base == o.base && s.fixed == o.fixed && s.jump == o.jump && s.bounded == o.bounded &&
         s.frictional == o.frictional && s.sliding == o.sliding && s.corners.of == o.corners.of &&
         s.corners.vertex == o.corners.vertex && same_cracks();
}

/// The factor of a model that nobody else has, or null.
/// A factor that another model shares must keep its values.
std::shared_ptr<Factor> taken_from(Model model) {
  if (model.inner.use_count() != 1 || model.inner->factor.use_count() != 1) return nullptr;
  return std::const_pointer_cast<Factor>(model.inner->factor);
}

/// The factor of K in the memory of one with its pattern; anew where that is lost.
/// A refactorization that fails leaves no values: the factor is made anew, with the shift that this may need.
std::shared_ptr<Factor> factor_in(std::shared_ptr<Factor> there, const LowerTriangle& K, const Element& e,
                                  const Ordering& ordering, int threads) {
  if (there) try {
      there->refactor(K);
      return there;
    } catch (const LostDefiniteness&) {
      there.reset();
    }
  return std::make_shared<Factor>(factor_of(K, e, ordering, threads));
}

/// `prepare`, with what may be taken over, or null, and the sequence of the vertices, or none.
Model prepare_from(Mesh mesh, const Element& e, Scene scene, int threads, const Preparation& how, Model* before,
                   std::span<const Index> sequence = {});

}  // namespace

/// A linear field carries enclosures, so that the body force stays proved.
Scene balanced(Scene scene, const std::vector<RigidMotion>& motions, const Eigen::VectorXd& share) {
  const auto force = [motions, share](const Vec2& x) {
    Vec2 force = Vec2::Zero();
    for (Eigen::Index i = 0; i < share.size(); ++i) force -= share[i] * motions[i].at(x);
    return force;
  };
  scene.body = sum(scene.body, linear_field(force));
  return scene;
}

/// Pins are named by the points of their edge, which every process has with the same bits; after divisions the first
/// piece of the edge keeps the end a.
Floating floating_of(const Model& m, int divisions) {
  const Inner& inner = *m.inner;
  if (inner.floating.empty()) return {};
  Floating f{.motions = inner.floating};
  const Skeleton unpinned = number(m.mesh, inner.kernel, {m.scene, inner.data}, inner.skeleton.curvatures);
  for (const Index u : pins(m.mesh, inner.kernel, unpinned, f.motions)) {
    const auto& [a, b] = m.mesh.edges[u / unpinned.per_edge];
    Pin p{{m.mesh.points[a], m.mesh.points[b]}, static_cast<int>(u % unpinned.per_edge)};
    p.edge[1] = divided_edge(m.mesh, u / unpinned.per_edge, divisions)[1];
    f.pins.push_back(p);
  }
  return f;
}

/// No matrix of its own: the order has no dissection, loads alone are assembled, and the factor is empty.
Model prepare_part(Mesh mesh, const Element& e, Scene scene, int threads, OwnShare own, const Floating& floating) {
  require_edges_alone(e);
  Stopwatch watch;
  Prepared made(std::move(mesh), kernel(e), std::move(scene), threads, Prepared::Part{});
  made.floating = floating.motions;
  for (const Pin& pin : floating.pins)
    for (Index edge = 0; edge < static_cast<Index>(made.mesh.edges.size()); ++edge) {
      const auto& [a, b] = made.mesh.edges[edge];
      if (made.mesh.points[a] == pin.edge[0] && made.mesh.points[b] == pin.edge[1])
        made.skeleton.fixed[edge_unknown(made.skeleton, edge) + pin.at] = true;
    }
  Ordering ordering = as_numbered(made.skeleton);
  ModelSeconds seconds;
  System system =
      assemble_without_matrix({made.mesh, made.kernel, made.skeleton, made.scene, made.data, ordering, threads, false});
  own.holder = holders(made.mesh, made.skeleton, ordering, own.holder);
  made.own = std::move(own);
  seconds.assemble = watch.lap();
  return std::move(made).model(std::move(ordering), std::move(system), std::make_shared<Factor>(LowerTriangle{}, 0),
                               seconds);
}

Index own_triangles(const Model& m) {
  return m.inner->own ? m.inner->own->triangles : static_cast<Index>(m.mesh.triangles.size());
}

const Mesh& whole_mesh(const Model& m) {
  return m.inner->own && m.inner->own->whole ? *m.inner->own->whole : m.mesh;
}

bool owns(const Model& m, Index unknown) {
  return !m.inner->own || m.inner->own->holder[static_cast<std::size_t>(unknown)] == m.inner->own->here;
}

std::optional<SolverEffort> solver_effort(const Model& m) {
  if (!m.inner->factor || !m.inner->factor->leading()) return std::nullopt;
  return m.inner->factor->leading()->effort();
}

Model prepare(Mesh mesh, const Element& e, Scene scene, int threads, const Preparation& how) {
  return prepare_from(std::move(mesh), e, std::move(scene), threads, how, nullptr);
}

Model prepare_moved(Mesh mesh, const Element& e, Scene scene, int threads, Model before,
                    std::span<const Index> sequence) {
  return prepare_from(std::move(mesh), e, std::move(scene), threads, {}, before.inner ? &before : nullptr, sequence);
}

namespace {

/// Where the triangles at the feet of pieces are too large the mesh is bisected there and all begins anew; not where a
/// mesh must stay (moved or ordered before), nor below 1e-4 of the largest edge. Of the model before its factor is
/// taken last, when nothing can be refused any more.
Model prepare_from(Mesh mesh, const Element& e, Scene scene, int threads, const Preparation& how, Model* before,
                   std::span<const Index> sequence) {
  if (scene.laws.size() != mesh.cracks.size()) throw std::invalid_argument("prepare: one law per crack is needed");
  for (const CrackLaw& law : scene.laws)
    if (law.kind == CrackLaw::Kind::Bonded && has_pressure(law))
      throw std::invalid_argument("prepare: a bonded crack has no faces for a pressure");
  for (const Index r : mesh.region)
    if (r >= static_cast<Index>(scene.regions.size()))
      throw std::invalid_argument("prepare: one material per region is needed");
  Stopwatch watch;
  Prepared made(std::move(mesh), kernel(e), std::move(scene), threads);
  const bool again = before && before->inner->ordering.interface_rows == 0 && how.interface_edges.empty() &&
                     same_topology(made.mesh, made.skeleton, before->mesh, before->inner->skeleton);
  Ordering ordering =
      again ? before->inner->ordering : order(made.mesh, made.skeleton, how.interface_edges, threads, sequence);
  constexpr std::size_t large = 20000;  // triangles; below, asking for pages anew costs more than the holes
  if (made.mesh.triangles.size() > large && !again && !keeps_memory()) return_freed_memory();
  const bool by_factors = made.is_large(ordering.contact_rows, how);
  if (!by_factors) check_contact(made.mesh, made.scene, ordering.contact_rows);
  ModelSeconds seconds;
  const double numbering = watch.lap();
  System system =
      assemble({made.mesh, made.kernel, made.skeleton, made.scene, made.data, ordering, threads, how.plain});
  seconds.assemble = watch.lap() + numbering;
  try {
    if (!made.semicoercive.empty())
      hold({made.mesh, made.kernel, made.scene, made.skeleton, ordering}, *system.K, system.F, made.semicoercive,
           made.notes);
  } catch (const CoarseFeet& feet) {
    constexpr double smallest = 1e-4;  // of the largest edge
    const double size = quality(made.mesh).h_min / quality(made.mesh).h_max;
    if (size < smallest || before || !sequence.empty()) throw;
    Mesh finer = bisect(longest_edges_first(std::move(made.mesh)), feet.triangles);
    return prepare_from(std::move(finer), e, std::move(made.scene), threads, how, nullptr);
  }
  if (by_factors) {
    if (how.precision == Precision::Single) made.notes.emplace_back(stays_double);
    made.held = std::make_shared<HeldFactors>(sequence_within(made.mesh, made.skeleton, ordering),
                                              ordering.contact_rows, threads);
    made.start = motions_of(made.mesh, made.skeleton, ordering, made.kernel, how.contact);
    made.held->of(*system.K, held_by(made.start, ordering.contact_rows));
    seconds.factor = watch.lap();
    made.notes.push_back(
        fmt::format("the cracks in contact have {} unknowns, too many for a dense matrix: contact is "
                    "solved by factors of the whole system, method \"active-set\"",
                    ordering.contact_rows));
    return std::move(made).model(std::move(ordering), std::move(system), nullptr, seconds);
  }
  const std::shared_ptr<const LowerTriangle> K =
      made.semicoercive.empty() ? system.K
                                : std::make_shared<const LowerTriangle>(sprung(*system.K, ordering, made.semicoercive));
  std::unique_ptr<LeadingSolver> in_single;
  if (how.factorize && how.precision == Precision::Single) {
    if (can_be_rounded(made, e, how)) in_single = rounded(K, ordering.contact_rows, system.F, threads);
    if (!in_single) made.notes.emplace_back(stays_double);
  }
  std::shared_ptr<Factor> factor;
  if (!how.factorize)
    factor = std::make_shared<Factor>(LowerTriangle{}, 0);
  else if (in_single)
    factor = std::make_shared<Factor>(*K, ordering.contact_rows, std::move(in_single));
  else if (!made.skeleton.unseen.empty())
    factor = std::make_shared<Factor>(lifted(*K, made.skeleton, ordering), ordering.contact_rows);
  else
    factor = factor_in(again && is_definite(e) ? taken_from(std::move(*before)) : nullptr, *K, e, ordering, threads);
  seconds.factor = watch.lap();
  return std::move(made).model(std::move(ordering), std::move(system), std::move(factor), seconds);
}

// `before`: the state whose slips go on, or nothing.
// Slips of the step before are prescribed values of frictional jumps: friction counts from there [theory: C.28].
Model reloaded(const Model& m, Scene scene, const Field* before, bool with_matrix = true) {
  Stopwatch watch;
  Prepared made(m.mesh, m.inner->kernel, std::move(scene), m.threads, &m.inner->skeleton);
  if (made.skeleton.total != m.inner->skeleton.total || made.skeleton.fixed != m.inner->skeleton.fixed)
    throw std::invalid_argument("with_loads: the supports differ");
  if (before)
    for (Index u = made.skeleton.base; u < made.skeleton.total; ++u)
      if (made.skeleton.frictional[u]) made.skeleton.prescribed[u] = before->skeleton[u];
  Ordering ordering = m.inner->ordering;
  System system =
      assemble_loads({made.mesh, made.kernel, made.skeleton, made.scene, made.data, ordering, m.threads, false},
                     m.inner->system, with_matrix);
  if (!made.semicoercive.empty())
    hold({made.mesh, made.kernel, made.scene, made.skeleton, ordering}, *system.K, system.F, made.semicoercive,
         made.notes);
  ModelSeconds seconds;
  seconds.assemble = watch.lap();
  made.held = m.inner->held;
  made.start = m.inner->start;
  return std::move(made).model(std::move(ordering), std::move(system), m.inner->factor, seconds);
}

}  // namespace

Model with_loads(const Model& m, Scene scene) {
  return reloaded(m, std::move(scene), nullptr);
}

Model loads_alone(const Model& m, Scene scene) {
  return reloaded(m, std::move(scene), nullptr, false);
}

Model continued(const Model& m, Scene scene, const Field& before) {
  return reloaded(m, std::move(scene), &before);
}

bool certified(const State& state) {
  return state.converged && state.certificate.kkt <= no_digits && state.certificate.work <= no_digits;
}

/// Defects are relative: 1e-n leaves n digits.
std::string lost_digits(const State& state) {
  const Certificate& c = state.certificate;
  const double worst = std::max(c.kkt, c.work);
  if (worst <= few_digits) return {};
  return fmt::format(
      "rounding: equilibrium and contact hold to {:.1g} of the load, and the work of the loads is twice "
      "the strain energy to {:.1g}; about {:.0f} digits of the results are left",
      c.kkt, c.work, std::max(0.0, std::floor(-std::log10(worst))));
}

bool has_large_contact(const Model& m) {
  return m.inner->held != nullptr;
}

Triangle triangle(const Model& model, Index t) {
  return triangle(model.mesh, model.inner->skeleton, t);
}

/// A mesh without arcs has no curved triangle: its areas need no map.
double cell_area(const Model& m, Index t) {
  return m.mesh.arc.empty() ? area(m.mesh, t) : cell_area(cell_of(m.mesh, m.inner->skeleton.curvatures, t));
}

void require_straight(const Model& m, std::string_view what) {
  if (m.mesh.arc.empty()) return;
  throw Error(Fault::Usage, fmt::format("{} is for straight triangles only; use mesh.curved = false", what));
}

Fields evaluate(const Model& model, const Field& state, Index t, const Points& x) {
  return evaluate(model.inner->kernel, triangle(model, t), state.interior.col(t), x);
}

/// 1/2 (A s, s) with the skew part of s in dev s (N.4), as the elements have it; the orthotropic share on the symmetric
/// part.
double strain_energy(const Model& m, const Field& s) {
  double energy = 0;
  for (Index t = 0; t < own_triangles(m); ++t) {
    const Triangle shape = triangle(m, t);
    const Material& material = material_of(m.mesh, m.scene, t);
    const TriangleRule& rule = stress_rule(m.inner->kernel, shape);
    const Points x = rule_points(rule, shape);
    const Eigen::VectorXd w = rule_weights(rule, shape);
    double sum = 0;
    for (Eigen::Index q = 0; q < x.cols(); ++q) {
      const Eigen::Vector4d v = stress_at(m.inner->kernel, shape, s.interior.col(t), x.col(q));
      const double difference = v[0] - v[3], trace = v[0] + v[3];
      sum += w[q] * ((0.5 * difference * difference + v[1] * v[1] + v[2] * v[2]) / (2 * material.mu) +
                     material.c * trace * trace);
      if (isotropic(material)) continue;
      const double shear = 0.5 * (v[1] + v[2]);
      const Eigen::Vector3d more = orthotropic_strain(material, v[0], v[3], shear);
      sum += w[q] * (more[0] * v[0] + more[1] * v[3] + 2 * more[2] * shear);
    }
    energy += 0.5 * area(shape) * sum;
  }
  return energy;
}

/// Moments are means against the stress functions over the area of the triangle of the chords.
double work_of_eigenstrain(const Model& m, const Field& s) {
  double work = 0;
  if (m.inner->data.strain.empty()) return work;
  const int count = stress_count(m.element);
  for (Index t = 0; t < own_triangles(m); ++t)
    work += area(m.mesh, t) * m.inner->system.force.col(t).tail(count).dot(s.interior.col(t).head(count));
  return work;
}

namespace {

// The derivatives of (l1, l2) by x, in rows.
Mat2 barycentric_slopes(const Mesh& mesh, Index t) {
  const auto& [a, b, c] = mesh.triangles[t];
  Mat2 sides;
  sides << mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a];
  return sides.inverse();
}

// (l1, l2) of points; of a curved triangle those that its map takes there.
// Straight: an affine map; curved: by Newton's method (cell_coordinates).
Points barycentric(const Model& m, Index t, const Points& x) {
  const Triangle shape = triangle(m, t);
  if (!is_curved(shape)) return barycentric_slopes(m.mesh, t) * (x.colwise() - m.mesh.points[m.mesh.triangles[t][0]]);
  Points l(2, x.cols());
  for (Eigen::Index i = 0; i < x.cols(); ++i) l.col(i) = cell_coordinates(shape, x.col(i));
  return l;
}

}  // namespace

Eigen::Matrix4Xd eigenstrain_at(const Model& m, double share, Index t, const Points& x) {
  if (share == 0 || m.inner->data.strain.empty()) return Eigen::Matrix4Xd::Zero(4, x.cols());
  return share * strain_at(m.inner->data.strain, t, barycentric(m, t, x));
}

/// The polynomial is one in (l1, l2), whose slopes by x are those of the triangle of the chords times D^-1 of its map.
Eigen::Matrix4Xd eigenstrain_slope_at(const Model& m, Index t, const Points& x, int axis) {
  const Mat2 inverse = barycentric_slopes(m.mesh, t);
  const Points l = barycentric(m, t, x);
  const Eigen::Matrix4Xd first = strain_slope_at(m.inner->data.strain, t, l, 0),
                         second = strain_slope_at(m.inner->data.strain, t, l, 1);
  const Triangle shape = triangle(m, t);
  if (!is_curved(shape)) return inverse(0, axis) * first + inverse(1, axis) * second;
  Eigen::Matrix4Xd slope(4, x.cols());
  for (Eigen::Index q = 0; q < x.cols(); ++q) {
    const Mat2 there = inverse * cell_map(shape, l.col(q)).D.inverse();
    slope.col(q) = there(0, axis) * first.col(q) + there(1, axis) * second.col(q);
  }
  return slope;
}

/// Tractions on the traces, body force by the moments that the element sees.
double work_of_loads(const Model& m, const Field& s) {
  double work = 0;
  for (Index u = 0; u < m.inner->skeleton.total; ++u)
    if (owns(m, u)) work += m.inner->system.tractions[u] * s.skeleton[u];
  const int first = stress_count(m.element), count = displacement_count(m.element);
  for (Index t = 0; m.inner->system.force.cols() > 0 && t < own_triangles(m); ++t)
    work += area(m.mesh, t) * m.inner->system.force.col(t).head(count).dot(s.interior.col(t).segment(first, count));
  return work;
}

double potential_energy(const Model& m, const Field& s) {
  return strain_energy(m, s) - work_of_loads(m, s);
}

double area(const Model& m) {
  double sum = 0;
  for (Index t = 0; t < own_triangles(m); ++t) sum += cell_area(m, t);
  return sum;
}

}  // namespace kerf
