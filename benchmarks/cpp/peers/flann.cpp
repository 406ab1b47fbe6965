// SPDX-License-Identifier: GPL-3.0-or-later
// FLANN's exact search for 20 neighbors: no reconstruction, but what any has to pay for.
#include "peers.hpp"

#include <flann/flann.hpp>

#include <algorithm>

namespace peers {

Result flann(const Points& points) {
  Result result;
  const Stopwatch stopwatch;
  // Each point finds itself.
  const std::size_t count = std::min<std::size_t>(21, points.count);
  const ::flann::Matrix<double> matrix(const_cast<double*>(points.coordinates.data()),
                                       points.count, points.dim);
  ::flann::KDTreeSingleIndex<::flann::L2<double>> index(
      matrix, ::flann::KDTreeSingleIndexParams(10));
  index.buildIndex();
  std::vector<int> indices(points.count * count);
  std::vector<double> distances(points.count * count);
  ::flann::Matrix<int> index_matrix(indices.data(), points.count, count);
  ::flann::Matrix<double> distance_matrix(distances.data(), points.count, count);
  ::flann::SearchParams parameters(::flann::FLANN_CHECKS_UNLIMITED);
  parameters.cores = 1;
  index.knnSearch(matrix, index_matrix, distance_matrix, count, parameters);
  stopwatch.stop(result);
  return result;
}

std::string flann_version() { return FLANN_VERSION_; }

}  // namespace peers
