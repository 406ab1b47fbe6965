// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/projection.hpp"

#include "detail/nearest_in_simplex.hpp"
#include "detail/parallel.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace remanifold {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Offset kBlock = 1024;
constexpr Offset kQueries = 128;
/// Simplices of a leaf.
constexpr Offset kLeaf = 3;
/// Coordinates of a box. Where there are more, boxes are in so many principal ones.
constexpr int kMostAxes = 8;
/// Vertices that principal coordinates are taken from. Any orthonormal ones are right.
constexpr Offset kAxesFrom = 256;
/// Distances that differ by less, in units of the size of the complex and of the distance
/// of the query, are equal.
constexpr double kTie = 0x1p-48;
/// What bounds are lowered by, in the same unit: more than their rounding.
constexpr double kSlack = 0x1p-40;
/// Queries farther away, in units of the complex, see it as a point.
constexpr int kFarthest = 300;

using Axes = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::Map<const Eigen::VectorXd>;

void check_finite(MatrixView matrix, const char* name) {
  for (Offset i = 0; i < matrix.rows * matrix.cols; ++i) {
    if (!std::isfinite(matrix.data[i])) {
      throw std::invalid_argument(std::string(name) + ": row " +
                                  std::to_string(i / matrix.cols) + " is not finite");
    }
  }
}

/// The power of two that brings the largest of the coordinates used to [1/2, 1).
double scale_of(MatrixView vertices, const SimplexArray& simplices) {
  double largest = 0;
  for (const Index v : simplices.vertices) {
    for (Offset a = 0; a < vertices.cols; ++a) {
      largest = std::max(largest, std::abs(vertices.row(v)[a]));
    }
  }
  int exponent = 0;
  std::frexp(largest, &exponent);
  return std::ldexp(1.0, -std::clamp(exponent, -1000, 1000));
}

double squared_distance(const double* a, const double* b, int size) {
  double sum = 0;
  for (int i = 0; i < size; ++i) {
    const double away = a[i] - b[i];
    sum += away * away;
  }
  return sum;
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

}  // namespace

class SimplexSearch::Tree {
 public:
  Tree(MatrixView vertices, const SimplexArray& simplices, const Execution& execution);

  Projections nearest(MatrixView queries, const Execution& execution) const;

 private:
  struct Node {
    Offset begin = 0;
    Offset end = 0;
    Offset right = 0;  // the left child follows its parent; 0 in a leaf
    Index center = 0;
    double radius = 0;     // of the ball around the vertex `center`
    double most_left = 0;  // of what principal coordinates leave out
  };
  struct Pending {
    Offset node;
    double bound;  // squared
  };
  /// Where a query stands, and what was found for it.
  struct Query {
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

  bool has_all_axes() const { return num_axes_ == ambient_dim_; }
  const double* point(Index v) const {
    return points_.data() + static_cast<std::size_t>(v) * ambient_dim_;
  }
  const double* reduced(Index v) const {
    return has_all_axes() ? point(v)
                          : reduced_.data() + static_cast<std::size_t>(v) * num_axes_;
  }

  void copy_used(MatrixView vertices, const SimplexArray& simplices);
  void find_axes(const Execution& execution);
  /// \returns the length of what the principal coordinates leave out
  double reduce(const double* point, double* reduced) const;
  void grow(const Execution& execution);
  void split_all(const std::vector<double>& centers, const Execution& execution);
  void bound_all(const Execution& execution);
  void bound(Offset node);

  void place(Query& query, const double* point) const;
  double lower_bound(const Query& query, Offset node) const;
  template <class Solver>
  void search(Query& query, Solver& solver) const;
  template <class Solver>
  void look_at(Query& query, Offset position, Solver& solver) const;
  template <int K>
  void nearest_of(MatrixView queries, Projections& result,
                  const Execution& execution) const;
  void set_corners(Query& query, Offset position) const;
  void write(const Query& query, const std::vector<double>& weights, double* out) const;

  int dim_;
  int ambient_dim_;
  int num_axes_;
  double scale_ = 1;
  double extent_ = 0;
  std::vector<double> points_;  // scaled, those in simplices only
  std::vector<double> mean_;
  Axes axes_;  // num_axes_ x D
  std::vector<double> reduced_;
  std::vector<double> left_;     // of each point
  std::vector<Index> vertices_;  // of the simplices in the order of the tree
  std::vector<Offset> order_;    // number of each simplex
  std::vector<Offset> position_;
  std::vector<Node> nodes_;
  std::vector<double> boxes_;  // low, then high, of each node
};

// ---------------------------------------------------------------------------- building

SimplexSearch::Tree::Tree(MatrixView vertices, const SimplexArray& simplices,
                          const Execution& execution)
    : dim_(simplices.arity - 1),
      ambient_dim_(static_cast<int>(vertices.cols)),
      num_axes_(std::min(ambient_dim_, kMostAxes)) {
  if (simplices.size() == 0) {
    throw std::invalid_argument("simplices: there are none, and no nearest point");
  }
  for (const Index v : simplices.vertices) {
    if (v < 0 || v >= vertices.rows) {
      throw std::invalid_argument("simplices: vertex " + std::to_string(v) +
                                  ", expected 0 to " +
                                  std::to_string(vertices.rows - 1));
    }
  }
  check_finite(vertices, "vertices");
  detail::begin_step(execution, Step::kPrepare, simplices.size());
  scale_ = scale_of(vertices, simplices);
  copy_used(vertices, simplices);
  find_axes(execution);
  grow(execution);
}

void SimplexSearch::Tree::copy_used(MatrixView vertices,
                                    const SimplexArray& simplices) {
  std::vector<Index> number(vertices.rows, -1);
  vertices_.reserve(simplices.vertices.size());
  Index count = 0;
  for (const Index v : simplices.vertices) {
    if (number[v] < 0) {
      number[v] = count++;
      for (int a = 0; a < ambient_dim_; ++a) {
        points_.push_back(vertices.row(v)[a] * scale_);
      }
    }
    vertices_.push_back(number[v]);
  }
  for (int a = 0; a < ambient_dim_; ++a) {
    double low = kInfinity;
    double high = -kInfinity;
    for (Index v = 0; v < count; ++v) {
      low = std::min(low, point(v)[a]);
      high = std::max(high, point(v)[a]);
    }
    extent_ += (high - low) * (high - low);
  }
  extent_ = std::sqrt(extent_);
}

void SimplexSearch::Tree::find_axes(const Execution& execution) {
  const auto count = static_cast<Offset>(points_.size()) / ambient_dim_;
  left_.assign(count, 0.0);
  if (has_all_axes()) {
    return;
  }
  const Offset taken = std::min(count, kAxesFrom);
  Axes rows(taken, ambient_dim_);
  for (Offset i = 0; i < taken; ++i) {
    rows.row(i) = Vector(point(static_cast<Index>(i * count / taken)), ambient_dim_);
  }
  const Eigen::RowVectorXd mean = rows.colwise().mean();
  mean_.assign(mean.data(), mean.data() + ambient_dim_);
  rows.rowwise() -= mean;
  const Eigen::MatrixXd gram = rows.lazyProduct(rows.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);
  // The directions of the largest values; where they are dependent, others complete them.
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(ambient_dim_, num_axes_);
  for (int i = 0; i < std::min<int>(num_axes_, static_cast<int>(taken)); ++i) {
    directions.col(i) =
        rows.transpose().lazyProduct(solver.eigenvectors().col(taken - 1 - i));
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> factors(directions);
  const Eigen::MatrixXd frame =
      factors.householderQ() * Eigen::MatrixXd::Identity(ambient_dim_, num_axes_);
  axes_ = frame.transpose();
  reduced_.resize(static_cast<std::size_t>(count) * num_axes_);
  detail::for_each_block_uncounted(
      count, kBlock, execution, [&](Offset begin, Offset end) {
        for (Offset i = begin; i < end; ++i) {
          left_[i] = reduce(point(static_cast<Index>(i)),
                            reduced_.data() + static_cast<std::size_t>(i) * num_axes_);
        }
      });
}

double SimplexSearch::Tree::reduce(const double* point, double* reduced) const {
  double total = 0;
  double within = 0;
  for (int a = 0; a < ambient_dim_; ++a) {
    total += (point[a] - mean_[a]) * (point[a] - mean_[a]);
  }
  for (int i = 0; i < num_axes_; ++i) {
    const double* axis = axes_.data() + static_cast<std::size_t>(i) * ambient_dim_;
    reduced[i] = 0;
    for (int a = 0; a < ambient_dim_; ++a) {
      reduced[i] += axis[a] * (point[a] - mean_[a]);
    }
    within += reduced[i] * reduced[i];
  }
  return std::sqrt(std::max(0.0, total - within));
}

void SimplexSearch::Tree::grow(const Execution& execution) {
  const auto count = static_cast<Offset>(vertices_.size()) / (dim_ + 1);
  std::vector<double> centers(static_cast<std::size_t>(count) * num_axes_);
  for (Offset s = 0; s < count; ++s) {
    for (int i = 0; i <= dim_; ++i) {
      const double* corner = reduced(vertices_[s * (dim_ + 1) + i]);
      for (int a = 0; a < num_axes_; ++a) {
        centers[s * num_axes_ + a] += corner[a] / (dim_ + 1);
      }
    }
  }
  order_.resize(count);
  std::iota(order_.begin(), order_.end(), Offset{0});
  split_all(centers, execution);
  std::vector<Index> sorted;
  sorted.reserve(vertices_.size());
  position_.resize(count);
  for (Offset p = 0; p < count; ++p) {
    const Offset first = order_[p] * (dim_ + 1);
    sorted.insert(sorted.end(), vertices_.begin() + first,
                  vertices_.begin() + first + dim_ + 1);
    position_[order_[p]] = p;
  }
  vertices_ = std::move(sorted);
  bound_all(execution);
}

/// Halves at the median along the widest axis.
void SimplexSearch::Tree::split_all(const std::vector<double>& centers,
                                    const Execution& execution) {
  struct Task {
    Offset begin;
    Offset end;
    Offset parent;  // whose right child this is, or -1
  };
  std::vector<Task> tasks{{0, static_cast<Offset>(order_.size()), -1}};
  while (!tasks.empty()) {
    const Task task = tasks.back();
    tasks.pop_back();
    execution.poll();
    const auto number = static_cast<Offset>(nodes_.size());
    if (task.parent >= 0) {
      nodes_[task.parent].right = number;
    }
    nodes_.emplace_back();
    nodes_.back().begin = task.begin;
    nodes_.back().end = task.end;
    if (task.end - task.begin <= kLeaf) {
      continue;
    }
    int widest = 0;
    double width = -1;
    for (int a = 0; a < num_axes_; ++a) {
      double low = kInfinity;
      double high = -kInfinity;
      for (Offset p = task.begin; p < task.end; ++p) {
        low = std::min(low, centers[order_[p] * num_axes_ + a]);
        high = std::max(high, centers[order_[p] * num_axes_ + a]);
      }
      if (high - low > width) {
        width = high - low;
        widest = a;
      }
    }
    const Offset middle = task.begin + (task.end - task.begin) / 2;
    std::nth_element(order_.begin() + task.begin, order_.begin() + middle,
                     order_.begin() + task.end, [&](Offset s, Offset t) {
                       const double one = centers[s * num_axes_ + widest];
                       const double other = centers[t * num_axes_ + widest];
                       return one != other ? one < other : s < t;
                     });
    tasks.push_back({middle, task.end, number});
    tasks.push_back({task.begin, middle, -1});
  }
}

void SimplexSearch::Tree::bound_all(const Execution& execution) {
  const auto count = static_cast<Offset>(nodes_.size());
  boxes_.resize(static_cast<std::size_t>(count) * 2 * num_axes_);
  detail::for_each_block_uncounted(count, 64, execution, [&](Offset begin, Offset end) {
    for (Offset n = begin; n < end; ++n) {
      bound(n);
    }
  });
}

void SimplexSearch::Tree::bound(Offset number) {
  Node& node = nodes_[number];
  const Index* const first = vertices_.data() + node.begin * (dim_ + 1);
  const Index* const last = vertices_.data() + node.end * (dim_ + 1);
  double* const low = boxes_.data() + static_cast<std::size_t>(number) * 2 * num_axes_;
  double* const high = low + num_axes_;
  std::fill(low, low + num_axes_, kInfinity);
  std::fill(high, high + num_axes_, -kInfinity);
  for (const Index* v = first; v != last; ++v) {
    for (int a = 0; a < num_axes_; ++a) {
      low[a] = std::min(low[a], reduced(*v)[a]);
      high[a] = std::max(high[a], reduced(*v)[a]);
    }
    node.most_left = std::max(node.most_left, left_[*v]);
  }
  if (has_all_axes()) {
    return;
  }
  // A ball around the vertex nearest to the middle of the box.
  double nearest = kInfinity;
  for (const Index* v = first; v != last; ++v) {
    double squared = 0;
    for (int a = 0; a < num_axes_; ++a) {
      const double away = reduced(*v)[a] - (low[a] + high[a]) / 2;
      squared += away * away;
    }
    if (squared < nearest) {
      nearest = squared;
      node.center = *v;
    }
  }
  double farthest = 0;
  for (const Index* v = first; v != last; ++v) {
    farthest = std::max(farthest,
                        squared_distance(point(*v), point(node.center), ambient_dim_));
  }
  node.radius = std::sqrt(farthest);
}

// ---------------------------------------------------------------------------- searching

void SimplexSearch::Tree::place(Query& query, const double* point) const {
  double largest = 0;
  for (int a = 0; a < ambient_dim_; ++a) {
    largest = std::max(largest, std::abs(point[a]));
  }
  int exponent = 0;
  std::frexp(largest, &exponent);
  int own = 0;
  std::frexp(scale_, &own);
  const int shift = std::min(own - 1, kFarthest - exponent);
  query.point.resize(ambient_dim_);
  for (int a = 0; a < ambient_dim_; ++a) {
    query.point[a] = std::ldexp(point[a], shift);
  }
  query.reduced.resize(num_axes_);
  query.left = has_all_axes() ? 0 : reduce(query.point.data(), query.reduced.data());
  if (has_all_axes()) {
    query.reduced = query.point;
  }
  const double away =
      std::sqrt(squared_distance(query.point.data(), this->point(0), ambient_dim_));
  query.tie = kTie * (extent_ + away);
  query.slack = kSlack * (extent_ + away);
  query.best = kInfinity;
  query.found.clear();
}

/// Of the squared distance, from the box and what it leaves out.
double SimplexSearch::Tree::lower_bound(const Query& query, Offset number) const {
  const double* const low =
      boxes_.data() + static_cast<std::size_t>(number) * 2 * num_axes_;
  const double* const high = low + num_axes_;
  double sum = 0;
  for (int a = 0; a < num_axes_; ++a) {
    const double x = query.reduced[a];
    const double away = std::max(std::max(low[a] - x, x - high[a]), 0.0);
    sum += away * away;
  }
  const double left = std::max(0.0, query.left - nodes_[number].most_left);
  return sum + left * left;
}

template <class Solver>
void SimplexSearch::Tree::search(Query& query, Solver& solver) const {
  query.stack.clear();
  query.stack.push_back({0, 0.0});
  while (!query.stack.empty()) {
    const Pending next = query.stack.back();
    query.stack.pop_back();
    const double limit = query.best + query.slack;
    if (next.bound > limit * limit) {
      continue;
    }
    const Node& node = nodes_[next.node];
    if (!has_all_axes()) {
      const double reach = limit + node.radius;
      if (squared_distance(query.point.data(), point(node.center), ambient_dim_) >
          reach * reach) {
        continue;
      }
    }
    if (node.right == 0) {
      for (Offset p = node.begin; p < node.end; ++p) {
        look_at(query, p, solver);
      }
      continue;
    }
    Pending near{next.node + 1, lower_bound(query, next.node + 1)};
    Pending far{node.right, lower_bound(query, node.right)};
    if (far.bound < near.bound) {
      std::swap(near, far);
    }
    query.stack.push_back(far);
    query.stack.push_back(near);
  }
}

void SimplexSearch::Tree::set_corners(Query& query, Offset position) const {
  query.corners.resize(dim_ + 1);
  for (int i = 0; i <= dim_; ++i) {
    query.corners[i] = point(vertices_[position * (dim_ + 1) + i]);
  }
}

template <class Solver>
void SimplexSearch::Tree::look_at(Query& query, Offset position, Solver& solver) const {
  set_corners(query, position);
  const double found =
      std::sqrt(solver.solve(query.point.data(), query.corners.data()));
  if (found > query.best + query.tie) {
    return;
  }
  query.best = std::min(query.best, found);
  query.found.emplace_back(found, order_[position]);
}

/// The point of these weights, from the vertex of the largest: exact where it is one.
void SimplexSearch::Tree::write(const Query& query, const std::vector<double>& weights,
                                double* out) const {
  const auto base = std::max_element(weights.begin(), weights.end()) - weights.begin();
  for (int a = 0; a < ambient_dim_; ++a) {
    double sum = 0;
    for (int i = 0; i <= dim_; ++i) {
      sum += weights[i] * (query.corners[i][a] - query.corners[base][a]);
    }
    out[a] = (query.corners[base][a] + sum) / scale_;
  }
}

template <int K>
void SimplexSearch::Tree::nearest_of(MatrixView queries, Projections& result,
                                     const Execution& execution) const {
  detail::for_each_block(
      queries.rows, kQueries, execution, [&](Offset begin, Offset end) {
        detail::NearestInSimplex<K> solver(dim_, ambient_dim_);
        Query query;
        for (Offset q = begin; q < end; ++q) {
          place(query, queries.row(q));
          search(query, solver);
          Offset lowest = -1;
          for (const auto& [away, simplex] : query.found) {
            if (away <= query.best + query.tie && (lowest < 0 || simplex < lowest)) {
              lowest = simplex;
            }
          }
          set_corners(query, position_[lowest]);
          solver.solve(query.point.data(), query.corners.data());
          double* const out = result.points.data() + q * ambient_dim_;
          write(query, solver.weights(), out);
          std::copy(solver.weights().begin(), solver.weights().end(),
                    result.barycentric.begin() + q * (dim_ + 1));
          result.simplices[q] = lowest;
          result.distances[q] = distance(queries.row(q), out, ambient_dim_);
        }
      });
}

Projections SimplexSearch::Tree::nearest(MatrixView queries,
                                         const Execution& execution) const {
  if (queries.cols != ambient_dim_) {
    throw std::invalid_argument("queries have " + std::to_string(queries.cols) +
                                " coordinates, expected " +
                                std::to_string(ambient_dim_));
  }
  check_finite(queries, "queries");
  Projections result;
  result.simplices.resize(queries.rows);
  result.barycentric.resize(queries.rows * (dim_ + 1));
  result.points.resize(queries.rows * ambient_dim_);
  result.distances.resize(queries.rows);
  detail::begin_step(execution, Step::kProjection, queries.rows);
  switch (dim_) {
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
    : tree_(std::make_unique<const Tree>(vertices, simplices, execution)) {}

SimplexSearch::~SimplexSearch() = default;

Projections SimplexSearch::nearest(MatrixView queries,
                                   const Execution& execution) const {
  return tree_->nearest(queries, execution);
}

}  // namespace remanifold
