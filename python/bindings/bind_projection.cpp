// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "remanifold/projection.hpp"
#include "run.hpp"

#include <memory>

namespace remanifold::python {
namespace {

std::shared_ptr<SimplexSearch> make_search(const InputArray<double>& vertices,
                                           const InputArray<Index>& simplices,
                                           int num_threads,
                                           const py::object& progress) {
  const SimplexArray complex{static_cast<int>(simplices.shape(1)),
                             to_vector(simplices)};
  const MatrixView input = view(vertices);
  return run(num_threads, progress, [&](const Execution& execution) {
    return std::make_shared<SimplexSearch>(input, complex, execution);
  });
}

py::tuple nearest(const SimplexSearch& search, const InputArray<double>& queries,
                  int num_threads, const py::object& progress) {
  const MatrixView input = view(queries);
  Projections result = run(num_threads, progress, [&](const Execution& execution) {
    return search.nearest(input, execution);
  });
  const py::ssize_t count = queries.shape(0);
  const auto arity =
      count == 0 ? 0 : static_cast<py::ssize_t>(result.barycentric.size()) / count;
  return py::make_tuple(to_numpy(std::move(result.points), {count, queries.shape(1)}),
                        to_numpy(std::move(result.simplices)),
                        to_numpy(std::move(result.barycentric), {count, arity}),
                        to_numpy(std::move(result.distances)));
}

}  // namespace

void bind_projection(py::module_& module) {
  py::class_<SimplexSearch, std::shared_ptr<SimplexSearch>>(module, "SimplexSearch")
      .def(py::init(&make_search), py::arg("vertices").noconvert(),
           py::arg("simplices").noconvert(), py::arg("num_threads"),
           py::arg("progress"))
      .def("nearest", &nearest, py::arg("queries").noconvert(), py::arg("num_threads"),
           py::arg("progress"));
}

}  // namespace remanifold::python
