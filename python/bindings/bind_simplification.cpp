// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "remanifold/simplification.hpp"
#include "run.hpp"

#include <cstdint>
#include <utility>
#include <vector>

namespace remanifold::python {
namespace {

py::tuple simplified(const InputArray<double>& vertices,
                     const InputArray<Index>& simplices,
                     const InputArray<std::uint8_t>& fixed, Index num_vertices,
                     double max_error, bool even, const py::object& progress) {
  const MatrixView points = view(vertices);
  const SimplexArray complex{static_cast<int>(simplices.shape(1)),
                             to_vector(simplices)};
  const std::vector<std::uint8_t> kept = to_vector(fixed);
  Simplification result = run(1, progress, [&](const Execution& execution) {
    return simplify(points, complex, kept, {num_vertices, max_error, even}, execution);
  });
  return py::make_tuple(to_numpy(std::move(result.simplices)),
                        to_numpy(std::move(result.errors)));
}

}  // namespace

void bind_simplification(py::module_& module) {
  module.def("simplify", &simplified, py::arg("vertices").noconvert(),
             py::arg("simplices").noconvert(), py::arg("fixed").noconvert(),
             py::arg("num_vertices"), py::arg("max_error"), py::arg("even"),
             py::arg("progress"));
}

}  // namespace remanifold::python
