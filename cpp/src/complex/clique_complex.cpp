// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/clique_complex.hpp"

#include "base/csr.hpp"
#include "base/parallel.hpp"
#include "complex/clique_expansion.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <stdexcept>
#include <string>

namespace remanifold {
namespace {

constexpr Offset kBlock = 1024;

void validate(const Csr& csr) {
  const Offset rows = csr.rows();
  if (rows < 0 || csr.offsets.front() != 0 ||
      csr.offsets.back() != static_cast<Offset>(csr.indices.size())) {
    throw std::invalid_argument(
        "offsets must start at 0 and end at the number of indices");
  }
  for (Offset i = 0; i < rows; ++i) {
    if (csr.offsets[i] > csr.offsets[i + 1]) {
      throw std::invalid_argument("offsets descend at " + std::to_string(i));
    }
  }
  for (std::size_t i = 0; i < csr.indices.size(); ++i) {
    if (csr.indices[i] < 0 || csr.indices[i] >= rows) {
      throw std::invalid_argument("indices[" + std::to_string(i) + "] is " +
                                  std::to_string(csr.indices[i]) + ", expected 0 to " +
                                  std::to_string(rows - 1));
    }
  }
}

/// Row j of the result lists the rows of `csr` that contain j, ascending.
Csr transpose(const Csr& csr) {
  return detail::csr_of(csr.rows(), [&](const auto& add) {
    for (Offset i = 0; i < csr.rows(); ++i) {
      for (const Index* j = csr.begin(i); j != csr.end(i); ++j) {
        add(*j, static_cast<Index>(i));
      }
    }
  });
}

}  // namespace

Csr edge_graph(const Csr& edge_sets, EdgeRule rule, const Execution& execution) {
  validate(edge_sets);
  execution.poll();
  // Transposing twice sorts the rows.
  const Csr reversed = transpose(edge_sets);
  const Csr sorted = transpose(reversed);
  Csr graph;
  graph.offsets.reserve(edge_sets.rows() + 1);
  for (Offset i = 0; i < edge_sets.rows(); ++i) {
    const auto self = static_cast<Index>(i);
    const auto first = static_cast<Offset>(graph.indices.size());
    if (rule == EdgeRule::kMutual) {
      std::set_intersection(sorted.begin(i), sorted.end(i), reversed.begin(i),
                            reversed.end(i), std::back_inserter(graph.indices));
    } else {
      std::set_union(sorted.begin(i), sorted.end(i), reversed.begin(i), reversed.end(i),
                     std::back_inserter(graph.indices));
    }
    const auto row = graph.indices.begin() + first;
    graph.indices.erase(std::unique(row, graph.indices.end()), graph.indices.end());
    graph.indices.erase(
        std::remove(graph.indices.begin() + first, graph.indices.end(), self),
        graph.indices.end());
    graph.offsets.push_back(static_cast<Offset>(graph.indices.size()));
  }
  return graph;
}

SimplexArray graph_edges(const Csr& graph) {
  SimplexArray edges{2, {}};
  edges.vertices.reserve(graph.indices.size());
  for (Offset i = 0; i < graph.rows(); ++i) {
    for (const Index* j = graph.begin(i); j != graph.end(i); ++j) {
      if (*j > i) {
        edges.vertices.push_back(static_cast<Index>(i));
        edges.vertices.push_back(*j);
      }
    }
  }
  return edges;
}

SimplexArray clique_complex(const Csr& graph, int dim, const Execution& execution) {
  if (dim < 1) {
    throw std::invalid_argument("dim is " + std::to_string(dim) +
                                ", expected at least 1");
  }
  const Offset n = graph.rows();
  if (dim >= n) {
    return {dim + 1, {}};
  }
  detail::begin_step(execution, Step::kComplex, n);
  std::vector<std::vector<Index>> blocks((n + kBlock - 1) / kBlock);
  detail::for_each_block(n, kBlock, execution, [&](Offset begin, Offset end) {
    detail::CliqueExpansion expansion(graph, dim + 1, execution);
    for (Offset i = begin; i < end; ++i) {
      expansion.expand_from(static_cast<Index>(i), blocks[begin / kBlock]);
    }
  });
  SimplexArray simplices{dim + 1, {}};
  std::size_t total = 0;
  for (const std::vector<Index>& block : blocks) {
    total += block.size();
  }
  simplices.vertices.reserve(total);
  for (std::vector<Index>& block : blocks) {
    simplices.vertices.insert(simplices.vertices.end(), block.begin(), block.end());
    block = {};
  }
  return simplices;
}

}  // namespace remanifold
