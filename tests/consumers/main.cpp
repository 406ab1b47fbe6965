// SPDX-License-Identifier: GPL-3.0-or-later
// Reconstructs a circle: what a first program with this library looks like.
#include <remanifold/remanifold.hpp>

#include <cmath>
#include <iostream>
#include <vector>

int main() {
  const int num_samples = 100;
  std::vector<double> points;
  for (int i = 0; i < num_samples; ++i) {
    // Irrational steps: no two samples coincide, no two spacings need be equal.
    points.push_back(std::cos(2.4 * i));
    points.push_back(std::sin(2.4 * i));
  }

  remanifold::ReconstructOptions options;
  options.dim = 1;
  const auto circle = remanifold::reconstruct(
      remanifold::Samples::from_points({points.data(), num_samples, 2}), options);

  std::cout << num_samples << " samples, " << circle.simplices.size() << " edges\n";
  return circle.simplices.size() == num_samples ? 0 : 1;
}
