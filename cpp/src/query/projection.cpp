// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/projection.hpp"

#include "base/assertions.hpp"
#include "base/parallel.hpp"
#include "query/nearest_in_simplex.hpp"
#include "query/simplex_tree.hpp"
#include "remanifold/verify.hpp"
#include "samples/distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace remanifold {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Offset kQueries = 128;
/// Distances that differ by less, in units of the size of the complex and of the distance
/// of the query, are equal.
constexpr double kTie = 0x1p-48;
/// What bounds are lowered by, in the same unit: more than their rounding.
constexpr double kSlack = 0x1p-40;
/// Power of two, in units of the complex, from where on queries see it as a point.
constexpr int kFarthest = 300;

void check_finite(MatrixView matrix, const char* name) {
  for (Offset i = 0; i < matrix.rows * matrix.cols; ++i) {
    if (!std::isfinite(matrix.data[i])) {
      throw std::invalid_argument(std::string(name) + ": row " +
                                  std::to_string(i / matrix.cols) + " is not finite");
    }
  }
}

/// Without overflow or underflow on the way.
double distance(const double* a, const double* b, Offset size) {
  double largest = 0;
  for (Offset i = 0; i < size; ++i) {
    largest = std::max(largest, std::abs(a[i] - b[i]));
  }
  if (!(largest > 0) || std::isinf(largest)) {
    return largest;
  }
  double sum = 0;
  for (Offset i = 0; i < size; ++i) {
    const double away = (a[i] - b[i]) / largest;
    sum += away * away;
  }
  return largest * std::sqrt(sum);
}

/// Where a query stands, and what was found for it.
struct Query {
  struct Pending {
    Offset node;
    double bound;  // squared
  };
  std::vector<double> point;  // scaled
  std::vector<double> reduced;
  double left = 0;
  double tie = 0;
  double slack = 0;
  double best = kInfinity;
  std::vector<std::pair<double, Offset>> found;  // distance, simplex
  std::vector<Pending> stack;
  std::vector<const double*> corners;
};

MatrixView checked(MatrixView vertices) {
  check_finite(vertices, "vertices");
  return vertices;
}

}  // namespace

class SimplexSearch::Search {
 public:
  Search(MatrixView vertices, const SimplexArray& simplices, const Execution& execution)
      : tree_(checked(vertices), simplices, execution) {}

  Projections nearest(MatrixView queries, const Execution& execution) const;

 private:
  void place(Query& query, const double* point) const;
  Query::Pending consider(const Query& query, Offset number) const;
  template <class Solver>
  void search(Query& query, Solver& solver) const;
  template <class Solver>
  void look_at(Query& query, Offset position, Solver& solver) const;
  template <int K>
  void nearest_of(MatrixView queries, Projections& result,
                  const Execution& execution) const;
  std::vector<Offset> order_of(MatrixView queries, const Execution& execution) const;
  void set_corners(Query& query, Offset position) const;
  double squared_from_box(const Query& query) const;
  void write(const Query& query, const std::vector<double>& weights, double* out) const;

  detail::SimplexTree tree_;
};

void SimplexSearch::Search::place(Query& query, const double* point) const {
  double largest = 0;
  for (int a = 0; a < tree_.ambient_dim(); ++a) {
    largest = std::max(largest, std::abs(point[a]));
  }
  int exponent = 0;
  std::frexp(largest, &exponent);
  int own = 0;
  std::frexp(tree_.scale(), &own);
  const int shift = std::min(own - 1, kFarthest - exponent);
  query.point.resize(tree_.ambient_dim());
  for (int a = 0; a < tree_.ambient_dim(); ++a) {
    query.point[a] = std::ldexp(point[a], shift);
  }
  query.reduced.resize(tree_.num_axes());
  query.left =
      tree_.has_all_axes() ? 0 : tree_.reduce(query.point.data(), query.reduced.data());
  if (tree_.has_all_axes()) {
    query.reduced = query.point;
  }
  const double away = std::sqrt(detail::squared_distance(
      query.point.data(), tree_.point(0), tree_.ambient_dim()));
  query.tie = kTie * (tree_.extent() + away);
  query.slack = kSlack * (tree_.extent() + away);
  query.best = kInfinity;
  query.found.clear();
}

Query::Pending SimplexSearch::Search::consider(const Query& query,
                                               Offset number) const {
  const double box = tree_.lower_bound(query.reduced.data(), query.left, number);
  const double limit = query.best + query.slack;
  if (tree_.has_all_axes() || box > limit * limit) {
    return {number, box};
  }
  const detail::SimplexTree::Node& node = tree_.node(number);
  const double away = std::sqrt(detail::squared_distance(
      query.point.data(), tree_.point(node.center), tree_.ambient_dim()));
  const double ball = std::max(0.0, away - node.radius);
  return {number, std::max(box, ball * ball)};
}

template <class Solver>
void SimplexSearch::Search::search(Query& query, Solver& solver) const {
  query.stack.clear();
  query.stack.push_back({0, 0.0});
  while (!query.stack.empty()) {
    const Query::Pending next = query.stack.back();
    query.stack.pop_back();
    const double limit = query.best + query.slack;
    if (next.bound > limit * limit) {
      continue;
    }
    const detail::SimplexTree::Node& node = tree_.node(next.node);
    if (node.right == 0) {
      for (Offset p = node.begin; p < node.end; ++p) {
        look_at(query, p, solver);
      }
      continue;
    }
    Query::Pending near = consider(query, next.node + 1);
    Query::Pending far = consider(query, node.right);
    if (far.bound < near.bound) {
      std::swap(near, far);
    }
    query.stack.push_back(far);
    query.stack.push_back(near);
  }
}

void SimplexSearch::Search::set_corners(Query& query, Offset position) const {
  query.corners.resize(tree_.dim() + 1);
  for (int i = 0; i <= tree_.dim(); ++i) {
    query.corners[i] = tree_.point(tree_.simplex(position)[i]);
  }
}

/// Of the query from the box around the corners.
double SimplexSearch::Search::squared_from_box(const Query& query) const {
  double sum = 0;
  for (int a = 0; a < tree_.ambient_dim(); ++a) {
    double low = query.corners[0][a];
    double high = low;
    for (int i = 1; i <= tree_.dim(); ++i) {
      low = std::min(low, query.corners[i][a]);
      high = std::max(high, query.corners[i][a]);
    }
    const double away = std::max({low - query.point[a], query.point[a] - high, 0.0});
    sum += away * away;
  }
  return sum;
}

template <class Solver>
void SimplexSearch::Search::look_at(Query& query, Offset position,
                                    Solver& solver) const {
  set_corners(query, position);
  // A box, or a ball around the first corner, for less than the solution.
  if (tree_.has_all_axes()) {
    const double limit = query.best + query.slack;
    if (squared_from_box(query) > limit * limit) {
      return;
    }
  } else {
    const double reach = query.best + query.slack + tree_.reach(position);
    if (detail::squared_distance(query.point.data(), query.corners[0],
                                 tree_.ambient_dim(), reach * reach) > reach * reach) {
      return;
    }
  }
  const double found =
      std::sqrt(solver.solve(query.point.data(), query.corners.data()));
  if (found > query.best + query.tie) {
    return;
  }
  query.best = std::min(query.best, found);
  query.found.emplace_back(found, tree_.number(position));
}

/// The point of these weights, from the vertex of the largest: exact where it is one.
void SimplexSearch::Search::write(const Query& query,
                                  const std::vector<double>& weights,
                                  double* out) const {
  const auto base = std::max_element(weights.begin(), weights.end()) - weights.begin();
  for (int a = 0; a < tree_.ambient_dim(); ++a) {
    double sum = 0;
    for (int i = 0; i <= tree_.dim(); ++i) {
      sum += weights[i] * (query.corners[i][a] - query.corners[base][a]);
    }
    out[a] = (query.corners[base][a] + sum) / tree_.scale();
  }
}

/// Along Morton's curve through up to three coordinates, so that one query after the other
/// meets the same nodes. Coordinates of another frame would cost more than that saves.
std::vector<Offset> SimplexSearch::Search::order_of(MatrixView queries,
                                                    const Execution& execution) const {
  std::vector<Offset> order(queries.rows);
  std::iota(order.begin(), order.end(), Offset{0});
  if (!tree_.has_all_axes()) {
    return order;
  }
  constexpr int kMortonBits = 10;
  constexpr int kMortonAxes = 3;
  const int axes = std::min(tree_.ambient_dim(), kMortonAxes);
  std::array<double, kMortonAxes> low;
  std::array<double, kMortonAxes> high;
  low.fill(kInfinity);
  high.fill(-kInfinity);
  for (Offset q = 0; q < queries.rows; ++q) {
    for (int a = 0; a < axes; ++a) {
      low[a] = std::min(low[a], queries.row(q)[a]);
      high[a] = std::max(high[a], queries.row(q)[a]);
    }
  }
  std::vector<std::uint32_t> codes(queries.rows, 0);
  for (Offset q = 0; q < queries.rows; ++q) {
    for (int a = 0; a < axes; ++a) {
      // Halves: the difference may be infinite.
      const double width = high[a] / 2 - low[a] / 2;
      const double share = width > 0 ? (queries.row(q)[a] / 2 - low[a] / 2) / width : 0;
      const auto cell = static_cast<std::uint32_t>(share * ((1U << kMortonBits) - 1));
      for (int bit = 0; bit < kMortonBits; ++bit) {
        codes[q] |= (cell >> bit & 1U) << (bit * axes + a);
      }
    }
  }
  detail::sort_all(order, execution, [&](Offset a, Offset b) {
    return codes[a] != codes[b] ? codes[a] < codes[b] : a < b;
  });
  return order;
}

template <int K>
void SimplexSearch::Search::nearest_of(MatrixView queries, Projections& result,
                                       const Execution& execution) const {
  const std::vector<Offset> order = order_of(queries, execution);
  detail::for_each_block(
      queries.rows, kQueries, execution, [&](Offset begin, Offset end) {
        detail::NearestInSimplex<K> solver(tree_.dim(), tree_.ambient_dim());
        Query query;
        for (Offset next = begin; next < end; ++next) {
          const Offset q = order[next];
          place(query, queries.row(q));
          search(query, solver);
          Offset lowest = -1;
          for (const auto& [away, simplex] : query.found) {
            if (away <= query.best + query.tie && (lowest < 0 || simplex < lowest)) {
              lowest = simplex;
            }
          }
          set_corners(query, tree_.position(lowest));
          solver.solve(query.point.data(), query.corners.data());
          double* const out = result.points.data() + q * tree_.ambient_dim();
          write(query, solver.weights(), out);
          std::copy(solver.weights().begin(), solver.weights().end(),
                    result.barycentric.begin() + q * (tree_.dim() + 1));
          result.simplices[q] = lowest;
          result.distances[q] = distance(queries.row(q), out, tree_.ambient_dim());
        }
      });
}

Projections SimplexSearch::Search::nearest(MatrixView queries,
                                           const Execution& execution) const {
  if (queries.cols != tree_.ambient_dim()) {
    throw std::invalid_argument("queries have " + std::to_string(queries.cols) +
                                " coordinates, expected " +
                                std::to_string(tree_.ambient_dim()));
  }
  check_finite(queries, "queries");
  Projections result;
  result.simplices.resize(queries.rows);
  result.barycentric.resize(queries.rows * (tree_.dim() + 1));
  result.points.resize(queries.rows * tree_.ambient_dim());
  result.distances.resize(queries.rows);
  detail::begin_step(execution, Step::kProjection, queries.rows);
  switch (tree_.dim()) {
    case 1:
      nearest_of<1>(queries, result, execution);
      break;
    case 2:
      nearest_of<2>(queries, result, execution);
      break;
    case 3:
      nearest_of<3>(queries, result, execution);
      break;
    default:
      nearest_of<-1>(queries, result, execution);
  }
  return result;
}

SimplexSearch::SimplexSearch(MatrixView vertices, const SimplexArray& simplices,
                             const Execution& execution)
    : search_(std::make_unique<const Search>(vertices, simplices, execution)) {}

SimplexSearch::~SimplexSearch() = default;

Projections SimplexSearch::nearest(MatrixView queries,
                                   const Execution& execution) const {
  Projections result = search_->nearest(queries, execution);
  detail::assert_that([&] { verify_projections(result, queries); });
  return result;
}

}  // namespace remanifold
