// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/cavity_part.hpp"

#include "base/sort_unique.hpp"

#include <algorithm>

namespace remanifold::detail {
namespace {

/// Of a full facet, which is no rim any more.
constexpr FacetNumber kFull = kBranching;

}  // namespace

Offset CavityPart::find_candidate(Index candidate) const {
  const auto at = std::lower_bound(candidates.begin(), candidates.end(), candidate);
  return at != candidates.end() && *at == candidate ? at - candidates.begin() : -1;
}

Offset CavityPart::facet_of(Offset c, int i) const {
  const Index facet = cavities->facets_without(candidates[c])[i];
  return std::lower_bound(facets.begin(), facets.end(), facet) - facets.begin();
}

CavityPart whole_cavity(const Cavities& cavities, Index cavity) {
  CavityPart part;
  part.cavities = &cavities;
  part.candidates.assign(cavities.candidates_in.begin(cavity),
                         cavities.candidates_in.end(cavity));
  part.facets.assign(cavities.facets_in.begin(cavity), cavities.facets_in.end(cavity));
  for (const Index f : part.facets) {
    part.rims.push_back(cavities.rims[f]);
    if (!cavities.rim_orientations.empty()) {
      part.rim_orientations.push_back(cavities.rim_orientations[f]);
    }
  }
  part.continued.assign(part.facets.size(), 0);
  part.core.assign(part.candidates.size(), 1);
  return part;
}

CavityWindows::CavityWindows(const Cavities& cavities, Offset num_fixed, Index size)
    : cavities_(cavities),
      arity_(cavities.candidates.arity),
      size_(size),
      num_fixed_(num_fixed),
      num_simplices_(num_fixed),
      rims_(cavities.rims),
      rim_orientations_(cavities.rim_orientations),
      decided_(cavities.energies.size(), 0),
      marked_(cavities.energies.size(), 0) {}

void CavityWindows::start(Index cavity) {
  front_ = {};
  num_simplices_ = num_fixed_;
  for (const Index* f = cavities_.facets_in.begin(cavity);
       f != cavities_.facets_in.end(cavity); ++f) {
    // Samples of a curve want edges whatever is there already.
    if (arity_ == 2 || rims_[*f] >= 0) {
      touch(*f);
    }
  }
}

void CavityWindows::touch(Index facet) {
  for (const Index* c = cavities_.candidates_on.begin(facet);
       c != cavities_.candidates_on.end(facet); ++c) {
    if (decided_[*c] == 0) {
      front_.push(*c);
    }
  }
}

CavityPart CavityWindows::next() {
  CavityPart part;
  part.cavities = &cavities_;
  while (!front_.empty() && decided_[front_.top()] != 0) {
    front_.pop();
  }
  if (front_.empty()) {
    return part;
  }
  std::vector<Index> grown{front_.top()};
  marked_[front_.top()] = 1;
  grow_through_facets(
      cavities_, size_, [&](Index c) { return decided_[c] == 0; }, marked_, grown);
  part.candidates = grown;
  std::sort(part.candidates.begin(), part.candidates.end());
  for (const Index c : part.candidates) {
    const Index* facets = cavities_.facets_without(c);
    part.facets.insert(part.facets.end(), facets, facets + arity_);
  }
  sort_unique(part.facets);
  for (const Index f : part.facets) {
    part.rims.push_back(rims_[f]);
    if (!rim_orientations_.empty()) {
      part.rim_orientations.push_back(rim_orientations_[f]);
    }
    part.continued.push_back(static_cast<std::uint8_t>(
        std::any_of(cavities_.candidates_on.begin(f), cavities_.candidates_on.end(f),
                    [&](Index c) { return decided_[c] == 0 && marked_[c] == 0; })));
  }
  for (const Index c : grown) {
    marked_[c] = 0;
  }
  // All of what is left, or the nearer half as far as all its neighbors are here.
  const bool all = static_cast<Index>(grown.size()) < size_;
  const std::size_t half = all ? grown.size() : (grown.size() + 1) / 2;
  part.core.assign(part.candidates.size(), 0);
  for (std::size_t i = 0; i < half; ++i) {
    const Offset own = part.find_candidate(grown[i]);
    bool inner = true;
    for (int j = 0; j < arity_; ++j) {
      inner = inner && part.continued[part.facet_of(own, j)] == 0;
    }
    part.core[own] = inner || i == 0 ? 1 : 0;
  }
  return part;
}

void CavityWindows::decide(const CavityPart& part, const std::vector<Index>& chosen,
                           RimOrientation* orientation) {
  for (Offset c = 0; c < part.num_candidates(); ++c) {
    if (part.core[c] != 0) {
      decided_[part.candidates[c]] = 1;
    }
  }
  std::vector<FacetNumber> neighbors(arity_);
  for (const Index c : chosen) {
    const Index* facets = cavities_.facets_without(c);
    for (int i = 0; i < arity_; ++i) {
      const Index f = facets[i];
      neighbors[i] = rims_[f];
      if (rims_[f] == kOpen) {
        rims_[f] = num_simplices_ * arity_ + i;
        if (!rim_orientations_.empty()) {
          rim_orientations_[f] = cavities_.orientations[c];
        }
        touch(f);
        continue;
      }
      rims_[f] = kFull;
      for (const Index* other = cavities_.candidates_on.begin(f);
           other != cavities_.candidates_on.end(f); ++other) {
        decided_[*other] = 1;
      }
    }
    if (orientation != nullptr) {
      orientation->append(neighbors.data());
    }
    ++num_simplices_;
  }
}

}  // namespace remanifold::detail
