// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/chain_program.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace remanifold::detail {
namespace {

constexpr double kIntegral = 1e-6;

bool is_fraction(double share) {
  return std::abs(share - std::round(share)) >= kIntegral;
}

}  // namespace

OrientedProgram::OrientedProgram(const CavityPart& part,
                                 const std::vector<std::int8_t>& signs)
    : part_(part),
      num_candidates_(part.num_candidates()),
      num_facets_(part.num_facets()) {
  add_columns();
  add_boundaries();
  add_rooms();
  set_signs(signs);
}

void OrientedProgram::set_signs(const std::vector<std::int8_t>& signs) {
  for (Offset f = 0; f < num_facets_; ++f) {
    const FacetNumber rim = part_.rims[f];
    const double inward = rim == kOpen ? 0.0 : signs[f] * parity(rim % part_.arity());
    program_.row_lower[f] = program_.row_upper[f] = -inward;
  }
}

double OrientedProgram::energy(const std::vector<double>& x) const {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += program_.costs[i] * x[i];
  }
  return sum;
}

bool OrientedProgram::is_integral(const std::vector<double>& x) const {
  for (Offset c = 0; c < num_candidates_; ++c) {
    if (part_.core[c] != 0 && is_fraction(share(x, c))) {
      return false;
    }
  }
  return true;
}

void OrientedProgram::make_integral(const std::vector<double>& x) {
  program_.integral.assign(program_.costs.size(), 0);
  std::fill_n(program_.integral.begin(), 2 * num_candidates_, 1);
  std::vector<std::uint8_t> touched(num_facets_, 0);
  for (Offset c = 0; c < num_candidates_; ++c) {
    if (is_fraction(share(x, c))) {
      for (int i = 0; i < part_.arity(); ++i) {
        touched[part_.facet_of(c, i)] = 1;
      }
    }
  }
  for (Offset c = 0; c < num_candidates_; ++c) {
    bool near = share(x, c) >= kIntegral;
    for (int i = 0; i < part_.arity(); ++i) {
      near = near || touched[part_.facet_of(c, i)] != 0;
    }
    if (!near) {
      program_.upper[c] = program_.upper[num_candidates_ + c] = 0;
    }
  }
}

std::vector<Index> OrientedProgram::chosen(const std::vector<double>& x) const {
  std::vector<Index> result;
  for (Offset c = 0; c < num_candidates_; ++c) {
    if (part_.core[c] != 0 && share(x, c) > 0.5) {
      result.push_back(part_.candidates[c]);
    }
  }
  return result;
}

std::vector<Index> OrientedProgram::rounded(const std::vector<double>& x) const {
  std::vector<Offset> order;
  for (Offset c = 0; c < num_candidates_; ++c) {
    if (part_.core[c] != 0 && share(x, c) >= 0.5 - kIntegral) {
      order.push_back(c);
    }
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](Offset a, Offset b) { return share(x, a) > share(x, b); });
  std::vector<int> left(num_facets_);
  for (Offset f = 0; f < num_facets_; ++f) {
    left[f] = room(f);
  }
  std::vector<Index> result;
  for (const Offset c : order) {
    bool fits = true;
    for (int i = 0; i < part_.arity(); ++i) {
      fits = fits && left[part_.facet_of(c, i)] > 0;
    }
    if (fits) {
      for (int i = 0; i < part_.arity(); ++i) {
        --left[part_.facet_of(c, i)];
      }
      result.push_back(part_.candidates[c]);
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

double OrientedProgram::share(const std::vector<double>& x, Offset candidate) const {
  return x[candidate] + x[num_candidates_ + candidate];
}

void OrientedProgram::add_columns() {
  const Cavities& cavities = *part_.cavities;
  LinearProgram& p = program_;
  for (int sign = 0; sign < 2; ++sign) {
    for (const Index c : part_.candidates) {
      p.costs.push_back(cavities.energies[c]);
      const bool wrong = !cavities.orientations.empty() &&
                         (cavities.orientations[c] > 0) != (sign == 0);
      p.upper.push_back(wrong ? 0 : 1);
    }
  }
  for (int sign = 0; sign < 2; ++sign) {
    for (Offset f = 0; f < num_facets_; ++f) {
      p.costs.push_back(part_.continued[f] != 0 ? 0 : cavities.prices[part_.facets[f]]);
      p.upper.push_back(2);
    }
  }
}

void OrientedProgram::add(Offset column, double value) {
  program_.columns.push_back(static_cast<Index>(column));
  program_.values.push_back(value);
}

void OrientedProgram::end_row(double lower, double upper) {
  program_.row_lower.push_back(lower);
  program_.row_upper.push_back(upper);
  program_.offsets.push_back(static_cast<Offset>(program_.columns.size()));
}

/// What is on both sides of a facet cancels, or is left open.
void OrientedProgram::add_boundaries() {
  for (Offset f = 0; f < num_facets_; ++f) {
    part_.for_each_on(f, [&](Offset c, int position) {
      add(c, parity(position));
      add(num_candidates_ + c, -parity(position));
    });
    add(2 * num_candidates_ + f, -1);
    add(2 * num_candidates_ + num_facets_ + f, 1);
    end_row(0, 0);  // until signs are known
  }
}

/// No more than two simplices on a facet.
void OrientedProgram::add_rooms() {
  std::vector<Offset> on;
  for (Offset f = 0; f < num_facets_; ++f) {
    on.clear();
    part_.for_each_on(f, [&](Offset c, int) { on.push_back(c); });
    if (static_cast<int>(on.size()) <= room(f)) {
      continue;
    }
    for (const Offset c : on) {
      add(c, 1);
      add(num_candidates_ + c, 1);
    }
    end_row(-std::numeric_limits<double>::infinity(), room(f));
  }
}

LinearProgram degree_program(const CavityPart& part) {
  LinearProgram p;
  for (const Index c : part.candidates) {
    p.costs.push_back(part.cavities->energies[c]);
    p.upper.push_back(1);
    p.integral.push_back(1);
  }
  for (Offset f = 0; f < part.num_facets(); ++f) {
    const double wanted = part.rims[f] == kOpen ? 2 : 1;
    part.for_each_on(f, [&](Offset c, int) {
      p.columns.push_back(static_cast<Index>(c));
      p.values.push_back(1);
    });
    p.columns.push_back(static_cast<Index>(p.costs.size()));
    p.values.push_back(1);
    p.costs.push_back(part.continued[f] != 0 ? 0
                                             : part.cavities->prices[part.facets[f]]);
    p.upper.push_back(wanted);
    p.integral.push_back(0);
    p.row_lower.push_back(wanted);
    p.row_upper.push_back(wanted);
    p.offsets.push_back(static_cast<Offset>(p.columns.size()));
  }
  return p;
}

}  // namespace remanifold::detail
