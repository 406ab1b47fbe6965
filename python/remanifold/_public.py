# SPDX-License-Identifier: GPL-3.0-or-later
"""The public names, which the package loads where the first of them is asked for."""

from remanifold import __version__, datasets, interoperability, io
from remanifold.calculus.calculus import Calculus
from remanifold.calculus.charts import Atlas, Chart, ChartPoints
from remanifold.calculus.cohomology import CircularCoordinates
from remanifold.calculus.curvature import AngleDefects, Curvature
from remanifold.calculus.delaunay import IntrinsicTriangles
from remanifold.calculus.paths import FrechetMean, LogarithmMap, VoronoiCells
from remanifold.calculus.poisson import PoissonSolution
from remanifold.calculus.regression import Regression
from remanifold.calculus.spectrum import Spectrum
from remanifold.complex.embedding import Embedding, embed
from remanifold.complex.graphs import edge_graph
from remanifold.complex.projection import PointsOnComplex, Projection
from remanifold.complex.topology import Topology, compute_topology
from remanifold.drawing.plotting import plot
from remanifold.judging.invariants import Invariant, Invariants
from remanifold.judging.quality import Quality, Reason
from remanifold.judging.singularities import Place, Singularities, find_singularities
from remanifold.method.cleaning import Smoothing, find_outliers, smooth
from remanifold.method.dimension import DimensionEstimate, estimate_dimension
from remanifold.method.forecast import Forecast
from remanifold.method.openings import Opening
from remanifold.method.provenance import Parameter, Parameters, Provenance
from remanifold.method.result import Repair
from remanifold.method.steps import (
    EdgeSets,
    LocalRegions,
    Neighborhoods,
    Stars,
    TangentSpaces,
    clique_complex,
    edge_sets,
    local_regions,
    neighborhoods,
    tangent_spaces,
)
from remanifold.page.report_page import write_report
from remanifold.remeshing.volume import VolumeEstimate
from remanifold.results.forecast import forecast
from remanifold.results.reconstruct import reconstruct
from remanifold.results.reconstruction import Reconstruction, load
from remanifold.results.simplicial_complex import (
    SimplicialComplex,
    SimplifiedComplex,
    Subcomplex,
)
from remanifold.warnings import (
    DimensionWarning,
    DoubtWarning,
    DroppedWarning,
    FileWarning,
    ManifoldWarning,
    MatrixWarning,
    MissingWarning,
    RecallWarning,
    RemanifoldWarning,
    TransposedWarning,
)

__all__ = [
    "AngleDefects",
    "Atlas",
    "Calculus",
    "Chart",
    "ChartPoints",
    "CircularCoordinates",
    "Curvature",
    "DimensionEstimate",
    "DimensionWarning",
    "DoubtWarning",
    "DroppedWarning",
    "EdgeSets",
    "Embedding",
    "FileWarning",
    "Forecast",
    "FrechetMean",
    "IntrinsicTriangles",
    "Invariant",
    "Invariants",
    "LocalRegions",
    "LogarithmMap",
    "ManifoldWarning",
    "MatrixWarning",
    "MissingWarning",
    "Neighborhoods",
    "Opening",
    "Parameter",
    "Parameters",
    "Place",
    "PointsOnComplex",
    "PoissonSolution",
    "Projection",
    "Provenance",
    "Quality",
    "Reason",
    "RecallWarning",
    "Reconstruction",
    "Regression",
    "RemanifoldWarning",
    "Repair",
    "SimplicialComplex",
    "SimplifiedComplex",
    "Singularities",
    "Smoothing",
    "Spectrum",
    "Stars",
    "Subcomplex",
    "TangentSpaces",
    "Topology",
    "TransposedWarning",
    "VolumeEstimate",
    "VoronoiCells",
    "__version__",
    "clique_complex",
    "compute_topology",
    "datasets",
    "edge_graph",
    "edge_sets",
    "embed",
    "estimate_dimension",
    "find_outliers",
    "find_singularities",
    "forecast",
    "interoperability",
    "io",
    "load",
    "local_regions",
    "neighborhoods",
    "plot",
    "reconstruct",
    "smooth",
    "tangent_spaces",
    "write_report",
]

# Pickles and messages name a class by where users find it, whatever file it is in.
for _public in [globals()[name] for name in __all__]:
    if isinstance(_public, type):
        _public.__module__ = "remanifold"
