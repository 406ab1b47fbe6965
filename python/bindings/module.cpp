// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>

#include <cstring>
#include <exception>
#include <stdexcept>

namespace remanifold::python {
void bind_calculus(pybind11::module_& module);
void bind_chain(pybind11::module_& module);
void bind_constants(pybind11::module_& module);
void bind_parts(pybind11::module_& module);
void bind_projection(pybind11::module_& module);
void bind_quality(pybind11::module_& module);
void bind_simplification(pybind11::module_& module);
void bind_steps(pybind11::module_& module);
void bind_reconstruct(pybind11::module_& module);
void bind_surface_distances(pybind11::module_& module);
void bind_topology(pybind11::module_& module);

namespace {

/// What pybind11 says where Python has no memory for an object is a RuntimeError of its own.
void translate_failed_allocation(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const std::runtime_error& error) {
    if (std::strncmp(error.what(), "Could not allocate", 18) != 0) {
      throw;
    }
    PyErr_NoMemory();
  }
}

}  // namespace
}  // namespace remanifold::python

PYBIND11_MODULE(_core, module) {
  module.doc() = "Compiled core of remanifold; use the package instead.";
  module.attr("__version__") = REMANIFOLD_VERSION;
  pybind11::register_local_exception_translator(
      remanifold::python::translate_failed_allocation);
  remanifold::python::bind_constants(module);
  remanifold::python::bind_steps(module);
  remanifold::python::bind_chain(module);
  remanifold::python::bind_parts(module);
  remanifold::python::bind_reconstruct(module);
  remanifold::python::bind_topology(module);
  remanifold::python::bind_quality(module);
  remanifold::python::bind_projection(module);
  remanifold::python::bind_simplification(module);
  remanifold::python::bind_surface_distances(module);
  remanifold::python::bind_calculus(module);
}
