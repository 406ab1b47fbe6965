// SPDX-License-Identifier: GPL-3.0-or-later
// A complex whose simplices come and go, with the star of each vertex.
#pragma once

#include "base/csr.hpp"
#include "complex/simplex_rows.hpp"
#include "remanifold/types.hpp"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <iterator>
#include <utility>
#include <vector>

namespace remanifold::detail {

/// Few stars of many are looked at: those are lists of their own from then on, all others
/// stay rows of one array.
class EditableComplex {
 public:
  EditableComplex(SimplexArray simplices, Index num_vertices)
      : simplices_(std::move(simplices)),
        removed_(simplices_.size(), 0),
        first_stars_(csr_of(num_vertices,
                            [&](const auto& add) {
                              for (Offset s = 0; s < simplices_.size(); ++s) {
                                for (int i = 0; i < simplices_.arity; ++i) {
                                  add(simplices_[s][i], static_cast<Index>(s));
                                }
                              }
                            })),
        place_(num_vertices, -1) {}

  int arity() const { return simplices_.arity; }
  const Index* operator[](Offset s) const { return simplices_[s]; }
  /// Simplices at a vertex, in the order in which they came.
  const std::vector<Offset>& star(Index v) const { return own_star(v); }

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
      std::vector<Offset>& star = own_star(simplices_[s][i]);
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
    for (const Offset s : star(face[0])) {
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
  SimplexArray link(Index v) const { return link(v, star(v)); }

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
  std::vector<Offset>& own_star(Index v) const {
    if (place_[v] < 0) {
      place_[v] = static_cast<Index>(stars_.size());
      stars_.emplace_back(first_stars_.begin(v), first_stars_.end(v));
    }
    return stars_[place_[v]];
  }

  void list(Offset s) {
    for (int i = 0; i < arity(); ++i) {
      own_star(simplices_[s][i]).push_back(s);
    }
  }

  SimplexArray simplices_;
  std::vector<std::uint8_t> removed_;
  Csr first_stars_;
  mutable std::vector<Index> place_;  // of each vertex in stars_, or -1
  mutable std::deque<std::vector<Offset>> stars_;
};

}  // namespace remanifold::detail
