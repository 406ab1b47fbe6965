// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/stretched_scales.hpp"

#include "base/csr.hpp"
#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"
#include "base/sort_unique.hpp"
#include "remanifold/constants.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace remanifold::detail {
namespace {

constexpr Offset kBlock = 256;
/// Times the local scale: nearly no simplex of independent samples has a larger radius.
constexpr float kLargeRadius = 1.2F;
/// A sample at whose simplices this share and more is large has no other spacing. At the rim
/// of an opening it is one or two of six.
constexpr double kMostlyLarge = 0.75;
/// So many such samples next to each other, and more of them than of others at the same
/// simplices, are no rim, nor a row of samples between two openings.
constexpr Index kLeastPatch = 60;
/// Simplices around a sample whose median radius is taken, at least.
constexpr std::size_t kLeastAround = 60;

/// Median circumradius of independent samples over the local scale: empty balls hold
/// Gamma(K) samples (Miles, 1974), whose median is K - 1/3 + 0.02 / K within 1 %.
double usual_radius(int dim) {
  const double held = dim - 1.0 / 3 + 0.02 / dim;
  return std::pow(held / scale_neighbors(dim), 1.0 / dim);
}

class Stretch {
 public:
  Stretch(const StarSimplices& stars, const std::vector<float>& radii,
          Index num_samples)
      : stars_(stars),
        simplices_(stars.simplices),
        radii_(radii),
        arity_(stars.simplices.arity),
        num_samples_(num_samples) {}

  /// Samples whose simplices are large, and those next to them, in patches that are large
  /// enough.
  bool find_samples() {
    std::vector<Index> all(num_samples_, 0);
    std::vector<Index> large(num_samples_, 0);
    for (Offset s = 0; s < simplices_.size(); ++s) {
      for (int i = 0; i < arity_ && stars_.agreed(s); ++i) {
        ++all[simplices_[s][i]];
        large[simplices_[s][i]] += radii_[s] > kLargeRadius ? 1 : 0;
      }
    }
    std::vector<std::uint8_t> members(num_samples_, 0);
    for (Index v = 0; v < num_samples_; ++v) {
      members[v] = all[v] >= arity_ && large[v] >= kMostlyLarge * all[v] ? 1 : 0;
    }
    if (std::count(members.begin(), members.end(), 1) < kLeastPatch) {
      return false;
    }
    DisjointSets patches(num_samples_);
    for (Offset s = 0; s < simplices_.size(); ++s) {
      const Index* simplex = simplices_[s];
      if (stars_.agreed(s) && radii_[s] > kLargeRadius &&
          std::any_of(simplex, simplex + arity_,
                      [&](Index v) { return members[v] != 0; })) {
        for (int i = 1; i < arity_; ++i) {
          patches.join(simplex[0], simplex[i]);
        }
      }
    }
    std::vector<Index> inside(num_samples_, 0);
    std::vector<Index> beside(num_samples_, 0);
    for (Index v = 0; v < num_samples_; ++v) {
      ++(members[v] != 0 ? inside : beside)[patches.find(v)];
    }
    samples_.assign(num_samples_, 0);
    bool any = false;
    for (Index v = 0; v < num_samples_; ++v) {
      const Offset patch = patches.find(v);
      samples_[v] =
          inside[patch] >= kLeastPatch && inside[patch] > beside[patch] ? 1 : 0;
      any = any || samples_[v] != 0;
    }
    return any;
  }

  std::vector<double> run(const Execution& execution) {
    if (!find_samples()) {
      return {};
    }
    const Csr stars = csr_of(num_samples_, [&](const auto& add) {
      for (Offset s = 0; s < simplices_.size(); ++s) {
        for (int i = 0; i < arity_ && stars_.agreed(s); ++i) {
          add(simplices_[s][i], static_cast<Index>(s));
        }
      }
    });
    const double usual = usual_radius(arity_ - 1);
    std::vector<double> stretch(num_samples_, 1.0);
    for_each_block_uncounted(
        num_samples_, kBlock, execution, [&](Offset begin, Offset end) {
          std::vector<float> near;
          for (Offset v = begin; v < end; ++v) {
            if (samples_[v] != 0) {
              radii_around(stars, static_cast<Index>(v), near);
              const auto middle = near.begin() + static_cast<Offset>(near.size() / 2);
              std::nth_element(near.begin(), middle, near.end());
              stretch[v] = std::max(1.0, *middle / usual);
            }
          }
        });
    return stretch;
  }

 private:
  /// Of whole layers of stars.
  void radii_around(const Csr& stars, Index v, std::vector<float>& near) const {
    std::vector<Index> reached{v};
    std::vector<Index> around;
    for (std::size_t next = 0; around.size() < kLeastAround && next < reached.size();) {
      for (const std::size_t layer = reached.size(); next < layer; ++next) {
        around.insert(around.end(), stars.begin(reached[next]),
                      stars.end(reached[next]));
      }
      sort_unique(around);
      for (const Index s : around) {
        for (int i = 0; i < arity_; ++i) {
          const Index other = simplices_[s][i];
          if (std::find(reached.begin(), reached.end(), other) == reached.end()) {
            reached.push_back(other);
          }
        }
      }
    }
    near.clear();
    for (const Index s : around) {
      near.push_back(radii_[s]);
    }
  }

  const StarSimplices& stars_;
  const SimplexArray& simplices_;
  const std::vector<float>& radii_;
  int arity_;
  Index num_samples_;
  std::vector<std::uint8_t> samples_;  // 1: in a patch
};

}  // namespace

std::vector<double> stretch_of_scales(const StarSimplices& stars,
                                      const std::vector<float>& radii,
                                      Index num_samples, const Execution& execution) {
  return Stretch(stars, radii, num_samples).run(execution);
}

}  // namespace remanifold::detail
