#pragma once
// The global condensed system: order of the unknowns, pattern, values, right-hand side.

#include "solver/factor.hpp"
#include "solver/system/skeleton.hpp"

#include <span>

namespace kerf {

/// Rows of the condensed matrix: the free unknowns of one edge or corner lie together, by nested dissection of the
/// vertices, and the jumps that a contact law acts on last. A function of the topology alone.
struct Ordering {
  std::vector<Index> row;       // per skeleton unknown, none where fixed
  Index size = 0;               // rows
  Index contact_rows = 0;       // of them jumps in contact, at the end, in the order of the cracks' paths
  Index interface_rows = 0;     // before those the base unknowns of the interface's edges, in their given order
  std::vector<Index> first;     // per node its first row, one more entry at the end
  std::vector<Index> node_of;   // per row its node
  std::vector<Index> adjacent;  // per node the later nodes that it is coupled to, increasing
  std::vector<Index> adjacent_start;
};
Ordering order(const Mesh& mesh, const Skeleton& s, std::span<const Index> interface_edges = {});

/// K x = F over the free unknowns: K = sum_T K_T on the traces that each triangle sees, F from tractions, body force
/// and prescribed values. Symmetric positive definite when the supports hold the body (quasi-definite with stresses at
/// vertices); on the jumps in contact the solution satisfies their law instead of K x = F.
struct System {
  double penalty = 0;  // Penalty::a in K; chosen when c is so small that digits would be lost
  LowerTriangle K;
  Eigen::MatrixXd force;  // force moments, a column per triangle; no columns without a body force
  Eigen::VectorXd F;
  Eigen::MatrixXd traces;  // with a penalty, per triangle Condensed::trace, own, by_theta
};
/// `plain`: no penalty, whatever the compliances.
System assemble(const Mesh& mesh, const Kernel& k, const Skeleton& s, const Scene& scene, const Ordering& order,
                int threads, bool plain = false);

ForceMoments force_of(const System& a, Index t);

}  // namespace kerf
