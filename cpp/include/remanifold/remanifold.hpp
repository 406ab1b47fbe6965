// SPDX-License-Identifier: GPL-3.0-or-later
// Turns unorganized samples of a K-manifold into a K-dimensional simplicial complex.
#pragma once

#include "remanifold/cavities.hpp"
#include "remanifold/clique_complex.hpp"
#include "remanifold/curve_repair.hpp"
#include "remanifold/execution.hpp"
#include "remanifold/facets.hpp"
#include "remanifold/input_numbering.hpp"
#include "remanifold/link_repair.hpp"
#include "remanifold/local_region.hpp"
#include "remanifold/manifold_complex.hpp"
#include "remanifold/minimum_chain.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/reconstruct.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/simplex_measures.hpp"
#include "remanifold/star_consensus.hpp"
#include "remanifold/tangent_space.hpp"
#include "remanifold/topology.hpp"
#include "remanifold/types.hpp"
#include "remanifold/vertex_insertion.hpp"
