// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's 3D triangulation, into which only points outside the hull so far are inserted.
#include "local/convex_hull.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_3.h>
#include <CGAL/Triangulation_data_structure_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

namespace remanifold::detail {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<Index, Kernel>;
using Triangulation =
    CGAL::Triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<VertexBase>>;

class Polyhedron final : public ConvexHull {
 public:
  void insert(const double* point, Index id) override {
    const Kernel::Point_3 p(point[0], point[1], point[2]);
    Triangulation::Locate_type type{};
    int i = 0;
    int j = 0;
    const auto cell = triangulation_.locate(p, type, i, j, hint_);
    hint_ = cell;
    if (type == Triangulation::OUTSIDE_CONVEX_HULL ||
        type == Triangulation::OUTSIDE_AFFINE_HULL) {
      const auto vertex = triangulation_.insert(p, type, cell, i, j);
      vertex->info() = id;
      hint_ = vertex->cell();
    }
  }

  void update() override {
    facets_.clear();
    vertices_.clear();
    const auto infinite = triangulation_.infinite_vertex();
    cells_.clear();
    triangulation_.incident_cells(infinite, std::back_inserter(cells_));
    for (const auto& cell : cells_) {
      for (int i = 0; i < 4; ++i) {
        if (cell->vertex(i) != infinite) {
          facets_.push_back(cell->vertex(i)->info());
        }
      }
    }
    neighbors_.clear();
    triangulation_.finite_adjacent_vertices(infinite, std::back_inserter(neighbors_));
    for (const auto& vertex : neighbors_) {
      if (!is_start(vertex->info())) {
        vertices_.push_back(vertex->info());
      }
    }
  }

 private:
  void clear() override {
    triangulation_.clear();
    hint_ = Triangulation::Cell_handle();
  }

  Triangulation triangulation_;
  Triangulation::Cell_handle hint_;
  std::vector<Triangulation::Cell_handle> cells_;
  std::vector<Triangulation::Vertex_handle> neighbors_;
};

}  // namespace

std::unique_ptr<ConvexHull> make_convex_hull_3() {
  return std::make_unique<Polyhedron>();
}

}  // namespace remanifold::detail
