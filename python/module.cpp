// _kerf: cases, runs and what they leave, for the Python around them. Computations go on in a thread of their own,
// without the interpreter, while the calling thread looks for signals every 50 ms: Ctrl-C asks for a stop, and what the
// handler raised leaves once the computation has stopped. Settings of the whole process that kerf changes (threads of
// OpenBLAS, levels of OpenMP) are given back when nothing computes any more. Arrays are read-only windows into the
// fields of an outcome and keep it alive. An exception of a user's function is raised as the cause of kerf's error, one
// of a callback as itself. Meshes, and values at points, are copies.

#include "app/body_mesh.hpp"
#include "app/folder.hpp"
#include "app/forecast.hpp"
#include "app/program.hpp"
#include "app/run.hpp"
#include "app/sweep.hpp"
#include "io/files.hpp"
#include "io/growth_columns.hpp"
#include "io/kept.hpp"
#include "io/read_result.hpp"
#include "kerf/stop.hpp"
#include "optimize/designs.hpp"
#include "plot/fonts.hpp"
#include "python/document.hpp"

#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <dlfcn.h>

#include <condition_variable>
#include <thread>

namespace py = pybind11;

namespace kerf {

namespace {

/// What kerf sets for the whole process so that bits do not depend on it: given back once nothing computes any more.
class Computing {
 public:
  Computing() {
    const std::scoped_lock lock(mutex());
    if (count()++ > 0) return;
    if (const auto get = find<int (*)()>("openblas_get_num_threads")) blas_threads() = get();
    if (const auto get = find<int (*)()>("omp_get_max_active_levels")) levels() = get();
  }
  ~Computing() {
    const std::scoped_lock lock(mutex());
    if (--count() > 0) return;
    if (const auto set = find<void (*)(int)>("openblas_set_num_threads")) set(blas_threads());
    if (const auto set = find<void (*)(int)>("omp_set_max_active_levels")) set(levels());
    forget_stop();
  }
  Computing(const Computing&) = delete;
  Computing& operator=(const Computing&) = delete;

 private:
  template <typename F>
  static F find(const char* name) {
    return reinterpret_cast<F>(dlsym(RTLD_DEFAULT, name));
  }
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  static int& count() {
    static int number = 0;
    return number;
  }
  static int& blas_threads() {
    static int number = 1;
    return number;
  }
  static int& levels() {
    static int number = 1;
    return number;
  }
};

/// `work` in a thread of its own, without the interpreter, while this one sees to signals: Ctrl-C asks for a stop, and
/// what the handler raised leaves once it has stopped.
template <typename Work>
void compute(const Work& work) {
  std::exception_ptr failure;
  std::mutex mutex;
  std::condition_variable ended;
  bool done = false, interrupted = false;
  PyObject *type = nullptr, *value = nullptr, *trace = nullptr;
  {
    const py::gil_scoped_release without_interpreter;
    const Computing computing;
    std::thread thread([&] {
      try {
        // One state of the interpreter for all calls of functions from this thread: a new one each costs ten times as
        // much as a call.
        const py::gil_scoped_acquire interpreter;
        const py::gil_scoped_release meanwhile;
        work();
      } catch (...) {
        failure = std::current_exception();
      }
      const std::scoped_lock lock(mutex);
      done = true;
      ended.notify_all();
    });
    for (std::unique_lock lock(mutex); !ended.wait_for(lock, std::chrono::milliseconds(50), [&] { return done; });) {
      if (interrupted) continue;
      lock.unlock();
      {
        const py::gil_scoped_acquire interpreter;
        interrupted = PyErr_CheckSignals() != 0;
        if (interrupted) PyErr_Fetch(&type, &value, &trace);
      }
      if (interrupted) request_stop();
      lock.lock();
    }
    thread.join();
  }
  if (interrupted) {
    PyErr_Restore(type, value, trace);
    throw py::error_already_set();
  }
  if (failure) std::rethrow_exception(failure);
}

struct PythonCase {
  Case c;
  std::shared_ptr<Trouble> trouble = std::make_shared<Trouble>();
  bool functions = false;
};

/// What a function of Python raised comes before what kerf made of it: the cause of a CaseError, or itself.
template <typename Work>
void compute_for(const PythonCase& of, const Work& work) {
  const auto raise_kept = [&](const char* message) {
    const py::object raised = of.trouble->take();
    if (!raised) return;
    py::module_::import("kerf._errors").attr("raise_from")(message, raised, of.trouble->by_callback());
  };
  try {
    compute(work);
  } catch (const Error& e) {
    raise_kept(e.what());
    throw;
  } catch (const Stopped&) {
    raise_kept("");
    throw Error(Fault::Numerics, "stopped");
  }
}

std::unique_ptr<PythonCase> case_of_file(const std::string& path, const std::vector<std::string>& overrides) {
  auto out = std::make_unique<PythonCase>();
  compute_for(*out, [&] { out->c = read_case(path, overrides); });
  return out;
}

std::unique_ptr<PythonCase> case_of_document(const py::dict& document, const std::string& name,
                                             const std::string& folder, const std::vector<std::string>& overrides) {
  auto out = std::make_unique<PythonCase>();
  Node root = node_of(document, out->trouble);
  out->functions = has_functions(root);
  compute_for(*out, [&] { out->c = read_case(std::move(root), {name, folder, "case"}, overrides); });
  return out;
}

std::unique_ptr<PythonCase> case_of_text(const std::string& text, const std::string& name, const std::string& folder,
                                         const std::vector<std::string>& overrides) {
  auto out = std::make_unique<PythonCase>();
  compute_for(*out, [&] { out->c = read_case(parse_document(text, name), {name, folder, name}, overrides); });
  return out;
}

/// The numbers of an iteration, as the columns of history.csv have them.
py::dict in_python(const Iteration& i) {
  py::dict out;
  out["iteration"] = i.number;
  out["objective"] = i.objective;
  out["merit"] = i.merit;
  out["volume_fraction"] = i.volume_fraction;
  out["bounds"] = i.bounds;
  out["violation"] = i.violation;
  out["step"] = i.step;
  out["optimality"] = i.optimality;
  out["holes"] = i.holes;
  out["triangles"] = i.triangles;
  out["state_solves"] = i.state_solves;
  out["accepted"] = i.accepted;
  out["note"] = i.note;
  out["variables"] = std::vector<double>(i.variables.begin(), i.variables.end());
  return out;
}

/// The numbers of a step of growth, as growth.csv has them.
py::dict in_python(const growth::GrowthStep& s) {
  py::dict out;
  out["step"] = s.number;
  out["cycles"] = s.cycles;
  out["load"] = s.load;
  out["solves"] = s.solves;
  py::list tips;
  for (const growth::GrownTip& t : s.tips) {
    py::dict tip;
    tip["tip"] = t.name;
    tip["at"] = std::array{t.at.x(), t.at.y()};
    for (const auto& [name, member] : columns_of_tip) tip[name] = t.*member;
    tips.append(std::move(tip));
  }
  out["tips"] = std::move(tips);
  return out;
}

struct Outcome {
  Result result;
  RunFields fields;
};

struct How {
  std::string job, folder;
  int threads = 1;
  bool force = false, resume = false, files = true;
  py::object on_phase, on_iteration, on_step;
};

/// Calls back into Python. What that raises ends the computation.
template <typename... Arguments>
void tell(const py::object& function, Trouble& trouble, const Arguments&... arguments) {
  try {
    function(arguments...);
  } catch (py::error_already_set& e) {
    e.restore();
    trouble.keep(true);
    throw Stopped{};
  }
}

std::unique_ptr<Outcome> run_case(const PythonCase& of, const How& how) {
  auto out = std::make_unique<Outcome>();
  Case c = of.c;
  if (!how.files) c.output.vtk = c.output.png = false;
  const Job job = job_called(how.job);
  if (how.resume && of.functions)
    throw Error(Fault::Usage, "a case with functions of Python cannot be resumed: they may be others than before");
  RunOptions options{.folder = how.folder, .command = "import kerf", .threads = how.threads, .resume = how.resume};
  options.fields = &out->fields;
  if (!how.on_phase.is_none())
    options.on_phase = [&](const std::string& phase) {
      const py::gil_scoped_acquire interpreter;
      tell(how.on_phase, *of.trouble, phase);
    };
  if (!how.on_iteration.is_none())
    options.on_iteration = [&](const Iteration& i) {
      const py::gil_scoped_acquire interpreter;
      tell(how.on_iteration, *of.trouble, in_python(i));
    };
  if (!how.on_step.is_none())
    options.on_step = [&](const growth::GrowthStep& s) {
      const py::gil_scoped_acquire interpreter;
      tell(how.on_step, *of.trouble, in_python(s));
    };
  compute_for(of, [&] {
    forecast_where_needed(c, job, how.threads, {});
    FolderLock lock;
    claim_folder(options.folder, how.force, how.resume, lock);
    options.lock = &lock;
    out->result = run(c, job, options);
  });
  return out;
}

// Arrays are windows into the fields of an outcome, which they keep alive.

py::array window(const py::object& owner, const double* data, py::ssize_t rows, py::ssize_t columns = 0,
                 py::ssize_t stride = 0) {
  const py::ssize_t step = stride ? stride : std::max<py::ssize_t>(columns, 1) * static_cast<py::ssize_t>(sizeof *data);
  py::array out = columns ? py::array(py::dtype::of<double>(), {rows, columns},
                                      {step, static_cast<py::ssize_t>(sizeof *data)}, data, owner)
                          : py::array(py::dtype::of<double>(), {rows}, {step}, data, owner);
  out.attr("setflags")(py::arg("write") = false);
  return out;
}

py::array window(const py::object& owner, const std::vector<std::array<Index, 3>>& all) {
  py::array out(py::dtype::of<Index>(), {static_cast<py::ssize_t>(all.size()), py::ssize_t{3}},
                {static_cast<py::ssize_t>(sizeof all[0]), static_cast<py::ssize_t>(sizeof(Index))}, all.data(), owner);
  out.attr("setflags")(py::arg("write") = false);
  return out;
}

py::array window(const py::object& owner, const std::vector<Vec2>& points) {
  return window(owner, points.empty() ? nullptr : points[0].data(), static_cast<py::ssize_t>(points.size()), 2);
}

/// A column is a row of the array.
template <typename Matrix>
py::array rows_of(const py::object& owner, const Matrix& columns) {
  return window(owner, columns.data(), columns.cols(), columns.rows());
}

py::array window(const py::object& owner, const Eigen::VectorXd& values) {
  return window(owner, values.data(), values.size());
}

/// Bits have no place that a window could show.
py::array_t<bool> copy_of(const std::vector<bool>& bits) {
  py::array_t<bool> out(static_cast<py::ssize_t>(bits.size()));
  std::copy(bits.begin(), bits.end(), out.mutable_data());
  return out;
}

py::dict arrays(const py::object& self) {
  const auto& [mesh, state, indicator, map, at] = self.cast<const Outcome&>().fields;
  py::dict out;
  out["points"] = window(self, mesh.points);
  out["triangles"] = window(self, mesh.triangles);
  out["corner_points"] = window(self, state.points);
  out["corner_triangles"] = window(self, state.corners.of);
  out["corner_vertex"] = py::array(py::dtype::of<Index>(), {static_cast<py::ssize_t>(state.corners.vertex.size())},
                                   {static_cast<py::ssize_t>(sizeof(Index))}, state.corners.vertex.data(), self);
  out["corner_vertex"].attr("setflags")(py::arg("write") = false);
  out["displacement"] = rows_of(self, state.values.displacement);
  out["stress"] = rows_of(self, state.values.stress);
  out["rotation"] = window(self, state.values.rotation.data(), state.values.rotation.size());
  out["von_mises"] = window(self, state.von_mises);
  if (indicator.size() > 0) out["error_indicator"] = window(self, indicator);
  if (map.at_corners.size() > 0) {
    out["topological_derivative"] = window(self, map.at_corners);
    out["masked"] = copy_of(map.masked_corner);
  }
  if (map.lower.size() > 0) {
    out["lower"] = window(self, map.lower);
    out["upper"] = window(self, map.upper);
  }
  if (map.angle.size() > 0) out["angle"] = window(self, map.angle);
  return out;
}

py::dict crack_arrays(const py::object& self, const std::string& name) {
  for (const CrackResult& crack : self.cast<const Outcome&>().result.cracks) {
    if (crack.name != name) continue;
    py::dict out;
    const auto n = static_cast<py::ssize_t>(crack.rows.size());
    const CrackRow* const first = crack.rows.data();
    const py::ssize_t step = sizeof(CrackRow);
    if (!first) return out;
    out["s"] = window(self, &first->s, n, 0, step);
    out["at"] = window(self, first->at.data(), n, 2, step);
    out["jump_n"] = window(self, &first->jump_n, n, 0, step);
    out["jump_t"] = window(self, &first->jump_t, n, 0, step);
    out["sigma_n"] = window(self, &first->sigma_n, n, 0, step);
    out["sigma_t"] = window(self, &first->sigma_t, n, 0, step);
    out["fluid_pressure"] = window(self, &first->fluid_pressure, n, 0, step);
    out["gap"] = window(self, &first->gap, n, 0, step);
    std::vector<bool> closed;
    for (const CrackRow& row : crack.rows) closed.push_back(row.closed);
    out["closed"] = copy_of(closed);
    return out;
  }
  throw py::key_error(name);
}

// Copies.

template <typename Values>
py::array rows_copied(const Values& columns) {
  py::array_t<double> out({columns.cols(), columns.rows()});
  std::copy_n(columns.data(), columns.size(), out.mutable_data());
  return out;
}

py::array_t<double> copy_of(const double* values, Eigen::Index count) {
  py::array_t<double> out(static_cast<py::ssize_t>(count));
  std::copy_n(values, count, out.mutable_data());
  return out;
}

template <std::size_t width>
py::array copy_of(const std::vector<std::array<Index, width>>& rows) {
  py::array_t<Index> out({static_cast<py::ssize_t>(rows.size()), static_cast<py::ssize_t>(width)});
  for (std::size_t i = 0; i < rows.size(); ++i) std::copy(rows[i].begin(), rows[i].end(), out.mutable_data(i, 0));
  return out;
}

using Places = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::vector<Vec2> points_of(const Places& rows) {
  if (rows.ndim() != 2 || rows.shape(1) != 2) throw Error(Fault::Usage, "points are rows of x and y: shape (n, 2)");
  std::vector<Vec2> points;
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) points.emplace_back(rows.at(i, 0), rows.at(i, 1));
  return points;
}

py::dict values_at(const Outcome& of, const Places& rows) {
  const std::vector<Vec2> points = points_of(rows);
  ValuesAt v;
  compute([&] { v = of.fields.at(points); });
  py::dict out;
  out["triangle"] = py::array_t<Index>(static_cast<py::ssize_t>(v.triangle.size()), v.triangle.data());
  out["displacement"] = rows_copied(v.displacement);
  out["stress"] = rows_copied(v.stress);
  out["rotation"] = copy_of(v.rotation.data(), v.rotation.size());
  out["von_mises"] = copy_of(v.von_mises.data(), v.von_mises.size());
  if (v.derivative.size() > 0) {
    out["topological_derivative"] = copy_of(v.derivative.data(), v.derivative.size());
    out["masked"] = copy_of(v.masked);
  }
  return out;
}

/// Triangles that hold the points, -1 outside.
std::vector<Index> triangles_at(const Places& corners, const py::array_t<Index, py::array::c_style>& triangles,
                                const Places& rows) {
  std::vector<std::array<Index, 3>> all;
  for (py::ssize_t t = 0; t < triangles.shape(0); ++t)
    all.push_back({triangles.at(t, 0), triangles.at(t, 1), triangles.at(t, 2)});
  const Mesh mesh = connect(points_of(corners), std::move(all), {});
  const Locator locator = make_locator(mesh);
  std::vector<Index> out;
  for (const Vec2& x : points_of(rows)) out.push_back(x.allFinite() ? locate(mesh, locator, x) : none);
  return out;
}

/// Points, triangles and their regions, and edges that mean something, by names: sides and cracks.
py::dict mesh_arrays(const PythonCase& of) {
  Mesh mesh;
  compute_for(of, [&] { mesh = mesh_of_run(of.c); });
  const Shape& shape = of.c.shape;
  py::dict out, sides, cracks, regions;
  Eigen::Map<const Points> points(mesh.points.empty() ? nullptr : mesh.points[0].data(), 2,
                                  static_cast<Eigen::Index>(mesh.points.size()));
  out["points"] = rows_copied(points);
  out["triangles"] = copy_of(mesh.triangles);
  std::vector<std::vector<std::array<Index, 2>>> of_label(shape.labels.size());
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.label[e] != none) of_label[static_cast<std::size_t>(mesh.label[e])].push_back(mesh.edges[e]);
  for (std::size_t k = 0; k < of_label.size(); ++k) sides[py::str(shape.labels[k])] = copy_of(of_label[k]);
  for (std::size_t k = 0; k < shape.cracks.size(); ++k) {
    std::vector<std::array<Index, 2>> edges;
    for (const auto& [edge, forward] : mesh.cracks[k]) {
      const auto& [a, b] = mesh.edges[static_cast<std::size_t>(edge)];
      edges.push_back(forward ? std::array{a, b} : std::array{b, a});
    }
    cracks[py::str(shape.cracks[k].name)] = copy_of(edges);
  }
  for (std::size_t k = 0; k < shape.regions.size(); ++k) {
    std::vector<bool> inside;
    for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t)
      inside.push_back(region_of(mesh, t) == static_cast<Index>(k));
    regions[py::str(shape.regions[k].name)] = copy_of(inside);
  }
  out["labels"] = sides;
  out["cracks"] = cracks;
  out["regions"] = regions;
  return out;
}

/// The designs of a case, which must outlive it.
struct PythonDesigns {
  const PythonCase& of;
  std::unique_ptr<DesignSpace> space = {};
};

std::unique_ptr<PythonDesigns> designs_of(const PythonCase& of, int threads) {
  if (!of.c.optimize)
    throw Error(Fault::Usage, "the case has no table [optimize]; add it with method and a hole or crack");
  auto out = std::make_unique<PythonDesigns>(PythonDesigns{of});
  compute_for(of, [&] { out->space = std::make_unique<DesignSpace>(problem_of(of.c, threads), *of.c.optimize); });
  return out;
}

py::dict values_of(PythonDesigns& designs, const std::vector<double>& x, bool gradients) {
  DesignValues v;
  const Eigen::VectorXd at = Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
  compute_for(designs.of, [&] { v = designs.space->evaluate(at, gradients); });
  py::dict out;
  out["value"] = v.value;
  out["objective"] = v.objective;
  out["volume_fraction"] = v.volume_fraction;
  out["bounds"] = py::array_t<double>(static_cast<py::ssize_t>(v.bounds.size()), v.bounds.data());
  out["constraints"] = copy_of(v.constraints.data(), v.constraints.size());
  out["gradient"] = gradients ? py::object(copy_of(v.gradient.data(), v.gradient.size())) : py::none();
  const Eigen::MatrixXd by_rows = v.jacobian.transpose();
  out["jacobian"] = gradients ? py::object(rows_copied(by_rows)) : py::none();
  out["triangles"] = v.triangles;
  out["failure"] = v.failure;
  return out;
}

py::array_t<double> copy_of(const Eigen::VectorXd& values) {
  return copy_of(values.data(), values.size());
}

std::unique_ptr<Outcome> outcome_in(const std::string& folder) {
  auto out = std::make_unique<Outcome>();
  compute([&] { out->result = read_result(folder); });
  return out;
}

void translate(std::exception_ptr thrown) {
  const auto raise = [](int code, const char* what) {
    const py::object made = py::module_::import("kerf._errors").attr("made")(code, what);
    PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(made.ptr())), made.ptr());
  };
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const Error& e) {
    raise(static_cast<int>(e.fault), e.what());
  } catch (const std::filesystem::filesystem_error& e) {
    raise(static_cast<int>(Fault::Files), e.what());
  } catch (const Stopped&) {
    raise(static_cast<int>(Fault::Numerics), "stopped");
  }
}

void offer_cases(py::module_& m) {
  py::class_<PythonCase>(m, "Case")
      .def_static("of_file", &case_of_file)
      .def_static("of_document", &case_of_document)
      .def_static("of_text", &case_of_text)
      .def_property_readonly("name", [](const PythonCase& of) { return of.c.name; })
      .def_property_readonly("title", [](const PythonCase& of) { return of.c.title; })
      .def_property_readonly("has_functions", [](const PythonCase& of) { return of.functions; })
      .def("keep",
           [](const PythonCase& of, const std::string& folder) {
             const KeptCase kept = keep(of.c, {std::string(head_of_results) + KERF_VERSION + " read it"});
             for (const auto& [name, bytes] : kept.files) write_file(folder, name, bytes);
             write_file(std::filesystem::path(folder) / "case.toml", kept.text);
           })
      .def("document", [](const PythonCase& of) { return in_python(*of.c.document); })
      .def_property_readonly("folder", [](const PythonCase& of) { return of.c.folder.string(); })
      .def("facts",
           [](const PythonCase& of) {
             const Shape& shape = of.c.shape;
             return std::tuple(shape.cracks.size(), shape.holes.size(), shape.labels, of.c.element.name,
                               of.c.element.degree);
           })
      .def("mesh", &mesh_arrays)
      .def("designs", &designs_of, py::keep_alive<0, 1>())
      .def("text", [](const PythonCase& of) { return keep(of.c, {}).text; })
      .def("check",
           [](const PythonCase& of) {
             std::string said;
             compute_for(of, [&] { said = check(of.c); });
             return said;
           })
      .def(
          "run",
          [](const PythonCase& of, std::string job, std::string folder, int threads, bool force, bool resume,
             bool files, py::object on_phase, py::object on_iteration, py::object on_step) {
            return run_case(of, {std::move(job), std::move(folder), threads, force, resume, files, std::move(on_phase),
                                 std::move(on_iteration), std::move(on_step)});
          },
          py::kw_only(), py::arg("job"), py::arg("folder"), py::arg("threads"), py::arg("force"), py::arg("resume"),
          py::arg("files"), py::arg("on_phase"), py::arg("on_iteration"), py::arg("on_step"));
  py::class_<PythonDesigns>(m, "Designs")
      .def_property_readonly("names", [](const PythonDesigns& d) { return d.space->names(); })
      .def_property_readonly("constraints", [](const PythonDesigns& d) { return d.space->constraints(); })
      .def_property_readonly("lower", [](const PythonDesigns& d) { return copy_of(d.space->lower()); })
      .def_property_readonly("upper", [](const PythonDesigns& d) { return copy_of(d.space->upper()); })
      .def_property_readonly("start", [](const PythonDesigns& d) { return copy_of(d.space->start()); })
      .def("forget_meshes", [](PythonDesigns& d) { d.space->forget_meshes(); })
      .def("evaluate", &values_of);
}

void offer_sweeps(py::module_& m) {
  py::class_<SweepPlan>(m, "SweepPlan")
      .def(py::init([](const std::string& case_file, const std::string& folder,
                       const std::vector<std::string>& overrides,
                       const std::vector<std::pair<std::string, std::vector<std::string>>>& over) {
        SweepPlan plan{.case_file = case_file, .folder = folder, .overrides = overrides, .columns = {"all"}};
        for (const auto& [key, values] : over) plan.over.push_back({key, values});
        return plan_sweep(std::move(plan));
      }))
      .def("runs",
           [](const SweepPlan& plan) {
             std::vector<std::pair<std::string, std::vector<std::string>>> out;
             for (const SweepRun& run : plan.runs) out.emplace_back(run.name, overrides_of(plan, run));
             return out;
           })
      .def("is_to_do",
           [](const SweepPlan& plan, std::size_t run) {
             return record_of(plan, plan.runs.at(run)).state == RunRecord::State::Todo;
           })
      .def("collect",
           [](const SweepPlan& plan) {
             const SweepSummary s = collect_sweep(plan);
             return std::tuple(s.done, s.failed, s.missing, in_words(s, plan));
           })
      .def("write", &write_sweep_script);
  m.def("write_failure",
        [](const std::string& folder, int code, const std::string& message) { write_failure(folder, code, message); });
}

void offer_outcomes(py::module_& m) {
  py::class_<Outcome>(m, "Outcome")
      .def_property_readonly("status", [](const Outcome& o) { return o.result.status; })
      .def_property_readonly("reason", [](const Outcome& o) { return o.result.reason; })
      .def("summary", [](const Outcome& o) { return summary(o.result); })
      .def("arrays", &arrays)
      .def_property_readonly("crack_names",
                             [](const Outcome& o) {
                               std::vector<std::string> names;
                               for (const CrackResult& crack : o.result.cracks) names.push_back(crack.name);
                               return names;
                             })
      .def_property_readonly("can_read", [](const Outcome& o) { return static_cast<bool>(o.fields.at); })
      .def("at", &values_at)
      .def("crack", &crack_arrays);
  m.def("read_result", &outcome_in);
  m.def("triangles_at", &triangles_at);
}

}  // namespace

PYBIND11_MODULE(_kerf, m) {
  offer_own_font();
  py::register_exception_translator(translate);
  m.attr("__version__") = KERF_VERSION;
  m.def("toml", [](py::handle value) {
    const auto trouble = std::make_shared<Trouble>();
    const Node node = value_node(value, "set", trouble);
    if (has_functions(node))
      throw Error(Fault::Usage, "a function stands in the dict of a case; what is set or swept are values");
    return inline_text(node);
  });
  offer_cases(m);
  offer_sweeps(m);
  offer_outcomes(m);
}

}  // namespace kerf
