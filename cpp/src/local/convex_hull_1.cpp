// SPDX-License-Identifier: GPL-3.0-or-later
// The hull on a line is an interval.
#include "local/convex_hull.hpp"

namespace remanifold::detail {
namespace {

class Interval final : public ConvexHull {
 public:
  void insert(const double* point, Index id) override {
    if (*point < low_.position) {
      low_ = {*point, id};
    } else if (*point > high_.position) {
      high_ = {*point, id};
    }
  }

  void update() override {
    facets_.assign({low_.id, high_.id});
    vertices_.clear();
    for (const Index id : facets_) {
      if (!is_start(id)) {
        vertices_.push_back(id);
      }
    }
  }

 private:
  void clear() override { low_ = high_ = {0.0, start_id(0)}; }

  struct End {
    double position;
    Index id;
  };
  End low_{};
  End high_{};
};

}  // namespace

std::unique_ptr<ConvexHull> make_convex_hull(int dim) {
  switch (dim) {
    case 1:
      return std::make_unique<Interval>();
    case 3:
      return make_convex_hull_3();
    default:
      return make_convex_hull_d(dim);
  }
}

}  // namespace remanifold::detail
