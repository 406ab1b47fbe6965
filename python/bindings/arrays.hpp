// SPDX-License-Identifier: GPL-3.0-or-later
// numpy in as views, vectors out as arrays that own them.
#pragma once

#include "remanifold/types.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace remanifold::python {

namespace py = pybind11;

template <class T>
using InputArray = py::array_t<T, py::array::c_style>;

inline MatrixView view(const InputArray<double>& array) {
  return {array.data(), array.shape(0), array.shape(1)};
}

template <class T>
std::vector<T> to_vector(const InputArray<T>& array) {
  return {array.data(), array.data() + array.size()};
}

/// Moves the vector into a capsule that the array keeps alive.
template <class T>
py::array to_numpy(std::vector<T>&& values, std::vector<py::ssize_t> shape,
                   const py::dtype& dtype = py::dtype::of<T>()) {
  auto owner = std::make_unique<std::vector<T>>(std::move(values));
  T* data = owner->data();
  py::capsule capsule(owner.get(),
                      [](void* p) { delete static_cast<std::vector<T>*>(p); });
  static_cast<void>(owner.release());
  return py::array(dtype, std::move(shape), data, capsule);
}

template <class T>
py::array to_numpy(std::vector<T>&& values) {
  const auto size = static_cast<py::ssize_t>(values.size());
  return to_numpy(std::move(values), {size});
}

inline py::array to_bool_array(std::vector<std::uint8_t>&& values) {
  const auto size = static_cast<py::ssize_t>(values.size());
  return to_numpy(std::move(values), {size}, py::dtype::of<bool>());
}

inline py::array to_numpy(SimplexArray&& simplices) {
  const py::ssize_t rows = simplices.size();
  const py::ssize_t arity = simplices.arity;
  return to_numpy(std::move(simplices.vertices), {rows, arity});
}

}  // namespace remanifold::python
