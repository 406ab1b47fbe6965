// SPDX-License-Identifier: GPL-3.0-or-later
#include "query/simplex_tree.hpp"

#include "base/decompositions.hpp"
#include "base/parallel.hpp"
#include "samples/distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

namespace remanifold::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Offset kBlock = 1024;
constexpr Offset kNodes = 64;
/// Simplices of a leaf.
constexpr Offset kLeaf = 3;
/// Coordinates of a box. Where there are more, boxes are in so many of another frame.
constexpr int kMostAxes = 8;
constexpr int kPrincipal = 4;
/// Vertices that these are taken from. Any orthonormal ones are right.
constexpr Offset kAxesFrom = 256;

using Vector = Eigen::Map<const Eigen::VectorXd>;

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

}  // namespace

SimplexTree::SimplexTree(MatrixView vertices, const SimplexArray& simplices,
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
  scale_ = scale_of(vertices, simplices);
  copy_used(vertices, simplices);
  find_axes(execution);
  grow(execution);
}

void SimplexTree::copy_used(MatrixView vertices, const SimplexArray& simplices) {
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

void SimplexTree::find_axes(const Execution& execution) {
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
  const SymmetricEigen solver(gram);
  // Half of them along the most variance, half mixed from all of it: the first alone may
  // take parts of a manifold that are far apart to the same place. Where they are
  // dependent, the decomposition completes them.
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(ambient_dim_, num_axes_);
  std::mt19937 random(1);
  Eigen::VectorXd weights(taken);
  for (int i = 0; i < num_axes_; ++i) {
    if (i < kPrincipal && i < taken) {
      weights = solver.eigenvectors().col(taken - 1 - i);
    } else {
      for (double& weight : weights) {
        weight = random() % 2 == 0 ? 1 : -1;
      }
    }
    directions.col(i) = rows.transpose().lazyProduct(weights);
  }
  axes_ = orthonormal_columns(directions).transpose();
  reduced_.resize(static_cast<std::size_t>(count) * num_axes_);
  for_each_block_uncounted(count, kBlock, execution, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) {
      left_[i] = reduce(point(static_cast<Index>(i)),
                        reduced_.data() + static_cast<std::size_t>(i) * num_axes_);
    }
  });
}

double SimplexTree::reduce(const double* point, double* reduced) const {
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

void SimplexTree::grow(const Execution& execution) {
  const auto count = static_cast<Offset>(vertices_.size()) / (dim_ + 1);
  order_.resize(count);
  std::iota(order_.begin(), order_.end(), Offset{0});
  split_all(execution);
  std::vector<Index> sorted;
  sorted.reserve(vertices_.size());
  position_.resize(count);
  for (Offset p = 0; p < count; ++p) {
    sorted.insert(sorted.end(), simplex(order_[p]), simplex(order_[p]) + dim_ + 1);
    position_[order_[p]] = p;
  }
  vertices_ = std::move(sorted);
  measure_reach();
  bound_all(execution);
}

/// Halves at the median.
void SimplexTree::split_all(const Execution& execution) {
  struct Task {
    Offset begin;
    Offset end;
    Offset parent;  // whose right child this is, or -1
  };
  std::vector<Task> tasks{{0, static_cast<Offset>(order_.size()), -1}};
  std::vector<double> keys(order_.size());
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
    project_on_widest_axis(task.begin, task.end, keys);
    const Offset middle = task.begin + (task.end - task.begin) / 2;
    std::nth_element(order_.begin() + task.begin, order_.begin() + middle,
                     order_.begin() + task.end, [&](Offset s, Offset t) {
                       return keys[s] != keys[t] ? keys[s] < keys[t] : s < t;
                     });
    tasks.push_back({middle, task.end, number});
    tasks.push_back({task.begin, middle, -1});
  }
}

/// Keys of the simplices: their centers (times K + 1) along the axis of most extent, in the
/// frame of the boxes, so that these become small.
void SimplexTree::project_on_widest_axis(Offset begin, Offset end,
                                         std::vector<double>& keys) const {
  const auto center = [&](Offset s, int a) {
    double sum = 0;
    for (int i = 0; i <= dim_; ++i) {
      sum += reduced(simplex(s)[i])[a];
    }
    return sum;
  };
  int widest = 0;
  double width = -1;
  for (int a = 0; a < num_axes_; ++a) {
    double low = kInfinity;
    double high = -kInfinity;
    for (Offset p = begin; p < end; ++p) {
      const double value = center(order_[p], a);
      low = std::min(low, value);
      high = std::max(high, value);
    }
    if (high - low > width) {
      width = high - low;
      widest = a;
    }
  }
  for (Offset p = begin; p < end; ++p) {
    keys[order_[p]] = center(order_[p], widest);
  }
}

void SimplexTree::measure_reach() {
  if (has_all_axes()) {
    return;
  }
  reach_.assign(order_.size(), 0.0);
  for (Offset p = 0; p < static_cast<Offset>(order_.size()); ++p) {
    for (int i = 1; i <= dim_; ++i) {
      const double edge =
          squared_distance(point(simplex(p)[0]), point(simplex(p)[i]), ambient_dim_);
      reach_[p] = std::max(reach_[p], std::sqrt(edge));
    }
  }
}

void SimplexTree::bound_all(const Execution& execution) {
  const auto count = static_cast<Offset>(nodes_.size());
  boxes_.resize(static_cast<std::size_t>(count) * 2 * num_axes_);
  for_each_block_uncounted(count, kNodes, execution, [&](Offset begin, Offset end) {
    for (Offset n = begin; n < end; ++n) {
      bound(n);
    }
  });
}

void SimplexTree::bound(Offset number) {
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

double SimplexTree::lower_bound(const double* reduced, double left,
                                Offset number) const {
  const double* const low =
      boxes_.data() + static_cast<std::size_t>(number) * 2 * num_axes_;
  const double* const high = low + num_axes_;
  double sum = 0;
  for (int a = 0; a < num_axes_; ++a) {
    const double x = reduced[a];
    const double away = std::max(std::max(low[a] - x, x - high[a]), 0.0);
    sum += away * away;
  }
  const double away = std::max(0.0, left - nodes_[number].most_left);
  return sum + away * away;
}

}  // namespace remanifold::detail
