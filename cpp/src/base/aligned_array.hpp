// SPDX-License-Identifier: GPL-3.0-or-later
// Uninitialized memory on the boundary of a cache line; large arrays in large pages where
// the system has them, since most of the time of touching new memory goes into pages.
#pragma once

#include "remanifold/types.hpp"

#include <memory>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace remanifold::detail {

template <class T>
class AlignedArray {
 public:
  AlignedArray() = default;
  explicit AlignedArray(Offset size) {
    const std::size_t bytes = static_cast<std::size_t>(size) * sizeof(T);
    const std::align_val_t alignment{bytes < 2 * kPage ? kLine : kPage};
    data_ = {static_cast<T*>(::operator new(bytes, alignment)), Free{alignment}};
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    if (bytes >= 2 * kPage) {
      // A wish: where it is not granted, all works as before.
      static_cast<void>(madvise(data_.get(), bytes / kPage * kPage, MADV_HUGEPAGE));
    }
#endif
  }

  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }

 private:
  static constexpr std::size_t kLine = 64;
  static constexpr std::size_t kPage = std::size_t{1} << 21;
  struct Free {
    std::align_val_t alignment{kLine};
    void operator()(T* data) const { ::operator delete(data, alignment); }
  };
  std::unique_ptr<T, Free> data_;
};

}  // namespace remanifold::detail
