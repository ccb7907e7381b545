// What the first process tells the others, as bytes and back: the undivided mesh, which process has which triangle,
// what is wanted, and what must be known of the whole body. Bytes are those of memory: all processes run the same
// program on machines of one kind. The first letter tells this task from that of app/parts/task_pool.cpp.

#include "app/parts/part_task.hpp"

#include "base/packer.hpp"

#include <stdexcept>

namespace kerf {

template <typename Visit, Like<Arc> T>
static void fields(Visit& visit, T& arc) {
  visit(arc.center, arc.axes, arc.from, arc.to);
}

template <typename Visit, Like<Mesh> T>
static void fields(Visit& visit, T& m) {
  visit(m.points, m.triangles, m.edges, m.edges_of, m.sides, m.label, m.crack, m.cracks, m.region, m.arc, m.arcs);
}

template <typename Visit, Like<RigidMotion> T>
static void fields(Visit& visit, T& m) {
  visit(m.center, m.translation, m.rotation);
}

template <typename Visit, Like<Pin> T>
static void fields(Visit& visit, T& p) {
  visit(p.edge, p.at);
}

template <typename Visit, Like<Floating> T>
static void fields(Visit& visit, T& floating) {
  visit(floating.motions, floating.pins);
}

template <typename Visit, Like<PartTask> T>
static void fields(Visit& visit, T& t) {
  visit(t.coarse, t.process, t.folder, t.threads, t.vtk, t.copy, t.map, t.zones.points, t.zones.radius);
  visit(t.piece, t.contact, t.floating, t.measured, t.green, t.rounds);
}

namespace {

constexpr char parts = 'p';  // what a task begins with

}  // namespace

std::string packed(const PartTask& task) {
  Packer to;
  to(parts, task);
  return std::move(to).take();
}

PartTask unpacked(std::string_view bytes) {
  Unpacker from(bytes);
  if (from.get<char>() != parts) throw std::logic_error("a task of another kind");
  return from.get<PartTask>();
}

}  // namespace kerf
