// SPDX-License-Identifier: GPL-3.0-or-later
// A binary tree over simplices, with bounds on how far they are from a point.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

#include <Eigen/Core>

#include <vector>

namespace remanifold::detail {

class SimplexTree {
 public:
  struct Node {
    Offset begin = 0;
    Offset end = 0;
    Offset right = 0;  // the left child follows its parent; 0 in a leaf
    Index center = 0;
    double radius = 0;     // of the ball around the vertex `center`
    double most_left = 0;  // of what the coordinates of the box leave out
  };

  /// Copies the coordinates that are used.
  /// \throws std::invalid_argument  no simplices, or a vertex out of range
  SimplexTree(MatrixView vertices, const SimplexArray& simplices,
              const Execution& execution);

  int dim() const { return dim_; }
  int ambient_dim() const { return ambient_dim_; }
  /// Coordinates here are those given times this power of two.
  double scale() const { return scale_; }
  /// The diagonal of the box around all.
  double extent() const { return extent_; }
  const Node& node(Offset number) const { return nodes_[number]; }
  /// Position in the order of the tree to number of the simplex, and back.
  Offset number(Offset position) const { return order_[position]; }
  Offset position(Offset number) const { return position_[number]; }
  const double* point(Index v) const {
    return points_.data() + static_cast<std::size_t>(v) * ambient_dim_;
  }
  const Index* simplex(Offset position) const {
    return vertices_.data() + position * (dim_ + 1);
  }

  /// Whether boxes are in all coordinates. Else they are in a few of another frame, and
  /// there are balls too.
  bool has_all_axes() const { return num_axes_ == ambient_dim_; }
  int num_axes() const { return num_axes_; }
  /// Coordinates of a point in the frame of the boxes.
  /// \returns the length of what they leave out
  double reduce(const double* point, double* reduced) const;
  /// Of the squared distance of a point from all in a node, from its box.
  double lower_bound(const double* reduced, double left, Offset number) const;
  /// Of a simplex, around its first corner; where there are balls.
  double reach(Offset position) const { return reach_[position]; }

 private:
  class NodeCounts;
  struct Branch {
    Offset begin;
    Offset end;
    Offset node;
  };
  struct Keyed {
    double key;
    Offset simplex;
  };
  using Axes = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  const double* reduced(Index v) const {
    return has_all_axes() ? point(v)
                          : reduced_.data() + static_cast<std::size_t>(v) * num_axes_;
  }

  void copy_used(MatrixView vertices, const SimplexArray& simplices);
  void find_axes(const Execution& execution);
  void grow(const Execution& execution);
  void split_all(const Execution& execution);
  void split(const Branch& branch, const NodeCounts& counts,
             const std::vector<double>& centers, std::vector<Keyed>& keyed,
             std::vector<Branch>& children);
  void sort_points();
  void measure_reach();
  void bound_all(const Execution& execution);
  void bound_box(Offset number);
  void bound_ball(Offset number);

  int dim_;
  int ambient_dim_;
  int num_axes_;
  double scale_ = 1;
  double extent_ = 0;
  std::vector<double> points_;  // scaled
  std::vector<double> mean_;
  Axes axes_;  // num_axes x D
  std::vector<double> reduced_;
  std::vector<double> left_;  // of each point
  std::vector<Index>
      vertices_;  // of the simplices, in the order of the tree once grown
  std::vector<Offset> order_;
  std::vector<Offset> position_;
  std::vector<double> reach_;
  std::vector<Node> nodes_;
  std::vector<double> boxes_;  // low, then high, of each node
};

}  // namespace remanifold::detail
