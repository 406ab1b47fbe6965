// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's dD triangulation, into which only points outside the hull so far are inserted.
// K = 4 has a kernel of its own, larger K share the one of run-time dimension.
#include "base/sort_unique.hpp"
#include "local/convex_hull.hpp"

#include <CGAL/Epick_d.h>
#include <CGAL/Triangulation.h>

#include <algorithm>
#include <iterator>

namespace remanifold::detail {
namespace {

template <class Dimension>
class Polytope final : public ConvexHull {
  using Kernel = CGAL::Epick_d<Dimension>;
  using Vertex = CGAL::Triangulation_vertex<Kernel, Index>;
  using Cell = CGAL::Triangulation_full_cell<Kernel>;
  using Structure = CGAL::Triangulation_data_structure<Dimension, Vertex, Cell>;
  using Triangulation = CGAL::Triangulation<Kernel, Structure>;
  using Point = typename Kernel::Point_d;

 public:
  explicit Polytope(int dim) : dim_(dim), triangulation_(dim) {}

  void insert(const double* point, Index id) override {
    const Point p(dim_, point, point + dim_);
    typename Triangulation::Locate_type type{};
    typename Triangulation::Face face(triangulation_.maximal_dimension());
    typename Triangulation::Facet facet;
    const auto cell = triangulation_.locate(p, type, face, facet, hint_);
    if (type == Triangulation::OUTSIDE_CONVEX_HULL ||
        type == Triangulation::OUTSIDE_AFFINE_HULL) {
      const auto vertex = triangulation_.insert(p, type, face, facet, cell);
      vertex->data() = id;
      hint_ = vertex->full_cell();
    } else {
      hint_ = cell;
    }
  }

  void update() override {
    facets_.clear();
    vertices_.clear();
    cells_.clear();
    triangulation_.incident_full_cells(triangulation_.infinite_vertex(),
                                       std::back_inserter(cells_));
    for (const auto& cell : cells_) {
      for (int i = 0; i <= dim_; ++i) {
        const auto vertex = cell->vertex(i);
        if (triangulation_.is_infinite(vertex)) {
          continue;
        }
        facets_.push_back(vertex->data());
        if (!is_start(vertex->data())) {
          vertices_.push_back(vertex->data());
        }
      }
    }
    sort_unique(vertices_);
  }

 private:
  void clear() override {
    triangulation_.clear();
    hint_ = triangulation_.infinite_full_cell();
  }

  int dim_;
  Triangulation triangulation_;
  typename Triangulation::Full_cell_handle hint_;
  std::vector<typename Triangulation::Full_cell_handle> cells_;
};

}  // namespace

std::unique_ptr<ConvexHull> make_convex_hull_d(int dim) {
  if (dim == 4) {
    return std::make_unique<Polytope<CGAL::Dimension_tag<4>>>(dim);
  }
  return std::make_unique<Polytope<CGAL::Dynamic_dimension_tag>>(dim);
}

}  // namespace remanifold::detail
