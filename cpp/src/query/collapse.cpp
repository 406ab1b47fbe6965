// SPDX-License-Identifier: GPL-3.0-or-later
#include "query/collapse.hpp"

#include "base/csr.hpp"
#include "base/mix_bits.hpp"
#include "base/sort_unique.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <unordered_map>
#include <vector>

namespace remanifold::detail {
namespace {

constexpr std::size_t kMaxVertices = 128;
/// Orders tried. What collapses at all mostly does so in the first.
constexpr int kOrders = 4;

/// A set of vertices.
struct Face {
  std::uint64_t low = 0;
  std::uint64_t high = 0;

  Face with(int v) const {
    Face face = *this;
    (v < 64 ? face.low : face.high) |= std::uint64_t{1} << (v % 64);
    return face;
  }
  Face without(int v) const {
    Face face = *this;
    (v < 64 ? face.low : face.high) &= ~(std::uint64_t{1} << (v % 64));
    return face;
  }
  bool operator==(const Face& other) const {
    return low == other.low && high == other.high;
  }
};

struct HashOfFace {
  std::size_t operator()(const Face& face) const {
    return static_cast<std::size_t>(mix_bits(face.low ^ mix_bits(face.high)));
  }
};

/// All faces, each with its facets one after the other.
class FacePoset {
 public:
  FacePoset(const SimplexArray& simplices, const std::vector<Index>& vertices) {
    std::vector<int> numbers(simplices.arity);
    for (Offset s = 0; s < simplices.size(); ++s) {
      Face top;
      for (int i = 0; i < simplices.arity; ++i) {
        numbers[i] = static_cast<int>(
            std::lower_bound(vertices.begin(), vertices.end(), simplices[s][i]) -
            vertices.begin());
        top = top.with(numbers[i]);
      }
      tops_.push_back(add(top, numbers));
    }
  }

  std::size_t size() const { return static_cast<std::size_t>(facets_.rows()); }
  std::size_t top(std::size_t simplex) const { return tops_[simplex]; }

  template <class Visit>
  void for_each_facet(std::size_t face, const Visit& visit) const {
    const auto row = static_cast<Offset>(face);
    std::for_each(facets_.begin(row), facets_.end(row), visit);
  }

 private:
  std::size_t add(const Face& face, const std::vector<int>& vertices) {
    const auto known = numbers_.find(face);
    if (known != numbers_.end()) {
      return known->second;
    }
    std::vector<std::size_t> facets;
    if (vertices.size() > 1) {
      std::vector<int> others(vertices.begin() + 1, vertices.end());
      for (std::size_t out = 0; out < vertices.size(); ++out) {
        facets.push_back(add(face.without(vertices[out]), others));
        if (out < others.size()) {
          others[out] = vertices[out];
        }
      }
    }
    const std::size_t number = size();
    numbers_.emplace(face, number);
    facets_.values.insert(facets_.values.end(), facets.begin(), facets.end());
    facets_.offsets.push_back(static_cast<Offset>(facets_.values.size()));
    return number;
  }

  std::unordered_map<Face, std::size_t, HashOfFace> numbers_;
  Ragged<std::size_t> facets_;
  std::vector<std::size_t> tops_;
};

/// \param random  of the order in which free faces are taken; null for as they come
bool collapses(const FacePoset& faces, bool closed, std::mt19937* random) {
  std::vector<std::uint32_t> cofaces(faces.size(), 0);
  std::vector<std::size_t> only(faces.size(), 0);  // exclusive or of the cofaces left
  std::vector<char> there(faces.size(), 1);
  for (std::size_t g = 0; g < faces.size(); ++g) {
    faces.for_each_facet(g, [&](std::size_t f) {
      ++cofaces[f];
      only[f] ^= g;
    });
  }
  std::vector<std::size_t> free;
  std::size_t left = faces.size();
  const auto take = [&](std::size_t g) {
    there[g] = 0;
    --left;
    faces.for_each_facet(g, [&](std::size_t f) {
      only[f] ^= g;
      if (--cofaces[f] == 1) {
        free.push_back(f);
      }
    });
  };
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (cofaces[f] == 1) {
      free.push_back(f);
    }
  }
  if (closed) {
    take(faces.top(0));
  }
  while (!free.empty()) {
    if (random != nullptr) {
      std::swap(free[(*random)() % free.size()], free.back());
    }
    const std::size_t f = free.back();
    free.pop_back();
    if (there[f] == 0 || cofaces[f] != 1) {
      continue;
    }
    const std::size_t g = only[f];
    take(g);
    take(f);
  }
  return left == 1;
}

}  // namespace

bool collapses_to_point(const SimplexArray& simplices, bool closed) {
  std::vector<Index> vertices = simplices.vertices;
  sort_unique(vertices);
  if (vertices.empty() || vertices.size() > kMaxVertices) {
    return false;
  }
  const FacePoset faces(simplices, vertices);
  std::mt19937 random(1);
  for (int order = 0; order < kOrders; ++order) {
    if (collapses(faces, closed, order == 0 ? nullptr : &random)) {
      return true;
    }
  }
  return false;
}

}  // namespace remanifold::detail
