// SPDX-License-Identifier: GPL-3.0-or-later
// A cavity, or a window of one, as a program.
#pragma once

#include "chain/cavity_part.hpp"
#include "remanifold/minimum_chain.hpp"

#include <cstdint>
#include <vector>

namespace remanifold::detail {

/// Over oriented simplices: for each candidate one column a sign, for each facet two for
/// what is left open, a sign each.
class OrientedProgram {
 public:
  /// \param signs  of the simplex that is at each facet of the part; 0 where none is
  OrientedProgram(const CavityPart& part, const std::vector<std::int8_t>& signs);
  void set_signs(const std::vector<std::int8_t>& signs);

  const LinearProgram& program() const { return program_; }
  double energy(const std::vector<double>& x) const;
  /// Whether every candidate that the part decides on is in or out.
  bool is_integral(const std::vector<double>& x) const;
  /// From a solution of the linear program to the integer program: candidates that it
  /// leaves out, and that share no facet with one it takes in part, stay out.
  void make_integral(const std::vector<double>& x);
  /// Those of the core that are in, as numbers of the cavities.
  std::vector<Index> chosen(const std::vector<double>& x) const;
  /// Those of the core that are in most, the surest first, as long as facets have room: of
  /// a solution that is not integral.
  std::vector<Index> rounded(const std::vector<double>& x) const;

 private:
  double share(const std::vector<double>& x, Offset candidate) const;
  int room(Offset facet) const { return part_.rims[facet] == kOpen ? 2 : 1; }
  void add_columns();
  void add_boundaries();
  void add_rooms();
  void add(Offset column, double value);
  void end_row(double lower, double upper);

  const CavityPart& part_;
  Offset num_candidates_;
  Offset num_facets_;
  LinearProgram program_;
};

/// K = 1: every sample of the cavity should have two edges, each missing one at its price.
/// Curves need no orientation for that.
LinearProgram degree_program(const CavityPart& part);

}  // namespace remanifold::detail
