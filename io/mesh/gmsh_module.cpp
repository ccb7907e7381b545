// The gmsh half of gmsh.cpp, built as a module of its own. gmsh lives here and nowhere else. Its state is global and
// its functions are not re-entrant: one call at a time, each from the beginning to the end of gmsh. A geometry is
// opened in a thread that may write no file, since .geo scripts can. Faces of a CAD file that lie beside each other are
// glued (removeAllDuplicates), so that they share their edges. For a coarse mesh every curve is divided by hand: lines
// in one edge, others by how far their direction turns. gmsh goes on after errors, which are read from its log.

#include "io/mesh/gmsh_module.hpp"

#include "io/mesh/confine.hpp"

#include <dlfcn.h>
#include <gmsh.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

/// FLTK, which comes with gmsh, makes ~/.fltk, and /etc/fltk anew where it may, as soon as gmsh begins, unless it has
/// done so already. Of this copy of FLTK alone; where it has no such variable, nothing happens.
void keep_fltk_from_writing() {
  Dl_info here;
  if (dladdr(reinterpret_cast<void*>(&keep_fltk_from_writing), &here) == 0) return;
  void* module = dlopen(here.dli_fname, RTLD_LAZY | RTLD_NOLOAD);
  if (!module) return;
  if (void* done = dlsym(module, "_ZN2Fl13options_read_E")) *static_cast<unsigned char*>(done) = 1;
  dlclose(module);  // still loaded by whoever called
}

class Session {
 public:
  Session() {
    keep_fltk_from_writing();
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.NumThreads", 1);
    gmsh::logger::start();
  }
  ~Session() {
    try {
      gmsh::logger::stop();  // else the next session finds the errors of this one
      gmsh::finalize();
    } catch (...) {  // nothing is left to be done
    }
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
};

/// gmsh goes on after errors, and tells them to its log alone.
void throw_logged_error() {
  std::vector<std::string> log;
  gmsh::logger::get(log);
  for (const std::string& line : log)
    if (line.rfind("Error", 0) == 0) throw std::runtime_error(line.substr(line.find_first_not_of(" :", 5)));
}

/// In a thread of its own, which may write no file: scripts of gmsh could.
void read_script(const std::string& path) {
  std::exception_ptr failure;
  std::thread([&] {
    try {
      if (!kerf::confine(kerf::Confined::Files))
        throw std::runtime_error("this system cannot keep a script of gmsh from writing files; save a mesh (.msh)");
      gmsh::open(path);
    } catch (...) {
      failure = std::current_exception();
    }
  }).join();
  if (failure) std::rethrow_exception(failure);
}

void open(const std::string& path) {
  gmsh::option::setNumber("Geometry.OCCFixDegenerated", 1);
  gmsh::option::setNumber("Geometry.OCCFixSmallEdges", 1);
  read_script(path);
  throw_logged_error();
  for (const char* written_at_the_end : {"General.SaveSession", "General.SaveOptions"})
    gmsh::option::setNumber(written_at_the_end, 0);
  gmsh::vectorpair entities;
  gmsh::model::getEntities(entities, 3);
  if (!entities.empty())
    throw std::runtime_error("it holds a solid; a plane body is one or more faces in the plane z = 0");
  gmsh::model::getEntities(entities, 2);
  if (entities.empty()) throw std::runtime_error("it holds no surface; a plane body is one or more faces");
  const std::string kind = path.substr(path.rfind('.') + 1);
  // Faces of a CAD file lie beside each other without sharing their edges.
  if (entities.size() > 1 && kind != "geo") {
    gmsh::model::occ::removeAllDuplicates();
    gmsh::model::occ::synchronize();
  }
}

/// Points along a curve, its ends among them.
std::vector<double> points_on(int tag) {
  constexpr int pieces = 1024;
  std::vector<double> low, high, t, xyz, xy;
  gmsh::model::getParametrizationBounds(1, tag, low, high);
  for (int k = 0; k <= pieces; ++k) t.push_back(low.at(0) + (high.at(0) - low.at(0)) * k / pieces);
  gmsh::model::getValue(1, tag, t, xyz);
  for (std::size_t k = 0; k + 2 < xyz.size(); k += 3) xy.insert(xy.end(), {xyz[k], xyz[k + 1]});
  return xy;
}

/// By how much the direction changes along it, in turns.
double turns(const std::vector<double>& xy) {
  double sum = 0;
  for (std::size_t k = 0; k + 5 < xy.size(); k += 2) {
    const double ax = xy[k + 2] - xy[k], ay = xy[k + 3] - xy[k + 1];
    const double bx = xy[k + 4] - xy[k + 2], by = xy[k + 5] - xy[k + 3];
    sum += std::abs(std::atan2(ax * by - ay * bx, ax * bx + ay * by));
  }
  return sum / (2 * std::acos(-1.0));
}

/// Lines in one edge, other curves in a few. Sizes from curvature would do, but gmsh 4.8 does not return from them.
void coarsen(int per_turn) {
  gmsh::model::mesh::removeConstraints();
  for (const char* off : {"Mesh.MeshSizeFromPoints", "Mesh.MeshSizeExtendFromBoundary", "Mesh.RecombineAll"})
    gmsh::option::setNumber(off, 0);
  gmsh::vectorpair curves;
  gmsh::model::getEntities(curves, 1);
  for (const auto& [dimension, tag] : curves) {
    std::string kind;
    gmsh::model::getType(dimension, tag, kind);
    const int edges = kind == "Line" ? 1 : std::max(3, static_cast<int>(std::ceil(per_turn * turns(points_on(tag)))));
    gmsh::model::mesh::setTransfiniteCurve(tag, edges + 1);
  }
}

void mesh(const KerfGmshRequest& request) {
  if (request.outline) coarsen(request.turn);
  if (request.size > 0) gmsh::option::setNumber("Mesh.MeshSizeMax", request.size);
  // Points are moved at random by this part of the size, which turns triangles over at small tips.
  gmsh::option::setNumber("Mesh.RandomFactor", 1e-13);
  gmsh::option::setNumber("Mesh.ElementOrder", request.outline ? 1 : 2);
  gmsh::model::mesh::generate(2);
  throw_logged_error();
  gmsh::option::setNumber("Mesh.MshFileVersion", 4.1);
  gmsh::option::setNumber("Mesh.Binary", 1);
  gmsh::option::setNumber("Mesh.SaveAll", 1);
  gmsh::write(request.mesh);
  throw_logged_error();
}

void tell_curves(KerfGmshCurveSink sink, void* target) {
  gmsh::vectorpair curves;
  gmsh::model::getEntities(curves, 1);
  for (const auto& entity : curves) {
    const int tag = entity.second;
    const std::vector<double> xy = points_on(tag);
    const KerfGmshCurve curve{tag, static_cast<std::int64_t>(xy.size() / 2), xy.data()};
    sink(target, &curve);
  }
}

void write_step(const std::string& path, const KerfGmshFace& face) {
  std::vector<int> wires;
  std::int64_t first = 0;
  for (std::int64_t l = 0; l < face.loops; ++l) {
    const std::int64_t end = face.ends[l];
    std::vector<int> corner, curves;
    for (std::int64_t k = first; k < end; ++k)
      corner.push_back(gmsh::model::occ::addPoint(face.start[2 * k], face.start[2 * k + 1], 0));
    for (std::int64_t k = first; k < end; ++k) {
      const int a = corner[static_cast<std::size_t>(k - first)];
      const int b = corner[static_cast<std::size_t>(k + 1 == end ? 0 : k + 1 - first)];
      curves.push_back(face.arc[k]
                           ? gmsh::model::occ::addCircleArc(
                                 a, gmsh::model::occ::addPoint(face.center[2 * k], face.center[2 * k + 1], 0), b)
                           : gmsh::model::occ::addLine(a, b));
    }
    wires.push_back(gmsh::model::occ::addCurveLoop(curves));
    first = end;
  }
  gmsh::model::occ::addPlaneSurface(wires);
  gmsh::model::occ::synchronize();
  gmsh::write(path);
  throw_logged_error();
}

/// gmsh throws strings.
template <typename Work>
bool guarded(KerfGmshErrorSink error, void* target, Work&& work) {
  try {
    const Session session;
    work();
    return true;
  } catch (const std::string& e) {
    error(target, e.c_str());
  } catch (const std::exception& e) {
    error(target, e.what());
  } catch (...) {
    error(target, "gmsh failed without a reason");
  }
  return false;
}

}  // namespace

extern "C" bool kerf_gmsh_mesh(const KerfGmshRequest* request, KerfGmshCurveSink curve, KerfGmshErrorSink error,
                               void* target) {
  return guarded(error, target, [&] {
    open(request->geometry);
    mesh(*request);
    tell_curves(curve, target);
  });
}

extern "C" bool kerf_gmsh_step(const char* path, const KerfGmshFace* face, KerfGmshErrorSink error, void* target) {
  return guarded(error, target, [&] { write_step(path, *face); });
}
