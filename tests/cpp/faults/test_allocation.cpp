// SPDX-License-Identifier: GPL-3.0-or-later
// Every allocation of small runs fails in turn: alone, and with all that follow, as where
// memory has run out. What comes is std::bad_alloc or, where the allocation could be done
// without, the result that comes without faults; the input is as it was, little is kept, and
// the next call is right.
//
// Here malloc itself fails, which operator new, Eigen, FLANN and GMP all call. So this is a
// program of its own, and not for the sanitizers, which have a malloc of theirs.
//
// The tests take some allocations of each run; with REMANIFOLD_ALL_FAULTS=1 all.
#include "remanifold/remanifold.hpp"
#include "support.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <limits>
#include <new>
#include <string>
#include <vector>

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
}

namespace {

/// Allocations that the scratch objects of a thread live on, at most.
constexpr std::int64_t kScratch = 150;
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

std::atomic<bool> armed{false};
std::atomic<bool> all_that_follow{false};
std::atomic<std::int64_t> failing{kNever};
std::atomic<std::int64_t> made{0};
std::atomic<std::int64_t> living{0};

bool fails() {
  if (!armed.load(std::memory_order_relaxed)) {
    return false;
  }
  const std::int64_t number = made.fetch_add(1, std::memory_order_relaxed);
  const std::int64_t at = failing.load(std::memory_order_relaxed);
  return number == at || (number > at && all_that_follow);
}

template <class Allocate>
void* counted(const Allocate& allocate) {
  void* const memory = fails() ? nullptr : allocate();
  if (memory == nullptr) {
    errno = ENOMEM;
  } else {
    living.fetch_add(1, std::memory_order_relaxed);
  }
  return memory;
}

}  // namespace

extern "C" {
void* malloc(std::size_t size) {
  return counted([=] { return __libc_malloc(size); });
}
void* calloc(std::size_t count, std::size_t size) {
  return counted([=] { return __libc_calloc(count, size); });
}
void* realloc(void* old, std::size_t size) {
  if (old == nullptr) {
    return malloc(size);
  }
  if (size != 0 && fails()) {
    errno = ENOMEM;
    return nullptr;
  }
  living.fetch_sub(size == 0 ? 1 : 0, std::memory_order_relaxed);
  return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  return counted([=] { return __libc_memalign(alignment, size); });
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  void* const memory = memalign(alignment, size);
  if (memory == nullptr) {
    return ENOMEM;
  }
  *out = memory;
  return 0;
}
void free(void* memory) {
  if (memory != nullptr) {
    living.fetch_sub(1, std::memory_order_relaxed);
    __libc_free(memory);
  }
}
}

namespace remanifold {
namespace {

using testing::Cloud;

/// What a run found, as numbers; compared without allocating.
using Found = std::vector<std::int64_t>;

/// A call, and what it is given.
struct Case {
  std::string name;
  std::vector<double> given;
  std::function<Found(const std::vector<double>&)> call;
  int num_threads = 1;
};

void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

Found numbers(const std::vector<Index>& values) {
  return {values.begin(), values.end()};
}

Found found(const Reconstruction& rec) {
  Found all = numbers(rec.simplices.vertices);
  all.insert(all.end(), rec.boundary.begin(), rec.boundary.end());
  all.insert(all.end(), rec.cleaning.outliers.begin(), rec.cleaning.outliers.end());
  all.push_back(static_cast<std::int64_t>(rec.report.openings.size()));
  for (const double x : rec.cleaning.displacements) {
    all.push_back(static_cast<std::int64_t>(x * 1e12));
  }
  return all;
}

enum class Kind { kPoints, kGram, kDistances };

Samples samples_of(const std::vector<double>& given, Kind kind, int columns) {
  const auto rows = static_cast<Offset>(given.size()) / columns;
  const MatrixView view{given.data(), rows, columns};
  return kind == Kind::kPoints ? Samples::from_points(view)
         : kind == Kind::kGram ? Samples::from_gram(view)
                               : Samples::from_distances(view);
}

Case reconstruction(const std::string& name, const Cloud& cloud, int dim,
                    Kind kind = Kind::kPoints, ReconstructOptions options = {},
                    int num_threads = 1) {
  options.dim = dim;
  const int columns =
      kind == Kind::kPoints ? cloud.dim : static_cast<int>(cloud.size());
  return {name,
          kind == Kind::kPoints ? cloud.points
          : kind == Kind::kGram ? testing::gram_of(cloud)
                                : testing::distances_of(cloud),
          [=](const std::vector<double>& given) {
            const Execution execution{num_threads, nullptr};
            return found(
                reconstruct(samples_of(given, kind, columns), options, {}, execution));
          },
          num_threads};
}

Cloud lower_half(Cloud cloud) {
  Cloud half{{}, cloud.dim};
  for (Offset i = 0; i < cloud.size(); ++i) {
    if (cloud[i][cloud.dim - 1] < 0.2) {
      half.points.insert(half.points.end(), cloud[i], cloud[i] + cloud.dim);
    }
  }
  return half;
}

ReconstructOptions cleaning() {
  ReconstructOptions options;
  options.outlier_distance = 3;
  options.smooth = true;
  return options;
}

ReconstructOptions searching(SearchMethod method) {
  ReconstructOptions options;
  options.search.method = method;
  return options;
}

Case paper_of(const Cloud& cloud, int dim) {
  return {"paper", cloud.points, [=](const std::vector<double>& given) {
            ReconstructOptions options;
            options.dim = dim;
            const PaperReconstruction rec = reconstruct_paper(
                samples_of(given, Kind::kPoints, cloud.dim), options, {1, nullptr});
            return numbers(rec.simplices.vertices);
          }};
}

/// What is asked of a result: topology, nearest points, quality, fewer vertices, paths.
Case queries_of(const Cloud& cloud) {
  ReconstructOptions options;
  options.dim = 2;
  const SimplexArray simplices =
      reconstruct(Samples::from_points(cloud.view()), options).simplices;
  SimplexArray sorted = simplices;
  for (Offset s = 0; s < sorted.size(); ++s) {
    std::sort(sorted.vertices.begin() + 3 * s, sorted.vertices.begin() + 3 * s + 3);
  }
  return {"queries", cloud.points, [=](const std::vector<double>& given) {
            const Execution alone{1, nullptr};
            const auto rows = static_cast<Index>(cloud.size());
            const MatrixView view{given.data(), rows, cloud.dim};
            const Topology topology = compute_topology(sorted, rows, alone);
            Found all{topology.components, topology.euler_characteristic};
            const SimplexSearch search(view, simplices, alone);
            for (const Offset s : search.nearest(view, alone).simplices) {
              all.push_back(s);
            }
            const Samples samples = Samples::from_points(view, alone);
            QualityOptions quality;
            quality.dim = 2;
            const NeighborSearch neighbors(samples, {}, alone);
            for (const double fold :
                 measure_quality(samples, neighbors, simplices, quality, alone).fold) {
              all.push_back(static_cast<std::int64_t>(fold * 1e6));
            }
            SimplificationOptions fewer;
            fewer.num_vertices = rows / 2;
            const Simplification simple =
                simplify(view, simplices, std::vector<std::uint8_t>(rows, kMovable),
                         fewer, alone);
            all.insert(all.end(), simple.simplices.vertices.begin(),
                       simple.simplices.vertices.end());
            const std::vector<double> lengths(simplices.vertices.size(), 1.0);
            for (const double way :
                 surface_distances(simplices, lengths, rows, {0, 1}, alone)) {
              all.push_back(static_cast<std::int64_t>(way * 1e6));
            }
            return all;
          }};
}

std::vector<Case> cases() {
  const Cloud circle = testing::sphere(40, 1, 1);
  const Cloud sphere = testing::sphere(60, 2, 2);
  const Cloud solid = testing::gaussian(30, 3, 3);
  const Cloud sphere_3 = testing::sphere(40, 3, 4);
  return {
      reconstruction("curve", circle, 1),
      reconstruction("curve of products", circle, 1, Kind::kGram),
      reconstruction("arc", lower_half(circle), 1),
      reconstruction("surface", sphere, 2),
      reconstruction("surface of products", sphere, 2, Kind::kGram),
      reconstruction("surface of distances", sphere, 2, Kind::kDistances),
      reconstruction("cap", lower_half(testing::sphere(150, 2, 5)), 2),
      reconstruction("brute force", sphere, 2, Kind::kPoints,
                     searching(SearchMethod::kBruteForce)),
      reconstruction("approximate", testing::sphere(100, 2, 2), 2, Kind::kPoints,
                     searching(SearchMethod::kApproximate)),
      reconstruction("clutter and noise", testing::noisy_sphere(250, 0.05, 10), 2,
                     Kind::kPoints, cleaning()),
      reconstruction("lattice", testing::grid(7, 2), 2),
      reconstruction("solid", solid, 3),
      reconstruction("three-sphere", sphere_3, 3),
      reconstruction("three-sphere of products", sphere_3, 3, Kind::kGram),
      reconstruction("four-sphere", testing::sphere(30, 4, 6), 4),
      reconstruction("in many coordinates", testing::sphere(40, 2, 7), 2,
                     Kind::kDistances),
      paper_of(sphere, 2),
      queries_of(testing::sphere(40, 2, 2)),
      reconstruction("by threads", testing::sphere(400, 2, 8), 2, Kind::kPoints,
                     cleaning(), 4),
  };
}

class Allocation : public ::testing::TestWithParam<Case> {};

enum class End { kFound, kOther, kBadAlloc, kAnotherError };

/// The call with the allocation of this number failing.
End with_fault(const Case& one, const std::vector<double>& given, const Found& expected,
               std::int64_t number, bool and_all_that_follow) {
  End end = End::kAnotherError;
  made = 0;
  failing = number;
  all_that_follow = and_all_that_follow;
  armed = true;
  try {
    const Found all = one.call(given);
    armed = false;
    end = all == expected ? End::kFound : End::kOther;
  } catch (const std::bad_alloc&) {
    end = End::kBadAlloc;
  } catch (...) {
  }
  armed = false;
  return end;
}

TEST_P(Allocation, FailuresAreAnException) {
  const Case& one = GetParam();
  const std::vector<double> given = one.given;
  const Found expected = one.call(given);
  ASSERT_FALSE(expected.empty());
  ASSERT_EQ(with_fault(one, given, expected, kNever, false), End::kFound);
  const std::int64_t total = made;
  ASSERT_GT(total, 100);

  const bool all = std::getenv("REMANIFOLD_ALL_FAULTS") != nullptr;
  const std::int64_t step = all ? 1 : total / 97 + 1;
  std::int64_t thrown = 0;
  std::int64_t done_without = 0;
  const std::int64_t living_before = living;
  for (std::int64_t number = 0; number < total; number += step) {
    for (const bool and_all_that_follow : {false, true}) {
      const End end = with_fault(one, given, expected, number, and_all_that_follow);
      ASSERT_TRUE(end == End::kFound || end == End::kBadAlloc)
          << "allocation " << number << " of " << total << ": "
          << (end == End::kOther ? "another result" : "another error");
      thrown += end == End::kBadAlloc ? 1 : 0;
      done_without += end == End::kFound ? 1 : 0;
      ASSERT_EQ(given, one.given) << number;
    }
    if (number % 16 == 0 || !all) {
      ASSERT_EQ(one.call(given), expected) << "after " << number;
    }
  }
  // What threads and libraries keep for next time, and the scratch object in whose use memory
  // ran out, which is not destroyed (per_thread.hpp).
  EXPECT_LT(living - living_before, 100 + kScratch * thrown);
  EXPECT_GT(thrown, 9 * done_without);
  RecordProperty("allocations", std::to_string(total));
  RecordProperty("thrown", std::to_string(thrown));
  RecordProperty("done_without", std::to_string(done_without));
  RecordProperty("kept", std::to_string(living - living_before));
}

std::string name_of(const ::testing::TestParamInfo<Case>& info) {
  std::string name = info.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Faults, Allocation, ::testing::ValuesIn(cases()), name_of);

}  // namespace
}  // namespace remanifold
