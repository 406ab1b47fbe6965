// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/input_numbering.hpp"

#include "base/parallel.hpp"
#include "complex/simplex_rows.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>

namespace remanifold {
namespace {

constexpr Offset kBlock = 1024;

/// Offsets of rows that move to the input numbers of their samples.
std::vector<Offset> row_offsets(const Samples& samples,
                                const std::vector<Offset>& offsets) {
  std::vector<Offset> result(static_cast<std::size_t>(samples.input_size()) + 1, 0);
  for (Index i = 0; i < samples.size(); ++i) {
    result[samples.input_index(i) + 1] = offsets[i + 1] - offsets[i];
  }
  std::partial_sum(result.begin(), result.end(), result.begin());
  return result;
}

}  // namespace

TangentSpaces to_input(const Samples& samples, const TangentSpaces& tangents,
                       const Execution& execution) {
  const std::vector<Index> canonical = samples.canonical_indices();
  const std::size_t n = canonical.size();
  const std::size_t arity = static_cast<std::size_t>(tangents.dim) + 1;
  const std::size_t size =
      static_cast<std::size_t>(tangents.dim) * samples.ambient_dim();
  TangentSpaces result;
  result.dim = tangents.dim;
  result.bases.resize(tangents.bases.empty() ? 0 : n * size);
  const auto count = static_cast<std::size_t>(tangents.num_coefficients);
  const std::size_t num_values = tangents.dim * count;
  if (!tangents.neighbors.empty()) {
    result.num_coefficients = tangents.num_coefficients;
    result.coefficients.resize(n * num_values);
    result.neighbors.resize(n * count);
  }
  const bool enclosed = !tangents.simplices.empty();
  result.simplices.resize(enclosed ? n * arity : 0);
  result.boundary.resize(n);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto leave_out = [&](Offset i) {
    if (!tangents.bases.empty()) {
      std::fill_n(result.bases.data() + i * size, size, nan);
    }
    if (!tangents.neighbors.empty()) {
      std::fill_n(result.coefficients.data() + i * num_values, num_values, nan);
      std::fill_n(result.neighbors.data() + i * count, count, 0);
    }
    std::fill_n(result.simplices.data() + i * arity, enclosed ? arity : 0, -1);
    result.boundary[i] = 1;
  };
  detail::for_each_block_uncounted(
      static_cast<Offset>(n), kBlock, execution, [&](Offset begin, Offset end) {
        for (Offset i = begin; i < end; ++i) {
          if (canonical[i] < 0) {
            leave_out(i);
            continue;
          }
          const auto c = static_cast<std::size_t>(canonical[i]);
          if (!tangents.bases.empty()) {
            std::copy_n(tangents.bases.data() + c * size, size,
                        result.bases.data() + i * size);
          }
          if (!tangents.neighbors.empty()) {
            std::copy_n(tangents.coefficients.data() + c * num_values, num_values,
                        result.coefficients.data() + i * num_values);
            for (std::size_t k = 0; k < count; ++k) {
              result.neighbors[i * count + k] =
                  samples.input_index(tangents.neighbors[c * count + k]);
            }
          }
          for (std::size_t k = 0; enclosed && k < arity; ++k) {
            const Index vertex = tangents.simplices[c * arity + k];
            result.simplices[i * arity + k] =
                vertex < 0 ? -1 : samples.input_index(vertex);
          }
          result.boundary[i] = tangents.boundary[c];
        }
      });
  return result;
}

Csr edge_sets_to_input(const Samples& samples, const LocalRegions& regions,
                       const Execution& execution) {
  const Csr& csr = regions.edge_sets;
  Csr result;
  result.offsets = row_offsets(samples, csr.offsets);
  result.indices.resize(csr.indices.size());
  detail::for_each_block_uncounted(
      samples.size(), kBlock, execution, [&](Offset begin, Offset end) {
        for (Offset i = begin; i < end; ++i) {
          Index* row = result.indices.data() +
                       result.offsets[samples.input_index(static_cast<Index>(i))];
          std::transform(csr.begin(i), csr.end(i), row,
                         [&](Index j) { return samples.input_index(j); });
          std::sort(row, row + csr.size(i));
        }
      });
  return result;
}

Csr stars_to_input(const Samples& samples, const LocalRegions& regions,
                   const Execution& execution) {
  const int dim = regions.dim;
  Csr result;
  result.offsets = row_offsets(samples, regions.star_offsets);
  result.indices.resize(result.offsets.back() * (dim + 1));
  detail::for_each_block_uncounted(
      samples.size(), kBlock, execution, [&](Offset begin, Offset end) {
        std::vector<Index> rows;
        std::vector<const Index*> order;
        for (Offset i = begin; i < end; ++i) {
          const Index self = samples.input_index(static_cast<Index>(i));
          rows.clear();
          regions.star(i).append_to(rows);
          for (Index& j : rows) {
            j = samples.input_index(j);
          }
          detail::sort_rows(rows, dim, order);
          Index* out = result.indices.data() + result.offsets[self] * (dim + 1);
          for (const Index* row : order) {
            *out++ = self;
            out = std::copy(row, row + dim, out);
          }
        }
      });
  return result;
}

std::vector<Index> to_input(const Samples& samples, std::vector<Index> vertices) {
  for (Index& v : vertices) {
    v = samples.input_index(v);
  }
  std::sort(vertices.begin(), vertices.end());
  return vertices;
}

SimplexArray to_canonical(const Samples& samples, SimplexArray simplices,
                          const Execution& execution) {
  const std::vector<Index> canonical = samples.canonical_indices();
  detail::for_each_block_uncounted(
      simplices.size(), kBlock, execution, [&](Offset begin, Offset end) {
        for (Offset s = begin; s < end; ++s) {
          const auto row = simplices.vertices.begin() + s * simplices.arity;
          std::transform(row, row + simplices.arity, row,
                         [&](Index v) { return canonical[v]; });
          detail::sort_few(row, row + simplices.arity, std::less<>());
        }
      });
  return simplices;
}

std::vector<std::uint8_t> flags_to_canonical(const Samples& samples,
                                             const std::vector<std::uint8_t>& flags) {
  std::vector<std::uint8_t> result(samples.size(), 0);
  const std::vector<Index> canonical = samples.canonical_indices();
  for (std::size_t i = 0; i < canonical.size(); ++i) {
    if (canonical[i] >= 0) {
      result[canonical[i]] |= flags[i];
    }
  }
  return result;
}

SimplexArray to_input(const Samples& samples, SimplexArray mapped,
                      const std::vector<std::int8_t>& signs,
                      const Execution& execution) {
  const int arity = mapped.arity;
  std::vector<std::int8_t> parity(signs);
  detail::for_each_block_uncounted(
      mapped.size(), kBlock, execution, [&](Offset begin, Offset end) {
        for (Offset s = begin; s < end; ++s) {
          Index* row = mapped.vertices.data() + s * arity;
          for (int i = 0; i < arity; ++i) {
            row[i] = samples.input_index(row[i]);
            for (int j = i; j > 0 && row[j - 1] > row[j]; --j) {
              std::swap(row[j - 1], row[j]);
              if (!parity.empty()) {
                parity[s] = static_cast<std::int8_t>(-parity[s]);
              }
            }
          }
        }
      });
  const std::vector<Offset> order = detail::row_order(mapped, execution);
  SimplexArray result{arity, std::vector<Index>(mapped.vertices.size())};
  detail::for_each_block_uncounted(
      mapped.size(), kBlock, execution, [&](Offset begin, Offset end) {
        for (Offset s = begin; s < end; ++s) {
          Index* row = result.vertices.data() + s * arity;
          std::copy_n(mapped[order[s]], arity, row);
          if (arity > 1 && !parity.empty() && parity[order[s]] < 0) {
            std::swap(row[arity - 1], row[arity - 2]);
          }
        }
      });
  return result;
}

}  // namespace remanifold
