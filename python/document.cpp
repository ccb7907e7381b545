// Python objects as documents of kerf's reader, and functions of Python as expressions. bool comes before int, of which
// it is a kind; arrays and numbers of numpy come by tolist(), paths by __fspath__(). Positions are paths such as
// crack[0].path, so that messages name them. A callable becomes a function of (x, y) or (x, y, nx, ny), by the number
// of its arguments; it may be called from several threads, each of which takes the interpreter first. What it raises is
// kept (the first only), and the computation gets an Error in its place. Where a case takes a vector it may return both
// components. References are given back with the interpreter held.

#include "python/document.hpp"

#include "io/words.hpp"

#include <fmt/format.h>

#include <cmath>

namespace py = pybind11;

namespace kerf {

Trouble::~Trouble() {
  if (!raised_) return;
  const py::gil_scoped_acquire python;
  Py_DECREF(raised_);
}

void Trouble::keep(bool by_callback) {
  PyObject *type = nullptr, *value = nullptr, *trace = nullptr;
  PyErr_Fetch(&type, &value, &trace);
  PyErr_NormalizeException(&type, &value, &trace);
  if (value && trace) PyException_SetTraceback(value, trace);
  Py_XDECREF(type);
  Py_XDECREF(trace);
  if (raised_) {
    Py_XDECREF(value);
    return;
  }
  raised_ = value;
  by_callback_ = by_callback;
}

py::object Trouble::take() {
  return py::reinterpret_steal<py::object>(std::exchange(raised_, nullptr));
}

namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
  throw Error(Fault::Usage, fmt::format("{}: {}", path, what));
}

std::string type_name(py::handle value) {
  return Py_TYPE(value.ptr())->tp_name;
}

/// A number or two behind an interpreter that need not be held by whoever calls it.
class Callable {
 public:
  Callable(py::object function, int arguments, std::shared_ptr<Trouble> trouble)
      : function_(function.release().ptr()), arguments_(arguments), trouble_(std::move(trouble)) {}
  Callable(const Callable&) = delete;
  Callable& operator=(const Callable&) = delete;
  ~Callable() {
    const py::gil_scoped_acquire python;
    Py_DECREF(function_);
  }

  double number(const Vec2& x, const Vec2& n) const {
    const py::gil_scoped_acquire python;
    PyObject* const out = call(x, n);
    const double value = out ? PyFloat_AsDouble(out) : nan;
    Py_XDECREF(out);
    if (PyErr_Occurred()) fail(x);
    return value;
  }

  Vec2 pair(const Vec2& x, const Vec2& n) const {
    const py::gil_scoped_acquire python;
    try {
      const auto out = py::reinterpret_steal<py::object>(call(x, n));
      if (!out) fail(x);
      const auto two = helper("two_numbers")(out).cast<std::pair<double, double>>();
      return {two.first, two.second};
    } catch (py::error_already_set& e) {
      e.restore();
      fail(x);
    }
  }

  py::object function() const {
    return py::reinterpret_borrow<py::object>(function_);
  }

 private:
  static py::object helper(const char* name) {
    return py::module_::import("kerf._functions").attr(name);
  }

  /// Null where it raises. A function that is written for arrays alone gets arrays of one number.
  PyObject* call(const Vec2& x, const Vec2& n) const {
    if (!for_arrays_) {
      PyObject* const out = arguments_ == 4 ? PyObject_CallFunction(function_, "dddd", x.x(), x.y(), n.x(), n.y())
                                            : PyObject_CallFunction(function_, "dd", x.x(), x.y());
      if (out || !(PyErr_ExceptionMatches(PyExc_TypeError) || PyErr_ExceptionMatches(PyExc_IndexError))) return out;
    }
    PyObject *type = nullptr, *value = nullptr, *trace = nullptr;
    PyErr_Fetch(&type, &value, &trace);
    const py::object given =
        arguments_ == 4 ? py::make_tuple(x.x(), x.y(), n.x(), n.y()) : py::make_tuple(x.x(), x.y());
    PyObject* const out =
        PyObject_CallFunctionObjArgs(helper("called_with_arrays").ptr(), function_, given.ptr(), nullptr);
    if (out || for_arrays_) {
      for_arrays_ = true;
      for (PyObject* one : {type, value, trace}) Py_XDECREF(one);
      return out;
    }
    PyErr_Restore(type, value, trace);  // what it said of numbers
    return nullptr;
  }

  [[noreturn]] void fail(const Vec2& x) const {
    trouble_->keep();
    throw Error(Fault::Usage, fmt::format("the function failed at ({:.6g}, {:.6g})", x.x(), x.y()));
  }

  PyObject* function_;
  int arguments_;
  mutable bool for_arrays_ = false;  // whoever looks at it holds the interpreter
  std::shared_ptr<Trouble> trouble_;
};

/// As an expression that still knows its function.
struct AsNumber {
  std::shared_ptr<const Callable> of;
  double operator()(const Vec2& x, const Vec2& n) const {
    return of->number(x, n);
  }
};

class Conversion {
 public:
  explicit Conversion(const std::shared_ptr<Trouble>& trouble) : trouble_(trouble) {}

  Node convert(py::handle value, const std::string& path, int depth) const {
    constexpr int deepest = 32;
    if (depth > deepest) refuse(path, "the case is nested too deeply");
    Node node;
    node.position = {std::make_shared<const std::string>(path), 0, 0};
    if (py::isinstance<py::bool_>(value)) {
      node.kind = Node::Kind::Boolean;
      node.boolean = value.ptr() == Py_True;
    } else if (PyLong_Check(value.ptr())) {
      node.kind = Node::Kind::Integer;
      const long long whole = PyLong_AsLongLong(value.ptr());
      if (PyErr_Occurred()) {
        PyErr_Clear();
        refuse(path, "the number does not fit 64 bits");
      }
      node.number = static_cast<double>(whole);
    } else if (PyFloat_Check(value.ptr())) {
      node.kind = Node::Kind::Float;
      node.number = PyFloat_AS_DOUBLE(value.ptr());
    } else if (PyUnicode_Check(value.ptr())) {
      node.kind = Node::Kind::String;
      node.text = text_of(value, path);
    } else if (PyDict_Check(value.ptr())) {
      add_table(py::reinterpret_borrow<py::dict>(value), path, depth, node);
    } else if (PyList_Check(value.ptr()) || PyTuple_Check(value.ptr())) {
      add_list(value, path, depth, node);
    } else if (PyCallable_Check(value.ptr())) {
      add_function(value, path, node);
    } else {
      return convert_other(value, path, depth);
    }
    return node;
  }

 private:
  static std::string text_of(py::handle value, const std::string& path) {
    Py_ssize_t size = 0;
    const char* const text = PyUnicode_AsUTF8AndSize(value.ptr(), &size);
    if (!text) {
      PyErr_Clear();
      refuse(path, "the string is not valid Unicode");
    }
    return {text, static_cast<std::size_t>(size)};
  }

  void add_table(const py::dict& table, const std::string& path, int depth, Node& node) const {
    for (const auto& [key, value] : table) {
      if (!PyUnicode_Check(key.ptr())) refuse(path, fmt::format("keys are strings, not {}", type_name(key)));
      std::string name = text_of(key, path);
      const std::string part = is_safe_name(name) ? name : quote(name);
      const std::string inner = depth == 0 ? part : fmt::format("{}.{}", path, part);
      Node below = convert(value, inner, depth + 1);
      const Position position = below.position;
      node.entries.push_back({std::move(name), position, std::move(below)});
    }
  }

  void add_list(py::handle list, const std::string& path, int depth, Node& node) const {
    node.kind = Node::Kind::Array;
    const auto items = py::reinterpret_borrow<py::sequence>(list);
    for (std::size_t k = 0; k < items.size(); ++k)
      node.items.push_back(convert(py::object(items[k]), fmt::format("{}[{}]", path, k), depth + 1));
  }

  void add_function(py::handle function, const std::string& path, Node& node) const {
    const auto [count, words] =
        py::module_::import("kerf._functions").attr("look_at")(function).cast<std::pair<int, std::string>>();
    if (count != 2 && count != 4)
      refuse(path, "a function of the place takes 2 arguments, f(x, y), or 4 on boundaries, f(x, y, nx, ny)");
    node.kind = Node::Kind::Function;
    node.text = words;
    const auto held = std::make_shared<const Callable>(py::reinterpret_borrow<py::object>(function), count, trouble_);
    node.function = AsNumber{held};
    node.pair = [held](const Vec2& x, const Vec2& n) { return held->pair(x, n); };
  }

  /// What numpy, pathlib and others have in place of Python's own: arrays and their numbers, paths.
  Node convert_other(py::handle value, const std::string& path, int depth) const {
    if (value.is_none()) refuse(path, "None is no value; leave the key out");
    if (py::hasattr(value, "__fspath__")) return convert(value.attr("__fspath__")(), path, depth + 1);
    if (py::hasattr(value, "tolist")) return convert(value.attr("tolist")(), path, depth + 1);
    refuse(path, fmt::format("a {} is no value of a case; use numbers, strings, lists, dicts or functions of x, y",
                             quote(type_name(value))));
  }

  const std::shared_ptr<Trouble>& trouble_;
};

py::object number_in_python(const Node& node) {
  if (node.kind == Node::Kind::Integer) return py::int_(static_cast<long long>(node.number));
  return py::float_(node.number);
}

}  // namespace

py::object in_python(const Node& node) {
  switch (node.kind) {
    case Node::Kind::Boolean:
      return py::bool_(node.boolean);
    case Node::Kind::Integer:
    case Node::Kind::Float:
      return number_in_python(node);
    case Node::Kind::String:
      return py::str(node.text);
    case Node::Kind::Function:
      if (const auto* number = node.function.target<AsNumber>()) return number->of->function();
      break;
    case Node::Kind::Array: {
      py::list out;
      for (const Node& item : node.items) out.append(in_python(item));
      return out;
    }
    case Node::Kind::Table: {
      py::dict out;
      for (const Entry& entry : node.entries) out[py::str(entry.key)] = in_python(entry.value);
      return out;
    }
    case Node::Kind::Date:
      break;
  }
  throw Error(Fault::Usage, to_string(node.position) + ": a date is no value of a case");
}

Node value_node(py::handle value, const std::string& path, const std::shared_ptr<Trouble>& trouble) {
  return Conversion(trouble).convert(value, path, 1);
}

Node node_of(py::handle value, const std::shared_ptr<Trouble>& trouble) {
  Node root = Conversion(trouble).convert(value, "case", 0);
  if (root.kind != Node::Kind::Table) refuse("case", "a case is a dict of tables, or the path of a file");
  return root;
}

}  // namespace kerf
