// SPDX-License-Identifier: GPL-3.0-or-later
// Words of the Python interface -> enumerations of the core.
#pragma once

#include "arrays.hpp"
#include "remanifold/remanifold.hpp"

#include <stdexcept>
#include <string>

namespace remanifold::python {

inline Samples make_samples(const std::string& kind, MatrixView matrix,
                            const Execution& execution) {
  if (kind == "gram") {
    return Samples::from_gram(matrix, execution);
  }
  if (kind == "distances") {
    return Samples::from_distances(matrix, execution);
  }
  return Samples::from_points(matrix, execution);
}

inline SearchOptions search_options(const std::string& search, int checks) {
  SearchOptions options;
  options.checks = checks;
  if (search == "auto") {
    options.method = SearchMethod::kAuto;
  } else if (search == "kdtree") {
    options.method = SearchMethod::kKdTree;
  } else if (search == "brute_force") {
    options.method = SearchMethod::kBruteForce;
  } else if (search == "approximate") {
    options.method = SearchMethod::kApproximate;
  } else {
    throw std::invalid_argument(
        "search is '" + search +
        "', expected 'auto', 'kdtree', 'brute_force' or 'approximate'");
  }
  return options;
}

inline const char* search_name(SearchMethod method) {
  switch (method) {
    case SearchMethod::kKdTree:
      return "kdtree";
    case SearchMethod::kBruteForce:
      return "brute_force";
    case SearchMethod::kApproximate:
      return "approximate";
    case SearchMethod::kAuto:
      break;
  }
  return "auto";
}

inline Estimator estimator_of(const std::string& estimator) {
  if (estimator == "enclosure") {
    return Estimator::kEnclosure;
  }
  if (estimator == "pca") {
    return Estimator::kPca;
  }
  if (estimator == "jet") {
    return Estimator::kJet;
  }
  throw std::invalid_argument("estimator is '" + estimator +
                              "', expected 'enclosure', 'pca' or 'jet'");
}

inline BoundaryRule boundary_rule(const std::string& boundary) {
  if (boundary == "auto") {
    return BoundaryRule::kAuto;
  }
  if (boundary == "none") {
    return BoundaryRule::kNone;
  }
  if (boundary == "given") {
    return BoundaryRule::kGiven;
  }
  throw std::invalid_argument("boundary is '" + boundary +
                              "', expected 'auto', 'none' or 'given'");
}

inline EdgeRule edge_rule(const std::string& edges) {
  if (edges == "mutual") {
    return EdgeRule::kMutual;
  }
  if (edges == "either") {
    return EdgeRule::kEither;
  }
  throw std::invalid_argument("edges is '" + edges +
                              "', expected 'mutual' or 'either'");
}

}  // namespace remanifold::python
