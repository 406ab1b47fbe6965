// SPDX-License-Identifier: GPL-3.0-or-later
// What Python has to know and the core decides: words of the options, numbers of the method.
#include "options.hpp"
#include "remanifold/constants.hpp"
#include "remanifold/openings.hpp"

namespace remanifold::python {

void bind_constants(py::module_& module) {
  module.attr("KINDS") = names(kKinds);
  module.attr("SEARCHES") = names(kSearches);
  module.attr("ESTIMATORS") = names(kEstimators);
  module.attr("EDGE_RULES") = names(kEdgeRules);
  module.attr("CHECKS") = kChecks;
  module.attr("OUTLIER_DISTANCE") = kOutlierDistance;
  module.attr("RANDOM_HOLE_RADIUS") = kRandomHoleRadius;
  module.attr("EVEN_HOLE_RADIUS") = kEvenHoleRadius;
  module.attr("JET_NEIGHBORS") = kJetNeighborsFormula;
  module.attr("PAPER_NEIGHBORS") = kPaperNeighborsFormula;
  module.attr("SCALE_WORDS") = kScaleWords;
  module.def("jet_neighbors", &jet_neighbors, py::arg("dim"));
  module.def("paper_neighbors", &paper_neighbors, py::arg("dim"));
  module.def("scale_neighbors", &scale_neighbors, py::arg("dim"));
  module.attr("SIGNIFICANCE") = kSignificance;
  module.def("opening_decay", &opening_decay, py::arg("dim"));
  module.def("hole_radius_share", &hole_radius_share, py::arg("dim"));
}

}  // namespace remanifold::python
