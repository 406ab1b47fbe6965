// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "remanifold/linear_elements.hpp"
#include "remanifold/second_forms.hpp"
#include "remanifold/sparse_factors.hpp"
#include "run.hpp"

#include <utility>
#include <vector>

namespace remanifold::python {
namespace {

py::tuple as_tuple(LinearElements&& found, py::ssize_t dim) {
  const auto count = static_cast<py::ssize_t>(found.volumes.size());
  return py::make_tuple(to_numpy(std::move(found.volumes)),
                        to_numpy(std::move(found.frames), {count, dim, dim}),
                        to_numpy(std::move(found.products), {count, dim + 1, dim + 1}),
                        to_bool_array(std::move(found.flat)));
}

py::tuple elements(const InputArray<double>& points,
                   const InputArray<Index>& simplices) {
  const SimplexArray complex{static_cast<int>(simplices.shape(1)),
                             to_vector(simplices)};
  return as_tuple(linear_elements(view(points), complex), complex.arity - 1);
}

py::tuple elements_of_lengths(int dim, const InputArray<double>& squares) {
  return as_tuple(linear_elements(dim, to_vector(squares)), dim);
}

py::array rotations(const InputArray<double>& maps) {
  const py::ssize_t dim = maps.shape(2);
  return to_numpy(nearest_rotations(static_cast<int>(dim), to_vector(maps)),
                  {maps.shape(0), dim, dim});
}

py::tuple forms(const InputArray<double>& points, const InputArray<Index>& edges,
                int dim, const InputArray<Index>& vertices, int num_threads) {
  const SimplexArray lines{2, to_vector(edges)};
  const std::vector<Index> own = to_vector(vertices);
  SecondForms found = run(num_threads, py::none(), [&](const Execution& execution) {
    return second_forms(view(points), lines, dim, own, execution);
  });
  const py::ssize_t count = vertices.shape(0);
  const py::ssize_t ambient = points.shape(1);
  return py::make_tuple(to_numpy(std::move(found.tangents), {count, dim, ambient}),
                        to_numpy(std::move(found.forms), {count, dim, dim, ambient}));
}

}  // namespace

void bind_calculus(py::module_& module) {
  module.def("linear_elements", &elements, py::arg("points").noconvert(),
             py::arg("simplices").noconvert());
  module.def("linear_elements_of_lengths", &elements_of_lengths, py::arg("dim"),
             py::arg("squares").noconvert());
  module.def("nearest_rotations", &rotations, py::arg("maps").noconvert());
  module.def("second_forms", &forms, py::arg("points").noconvert(),
             py::arg("edges").noconvert(), py::arg("dim"),
             py::arg("vertices").noconvert(), py::arg("num_threads"));
  py::class_<SparseFactors>(module, "SparseFactors")
      .def(py::init([](const InputArray<Index>& offsets, const InputArray<Index>& rows,
                       const InputArray<double>& values) {
             const std::vector<Index> starts = to_vector(offsets);
             const std::vector<Index> own = to_vector(rows);
             const std::vector<double> entries = to_vector(values);
             const py::gil_scoped_release release;
             return SparseFactors(starts, own, entries);
           }),
           py::arg("offsets").noconvert(), py::arg("rows").noconvert(),
           py::arg("values").noconvert())
      .def_property_readonly("entries", &SparseFactors::entries)
      .def("solve", [](const SparseFactors& factors, const InputArray<double>& right) {
        if (right.size() != factors.size()) {
          throw py::value_error("right has another size than the matrix");
        }
        const std::vector<double> given = to_vector(right);
        std::vector<double> found;
        {
          const py::gil_scoped_release release;
          found = factors.solve(given);
        }
        return to_numpy(std::move(found));
      });
}

}  // namespace remanifold::python
