// SPDX-License-Identifier: GPL-3.0-or-later
// What Python hands over: samples of one kind or another, and options. Words of its
// interface become enumerations of the core here and nowhere else.
#pragma once

#include "arrays.hpp"
#include "remanifold/remanifold.hpp"

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace remanifold::python {

template <class T>
struct Word {
  const char* name;
  T value;
};

inline constexpr std::array kSearches{
    Word<SearchMethod>{"auto", SearchMethod::kAuto},
    Word<SearchMethod>{"kdtree", SearchMethod::kKdTree},
    Word<SearchMethod>{"brute_force", SearchMethod::kBruteForce},
    Word<SearchMethod>{"approximate", SearchMethod::kApproximate}};
inline constexpr std::array kEstimators{
    Word<Estimator>{"enclosure", Estimator::kEnclosure},
    Word<Estimator>{"pca", Estimator::kPca}, Word<Estimator>{"jet", Estimator::kJet}};
inline constexpr std::array kEdgeRules{Word<EdgeRule>{"mutual", EdgeRule::kMutual},
                                       Word<EdgeRule>{"either", EdgeRule::kEither}};
inline constexpr std::array kBoundaryRules{
    Word<BoundaryRule>{"auto", BoundaryRule::kAuto},
    Word<BoundaryRule>{"none", BoundaryRule::kNone},
    Word<BoundaryRule>{"given", BoundaryRule::kGiven}};
inline constexpr std::array kOpeningKinds{
    Word<OpeningKind>{"gap", OpeningKind::kGap},
    Word<OpeningKind>{"hole", OpeningKind::kHole},
    Word<OpeningKind>{"joint", OpeningKind::kJoint},
    Word<OpeningKind>{"part", OpeningKind::kPart}};

/// \param what  names the argument in the error
template <class T, std::size_t N>
T value_of(const std::array<Word<T>, N>& words, std::string_view name,
           const char* what) {
  std::string expected;
  for (const Word<T>& word : words) {
    if (word.name == name) {
      return word.value;
    }
    expected += (expected.empty() ? "'" : ", '") + std::string(word.name) + "'";
  }
  throw std::invalid_argument(std::string(what) + " is '" + std::string(name) +
                              "', expected one of " + expected);
}

template <class T, std::size_t N>
const char* name_of(const std::array<Word<T>, N>& words, T value) {
  for (const Word<T>& word : words) {
    if (word.value == value) {
      return word.name;
    }
  }
  return "";
}

template <class T, std::size_t N>
py::tuple names(const std::array<Word<T>, N>& words) {
  py::tuple result(N);
  for (std::size_t i = 0; i < N; ++i) {
    result[i] = words[i].name;
  }
  return result;
}

/// Samples as Python gives them: an object with `kind` and `matrix`, `_base.samples.Input`.
/// The matrix is alive as long as this.
class Input {
 public:
  enum class Kind { kPoints, kGram, kDistances };

  Input() = default;
  Input(Kind kind, InputArray<double> matrix)
      : kind_(kind), matrix_(std::move(matrix)) {}

  bool points() const { return kind_ == Kind::kPoints; }
  // What follows reads memory only: it may be called without the interpreter's lock.
  MatrixView view() const { return python::view(matrix_); }
  py::ssize_t rows() const { return matrix_.shape(0); }
  py::ssize_t columns() const { return matrix_.shape(1); }
  Samples samples(const Execution& execution) const {
    switch (kind_) {
      case Kind::kGram:
        return Samples::from_gram(view(), execution);
      case Kind::kDistances:
        return Samples::from_distances(view(), execution);
      case Kind::kPoints:
        break;
    }
    return Samples::from_points(view(), execution);
  }
  /// Points that are a part of more.
  Samples part(const GlobalStatistics& whole, const Execution& execution) const {
    return Samples::from_part(view(), whole, execution);
  }

 private:
  Kind kind_ = Kind::kPoints;
  InputArray<double> matrix_;
};

inline constexpr std::array kKinds{
    Word<Input::Kind>{"points", Input::Kind::kPoints},
    Word<Input::Kind>{"gram", Input::Kind::kGram},
    Word<Input::Kind>{"distances", Input::Kind::kDistances}};

inline SearchOptions search_options(const std::string& search, int checks) {
  return {value_of(kSearches, search, "search"), checks};
}

}  // namespace remanifold::python

namespace pybind11::detail {

template <>
struct type_caster<remanifold::python::Input> {
  PYBIND11_TYPE_CASTER(remanifold::python::Input, const_name("Input"));

  bool load(handle source, bool /*convert*/) {
    using Array = remanifold::python::InputArray<double>;
    if (!hasattr(source, "kind") || !hasattr(source, "matrix")) {
      return false;
    }
    const object matrix = source.attr("matrix");
    if (!isinstance<Array>(matrix)) {
      return false;
    }
    value = {
        remanifold::python::value_of(remanifold::python::kKinds,
                                     source.attr("kind").cast<std::string>(), "kind"),
        reinterpret_borrow<Array>(matrix)};
    return true;
  }
};

}  // namespace pybind11::detail
