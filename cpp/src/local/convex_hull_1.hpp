// SPDX-License-Identifier: GPL-3.0-or-later
// The hull on a line is an interval.
#pragma once

#include "local/convex_hull.hpp"

namespace remanifold::detail {

class HullInterval {
 public:
  void restart(double size) {
    low_ = {size * start_coordinate(1, 1, 0), start_id(1)};
    high_ = {size * start_coordinate(1, 0, 0), start_id(0)};
  }

  /// \returns false where the point is inside
  bool insert(double position, Index id) {
    if (position < low_.position) {
      low_ = {position, id};
    } else if (position > high_.position) {
      high_ = {position, id};
    } else {
      return false;
    }
    return true;
  }

  struct End {
    double position;
    Index id;
  };
  const End& low() const { return low_; }
  const End& high() const { return high_; }

 private:
  End low_{};
  End high_{};
};

}  // namespace remanifold::detail
