// SPDX-License-Identifier: GPL-3.0-or-later
// Uninitialized memory on the boundary of a cache line.
#pragma once

#include "remanifold/types.hpp"

#include <memory>
#include <new>

namespace remanifold::detail {

template <class T>
class AlignedArray {
 public:
  AlignedArray() = default;
  explicit AlignedArray(Offset size)
      : data_(static_cast<T*>(
            ::operator new(static_cast<std::size_t>(size) * sizeof(T), kAlignment))) {}

  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }

 private:
  static constexpr std::align_val_t kAlignment{64};
  struct Free {
    void operator()(T* data) const { ::operator delete(data, kAlignment); }
  };
  std::unique_ptr<T, Free> data_;
};

}  // namespace remanifold::detail
