// SPDX-License-Identifier: GPL-3.0-or-later
// The pool that FLANN takes the nodes of its trees from, in place of its own, which hands
// out null where memory has run out, and then writes there. Here is also where the building
// of a tree can be cancelled. To be included before FLANN.
#pragma once

#ifdef FLANN_ALLOCATOR_H_
#error "FLANN has been included already, with its own allocator"
#endif
#define FLANN_ALLOCATOR_H_  // NOLINT: that of FLANN's flann/util/allocator.h

#include "remanifold/execution.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace flann {

/// Memory that is given back all at once, for objects that need no destructor.
class PooledAllocator {
 public:
  /// What FLANN counts its memory by.
  std::size_t usedMemory = 0;
  std::size_t wastedMemory = 0;

  /// As long as it lives, allocations of this thread look for cancellation now and then.
  class Polled {
   public:
    explicit Polled(const remanifold::Execution& execution) { polled_ = &execution; }
    Polled(const Polled&) = delete;
    Polled& operator=(const Polled&) = delete;
    ~Polled() { polled_ = nullptr; }
  };

  static void poll() {
    if (polled_ != nullptr) {
      polled_->poll();
    }
  }

  /// \throws std::bad_alloc, remanifold::Cancelled
  void* allocateMemory(std::size_t size) {
    size = (size + kAlignment - 1) / kAlignment * kAlignment;
    if (size > remaining_) {
      poll();
      const std::size_t block_size = std::max(size, kBlock);
      blocks_.push_back(std::make_unique<std::byte[]>(block_size));
      wastedMemory += remaining_;
      next_ = blocks_.back().get();
      remaining_ = block_size;
    }
    void* const memory = next_;
    next_ += size;
    remaining_ -= size;
    usedMemory += size;
    return memory;
  }

  template <class T>
  T* allocate(std::size_t count = 1) {
    return static_cast<T*>(allocateMemory(sizeof(T) * count));
  }

  void free() { *this = PooledAllocator(); }

 private:
  static constexpr std::size_t kAlignment = alignof(std::max_align_t);
  static constexpr std::size_t kBlock = 8192;

  static inline thread_local const remanifold::Execution* polled_ = nullptr;

  std::vector<std::unique_ptr<std::byte[]>> blocks_;
  std::byte* next_ = nullptr;
  std::size_t remaining_ = 0;
};

}  // namespace flann

inline void* operator new(std::size_t size, flann::PooledAllocator& allocator) {
  return allocator.allocateMemory(size);
}
inline void operator delete(void* /*memory*/, flann::PooledAllocator& /*allocator*/) {}
