// SPDX-License-Identifier: GPL-3.0-or-later
// A scratch object for each thread, made on first use. TBB's enumerable_thread_specific,
// which does the same, destroys what it has not made where making it fails.
//
// Scratch objects hold matrices of Eigen, which are resized again and again. A resize that
// finds no memory leaves the matrix with what it has freed, and its destructor would free
// that again. So where memory runs out in the middle of use the object is not destroyed.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <new>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace remanifold::detail {

template <class T>
class ThreadScratch {
 public:
  ThreadScratch() : make_([] { return std::make_unique<T>(); }) {}
  /// Copies of a value.
  explicit ThreadScratch(const T& value)
      : make_([value] { return std::make_unique<T>(value); }) {}
  /// \param make  called without arguments by several threads; returns a T
  template <class Make, class = std::enable_if_t<std::is_invocable_r_v<T, Make>>>
  explicit ThreadScratch(Make make)
      : make_([make = std::move(make)] { return std::unique_ptr<T>(new T(make())); }) {}

  /// Calls with that of the calling thread. Takes a lock: to be called once a block.
  template <class Use>
  void use(const Use& use) {
    T& value = local();
    try {
      use(value);
    } catch (const std::bad_alloc&) {
      give_up();
      throw;
    }
  }

  /// Calls with those of all threads, when these are done.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const Entry& entry : entries_) {
      visit(*entry.value);
    }
  }

 private:
  struct Entry {
    std::thread::id thread;
    std::unique_ptr<T> value;
  };

  T& local() {
    const std::thread::id self = std::this_thread::get_id();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      for (const Entry& entry : entries_) {
        if (entry.thread == self) {
          return *entry.value;
        }
      }
    }
    std::unique_ptr<T> made = make_();
    const std::lock_guard<std::mutex> lock(mutex_);
    entries_.push_back({self, std::move(made)});
    return *entries_.back().value;
  }

  /// What is left of that of the calling thread stays where it is.
  void give_up() noexcept {
    const std::thread::id self = std::this_thread::get_id();
    const std::lock_guard<std::mutex> lock(mutex_);
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
      if (entry->thread == self) {
        static_cast<void>(entry->value.release());
        entries_.erase(entry);
        return;
      }
    }
  }

  std::function<std::unique_ptr<T>()> make_;
  std::mutex mutex_;
  std::vector<Entry> entries_;
};

}  // namespace remanifold::detail
