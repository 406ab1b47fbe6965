// SPDX-License-Identifier: GPL-3.0-or-later
// SC(X): the graph of mutual edges (or of edges seen from either end) and its cliques of
// K + 1 samples (Freedman 2002, section 3.3).
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

namespace remanifold {

enum class EdgeRule {
  kMutual,  ///< x in ES(y) and y in ES(x)
  kEither   ///< x in ES(y) or y in ES(x)
};

/// Symmetric adjacency, rows ascending, without loops. Rows of the edge sets need not be
/// sorted.
/// \throws std::invalid_argument  offsets that do not ascend, indices out of range
Csr edge_graph(const Csr& edge_sets, EdgeRule rule, const Execution& execution = {});

/// Edges i < j, sorted.
SimplexArray graph_edges(const Csr& graph);

/// All cliques of dim + 1 vertices, columns ascending, rows sorted.
SimplexArray clique_complex(const Csr& graph, int dim, const Execution& execution = {});

}  // namespace remanifold
