// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the core without the GIL, on a thread of its own, while the calling thread shows
// progress and listens for Ctrl-C.
#pragma once

#include "remanifold/execution.hpp"

#include <pybind11/pybind11.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <future>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

namespace remanifold::python {

namespace py = pybind11;

inline const char* step_name(Step step) {
  switch (step) {
    case Step::kPrepare:
      return "prepare";
    case Step::kNeighborhoods:
      return "neighborhoods";
    case Step::kOutliers:
      return "outliers";
    case Step::kSmoothing:
      return "smoothing";
    case Step::kTangentSpaces:
      return "tangent_spaces";
    case Step::kLocalRegions:
      return "local_regions";
    case Step::kComplex:
      return "complex";
    case Step::kTopology:
      return "topology";
    case Step::kProjection:
      return "projection";
    case Step::kSimplification:
      return "simplification";
  }
  return "";
}

/// What to say where the system starts no more threads, which it gives a short reason for.
inline std::runtime_error no_thread(const char* reason) {
  return std::runtime_error(
      std::string("a thread cannot be started (") + reason +
      "): the limit of processes or of memory is reached; num_threads=1 takes fewest");
}

/// \param on_progress  None, or called as on_progress(step, done, total)
/// \param work  called with the Execution; must not touch Python objects
template <class Work>
auto run(int num_threads, const py::object& on_progress, Work&& work) {
  constexpr auto interval = std::chrono::milliseconds(50);
  Progress progress;
  const Execution execution{num_threads, &progress};
  std::future<decltype(work(execution))> result;
  const auto wait = [&](auto duration) {
    const py::gil_scoped_release release;
    return result.wait_for(duration) == std::future_status::ready;
  };
  {
    const py::gil_scoped_release release;
    try {
      result = std::async(std::launch::async, [&] { return work(execution); });
    } catch (const std::system_error& error) {
      throw no_thread(error.what());
    }
  }
  try {
    while (!wait(interval)) {
      if (PyErr_CheckSignals() != 0) {
        throw py::error_already_set();
      }
      if (!on_progress.is_none()) {
        const std::int64_t total = progress.total;
        on_progress(step_name(progress.step), std::min(progress.done.load(), total),
                    total);
      }
    }
  } catch (...) {
    progress.cancel = true;
    const py::gil_scoped_release release;
    result.wait();
    throw;
  }
  try {
    return result.get();
  } catch (const std::runtime_error& error) {
    // TBB's only word for it.
    if (std::strncmp(error.what(), "pthread_create", 14) == 0) {
      throw no_thread(error.what());
    }
    throw;
  }
}

}  // namespace remanifold::python
