// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "options.hpp"
#include "remanifold/local_spreads.hpp"
#include "remanifold/sampling_quality.hpp"
#include "run.hpp"

#include <pybind11/stl.h>

#include <optional>
#include <utility>
#include <vector>

namespace remanifold::python {
namespace {

/// Numbers of the samples, and their neighbors among these.
py::tuple listed(ListedNeighbors result) {
  const auto rows = static_cast<py::ssize_t>(result.numbers.size());
  const py::ssize_t count = result.near.count;
  py::array near = to_numpy(std::move(result.near.indices), {rows, count});
  return py::make_tuple(to_numpy(std::move(result.numbers)), std::move(near));
}

/// \param tangents  shape (N, K, D), or none
py::dict quality(const Input& input, const InputArray<Index>& simplices,
                 const std::optional<InputArray<double>>& tangents, Index num_neighbors,
                 Index num_listed, const std::string& search, int checks,
                 int num_threads, const py::object& progress) {
  const SimplexArray complex{static_cast<int>(simplices.shape(1)),
                             to_vector(simplices)};
  const QualityOptions options{complex.arity - 1, num_neighbors,
                               tangents ? tangents->data() : nullptr, num_listed};
  const SearchOptions searching = search_options(search, checks);
  SamplingQuality result = run(num_threads, progress, [&](const Execution& execution) {
    const Samples samples = input.samples(execution);
    const NeighborSearch index(samples, searching, execution);
    return measure_quality(samples, index, complex, options, execution);
  });
  py::dict out;
  out["spacing"] = to_numpy(std::move(result.spacing));
  out["scatter"] = to_numpy(std::move(result.scatter));
  out["wide_scatter"] = to_numpy(std::move(result.wide_scatter));
  out["curvature"] = to_numpy(std::move(result.curvature));
  out["reach"] = to_numpy(std::move(result.reach));
  out["tangent_share"] = to_numpy(std::move(result.tangent_share));
  out["fold"] = to_numpy(std::move(result.fold));
  out["gap"] = to_numpy(std::move(result.gap));
  out["nearest_strange"] = to_numpy(std::move(result.nearest_strange));
  out["rim"] = to_numpy(std::move(result.rim));
  const py::tuple of_listed = listed(std::move(result.listed));
  out["numbers"] = of_listed[0];
  out["near"] = of_listed[1];
  return out;
}

py::tuple neighbors(const Input& input, Index count, const std::string& search,
                    int checks, int num_threads, const py::object& progress) {
  const SearchOptions searching = search_options(search, checks);
  return listed(run(num_threads, progress, [&](const Execution& execution) {
    const Samples samples = input.samples(execution);
    const NeighborSearch index(samples, searching, execution);
    return list_neighbors(samples, index, count, execution);
  }));
}

/// \param samples  shape (n,)
/// \param neighbors  shape (n, m)
py::array spreads(const InputArray<double>& points, const InputArray<Index>& samples,
                  const InputArray<Index>& neighbors, const std::vector<Index>& sizes,
                  int num_spreads, int num_threads) {
  const NeighborRows rows{samples.data(), neighbors.data(), samples.shape(0),
                          static_cast<Index>(neighbors.shape(1))};
  std::vector<double> found =
      run(num_threads, py::none(), [&](const Execution& execution) {
        return local_spreads(view(points), rows, sizes, num_spreads, execution);
      });
  return to_numpy(
      std::move(found),
      {samples.shape(0), static_cast<py::ssize_t>(sizes.size()), num_spreads});
}

/// \param samples  shape (n,)
/// \param neighbors  shape (n, m)
py::array on_curve(const InputArray<double>& points, const InputArray<Index>& samples,
                   const InputArray<Index>& neighbors, int num_threads) {
  const NeighborRows rows{samples.data(), neighbors.data(), samples.shape(0),
                          static_cast<Index>(neighbors.shape(1))};
  return to_bool_array(run(num_threads, py::none(), [&](const Execution& execution) {
    return lie_on_curve(view(points), rows, execution);
  }));
}

int affine_dim(const InputArray<double>& points, int num_threads) {
  return run(num_threads, py::none(), [&](const Execution& execution) {
    return Samples::from_points(view(points), execution).affine_dim();
  });
}

}  // namespace

void bind_quality(py::module_& module) {
  using py::arg;
  module.def("quality", &quality, arg("samples"), arg("simplices").noconvert(),
             arg("tangents").noconvert(), py::kw_only(), arg("num_neighbors"),
             arg("num_listed"), arg("search"), arg("checks"), arg("num_threads"),
             arg("progress"));
  module.def("list_neighbors", &neighbors, arg("samples"), arg("count"), py::kw_only(),
             arg("search"), arg("checks"), arg("num_threads"), arg("progress"));
  module.def("local_spreads", &spreads, arg("points").noconvert(),
             arg("samples").noconvert(), arg("neighbors").noconvert(), arg("sizes"),
             arg("num_spreads"), arg("num_threads"));
  module.def("affine_dim", &affine_dim, arg("points").noconvert(), arg("num_threads"));
  module.def("lie_on_curve", &on_curve, arg("points").noconvert(),
             arg("samples").noconvert(), arg("neighbors").noconvert(),
             arg("num_threads"));
}

}  // namespace remanifold::python
