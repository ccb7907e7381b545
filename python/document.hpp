#pragma once
// Python objects as documents of kerf's reader, and functions of Python as expressions.

#include "io/document.hpp"

#include <pybind11/pybind11.h>

#include <mutex>

namespace kerf {

/// The first exception that a function of Python raised inside a computation, until Python gets it back. Its own lock:
/// functions are called from several threads.
class Trouble {
 public:
  Trouble() = default;
  Trouble(const Trouble&) = delete;
  Trouble& operator=(const Trouble&) = delete;
  ~Trouble();
  /// Takes the exception that Python has raised. Call with the interpreter held.
  void keep(bool by_callback = false);
  /// It comes from a callback that watches, not from a value of the case.
  bool by_callback() const {
    return by_callback_;
  }
  /// The exception, once; null without one. Call with the interpreter held.
  pybind11::object take();

 private:
  PyObject* raised_ = nullptr;
  bool by_callback_ = false;
};

/// A document in Python's own values, with the functions of Python that stand in it. Throws Error(Usage) for dates.
pybind11::object in_python(const Node& node);

/// A value of a key, at the path.
Node value_node(pybind11::handle value, const std::string& path, const std::shared_ptr<Trouble>& trouble);

/// A whole case. Numbers, strings, lists, tuples, arrays, dicts and callables, nested; every node's position is its
/// path, such as crack[0].path. Throws Error(Usage) with the path for what is none of these.
Node node_of(pybind11::handle value, const std::shared_ptr<Trouble>& trouble);

}  // namespace kerf
