// SPDX-License-Identifier: GPL-3.0-or-later
// How a step runs: number of threads, progress, cancellation. The core never prints;
// a caller that wants to show progress reads the counters from another thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <stdexcept>

namespace remanifold {

enum class Step : int {
  kPrepare,
  kNeighborhoods,
  kOutliers,
  kSmoothing,
  kTangentSpaces,
  kLocalRegions,
  kComplex,
  kTopology,
  kProjection,
  kSimplification,
};

/// Shared between a running step and its observer.
struct Progress {
  std::atomic<Step> step{Step::kPrepare};
  std::atomic<std::int64_t> done{0};
  std::atomic<std::int64_t> total{0};
  std::atomic<bool> cancel{false};
};

/// Thrown out of a step after Progress::cancel was set.
struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("cancelled") {}
};

struct Execution {
  int num_threads = 0;           ///< 0: all cores
  Progress* progress = nullptr;  ///< not owned, may be null

  void poll() const {
    if (progress != nullptr && progress->cancel.load(std::memory_order_relaxed)) {
      throw Cancelled();
    }
  }
};

}  // namespace remanifold
