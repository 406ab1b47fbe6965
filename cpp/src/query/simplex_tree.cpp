// SPDX-License-Identifier: GPL-3.0-or-later
#include "query/simplex_tree.hpp"

#include "base/decompositions.hpp"
#include "base/parallel.hpp"
#include "samples/distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
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
/// Branches that are split side by side.
constexpr std::size_t kBranches = 64;
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
  sort_points();
  measure_reach();
  bound_all(execution);
}

/// In the order in which the simplices of the tree have them: what is near is near in
/// memory.
void SimplexTree::sort_points() {
  const auto count = static_cast<Offset>(left_.size());
  std::vector<Index> number(count, -1);
  std::vector<Index> sources;
  sources.reserve(count);
  for (Index& v : vertices_) {
    if (number[v] < 0) {
      number[v] = static_cast<Index>(sources.size());
      sources.push_back(v);
    }
    v = number[v];
  }
  const auto permute = [&](std::vector<double>& rows, int width) {
    std::vector<double> sorted;
    sorted.reserve(rows.size());
    for (const Index v : sources) {
      const auto row = rows.begin() + static_cast<Offset>(v) * width;
      sorted.insert(sorted.end(), row, row + width);
    }
    rows = std::move(sorted);
  };
  permute(points_, ambient_dim_);
  permute(left_, 1);
  if (!has_all_axes()) {
    permute(reduced_, num_axes_);
  }
}

/// Numbers of nodes of trees over so many simplices, each half being a tree.
class SimplexTree::NodeCounts {
 public:
  explicit NodeCounts(Offset count) { fill(count); }
  Offset of(Offset count) const { return counts_.at(count); }

 private:
  Offset fill(Offset count) {
    const auto known = counts_.find(count);
    if (known != counts_.end()) {
      return known->second;
    }
    const Offset nodes =
        count <= kLeaf ? 1 : 1 + fill(count / 2) + fill(count - count / 2);
    counts_.emplace(count, nodes);
    return nodes;
  }

  std::map<Offset, Offset> counts_;
};

/// Halves at the median. The numbers of the nodes follow from those of the simplices, so
/// that branches can be split side by side.
void SimplexTree::split_all(const Execution& execution) {
  const auto count = static_cast<Offset>(order_.size());
  const NodeCounts counts(count);
  nodes_.resize(counts.of(count));
  // Times K + 1, in the frame of the boxes, so that these become small.
  std::vector<double> centers(static_cast<std::size_t>(count) * num_axes_, 0.0);
  for_each_block_uncounted(count, kBlock, execution, [&](Offset begin, Offset end) {
    for (Offset s = begin; s < end; ++s) {
      for (int i = 0; i <= dim_; ++i) {
        const double* corner = reduced(simplex(s)[i]);
        for (int a = 0; a < num_axes_; ++a) {
          centers[s * num_axes_ + a] += corner[a];
        }
      }
    }
  });
  std::vector<Branch> branches{{0, count, 0}};
  std::vector<Keyed> keyed;
  for (std::size_t next = 0;
       next < branches.size() && branches.size() - next < kBranches; ++next) {
    execution.poll();
    split(Branch(branches[next]), counts, centers, keyed, branches);
  }
  // What is split already has children, which come behind it.
  std::vector<Branch> left;
  std::copy_if(branches.begin(), branches.end(), std::back_inserter(left),
               [&](const Branch& branch) { return nodes_[branch.node].end == 0; });
  for_each_block_uncounted(static_cast<Offset>(left.size()), 1, execution,
                           [&](Offset begin, Offset) {
                             std::vector<Branch> own{left[begin]};
                             std::vector<Keyed> scratch;
                             while (!own.empty()) {
                               execution.poll();
                               const Branch branch = own.back();
                               own.pop_back();
                               split(branch, counts, centers, scratch, own);
                             }
                           });
}

/// Along the axis of most extent.
void SimplexTree::split(const Branch& branch, const NodeCounts& counts,
                        const std::vector<double>& centers, std::vector<Keyed>& keyed,
                        std::vector<Branch>& children) {
  Node& node = nodes_[branch.node];
  node.begin = branch.begin;
  node.end = branch.end;
  const Offset count = branch.end - branch.begin;
  if (count <= kLeaf) {
    return;
  }
  std::array<double, kMostAxes> low;
  std::array<double, kMostAxes> high;
  low.fill(kInfinity);
  high.fill(-kInfinity);
  for (Offset p = branch.begin; p < branch.end; ++p) {
    const double* center = centers.data() + order_[p] * num_axes_;
    for (int a = 0; a < num_axes_; ++a) {
      low[a] = std::min(low[a], center[a]);
      high[a] = std::max(high[a], center[a]);
    }
  }
  int widest = 0;
  for (int a = 1; a < num_axes_; ++a) {
    if (high[a] - low[a] > high[widest] - low[widest]) {
      widest = a;
    }
  }
  keyed.resize(count);
  for (Offset i = 0; i < count; ++i) {
    const Offset s = order_[branch.begin + i];
    keyed[i] = {centers[s * num_axes_ + widest], s};
  }
  const Offset half = count / 2;
  std::nth_element(keyed.begin(), keyed.begin() + half, keyed.end(),
                   [](const Keyed& a, const Keyed& b) {
                     return a.key != b.key ? a.key < b.key : a.simplex < b.simplex;
                   });
  for (Offset i = 0; i < count; ++i) {
    order_[branch.begin + i] = keyed[i].simplex;
  }
  node.right = branch.node + 1 + counts.of(half);
  const Offset middle = branch.begin + half;
  children.push_back({middle, branch.end, node.right});
  children.push_back({branch.begin, middle, branch.node + 1});
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

/// Children come behind their parent.
void SimplexTree::bound_all(const Execution& execution) {
  const auto count = static_cast<Offset>(nodes_.size());
  boxes_.resize(static_cast<std::size_t>(count) * 2 * num_axes_);
  for (Offset n = count - 1; n >= 0; --n) {
    bound_box(n);
  }
  if (!has_all_axes()) {
    for_each_block_uncounted(count, kNodes, execution, [&](Offset begin, Offset end) {
      for (Offset n = begin; n < end; ++n) {
        bound_ball(n);
      }
    });
  }
}

void SimplexTree::bound_box(Offset number) {
  Node& node = nodes_[number];
  const int axes = num_axes_;
  double* const low = boxes_.data() + static_cast<std::size_t>(number) * 2 * axes;
  double* const high = low + axes;
  if (node.right == 0) {
    std::fill(low, low + axes, kInfinity);
    std::fill(high, high + axes, -kInfinity);
    for (const Index* v = simplex(node.begin); v != simplex(node.end); ++v) {
      for (int a = 0; a < axes; ++a) {
        low[a] = std::min(low[a], reduced(*v)[a]);
        high[a] = std::max(high[a], reduced(*v)[a]);
      }
      node.most_left = std::max(node.most_left, left_[*v]);
    }
    return;
  }
  const double* const first =
      boxes_.data() + static_cast<std::size_t>(number + 1) * 2 * axes;
  const double* const second =
      boxes_.data() + static_cast<std::size_t>(node.right) * 2 * axes;
  for (int a = 0; a < axes; ++a) {
    low[a] = std::min(first[a], second[a]);
    high[a] = std::max(first[axes + a], second[axes + a]);
  }
  node.most_left = std::max(nodes_[number + 1].most_left, nodes_[node.right].most_left);
}

/// Around the vertex nearest to the middle of the box.
void SimplexTree::bound_ball(Offset number) {
  Node& node = nodes_[number];
  const Index* const first = simplex(node.begin);
  const Index* const last = simplex(node.end);
  const double* const low =
      boxes_.data() + static_cast<std::size_t>(number) * 2 * num_axes_;
  const double* const high = low + num_axes_;
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
