// SPDX-License-Identifier: GPL-3.0-or-later
// Runs one peer on points of a file; benchmarks/side_by_side.py calls this.
#include "peers.hpp"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>

namespace peers {
namespace {

constexpr const char* kUsage =
    "usage: remanifold_peers NAME POINTS N SIMPLICES, or remanifold_peers --version\n"
    "  NAME       flann, advancing_front, scale_space or delaunay\n"
    "  POINTS     file of N rows of float64\n"
    "  SIMPLICES  file to write: rows of int32, three or, of delaunay, four\n";

struct Peer {
  Result (*run)(const Points&);
  std::size_t dim;  // the only one it takes; 0: any
};

const std::map<std::string, Peer>& table() {
  static const std::map<std::string, Peer> peers{
      {"flann", {flann, 0}},
      {"advancing_front", {advancing_front, 3}},
      {"scale_space", {scale_space, 3}},
      {"delaunay", {delaunay, 3}},
  };
  return peers;
}

/// A number of bytes from the status of this process, or -1.
long long status(const std::string& name) {
  std::ifstream file("/proc/self/status");
  for (std::string word; file >> word;) {
    if (word == name + ":") {
      long long kilobytes = 0;
      return file >> kilobytes ? 1024 * kilobytes : -1;
    }
  }
  return -1;
}

Points read_points(const std::string& path, std::size_t count) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file || count == 0) {
    throw std::invalid_argument("no points in " + path);
  }
  const auto bytes = static_cast<std::size_t>(file.tellg());
  if (bytes % (count * sizeof(double)) != 0) {
    throw std::invalid_argument(path + " does not have that many rows");
  }
  Points points{{}, count, bytes / (count * sizeof(double))};
  points.coordinates.resize(points.count * points.dim);
  file.seekg(0);
  file.read(reinterpret_cast<char*>(points.coordinates.data()),
            static_cast<std::streamsize>(bytes));
  return points;
}

int run(const std::string& name, const std::string& points_path, std::size_t count,
        const std::string& simplices_path) {
  const auto peer = table().find(name);
  if (peer == table().end()) {
    throw std::invalid_argument("unknown peer " + name);
  }
  const Points points = read_points(points_path, count);
  if (peer->second.dim != 0 && points.dim != peer->second.dim) {
    throw std::invalid_argument(name + " takes points of R^3 only");
  }
  const Result result = peer->second.run(points);
  std::ofstream file(simplices_path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(result.simplices.data()),
             static_cast<std::streamsize>(result.simplices.size() * sizeof(int)));
  file.close();
  if (!file) {
    throw std::runtime_error("cannot write " + simplices_path);
  }
  std::printf("{\"seconds\": %.6f, \"cpu_seconds\": %.6f, \"peak_bytes\": ",
              result.seconds, result.cpu_seconds);
  if (result.peak_bytes < 0) {
    std::printf("null}\n");
  } else {
    std::printf("%lld}\n", result.peak_bytes);
  }
  return EXIT_SUCCESS;
}

}  // namespace

Stopwatch::Stopwatch() {
  std::ofstream("/proc/self/clear_refs") << '5';  // forget the peak so far
  resident_before_ = status("VmRSS");
  cpu_start_ = std::clock();
  start_ = std::chrono::steady_clock::now();
}

void Stopwatch::stop(Result& result) const {
  const auto end = std::chrono::steady_clock::now();
  result.seconds = std::chrono::duration<double>(end - start_).count();
  result.cpu_seconds = static_cast<double>(std::clock() - cpu_start_) / CLOCKS_PER_SEC;
  const long long peak = status("VmHWM");
  if (peak >= 0 && resident_before_ >= 0) {
    result.peak_bytes = peak - resident_before_;
  }
}

}  // namespace peers

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    if (words.size() == 1 && words[0] == "--version") {
      std::printf("{\"CGAL\": \"%s\", \"FLANN\": \"%s\"}\n",
                  peers::cgal_version().c_str(), peers::flann_version().c_str());
      return EXIT_SUCCESS;
    }
    if (words.size() != 4) {
      std::cerr << peers::kUsage;
      return EXIT_FAILURE;
    }
    return peers::run(words[0], words[1], std::stoull(words[2]), words[3]);
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return EXIT_FAILURE;
  }
}
