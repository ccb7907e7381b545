// What the first process tells the others, as bytes and back: the undivided mesh, which process has which triangle,
// what is wanted, and what must be known of the whole body. packed() and unpacked() list the same fields in the same
// order; a field that one of them lacks shifts all that follow. Bytes are those of memory: all processes run the same
// program on machines of one kind. The first letter tells this task from that of app/farm.cpp. Of arcs as many are read
// as edges have one, since each arc of a mesh belongs to one edge.

#include "app/part_task.hpp"

#include "solver/packer.hpp"

#include <algorithm>
#include <stdexcept>

namespace kerf {

namespace {

void put(const std::vector<Vec2>& points, Packer& to) {
  std::vector<double> flat;
  for (const Vec2& x : points) flat.insert(flat.end(), {x.x(), x.y()});
  to.put(flat);
}

std::vector<Vec2> points_from(Unpacker& from) {
  const auto flat = from.all<double>();
  std::vector<Vec2> points;
  for (std::size_t i = 0; i + 1 < flat.size(); i += 2) points.emplace_back(flat[i], flat[i + 1]);
  return points;
}

void put_arc(const Arc& arc, Packer& to) {
  put({arc.center, arc.axes.col(0), arc.axes.col(1)}, to);
  to.put(arc.from);
  to.put(arc.to);
}

Arc arc_from(Unpacker& from) {
  const std::vector<Vec2> all = points_from(from);
  Arc arc{.center = all.at(0), .axes = Mat2::Zero(), .from = from.get<double>(), .to = 0};
  arc.axes << all.at(1), all.at(2);
  arc.to = from.get<double>();
  return arc;
}

void put(const Floating& floating, Packer& to) {
  to.put(floating.motions.size());
  for (const RigidMotion& m : floating.motions) {
    put({m.center, m.translation}, to);
    to.put(m.rotation);
  }
  to.put(floating.pins.size());
  for (const Pin& p : floating.pins) {
    put({p.edge[0], p.edge[1]}, to);
    to.put(p.at);
  }
}

Floating floating_from(Unpacker& from) {
  Floating floating;
  floating.motions.resize(from.get<std::size_t>());
  for (RigidMotion& m : floating.motions) {
    const std::vector<Vec2> both = points_from(from);
    m = {both.at(0), both.at(1), from.get<double>()};
  }
  floating.pins.resize(from.get<std::size_t>());
  for (Pin& p : floating.pins) {
    const std::vector<Vec2> both = points_from(from);
    p = {{both.at(0), both.at(1)}, from.get<int>()};
  }
  return floating;
}

constexpr char parts = 'p';  // what a task begins with

}  // namespace

std::string packed(const PartTask& task) {
  Packer to;
  to.put(parts);
  const Mesh& m = task.coarse;
  put(m.points, to);
  to.put(m.triangles);
  to.put(m.edges);
  to.put(m.edges_of);
  to.put(m.sides);
  to.put(m.label);
  to.put(m.crack);
  to.put(m.cracks.size());
  for (const auto& path : m.cracks) to.put(path);
  to.put(m.region);
  to.put(m.arc);
  for (const Arc& arc : m.arcs) put_arc(arc, to);
  to.put(task.process);
  to.put(task.folder);
  to.put(task.divisions);
  to.put(task.threads);
  to.put(task.vtk);
  to.put(task.estimate);
  to.put(task.peaks);
  to.put(task.tips);
  to.put(task.bounds);
  to.put(task.copy);
  to.put(task.map);
  put(task.zones.points, to);
  to.put(task.zones.radius);
  to.put(task.precision);
  to.put(task.piece);
  to.put(task.contact.size());
  for (const auto& faces : task.contact) to.put(faces);
  put(task.floating, to);
  put(task.measured, to);
  to.put(task.green);
  to.put(task.adapts);
  to.put(task.error);
  to.put(task.max_triangles);
  to.put(task.rounds);
  return std::move(to).take();
}

PartTask unpacked(std::string_view bytes) {
  Unpacker from(bytes);
  if (from.get<char>() != parts) throw std::logic_error("a task of another kind");
  PartTask task;
  Mesh& m = task.coarse;
  m.points = points_from(from);
  m.triangles = from.all<std::array<Index, 3>>();
  m.edges = from.all<std::array<Index, 2>>();
  m.edges_of = from.all<std::array<Index, 3>>();
  m.sides = from.all<std::array<Index, 2>>();
  m.label = from.all<Index>();
  m.crack = from.all<Index>();
  m.cracks.resize(from.get<std::size_t>());
  for (auto& path : m.cracks) path = from.all<CrackEdge>();
  m.region = from.all<Index>();
  m.arc = from.all<Index>();
  m.arcs.reserve(m.arc.size());
  for (auto left = std::ranges::count_if(m.arc, [](Index a) { return a != none; }); left > 0; --left)
    m.arcs.push_back(arc_from(from));
  task.process = from.all<Index>();
  task.folder = from.text();
  task.divisions = from.get<int>();
  task.threads = from.get<int>();
  task.vtk = from.get<bool>();
  task.estimate = from.get<bool>();
  task.peaks = from.get<bool>();
  task.tips = from.get<bool>();
  task.bounds = from.get<bool>();
  task.copy = from.get<bool>();
  task.map = from.get<bool>();
  task.zones.points = points_from(from);
  task.zones.radius = from.all<double>();
  task.precision = from.get<Precision>();
  task.piece = from.all<Index>();
  task.contact.resize(from.get<std::size_t>());
  for (auto& faces : task.contact) faces = from.all<FaceMotion>();
  task.floating = floating_from(from);
  task.measured = floating_from(from);
  task.green = from.text();
  task.adapts = from.get<bool>();
  task.error = from.get<double>();
  task.max_triangles = from.get<Index>();
  task.rounds = from.all<Round>();
  return task;
}

}  // namespace kerf
