// SPDX-License-Identifier: GPL-3.0-or-later
// What is asked of samples that are a part of more, before the reconstruction of the part.
#include "arrays.hpp"
#include "options.hpp"
#include "remanifold/constants.hpp"
#include "remanifold/facets.hpp"
#include "remanifold/outliers.hpp"
#include "remanifold/simplex_measures.hpp"
#include "remanifold/smoothing.hpp"
#include "run.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace remanifold::python {
namespace {

GlobalStatistics make_statistics(std::vector<double> low, std::vector<double> high,
                                 Offset size, double evenness, int affine_dim,
                                 bool orientable, int opening_rounds) {
  return {std::move(low), std::move(high), size,          evenness,
          affine_dim,     orientable,      opening_rounds};
}

std::vector<Index> order_of(const Samples& samples) {
  std::vector<Index> order(samples.size());
  for (Index i = 0; i < samples.size(); ++i) {
    order[i] = samples.input_index(i);
  }
  return order;
}

/// The distinct samples in canonical order, and of all the first that they coincide with.
py::tuple part_order(const Input& input, const GlobalStatistics& whole,
                     int num_threads) {
  auto [order, firsts] = run(num_threads, py::none(), [&](const Execution& execution) {
    const Samples samples = input.part(whole, execution);
    return std::pair(order_of(samples), samples.representatives());
  });
  return py::make_tuple(to_numpy(std::move(order)), to_numpy(std::move(firsts)));
}

struct Spacings {
  std::vector<Index> order;
  std::vector<double> ratios;  // nearest neighbor over the scale
  std::vector<double> apart;   // to the (K+1)-th neighbor
  std::vector<double> scales;  // as outliers are measured by
  std::vector<double> around;  // median of those that vote; NaN where nothing is apart
  std::vector<double> reach;   // within which all samples have to be here for that
};

/// In canonical order and lengths.
/// \param distance  of outliers: those that are no farther from others, in units of half their
///                  own scale, are not looked at further
py::dict part_spacings(const Input& input, const GlobalStatistics& whole, int dim,
                       double distance, int num_threads) {
  Spacings found = run(num_threads, py::none(), [&](const Execution& execution) {
    const Samples samples = input.part(whole, execution);
    const NeighborSearch search(samples, {SearchMethod::kKdTree}, execution);
    const Index count = std::max(scale_neighbors(dim), outlier_scale_neighbors(dim));
    const Neighborhoods neighborhoods =
        find_neighborhoods(samples, search, count, execution);
    Spacings result;
    result.order = order_of(samples);
    const Index n = samples.size();
    result.reach.assign(n, 0);
    result.apart.assign(n, 0);
    result.scales.assign(n, 0);
    result.ratios.assign(n, 0);
    if (neighborhoods.count == 0) {
      return result;
    }
    result.ratios = nearest_over_scale(
        samples, neighborhoods, local_scales(samples, neighborhoods, dim, execution),
        execution);
    const auto to_neighbor = [&](Index x, Index rank) {
      const Index k = std::min(rank, neighborhoods.count) - 1;
      return std::sqrt(samples.squared_distance(x, neighborhoods.of(x)[k]));
    };
    const Index near = std::min(outlier_scale_neighbors(dim), neighborhoods.count);
    std::vector<double> around;
    for (Index x = 0; x < n; ++x) {
      result.apart[x] = to_neighbor(x, dim + 1);
      around.assign(1, to_neighbor(x, near));
      double farthest = 0;
      for (Index k = 0; k < neighborhoods.count; ++k) {
        const Index y = neighborhoods.of(x)[k];
        if (k < near) {
          around.push_back(to_neighbor(y, near));
        }
        farthest = std::max(farthest, to_neighbor(y, neighborhoods.count));
      }
      const auto middle = around.begin() + static_cast<Offset>(around.size() / 2);
      std::nth_element(around.begin(), middle, around.end());
      result.scales[x] = *middle;
      result.reach[x] = to_neighbor(x, neighborhoods.count) + farthest;
    }
    const Index votes = outlier_votes(dim, samples.whole_size());
    const std::vector<double> reach = result.reach;
    result.around.assign(n, std::numeric_limits<double>::quiet_NaN());
    const auto query = search.query(execution);
    std::vector<Neighbor> voters;
    for (Index x = 0; x < n; ++x) {
      if (!(result.apart[x] > distance * result.scales[x] / 2)) {
        continue;
      }
      query->nearest(x, std::min(votes, n - 1), std::numeric_limits<double>::infinity(),
                     voters);
      around.assign(1, result.scales[x]);
      for (const Neighbor& neighbor : voters) {
        around.push_back(result.scales[neighbor.index]);
        result.reach[x] =
            std::max(result.reach[x],
                     std::sqrt(neighbor.squared_distance) + reach[neighbor.index]);
      }
      const auto middle = around.begin() + static_cast<Offset>(around.size() / 2);
      std::nth_element(around.begin(), middle, around.end());
      result.around[x] = *middle;
    }
    return result;
  });
  py::dict out;
  out["order"] = to_numpy(std::move(found.order));
  out["ratios"] = to_numpy(std::move(found.ratios));
  out["apart"] = to_numpy(std::move(found.apart));
  out["scales"] = to_numpy(std::move(found.scales));
  out["around"] = to_numpy(std::move(found.around));
  out["reach"] = to_numpy(std::move(found.reach));
  return out;
}

/// \param probes  in canonical numbers
py::array noise_at(const Input& input, const GlobalStatistics& whole, int dim,
                   const std::vector<Index>& probes, int num_threads) {
  std::vector<double> values =
      run(num_threads, py::none(), [&](const Execution& execution) {
        const Samples samples = input.part(whole, execution);
        const NeighborSearch search(samples, {SearchMethod::kKdTree}, execution);
        return test_noise_at(samples, search, dim, probes, execution);
      });
  return to_numpy(std::move(values), {static_cast<py::ssize_t>(probes.size()),
                                      kNoiseTests * kNoiseValues});
}

bool noise_of(const Input& some, const GlobalStatistics& whole, int dim,
              const std::vector<double>& tests) {
  return shows_noise(some.part(whole, {}), dim, tests);
}

/// How far those are away that lie apart, and of each probe the distance that is usual.
/// \param apart, probes  in canonical numbers
py::tuple outliers_at(const Input& input, const GlobalStatistics& whole, int dim,
                      double distance, double median, const std::vector<Index>& apart,
                      const std::vector<Index>& probes, int num_threads) {
  OutlierEvidence found = run(num_threads, py::none(), [&](const Execution& execution) {
    const Samples samples = input.part(whole, execution);
    const NeighborSearch search(samples, {SearchMethod::kKdTree}, execution);
    const Neighborhoods neighborhoods =
        find_neighborhoods(samples, search, outlier_scale_neighbors(dim), execution);
    return outlier_evidence(samples, search, neighborhoods, {dim, distance},
                            {apart, probes, median}, execution);
  });
  return py::make_tuple(to_numpy(std::move(found.away)),
                        to_numpy(std::move(found.relative)), found.reach);
}

/// Of simplices with ascending columns: patch, sign, and which patches are orientable.
py::tuple oriented_patches(const InputArray<Index>& simplices, Index num_vertices,
                           int num_threads) {
  const SimplexArray rows{static_cast<int>(simplices.shape(1)),
                          {simplices.data(), simplices.data() + simplices.size()}};
  OrientedPatches found = run(num_threads, py::none(), [&](const Execution& execution) {
    return orient_patches(rows, num_vertices, execution);
  });
  return py::make_tuple(to_numpy(std::move(found.patch)),
                        to_numpy(std::move(found.sign)),
                        to_bool_array(std::move(found.orientable)));
}

}  // namespace

void bind_parts(py::module_& module) {
  using py::arg;
  py::class_<GlobalStatistics>(module, "GlobalStatistics")
      .def(py::init(&make_statistics), py::kw_only(), arg("low"), arg("high"),
           arg("size"), arg("evenness") = 0.0, arg("affine_dim") = 0,
           arg("orientable") = true, arg("opening_rounds") = -1);
  module.attr("SPARSE_SCALE") = kSparseScale;
  module.def("part_order", &part_order, arg("samples"), arg("whole"),
             arg("num_threads"));
  module.def("part_spacings", &part_spacings, arg("samples"), arg("whole"), arg("dim"),
             arg("distance"), arg("num_threads"));
  module.def("noise_at", &noise_at, arg("samples"), arg("whole"), arg("dim"),
             arg("probes"), arg("num_threads"));
  module.def("shows_noise", &noise_of, arg("samples"), arg("whole"), arg("dim"),
             arg("tests"));
  module.def("outliers_at", &outliers_at, arg("samples"), arg("whole"), arg("dim"),
             arg("distance"), arg("median"), arg("apart"), arg("probes"),
             arg("num_threads"));
  module.def("outlier_probe_stride", &outlier_probe_stride, arg("size"));
  module.def("least_outlier_distance", &least_outlier_distance, arg("distance"),
             arg("relative"));
  module.def("num_noise_probes", &num_noise_probes, arg("size"));
  module.def("noise_probe", &noise_probe, arg("i"), arg("size"));
  module.def("oriented_patches", &oriented_patches, arg("simplices"),
             arg("num_vertices"), arg("num_threads"));
  module.def("evenness_of", &evenness_of, arg("tenth"), arg("dim"));
}

}  // namespace remanifold::python
