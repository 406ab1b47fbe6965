// SPDX-License-Identifier: GPL-3.0-or-later
// What the drivers of the peers share. A driver gets points in memory, does by a Stopwatch
// only what belongs to its algorithm, and hands back simplices, K + 1 indices each.
#pragma once

#include <chrono>
#include <cstddef>
#include <ctime>
#include <string>
#include <vector>

namespace peers {

struct Points {
  std::vector<double> coordinates;  // row by row
  std::size_t count = 0;
  std::size_t dim = 0;
};

struct Result {
  double seconds = 0;
  double cpu_seconds = 0;
  long long peak_bytes = -1;  // beyond what was there before; -1: unknown
  std::vector<int> simplices;
};

/// Started when made; `stop` must come before anything that the algorithm is not to blame
/// for.
class Stopwatch {
 public:
  Stopwatch();
  void stop(Result& result) const;

 private:
  long long resident_before_;
  std::clock_t cpu_start_;
  std::chrono::steady_clock::time_point start_;
};

Result flann(const Points& points);
Result advancing_front(const Points& points);
Result scale_space(const Points& points);
Result delaunay(const Points& points);

std::string flann_version();
std::string cgal_version();

}  // namespace peers
