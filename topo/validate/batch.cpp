// Balls around sites that keep apart share a mesh, a factor that keeps the balls' boundaries, and one analysis [theory:
// V.2].

#include "topo/validate/batch.hpp"

namespace kerf {

namespace {

std::vector<Index> interface_edges(const Filled& f) {
  std::vector<Index> edges;
  for (const auto& contours : f.contour) edges.insert(edges.end(), contours[0].begin(), contours[0].end());
  return edges;
}

State solved_with_balls(const Model& m) {
  State s = solve(m);
  if (!certified(s)) throw Error(Fault::Numerics, "the body with the balls of the validation could not be solved");
  return s;
}

}  // namespace

Batch fill_batch(const Mesh& outside, const std::vector<Site>& sites, int sides, const SiteEllipses& drawn,
                 bool curved) {
  Batch b;
  for (const Site& s : sites)
    b.balls.push_back(ball_mesh({s.at, s.ball, sides}, s.radii, drawn.aspect,
                                drawn.angle.empty() ? 0 : drawn.angle[s.number], curved));
  b.filled = fill(outside, b.balls);
  b.how.interface_edges = interface_edges(b.filled);
  return b;
}

Batch mesh_batch(const Meshing& meshing, const std::vector<Site>& sites, int sides, const SiteEllipses& drawn) {
  return fill_batch(triangulate(with_balls(meshing.shape, sites, sides), meshing.sizing), sites, sides, drawn,
                    meshing.sizing.curved);
}

SolvedBatch::SolvedBatch(const Batch& batch, const Body& body, const Functional& j, const Perturbation& p)
    : model(prepare(batch.filled.mesh, body.element, body.scene, body.threads, batch.how)),
      state(solved_with_balls(model)),
      a(analyze(j, model, state)),
      differences(Differences({a, j, batch.filled}, p, batch.how, body.drawn ? *body.drawn : ScenesOfChanges{})
                      .all(batch.balls)) {}

}  // namespace kerf
