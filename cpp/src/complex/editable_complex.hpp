// SPDX-License-Identifier: GPL-3.0-or-later
// A complex whose simplices come and go, with the star of each vertex.
#pragma once

#include "complex/simplex_rows.hpp"
#include "remanifold/types.hpp"

#include <algorithm>
#include <vector>

namespace remanifold::detail {

class EditableComplex {
 public:
  EditableComplex(const SimplexArray& simplices, Index num_vertices)
      : simplices_(simplices), stars_(num_vertices) {
    std::vector<Index> counts(num_vertices, 0);
    for (const Index v : simplices_.vertices) {
      ++counts[v];
    }
    for (Index v = 0; v < num_vertices; ++v) {
      stars_[v].reserve(counts[v]);
    }
    for (Offset s = 0; s < simplices_.size(); ++s) {
      list(s);
    }
    removed_.assign(simplices_.size(), 0);
  }

  int arity() const { return simplices_.arity; }
  const Index* operator[](Offset s) const { return simplices_[s]; }
  /// Simplices at a vertex, in the order in which they came.
  const std::vector<Offset>& star(Index v) const { return stars_[v]; }

  /// Columns must ascend.
  Offset add(const Index* simplex) {
    append_row(simplices_, simplex);
    removed_.push_back(0);
    list(simplices_.size() - 1);
    return simplices_.size() - 1;
  }

  void remove(Offset s) {
    removed_[s] = 1;
    for (int i = 0; i < arity(); ++i) {
      std::vector<Offset>& star = stars_[simplices_[s][i]];
      star.erase(std::find(star.begin(), star.end(), s));
    }
  }

  /// Undoes remove().
  void restore(Offset s) {
    removed_[s] = 0;
    list(s);
  }

  /// Simplices on a face; its vertices ascend.
  std::vector<Offset> simplices_on(const std::vector<Index>& face) const {
    std::vector<Offset> result;
    for (const Offset s : stars_[face[0]]) {
      const Index* row = simplices_[s];
      if (std::includes(row, row + arity(), face.begin(), face.end())) {
        result.push_back(s);
      }
    }
    return result;
  }

  /// The facet of a simplex that leaves out its i-th vertex.
  std::vector<Index> facet(Offset s, int i) const {
    std::vector<Index> face(simplices_[s], simplices_[s] + arity());
    face.erase(face.begin() + i);
    return face;
  }

  /// Facets of the star of v opposite to it.
  SimplexArray link(Index v) const { return link(v, stars_[v]); }

  /// The same of some simplices of the star alone.
  SimplexArray link(Index v, const std::vector<Offset>& fan) const {
    SimplexArray link{arity() - 1, {}};
    for (const Offset s : fan) {
      std::copy_if(simplices_[s], simplices_[s] + arity(),
                   std::back_inserter(link.vertices), [&](Index w) { return w != v; });
    }
    return link;
  }

  /// What is left, rows sorted.
  SimplexArray finish() {
    erase_rows(simplices_, removed_);
    return sorted_unique(simplices_);
  }

 private:
  void list(Offset s) {
    for (int i = 0; i < arity(); ++i) {
      stars_[simplices_[s][i]].push_back(s);
    }
  }

  SimplexArray simplices_;
  std::vector<std::uint8_t> removed_;
  std::vector<std::vector<Offset>> stars_;
};

}  // namespace remanifold::detail
