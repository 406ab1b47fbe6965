// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/input_numbering.hpp"

#include <algorithm>

namespace remanifold {

TangentSpaces to_input(const Samples& samples, const TangentSpaces& tangents) {
  const std::vector<Index> canonical = samples.canonical_indices();
  const std::size_t n = canonical.size();
  const std::size_t arity = static_cast<std::size_t>(tangents.dim) + 1;
  const std::size_t size =
      static_cast<std::size_t>(tangents.dim) * samples.ambient_dim();
  TangentSpaces result;
  result.dim = tangents.dim;
  result.bases.resize(n * size);
  result.simplices.resize(n * arity);
  result.boundary.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto c = static_cast<std::size_t>(canonical[i]);
    std::copy_n(tangents.bases.data() + c * size, size, result.bases.data() + i * size);
    for (std::size_t k = 0; k < arity; ++k) {
      const Index vertex = tangents.simplices[c * arity + k];
      result.simplices[i * arity + k] = vertex < 0 ? -1 : samples.input_index(vertex);
    }
    result.boundary[i] = tangents.boundary[c];
  }
  return result;
}

Csr edge_sets_to_input(const Samples& samples, const LocalRegions& regions) {
  const Csr& csr = regions.edge_sets;
  const Index n = samples.input_size();
  Csr result;
  result.offsets.assign(static_cast<std::size_t>(n) + 1, 0);
  for (Index i = 0; i < samples.size(); ++i) {
    result.offsets[samples.input_index(i) + 1] = csr.size(i);
  }
  for (Index i = 0; i < n; ++i) {
    result.offsets[i + 1] += result.offsets[i];
  }
  result.indices.resize(csr.indices.size());
  for (Index i = 0; i < samples.size(); ++i) {
    Index* row = result.indices.data() + result.offsets[samples.input_index(i)];
    std::transform(csr.begin(i), csr.end(i), row,
                   [&](Index j) { return samples.input_index(j); });
    std::sort(row, row + csr.size(i));
  }
  return result;
}

Csr stars_to_input(const Samples& samples, const LocalRegions& regions) {
  const Index n = samples.input_size();
  const int dim = regions.dim;
  Csr result;
  result.offsets.assign(static_cast<std::size_t>(n) + 1, 0);
  for (Index i = 0; i < samples.size(); ++i) {
    result.offsets[samples.input_index(i) + 1] =
        regions.star_offsets[i + 1] - regions.star_offsets[i];
  }
  for (Index i = 0; i < n; ++i) {
    result.offsets[i + 1] += result.offsets[i];
  }
  result.indices.resize(result.offsets.back() * (dim + 1));
  std::vector<std::vector<Index>> star;
  for (Index i = 0; i < samples.size(); ++i) {
    star.clear();
    for (Offset s = regions.star_offsets[i]; s < regions.star_offsets[i + 1]; ++s) {
      std::vector<Index> simplex;
      for (int k = 0; k < dim; ++k) {
        simplex.push_back(samples.input_index(regions.stars[s * dim + k]));
      }
      std::sort(simplex.begin(), simplex.end());
      star.push_back(std::move(simplex));
    }
    std::sort(star.begin(), star.end());
    Index* out =
        result.indices.data() + result.offsets[samples.input_index(i)] * (dim + 1);
    for (const std::vector<Index>& simplex : star) {
      *out++ = samples.input_index(i);
      out = std::copy(simplex.begin(), simplex.end(), out);
    }
  }
  return result;
}

}  // namespace remanifold
