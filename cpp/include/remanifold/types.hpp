// SPDX-License-Identifier: GPL-3.0-or-later
// Plain data exchanged by the steps: indices, ragged arrays, simplices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace remanifold {

using Index = std::int32_t;   ///< number of a sample
using Offset = std::int64_t;  ///< position in a ragged array

/// Read-only view of a dense row-major array.
struct MatrixView {
  const double* data = nullptr;
  Offset rows = 0;
  Offset cols = 0;

  const double* row(Offset i) const { return data + i * cols; }
};

/// Ragged array: row i is indices[offsets[i] .. offsets[i + 1]).
struct Csr {
  std::vector<Offset> offsets{0};
  std::vector<Index> indices;

  Offset rows() const { return static_cast<Offset>(offsets.size()) - 1; }
  const Index* begin(Offset i) const { return indices.data() + offsets[i]; }
  const Index* end(Offset i) const { return indices.data() + offsets[i + 1]; }
  Offset size(Offset i) const { return offsets[i + 1] - offsets[i]; }
};

/// Simplices of one dimension, `arity` vertices each, stored one after the other.
struct SimplexArray {
  int arity = 0;
  std::vector<Index> vertices;

  Offset size() const {
    return arity == 0 ? 0 : static_cast<Offset>(vertices.size()) / arity;
  }
  const Index* operator[](Offset i) const { return vertices.data() + i * arity; }
};

}  // namespace remanifold
