// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's 2D convex hull, over the extreme points so far and those inserted since.
#include "detail/convex_hull.hpp"

#include <CGAL/Convex_hull_traits_adapter_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/ch_graham_andrew.h>
#include <CGAL/property_map.h>

#include <iterator>

namespace remanifold::detail {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;
using PointMap = CGAL::Pointer_property_map<Point>::type;
using Traits = CGAL::Convex_hull_traits_adapter_2<Kernel, PointMap>;

class Polygon final : public ConvexHull {
 public:
  void insert(const double* point, Index id) override {
    points_.emplace_back(point[0], point[1]);
    ids_.push_back(id);
  }

  void update() override {
    order_.resize(points_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) {
      order_[i] = i;
    }
    hull_.clear();
    CGAL::ch_graham_andrew(order_.begin(), order_.end(), std::back_inserter(hull_),
                           Traits(CGAL::make_property_map(points_)));
    facets_.clear();
    vertices_.clear();
    kept_points_.clear();
    kept_ids_.clear();
    for (std::size_t i = 0; i < hull_.size(); ++i) {
      const Index id = ids_[hull_[i]];
      facets_.push_back(id);
      facets_.push_back(ids_[hull_[(i + 1) % hull_.size()]]);
      if (!is_start(id)) {
        vertices_.push_back(id);
      }
      kept_points_.push_back(points_[hull_[i]]);
      kept_ids_.push_back(id);
    }
    points_.swap(kept_points_);
    ids_.swap(kept_ids_);
  }

 private:
  void clear() override {
    points_.clear();
    ids_.clear();
  }

  std::vector<Point> points_;
  std::vector<Index> ids_;
  std::vector<Point> kept_points_;
  std::vector<Index> kept_ids_;
  std::vector<std::size_t> order_;
  std::vector<std::size_t> hull_;
};

}  // namespace

std::unique_ptr<ConvexHull> make_convex_hull_2() { return std::make_unique<Polygon>(); }

}  // namespace remanifold::detail
