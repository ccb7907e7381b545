// Geometries (.geo, STEP, BREP, IGES) meshed by gmsh, and STEP files written by it. gmsh runs in a child process of its
// own: it may crash, never end, print, and a .geo script may do anything. The child has a time limit, dies with kerf,
// can start no program and write one file (confine.cpp), and sends records through a pipe: curves as 1,025 points each,
// an error, or "done". The mesh itself comes as a file. kerf's own meshing needs the topology and the curves alone, so
// that gmsh meshes coarsely then, 12 edges a turn; where chords so long cross each other 48 and 192 are tried. A curve
// is recognized by its points, whatever gmsh calls it: a line where all lie on the chord, a circle where all have one
// distance from the center through three of them, up to 1e-11 of the size or the radius. Temporary files go with the
// object, with a signal and with quick_exit. The module with gmsh is loaded when it is needed (gmsh_module.cpp).

#include "io/mesh/gmsh.hpp"

#include "geometry/arc_chain.hpp"
#include "geometry/plane.hpp"
#include "io/files.hpp"
#include "io/mesh/confine.hpp"
#include "io/mesh/gmsh_module.hpp"
#include "io/module.hpp"
#include "kerf/stop.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>

namespace kerf {

namespace {

constexpr unsigned coarse_minutes = 5;  // for what takes gmsh less than a second, unless it never ends
constexpr unsigned fine_minutes = 120;

struct Module {
  KerfGmshMesher mesh = nullptr;
  KerfGmshStep step = nullptr;
  std::string reason = {};
};

const Module& loaded() {
  static const Module module = [] {
    const LoadedModule found = load_module("kerf_gmsh.so", KERF_GMSH_FOLDER, {"kerf_gmsh_mesh", "kerf_gmsh_step"});
    if (!found.handle) return Module{.reason = found.reason};
    return Module{reinterpret_cast<KerfGmshMesher>(dlsym(found.handle, "kerf_gmsh_mesh")),
                  reinterpret_cast<KerfGmshStep>(dlsym(found.handle, "kerf_gmsh_step"))};
  }();
  return module;
}

const Module& needed(const std::filesystem::path& path) {
  const Module& module = loaded();
  if (!module.mesh)
    throw Error(Fault::Files,
                fmt::format("{}: gmsh is needed for it, and kerf was built without it or does not find its module "
                            "kerf_gmsh.so ({}); ./dev gmsh builds it, or save a mesh (.msh) with gmsh",
                            path.string(), module.reason));
  return module;
}

constexpr std::array ending{SIGINT, SIGTERM, SIGHUP};

// Of a file that goes when a signal ends kerf at once, as it does before a run has begun. A handler reaches nothing
// else.
char doomed[PATH_MAX] = "";

extern "C" void remove_and_end(int signal) {
  unlink(doomed);
  std::signal(signal, SIG_DFL);
  raise(signal);
}

extern "C" void remove_at_once() {
  if (doomed[0] != '\0') unlink(doomed);
}

void stop_removing() {
  for (const int signal : ending) {
    struct sigaction now = {};
    if (sigaction(signal, nullptr, &now) == 0 && now.sa_handler == remove_and_end) std::signal(signal, SIG_DFL);
  }
  doomed[0] = '\0';
}

/// A file of its own in the folder for temporary files, gone with the object.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& suffix) {
    std::error_code code;  // a folder that is not there
    const std::filesystem::path folder = std::filesystem::temp_directory_path(code);
    if (!code) name_ = (std::filesystem::absolute(folder) / ("kerf-XXXXXX" + suffix)).string();
    const int file = code ? -1 : mkstemps(name_.data(), int(suffix.size()));
    if (file < 0)
      throw Error(Fault::Files, fmt::format("cannot make a temporary file: {}; set TMPDIR to a folder that exists and "
                                            "may be written to",
                                            std::strerror(code ? code.value() : errno)));
    close(file);
    if (doomed[0] != '\0' || name_.size() >= sizeof doomed) return;
    std::strcpy(doomed, name_.c_str());
    static const bool registered = std::at_quick_exit(remove_at_once) == 0;  // as limits end a run
    (void)registered;
    for (const int signal : ending) {
      struct sigaction now = {};
      if (sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_DFL) std::signal(signal, remove_and_end);
    }
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(name_, ignored);
    if (name_ == doomed) stop_removing();
  }
  const std::string& name() const {
    return name_;
  }

 private:
  std::string name_;
};

/// What the points lie on, whatever gmsh calls it: a round ellipse is a circle.
void classify(RawCurve& curve) {
  const std::size_t n = curve.points.size();
  double size = 0, bulge = 0;
  for (const Vec2& x : curve.points) {
    size = std::max(size, (x - curve.points.front()).norm());
    bulge = std::max(bulge, distance(x, curve.points.front(), curve.points.back()));
  }
  constexpr double rounding = 1e-11;
  if (n < 4 || bulge <= rounding * size) return;
  curve.kind = RawCurve::Kind::Other;
  const Vec2 a = curve.points.front(), p = curve.points[n / 3] - a, q = curve.points[2 * n / 3] - a;
  const double twice = 2 * cross(p, q);
  const Vec2 center(q.y() * p.squaredNorm() - p.y() * q.squaredNorm(),
                    p.x() * q.squaredNorm() - q.x() * p.squaredNorm());
  if (twice == 0) return;
  curve.center = a + center / twice;
  curve.radius = center.norm() / std::abs(twice);
  if (std::all_of(curve.points.begin(), curve.points.end(), [&](const Vec2& x) {
        return std::abs((x - curve.center).norm() - curve.radius) <= rounding * curve.radius;
      }))
    curve.kind = RawCurve::Kind::Circle;
}

/// What gmsh tells, in the process that runs it: records that go through a pipe.
class Teller {
 public:
  explicit Teller(int pipe) : pipe_(pipe) {}

  static void curve(void* target, const KerfGmshCurve* told) {
    const Teller& to = *static_cast<Teller*>(target);
    to.put("c", 1);
    to.put(&told->tag, sizeof told->tag);
    to.put(&told->points, sizeof told->points);
    to.put(told->xy, 2 * sizeof(double) * std::size_t(told->points));
  }
  static void error(void* target, const char* message) {
    const Teller& to = *static_cast<Teller*>(target);
    to.put("e", 1);
    to.put(message, std::strlen(message));
  }
  void done() const {
    put("d", 1);
  }

 private:
  void put(const void* bytes, std::size_t count) const {
    for (const char* at = static_cast<const char*>(bytes); count > 0;) {
      const ssize_t written = write(pipe_, at, count);
      if (written <= 0) return;  // the reader is gone
      at += written;
      count -= std::size_t(written);
    }
  }
  int pipe_;
};

struct Told {
  std::map<std::int32_t, RawCurve> curves = {};
  std::string error = "it ended early";  // as scripts may tell it to
  bool in_time = true;
};

Told understand(const std::string& bytes) {
  Told told;
  std::size_t at = 0;
  const auto take = [&](void* to, std::size_t count) {
    if (bytes.size() - at < count) throw Error(Fault::Files, "gmsh did not tell all its curves");
    std::memcpy(to, bytes.data() + at, count);
    at += count;
  };
  while (at < bytes.size()) {
    const char kind = bytes[at++];
    if (kind == 'e' || kind == 'd') {
      told.error = bytes.substr(at);
      return told;
    }
    std::int32_t tag;
    std::int64_t count;
    take(&tag, sizeof tag);
    take(&count, sizeof count);
    RawCurve curve;
    for (std::int64_t k = 0; k < count; ++k) {
      curve.points.emplace_back();
      take(curve.points.back().data(), 2 * sizeof(double));
    }
    classify(curve);
    told.curves[tag] = std::move(curve);
  }
  return told;
}

/// `work` in a process of its own: what gmsh and OpenCASCADE print does not mix with what kerf prints, and where they
/// crash, kerf says so.
/// `minutes`: how long it may take; `file`: the only one that it may write; `work`: whether it went well.
Told in_child(unsigned minutes, const TemporaryFile& file, const std::function<bool(Teller& teller)>& work) {
  int ends[2];
  if (pipe(ends) != 0) throw Error(Fault::Files, "cannot start gmsh: there are too many open files");
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) {
    close(ends[0]);
    close(ends[1]);
    throw Error(Fault::Files, "cannot start gmsh in a process of its own: there is no memory for it");
  }
  if (child == 0) {
    close(ends[0]);
    for (const int signal : {SIGINT, SIGTERM, SIGALRM}) std::signal(signal, SIG_DFL);
    stop_removing();
    alarm(60 * minutes);
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // a script that never ends does not outlive kerf
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    Teller teller(ends[1]);
    stand_nowhere();
    write_only(file.name());  // older kernels have the list of calls alone
    if (!confine(Confined::Programs))
      Teller::error(&teller, "this system cannot keep gmsh from starting programs (no seccomp)");
    else if (work(teller))
      teller.done();
    _exit(0);
  }
  close(ends[1]);
  std::string bytes;
  char block[1 << 16];
  constexpr int look = 100;  // milliseconds
  for (pollfd there{ends[0], POLLIN, 0};;) {
    if (stop_requested()) {
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
      close(ends[0]);
      throw Stopped{};
    }
    const int ready = poll(&there, 1, look);
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    const ssize_t n = read(ends[0], block, sizeof block);
    if (n == 0 || (n < 0 && errno != EINTR)) break;
    if (n > 0) bytes.append(block, std::size_t(n));
  }
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return understand(bytes);
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
    return {.error = fmt::format("it did not end within {} minutes", minutes), .in_time = false};
  if (WIFSIGNALED(status)) return {.error = fmt::format("it crashed (signal {})", WTERMSIG(status))};
  return {};
}

}  // namespace

bool has_gmsh() {
  return loaded().mesh != nullptr;
}

RawMesh mesh_geometry(const BodySource& source) {
  const Module& module = needed(source.path);
  read_file(source.path);  // gmsh says nothing of a file that is not there
  const std::string path = source.path.string(), absolute = std::filesystem::absolute(source.path).string();
  const TemporaryFile file(".msh");
  // Chords that are too long may cross.
  for (const int turn : {12, 48, 192}) {
    const KerfGmshRequest request{absolute.c_str(), file.name().c_str(), !source.keep_mesh, source.size, turn};
    Told told = in_child(source.keep_mesh ? fine_minutes : coarse_minutes, file,
                         [&](Teller& teller) { return module.mesh(&request, Teller::curve, Teller::error, &teller); });
    if (told.error.empty()) {
      RawMesh raw = parse_msh(path, read_file(file.name()));
      if (!source.keep_mesh) raw.curves = std::move(told.curves);
      return raw;
    }
    if (source.keep_mesh || turn == 192 || !told.in_time)
      throw Error(Fault::Geometry, fmt::format("{}: gmsh: {}", path, told.error));
  }
  return {};
}

namespace {

/// Arcs of more than a third of a turn in pieces.
std::vector<Side> short_arcs(const Loop& loop) {
  std::vector<Side> out;
  for (const Side& side : loop.sides) {
    const double whole = side.arc ? side.arc->to - side.arc->from : 0;
    const int count = std::max(1, int(std::ceil(std::abs(whole) / (2 * pi / 3) - 1e-9)));
    for (int k = 0; k < count; ++k) {
      Side part = side;
      if (side.arc) part.start = k == 0 ? side.start : at(*side.arc, side.arc->from + whole * k / count);
      out.push_back(part);
    }
  }
  return out;
}

}  // namespace

std::string step_file(const Shape& shape) {
  const Module& module = needed("STEP");
  const Shape drawn = circular(shape, 1e-4 * extent(shape), true);
  std::vector<Side> sides;
  std::vector<std::int64_t> ends;
  const auto add = [&](const Loop& loop) {
    for (const Side& side : short_arcs(loop)) sides.push_back(side);
    ends.push_back(std::int64_t(sides.size()));
  };
  add(drawn.outline);
  for (const Loop& hole : drawn.holes) add(hole);
  std::vector<double> start, center;
  const auto arc = std::make_unique<bool[]>(sides.size());
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const Vec2 c = sides[k].arc ? sides[k].arc->center : Vec2(0, 0);
    start.insert(start.end(), {sides[k].start.x(), sides[k].start.y()});
    center.insert(center.end(), {c.x(), c.y()});
    arc[k] = sides[k].arc.has_value();
  }
  const KerfGmshFace face{std::int64_t(ends.size()), ends.data(), start.data(), arc.get(), center.data()};
  const TemporaryFile file(".step");
  const Told told = in_child(coarse_minutes, file, [&](Teller& teller) {
    return module.step(file.name().c_str(), &face, Teller::error, &teller);
  });
  if (!told.error.empty()) throw Error(Fault::Geometry, fmt::format("no STEP file: gmsh: {}", told.error));
  std::string bytes = read_file(file.name());
  if (bytes.find("END-ISO-10303-21") == std::string::npos)  // gmsh does not look whether all was written
    throw Error(Fault::Files, fmt::format("no STEP file: gmsh wrote {} bytes without an end to '{}'; is the disk full?",
                                          bytes.size(), file.name()));
  return bytes;
}

}  // namespace kerf
