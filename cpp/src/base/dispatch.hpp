// SPDX-License-Identifier: GPL-3.0-or-later
// From K at run time to K as a template parameter, once a call. K from 1 to 4 have code of
// their own, with everything of size K on the stack; larger K share one.
#pragma once

#include <Eigen/Core>

#include <type_traits>
#include <utility>

namespace remanifold::detail {

template <class Function>
decltype(auto) dispatch_dim(int dim, Function&& function) {
  switch (dim) {
    case 1:
      return function(std::integral_constant<int, 1>());
    case 2:
      return function(std::integral_constant<int, 2>());
    case 3:
      return function(std::integral_constant<int, 3>());
    case 4:
      return function(std::integral_constant<int, 4>());
    default:
      return function(std::integral_constant<int, Eigen::Dynamic>());
  }
}

}  // namespace remanifold::detail
