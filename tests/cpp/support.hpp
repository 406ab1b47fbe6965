// SPDX-License-Identifier: GPL-3.0-or-later
// Seeded samples and slow checks shared by the tests.
#pragma once

#include "remanifold/remanifold.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <vector>

namespace remanifold::testing {

struct Cloud {
  std::vector<double> points;
  int dim = 0;

  Offset size() const { return static_cast<Offset>(points.size()) / dim; }
  MatrixView view() const { return {points.data(), size(), dim}; }
  const double* operator[](Offset i) const { return points.data() + i * dim; }
};

inline Cloud gaussian(Offset n, int dim, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Cloud cloud{std::vector<double>(n * dim), dim};
  std::generate(cloud.points.begin(), cloud.points.end(),
                [&] { return normal(random); });
  return cloud;
}

/// Uniform on the unit sphere of the given dimension.
inline Cloud sphere(Offset n, int dim, unsigned seed) {
  Cloud cloud = gaussian(n, dim + 1, seed);
  for (Offset i = 0; i < n; ++i) {
    double* p = cloud.points.data() + i * cloud.dim;
    double norm = 0;
    for (int j = 0; j < cloud.dim; ++j) {
      norm += p[j] * p[j];
    }
    for (int j = 0; j < cloud.dim; ++j) {
      p[j] /= std::sqrt(norm);
    }
  }
  return cloud;
}

/// side^dim points with integer coordinates.
inline Cloud grid(int side, int dim) {
  Cloud cloud{{}, dim};
  std::vector<int> cell(dim, 0);
  for (;;) {
    cloud.points.insert(cloud.points.end(), cell.begin(), cell.end());
    int i = 0;
    while (i < dim && ++cell[i] == side) {
      cell[i++] = 0;
    }
    if (i == dim) {
      return cloud;
    }
  }
}

inline std::vector<double> gram_of(const Cloud& cloud) {
  const Offset n = cloud.size();
  std::vector<double> gram(n * n, 0.0);
  for (Offset i = 0; i < n; ++i) {
    for (Offset j = 0; j < n; ++j) {
      for (int k = 0; k < cloud.dim; ++k) {
        gram[i * n + j] += cloud[i][k] * cloud[j][k];
      }
    }
  }
  return gram;
}

inline std::vector<double> distances_of(const Cloud& cloud) {
  const Offset n = cloud.size();
  std::vector<double> distances(n * n, 0.0);
  for (Offset i = 0; i < n; ++i) {
    for (Offset j = 0; j < n; ++j) {
      double sum = 0;
      for (int k = 0; k < cloud.dim; ++k) {
        sum += (cloud[i][k] - cloud[j][k]) * (cloud[i][k] - cloud[j][k]);
      }
      distances[i * n + j] = std::sqrt(sum);
    }
  }
  return distances;
}

inline std::vector<std::vector<Index>> rows(const SimplexArray& simplices) {
  std::vector<std::vector<Index>> result;
  for (Offset s = 0; s < simplices.size(); ++s) {
    result.emplace_back(simplices[s], simplices[s] + simplices.arity);
  }
  return result;
}

inline PaperReconstruction paper(const Samples& samples, int dim,
                                 Estimator estimator = Estimator::kEnclosure,
                                 int num_threads = 1) {
  ReconstructOptions options;
  options.dim = dim;
  options.estimator = estimator;
  return reconstruct_paper(samples, options, {num_threads, nullptr});
}

/// A sphere of radius one, displaced by noise, and far points after it.
inline Cloud noisy_sphere(Offset n, double noise, Offset num_outliers) {
  Cloud cloud = sphere(n, 2, 1);
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal(1.0, noise);
  for (Offset i = 0; i < n; ++i) {
    const double radius = normal(random);
    for (int axis = 0; axis < 3; ++axis) {
      cloud.points[3 * i + axis] *= radius;
    }
  }
  std::uniform_real_distribution<double> box(-2, 2);
  while (cloud.size() < n + num_outliers) {
    const double p[3] = {box(random), box(random), box(random)};
    if (std::abs(std::hypot(p[0], p[1], p[2]) - 1) > 0.6) {
      cloud.points.insert(cloud.points.end(), p, p + 3);
    }
  }
  return cloud;
}

}  // namespace remanifold::testing
