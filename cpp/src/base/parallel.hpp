// SPDX-License-Identifier: GPL-3.0-or-later
// Parallel loops whose result does not depend on the number of threads: blocks of fixed
// size, each writing its own slots. Cancellation is looked at once a block.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <new>
#include <optional>
#include <vector>

namespace remanifold::detail {

inline int num_threads(const Execution& execution) {
  return execution.num_threads > 0
             ? execution.num_threads
             : tbb::task_arena(tbb::task_arena::automatic).max_concurrency();
}

/// Runs with as many threads as the execution allows.
template <class Function>
void with_threads(const Execution& execution, const Function& function) {
  constexpr int most_threads = 256;
  const int threads = std::min(execution.num_threads, most_threads);
  std::optional<tbb::global_control> more_than_cores;
  if (threads > tbb::info::default_concurrency()) {
    more_than_cores.emplace(tbb::global_control::max_allowed_parallelism, threads);
  }
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute(function);
}

/// The first exception of several threads. Without it TBB would hand exceptions on, which
/// takes memory, and ends the program where there is none left.
class FirstException {
 public:
  /// To be called where an exception is handled.
  void keep() noexcept {
    if (!kept_.exchange(true)) {
      exception_ = std::current_exception();
    }
  }
  /// When all threads have ended.
  void rethrow() const {
    if (exception_ != nullptr) {
      std::rethrow_exception(exception_);
    }
  }

 private:
  std::atomic<bool> kept_{false};
  std::exception_ptr exception_;
};

/// body(begin, end) on consecutive blocks that cover [0, count), beside the progress.
template <class Body>
void for_each_block_uncounted(Offset count, Offset block, const Execution& execution,
                              const Body& body) {
  const Offset num_blocks = (count + block - 1) / block;
  const auto run = [&](Offset b) {
    execution.poll();
    const Offset begin = b * block;
    body(begin, std::min(count, begin + block));
  };
  if (execution.num_threads == 1 || num_blocks <= 1) {
    for (Offset b = 0; b < num_blocks; ++b) {
      run(b);
    }
    return;
  }
  FirstException exception;
  std::atomic<Offset> num_done{0};
  with_threads(execution, [&] {
    tbb::task_group_context context;
    tbb::parallel_for(
        tbb::blocked_range<Offset>(0, num_blocks, 1),
        [&](const tbb::blocked_range<Offset>& range) {
          try {
            for (Offset b = range.begin(); b != range.end(); ++b) {
              run(b);
              num_done.fetch_add(1, std::memory_order_relaxed);
            }
          } catch (...) {
            exception.keep();
            context.cancel_group_execution();
          }
        },
        tbb::simple_partitioner(), context);
  });
  exception.rethrow();
  if (num_done != num_blocks) {
    throw std::bad_alloc();  // of a task
  }
}

/// The same, and counts towards the step that has begun.
template <class Body>
void for_each_block(Offset count, Offset block, const Execution& execution,
                    const Body& body) {
  for_each_block_uncounted(count, block, execution, [&](Offset begin, Offset end) {
    body(begin, end);
    if (execution.progress != nullptr) {
      execution.progress->done.fetch_add(end - begin, std::memory_order_relaxed);
    }
  });
}

/// Sorts by an order that leaves no two values equal.
template <class T, class Less>
void sort_all(std::vector<T>& values, const Execution& execution, const Less& less) {
  if (execution.num_threads == 1) {
    std::sort(values.begin(), values.end(), less);
  } else {
    with_threads(execution,
                 [&] { tbb::parallel_sort(values.begin(), values.end(), less); });
  }
}

inline void begin_step(const Execution& execution, Step step, Offset total) {
  if (execution.progress != nullptr) {
    execution.progress->step = step;
    execution.progress->done = 0;
    execution.progress->total = total;
  }
}

class Stopwatch {
 public:
  /// Seconds since construction or the last call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    start_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Adds the seconds of its life to a total.
class Timed {
 public:
  explicit Timed(double& total) : total_(total) {}
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;
  ~Timed() { total_ += watch_.lap(); }

 private:
  double& total_;
  Stopwatch watch_;
};

}  // namespace remanifold::detail
