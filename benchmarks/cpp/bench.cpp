// SPDX-License-Identifier: GPL-3.0-or-later
// Times each step of a method on generated or given points, beside FLANN's own search for
// nearest neighbors, 20 unless told, on the same points.
#include "remanifold/remanifold.hpp"

#include <flann/flann.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using remanifold::Index;
using remanifold::Offset;

constexpr const char* kUsage = R"(usage: remanifold_bench [options]

  --shape NAME      circle, sphere, torus (default), flat_torus, sphere3, sphere4
  --points FILE     points of a text file instead, one a line
  --dim K           dimension of the manifold; known for shapes
  --samples N[,N..] numbers of samples, timed one after the other (default 100000)
  --ambient D       embed the shape into R^D by a random orthonormal map
  --method NAME     paper (default), or manifold without a solver: cavities too large for
                    the search stay open and are counted
  --estimator NAME  enclosure (default of the paper), pca, jet (default of manifold)
  --threads T       threads (default 1)
  --repeat R        runs, of which the median is printed (default 3)
  --flann M         neighbors that FLANN searches (default 20)
  --order NAME      random (default) or morton: order in which the points are given
  --seed S          seed of the generator (default 1)
)";

struct Cloud {
  std::vector<double> points;
  int ambient_dim = 0;

  Offset size() const { return static_cast<Offset>(points.size()) / ambient_dim; }
  remanifold::MatrixView view() const { return {points.data(), size(), ambient_dim}; }
};

using Random = std::mt19937_64;

Cloud sphere(Offset n, int dim, Random& random) {
  std::normal_distribution<double> normal;
  Cloud cloud{{}, dim + 1};
  for (Offset i = 0; i < n; ++i) {
    std::vector<double> p(dim + 1);
    double norm = 0;
    for (double& x : p) {
      x = normal(random);
      norm += x * x;
    }
    for (const double x : p) {
      cloud.points.push_back(x / std::sqrt(norm));
    }
  }
  return cloud;
}

Cloud torus(Offset n, Random& random) {
  std::uniform_real_distribution<double> uniform;
  constexpr double two_pi = 6.283185307179586;
  constexpr double minor = 0.4;
  Cloud cloud{{}, 3};
  while (cloud.size() < n) {
    const double u = two_pi * uniform(random);
    const double v = two_pi * uniform(random);
    // Uniform by area.
    if (uniform(random) * (1 + minor) < 1 + minor * std::cos(v)) {
      const double r = 1 + minor * std::cos(v);
      for (const double x : {r * std::cos(u), r * std::sin(u), minor * std::sin(v)}) {
        cloud.points.push_back(x);
      }
    }
  }
  return cloud;
}

Cloud flat_torus(Offset n, Random& random) {
  std::uniform_real_distribution<double> angle(0, 6.283185307179586);
  Cloud cloud{{}, 4};
  for (Offset i = 0; i < 2 * n; ++i) {
    const double u = angle(random);
    cloud.points.push_back(std::cos(u));
    cloud.points.push_back(std::sin(u));
  }
  return cloud;
}

struct Shape {
  int dim;
  std::function<Cloud(Offset, Random&)> sample;
};

const std::map<std::string, Shape>& shapes() {
  static const std::map<std::string, Shape> table{
      {"circle", {1, [](Offset n, Random& r) { return sphere(n, 1, r); }}},
      {"sphere", {2, [](Offset n, Random& r) { return sphere(n, 2, r); }}},
      {"torus", {2, torus}},
      {"flat_torus", {2, flat_torus}},
      {"sphere3", {3, [](Offset n, Random& r) { return sphere(n, 3, r); }}},
      {"sphere4", {4, [](Offset n, Random& r) { return sphere(n, 4, r); }}},
  };
  return table;
}

/// Into R^D by D x d orthonormal columns.
Cloud embed(const Cloud& cloud, int ambient_dim, Random& random) {
  const int d = cloud.ambient_dim;
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> axes(d, std::vector<double>(ambient_dim));
  for (int i = 0; i < d; ++i) {
    for (double& x : axes[i]) {
      x = normal(random);
    }
    for (int j = 0; j <= i; ++j) {
      double dot = 0;
      for (int k = 0; k < ambient_dim; ++k) {
        dot += axes[i][k] * axes[j][k];
      }
      for (int k = 0; k < ambient_dim; ++k) {
        axes[i][k] =
            j < i ? axes[i][k] - dot * axes[j][k] : axes[i][k] / std::sqrt(dot);
      }
    }
  }
  Cloud result{std::vector<double>(cloud.size() * ambient_dim), ambient_dim};
  for (Offset p = 0; p < cloud.size(); ++p) {
    for (int i = 0; i < d; ++i) {
      for (int k = 0; k < ambient_dim; ++k) {
        result.points[p * ambient_dim + k] += cloud.points[p * d + i] * axes[i][k];
      }
    }
  }
  return result;
}

Cloud read_points(const std::string& path) {
  std::ifstream file(path);
  if (!file) {
    throw std::invalid_argument("cannot read " + path);
  }
  Cloud cloud;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::istringstream words(line);
    int count = 0;
    for (double x = 0; words >> x; ++count) {
      cloud.points.push_back(x);
    }
    if (!words.eof() || (cloud.ambient_dim != 0 && count != cloud.ambient_dim)) {
      throw std::invalid_argument(path + ":" + std::to_string(number) +
                                  ": not a row of numbers like those before");
    }
    cloud.ambient_dim = count;
  }
  return cloud;
}

Cloud morton_ordered(const Cloud& cloud) {
  const auto samples = remanifold::Samples::from_points(cloud.view());
  Cloud result{{}, cloud.ambient_dim};
  for (Index i = 0; i < samples.size(); ++i) {
    const double* p = cloud.view().row(samples.input_index(i));
    result.points.insert(result.points.end(), p, p + cloud.ambient_dim);
  }
  return result;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
      .count();
}

/// FLANN alone: build the exact tree, search neighbors of every point, one thread.
double time_flann(const Cloud& cloud, int neighbors) {
  const auto start = std::chrono::steady_clock::now();
  const std::size_t n = cloud.size();
  // Each point finds itself.
  const auto count = std::min(static_cast<std::size_t>(neighbors) + 1, n);
  const flann::Matrix<double> points(const_cast<double*>(cloud.points.data()), n,
                                     cloud.ambient_dim);
  flann::KDTreeSingleIndex<flann::L2<double>> index(points,
                                                    flann::KDTreeSingleIndexParams(10));
  index.buildIndex();
  std::vector<int> indices(n * count);
  std::vector<double> distances(n * count);
  flann::Matrix<int> index_matrix(indices.data(), n, count);
  flann::Matrix<double> distance_matrix(distances.data(), n, count);
  flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED);
  parameters.cores = 1;
  index.knnSearch(points, index_matrix, distance_matrix, count, parameters);
  return seconds_since(start);
}

struct Run {
  remanifold::StepSeconds seconds;
  double flann = 0;
  double total = 0;
  Offset simplices = 0;
  double neighbors_used = 0;
  Index unsolved = 0;
};

Run run(const Cloud& cloud, const remanifold::ReconstructOptions& options,
        bool manifold, int threads, int flann_neighbors) {
  Run result;
  if (flann_neighbors > 0) {
    result.flann = time_flann(cloud, flann_neighbors);
  }
  const remanifold::Execution execution{threads, nullptr};
  const auto start = std::chrono::steady_clock::now();
  const auto samples = remanifold::Samples::from_points(cloud.view(), execution);
  const double prepare = seconds_since(start);
  if (manifold) {
    const auto reconstruction =
        remanifold::reconstruct(samples, options, {}, execution);
    result.total = seconds_since(start);
    result.seconds = reconstruction.seconds;
    result.seconds.prepare = prepare;
    result.simplices = reconstruction.simplices.size();
    result.unsolved = reconstruction.report.unsolved;
    return result;
  }
  const auto reconstruction =
      remanifold::reconstruct_paper(samples, options, execution);
  result.total = seconds_since(start);
  result.seconds = reconstruction.seconds;
  result.seconds.prepare = prepare;
  result.simplices = reconstruction.simplices.size();
  result.neighbors_used =
      static_cast<double>(reconstruction.neighbors_used) / samples.size();
  return result;
}

double median(const std::vector<Run>& runs,
              const std::function<double(const Run&)>& of) {
  std::vector<double> values;
  for (const Run& r : runs) {
    values.push_back(of(r));
  }
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

std::vector<Offset> parse_list(const std::string& text) {
  std::vector<Offset> result;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    result.push_back(std::stoll(word));
  }
  return result;
}

int bench(const std::map<std::string, std::string>& arguments) {
  const auto get = [&](const std::string& name, const std::string& fallback) {
    const auto it = arguments.find(name);
    return it == arguments.end() ? fallback : it->second;
  };
  const std::string shape_name = get("shape", "torus");
  const std::string file = get("points", "");
  const int threads = std::stoi(get("threads", "1"));
  const int repeat = std::stoi(get("repeat", "3"));
  const int flann_neighbors = std::stoi(get("flann", "20"));
  const std::string method = get("method", "paper");
  if (method != "paper" && method != "manifold") {
    throw std::invalid_argument("unknown method " + method);
  }
  const bool manifold = method == "manifold";
  const std::string estimator = get("estimator", manifold ? "jet" : "enclosure");
  const auto shape = shapes().find(shape_name);
  if (file.empty() && shape == shapes().end()) {
    throw std::invalid_argument("unknown shape " + shape_name);
  }
  if (!file.empty() && arguments.count("dim") == 0) {
    throw std::invalid_argument("--points needs --dim");
  }
  remanifold::ReconstructOptions options;
  options.dim = std::stoi(
      get("dim", file.empty() ? std::to_string(shape->second.dim) : std::string()));
  options.estimator = estimator == "jet"   ? remanifold::Estimator::kJet
                      : estimator == "pca" ? remanifold::Estimator::kPca
                                           : remanifold::Estimator::kEnclosure;

  std::printf("%10s %5s %3s | %8s %8s %8s %8s %8s | %8s %8s %6s | %10s %8s\n",
              "samples", "D", "K", "prepare", "neighb.", "tangent", "regions",
              "complex", "total", ("FLANN " + std::to_string(flann_neighbors)).c_str(),
              "ratio", "simplices", manifold ? "unsolved" : "looked");
  const std::vector<Offset> sizes =
      file.empty() ? parse_list(get("samples", "100000")) : std::vector<Offset>{0};
  for (const Offset size : sizes) {
    Random random(std::stoull(get("seed", "1")));
    Cloud cloud = file.empty() ? shape->second.sample(size, random) : read_points(file);
    if (arguments.count("ambient") != 0) {
      cloud = embed(cloud, std::stoi(get("ambient", "")), random);
    }
    if (get("order", "random") == "morton") {
      cloud = morton_ordered(cloud);
    }
    const bool with_flann = cloud.ambient_dim <= 32;
    std::vector<Run> runs;
    for (int i = 0; i < repeat; ++i) {
      runs.push_back(
          run(cloud, options, manifold, threads, with_flann ? flann_neighbors : 0));
    }
    const auto of = [&](auto member) {
      return median(runs, [&](const Run& r) { return r.seconds.*member; });
    };
    using Seconds = remanifold::StepSeconds;
    const double total = median(runs, [](const Run& r) { return r.total; });
    const double flann = median(runs, [](const Run& r) { return r.flann; });
    std::printf("%10lld %5d %3d | %8.3f %8.3f %8.3f %8.3f %8.3f | %8.3f",
                static_cast<long long>(cloud.size()), cloud.ambient_dim, options.dim,
                of(&Seconds::prepare), of(&Seconds::neighborhoods),
                of(&Seconds::tangent_spaces), of(&Seconds::local_regions),
                of(&Seconds::complex), total);
    if (with_flann) {
      std::printf(" %8.3f %6.2f", flann, total / flann);
    } else {
      std::printf(" %8s %6s", "-", "-");
    }
    std::printf(" | %10lld", static_cast<long long>(runs.front().simplices));
    if (manifold) {
      std::printf(" %8d\n", runs.front().unsolved);
    } else {
      std::printf(" %8.1f\n", runs.front().neighbors_used);
    }
    std::fflush(stdout);
  }
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  std::map<std::string, std::string> arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--help") {
      std::cout << kUsage;
      return EXIT_SUCCESS;
    }
    if (word.rfind("--", 0) != 0 || i + 1 == argc) {
      std::cerr << "unexpected argument " << word << "\n\n" << kUsage;
      return EXIT_FAILURE;
    }
    arguments[word.substr(2)] = argv[++i];
  }
  try {
    return bench(arguments);
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return EXIT_FAILURE;
  }
}
