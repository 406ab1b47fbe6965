// SPDX-License-Identifier: GPL-3.0-or-later
// Turns unorganized samples of a K-manifold into a K-dimensional simplicial complex.
#pragma once

#include "remanifold/clique_complex.hpp"
#include "remanifold/execution.hpp"
#include "remanifold/input_numbering.hpp"
#include "remanifold/local_region.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/reconstruct.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/tangent_space.hpp"
#include "remanifold/topology.hpp"
#include "remanifold/types.hpp"
