#pragma once
// A body ready to be solved.

#include "kerf/element.hpp"
#include "kerf/mesh.hpp"
#include "kerf/scene.hpp"

#include <memory>

namespace kerf {

struct ModelSeconds {
  double assemble = 0, factor = 0;
};

struct Inner;  // numbering, order, matrix and factor: not for users

struct Model {
  Mesh mesh;
  Element element;
  Scene scene;
  std::vector<std::string> notes;  // what the user should know
  int threads = 1;
  ModelSeconds seconds;
  std::shared_ptr<const Inner> inner;  // shared by copies
};

/// What the faces of cracks in contact do, from a share of a crack's length on: open, sliding to one side or the other.
struct FaceMotion {
  double from = 0;  // share of the length of the path, increasing
  bool open = false;
  signed char slide = 0;  // sign of the tangential jump
};
using ContactGuess = std::vector<std::vector<FaceMotion>>;  // per crack

/// In which the factor lies in memory. Single takes half of it, and a few steps of conjugate gradients for each solve,
/// which is as exact; where it does not serve (bodies thousands of times as long as wide) the factor is double, with a
/// note.
enum class Precision { Double, Single };

/// Numbers, assembles and factorizes. Throws Error(Numerics) when the supports leave a rigid motion free on which the
/// loads do work, naming the motion, or when a crack cuts off a piece that the supports do not hold.
/// `factorize`: for `solve`; solve_saddle_point (solver/saddle_point.hpp) does without.
/// `interface_edges`: their unknowns come next to last, before the jumps in contact; `plain`: no penalty, however
/// nearly incompressible the materials are. With more unknowns in contact than `most_dense` their matrix is not made,
/// and K is factorized for sets of closed points, that of `contact` first: a guess, which a coarser mesh has.
struct Preparation {
  bool factorize = true, plain = false;
  std::vector<Index> interface_edges = {};
  Index most_dense = 3000;
  ContactGuess contact = {};
  Precision precision = Precision::Double;
};
Model prepare(Mesh mesh, const Element& e, Scene scene, int threads, const Preparation& how = {});

double area(const Model& model);

}  // namespace kerf
