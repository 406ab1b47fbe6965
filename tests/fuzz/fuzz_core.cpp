// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes as small sets of samples and options, through every entry of the core that takes
// arrays. Samples coincide, lie on lattices and lines, a few bits apart, at 1e-300 and at
// 1e300. What may come is a result that is what verify.hpp says, the same for one thread
// and for two, or std::invalid_argument.
#include "remanifold/remanifold.hpp"
#include "remanifold/simplification.hpp"
#include "remanifold/surface_distances.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>
#include <set>
#include <stdexcept>
#include <vector>

namespace {

using namespace remanifold;

/// Bytes one after the other, zeros when there are no more.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : next_(data), end_(data + size) {}

  bool none() const { return next_ == end_; }
  std::uint8_t byte() { return none() ? 0 : *next_++; }
  int below(int count) { return byte() % count; }
  bool coin() { return byte() % 2 == 1; }
  double any_double() {
    double value = 0;
    std::uint8_t raw[sizeof value];
    for (std::uint8_t& one : raw) {
      one = byte();
    }
    std::memcpy(&value, raw, sizeof value);
    return value;
  }

 private:
  const std::uint8_t* next_;
  const std::uint8_t* end_;
};

[[noreturn]] void wrong(const char* what) {
  std::fprintf(stderr, "remanifold_fuzz: %s\n", what);
  std::abort();
}

/// Of all that was found so far: builds by other compilers and with other settings have to
/// find the same.
std::uint64_t digest = 14695981039346656037ULL;

template <class Values>
void note(const Values& values) {
  for (const auto value : values) {
    digest = (digest ^ static_cast<std::uint64_t>(value)) * 1099511628211ULL;
  }
}

struct Table {
  std::vector<double> values;
  int cols = 1;

  Offset rows() const { return static_cast<Offset>(values.size()) / cols; }
  MatrixView view() const { return {values.data(), rows(), cols}; }
};

double coordinate(Bytes& bytes) {
  switch (bytes.below(8)) {
    case 0:
      return bytes.any_double();
    case 1: {  // a few bits off a whole number
      double value = bytes.below(4);
      for (int i = bytes.below(4); i > 0; --i) {
        value = std::nextafter(value, 9.0);
      }
      return value;
    }
    case 2:
      return std::ldexp(bytes.below(16) - 8.0, bytes.byte() * 8 - 1020);
    case 3:
      return bytes.below(5) + std::ldexp(1.0, -bytes.below(64));
    case 4:
      return bytes.byte() / 256.0 + bytes.byte() / 65536.0;
    default:
      return bytes.below(5);
  }
}

Table points_of(Bytes& bytes) {
  Table table;
  table.cols = 1 + bytes.below(bytes.coin() ? 4 : 12);
  const int rows = 1 + bytes.below(40);
  const int scale = bytes.below(8) == 0 ? bytes.byte() * 8 - 1020 : 0;
  for (int i = 0; i < rows && !bytes.none(); ++i) {
    const Offset before = table.rows();
    const int how = bytes.below(8);
    for (int j = 0; j < table.cols; ++j) {
      double value = 0;
      if (how == 0 && before > 0) {  // again, or with another last coordinate
        value = table.values[(bytes.byte() % before) * table.cols + j];
      } else if (how == 1) {  // on a circle, in the plane of two axes
        const double angle = i * 6.283185307179586 / rows;
        value = j == 0 ? std::cos(angle) : j == 1 ? std::sin(angle) : 0;
      } else if (how == 2) {  // on a lattice
        value = j == 0 ? i % 4 : j == 1 ? i / 4 % 4 : i / 16;
      } else {
        value = coordinate(bytes);
      }
      table.values.push_back(std::ldexp(value, scale));
    }
  }
  if (table.values.empty()) {
    table.values.assign(table.cols, 0.0);
  }
  return table;
}

/// Some hundred samples of a surface, a curve or a solid, with noise or without.
Table manifold_of(Bytes& bytes) {
  std::mt19937_64 random(bytes.byte());
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const int kind = bytes.below(4);
  const int rows = 20 + 2 * bytes.byte();
  const double noise = bytes.coin() ? bytes.byte() / 2000.0 : 0;
  Table table;
  table.cols = kind == 0 ? 2 : 3;
  for (int i = 0; i < rows; ++i) {
    const double u = 6.283185307179586 * uniform();
    const double v = 6.283185307179586 * uniform();
    const double radius = kind == 1 ? 2 + std::cos(v) : 1.0;
    double p[3] = {radius * std::cos(u), radius * std::sin(u),
                   kind == 1 ? std::sin(v) : uniform()};
    if (kind == 3) {
      p[0] = uniform();
      p[1] = uniform();
    }
    for (int j = 0; j < table.cols; ++j) {
      table.values.push_back(p[j] + noise * (uniform() + uniform() - 1));
    }
  }
  return table;
}

bool is_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double x) { return std::isfinite(x); });
}

/// Inner products of the points, or their distances, or what is neither.
Table products_of(Bytes& bytes, const Table& points, bool gram) {
  const Offset n = points.rows();
  Table result{std::vector<double>(n * n), static_cast<int>(n)};
  for (Offset i = 0; i < n; ++i) {
    for (Offset j = 0; j < n; ++j) {
      double sum = 0;
      for (int k = 0; k < points.cols; ++k) {
        const double a = points.view().row(i)[k];
        const double b = points.view().row(j)[k];
        sum += gram ? a * b : (a - b) * (a - b);
      }
      result.values[i * n + j] = gram ? sum : std::sqrt(sum);
    }
  }
  if (bytes.below(4) == 0) {
    const Offset i = bytes.byte() % n;
    const Offset j = bytes.byte() % n;
    result.values[i * n + j] = result.values[j * n + i] = coordinate(bytes);
  }
  if (bytes.below(4) == 0) {
    for (double& value : result.values) {
      value = static_cast<double>(static_cast<float>(value));
    }
  }
  return result;
}

ReconstructOptions options_of(Bytes& bytes) {
  ReconstructOptions options;
  options.dim = bytes.below(8) == 0 ? bytes.below(8) : 1 + bytes.below(3);
  if (bytes.below(4) == 0) {
    options.num_neighbors = bytes.byte();
  }
  if (bytes.below(4) == 0) {
    options.estimator = static_cast<Estimator>(bytes.below(3));
  }
  if (bytes.below(4) == 0) {
    options.outlier_distance = bytes.below(6);
  }
  options.smooth = bytes.below(4) == 0;
  options.smoothing.num_neighbors = bytes.below(3) == 0 ? bytes.byte() : 0;
  options.smoothing.only_noise = bytes.coin();
  options.edges = bytes.coin() ? EdgeRule::kMutual : EdgeRule::kEither;
  options.manifold.boundary = bytes.coin() ? BoundaryRule::kAuto : BoundaryRule::kNone;
  if (bytes.below(4) == 0) {
    options.manifold.hole_radius = bytes.below(8) / 2.0;
  }
  if (bytes.below(8) == 0) {
    options.search.method = static_cast<SearchMethod>(bytes.below(4));
    options.search.checks = 1 + bytes.byte();
  }
  return options;
}

void same(bool holds) {
  if (!holds) {
    wrong("two threads find something else than one");
  }
}

std::vector<std::uint8_t> flags(Bytes& bytes, Offset count) {
  std::vector<std::uint8_t> result(count);
  for (std::uint8_t& one : result) {
    one = bytes.coin() ? 1 : 0;
  }
  return result;
}

/// What may be asked of any simplices with vertices.
void ask(Bytes& bytes, const Table& points, const SimplexArray& simplices) {
  const auto n = static_cast<Index>(points.rows());
  const Execution alone{1, nullptr};
  const Execution two{2, nullptr};
  SimplexArray sorted = simplices;
  for (Offset s = 0; s < sorted.size(); ++s) {
    std::sort(sorted.vertices.begin() + s * sorted.arity,
              sorted.vertices.begin() + (s + 1) * sorted.arity);
  }
  const Topology topology = compute_topology(sorted, n, alone);
  same(topology.singular_vertices ==
       compute_topology(sorted, n, two).singular_vertices);
  connected_components(sorted, n);
  if (sorted.size() == 0) {
    return;
  }
  const Faces facets = faces_of(sorted, sorted.arity - 2, alone);
  find_open_faces(facets, flags(bytes, n));
  singular_vertices(sorted, flags(bytes, n), alone);
  const SimplexSearch search(points.view(), simplices, alone);
  Table queries{{}, points.cols};
  for (int i = bytes.below(6); i >= 0; --i) {
    for (int j = 0; j < points.cols; ++j) {
      const double value = coordinate(bytes);
      queries.values.push_back(std::isfinite(value) ? value : 0.0);
    }
  }
  const Projections found = search.nearest(queries.view(), alone);
  note(found.simplices);
  same(found.simplices == search.nearest(queries.view(), two).simplices);
  for (const Offset simplex : found.simplices) {
    if (simplex < 0 || simplex >= simplices.size()) {
      wrong("a simplex that there is not is the nearest");
    }
  }
  SimplificationOptions fewer;
  fewer.num_vertices = bytes.byte();
  fewer.even = bytes.coin();
  if (topology.singular_vertices.empty() && topology.pseudomanifold) {
    const Simplification simple = simplify(
        points.view(), simplices, std::vector<std::uint8_t>(n, kMovable), fewer, alone);
    SimplexArray ordered = simple.simplices;
    for (Offset s = 0; s < ordered.size(); ++s) {
      std::sort(ordered.vertices.begin() + s * ordered.arity,
                ordered.vertices.begin() + (s + 1) * ordered.arity);
    }
    const Topology after = compute_topology(ordered, n, alone);
    if (after.euler_characteristic != topology.euler_characteristic ||
        after.components != topology.components || !after.singular_vertices.empty()) {
      wrong("simplified, it is another manifold");
    }
  }
  if (simplices.arity == 3 && topology.pseudomanifold) {
    std::vector<double> lengths;
    for (Offset s = 0; s < simplices.size(); ++s) {
      for (int i = 0; i < 3; ++i) {
        const double* a = points.view().row(simplices[s][(i + 1) % 3]);
        const double* b = points.view().row(simplices[s][(i + 2) % 3]);
        double sum = 0;
        for (int j = 0; j < points.cols; ++j) {
          sum += (a[j] - b[j]) * (a[j] - b[j]);
        }
        lengths.push_back(std::sqrt(sum));
      }
    }
    if (is_finite(lengths)) {
      surface_distances(simplices, lengths, n, {0, n - 1}, alone);
    }
  }
}

/// Any simplices, in range and rows without twins.
SimplexArray simplices_of(Bytes& bytes, Index num_vertices) {
  SimplexArray result{1 + bytes.below(5), {}};
  if (num_vertices < result.arity) {
    result.arity = 1;
  }
  std::set<std::vector<Index>> rows;
  std::vector<Index> row;
  for (int i = bytes.below(24); i > 0 && !bytes.none(); --i) {
    row.clear();
    for (int j = 0; j < result.arity; ++j) {
      row.push_back(bytes.byte() % num_vertices);
    }
    std::sort(row.begin(), row.end());
    if (std::adjacent_find(row.begin(), row.end()) == row.end()) {
      rows.insert(row);
    }
  }
  for (const std::vector<Index>& one : rows) {
    result.vertices.insert(result.vertices.end(), one.begin(), one.end());
  }
  return result;
}

/// The enclosure tries all tuples of K + 1 neighbors: few enough of few.
ReconstructOptions in_time(ReconstructOptions options, bool enclosure) {
  if (options.estimator) {
    enclosure = options.estimator == Estimator::kEnclosure;
  }
  if (enclosure && options.dim > 2) {
    options.num_neighbors = std::min(options.num_neighbors, 20);
    options.estimator = options.dim > 3 || options.num_neighbors == 0
                            ? Estimator::kPca
                            : Estimator::kEnclosure;
  }
  return options;
}

void manifold(const Samples& samples, const ReconstructOptions& given, Bytes& bytes,
              const Table* points) {
  const ReconstructOptions options = in_time(given, false);
  const Reconstruction one = reconstruct(samples, options, {}, {1, nullptr});
  const Reconstruction two = reconstruct(samples, options, {}, {2, nullptr});
  same(one.simplices.vertices == two.simplices.vertices &&
       one.boundary == two.boundary &&
       one.report.openings.size() == two.report.openings.size() &&
       one.cleaning.outliers == two.cleaning.outliers);
  note(one.simplices.vertices);
  note(one.boundary);
  note(one.cleaning.outliers);
  for (const Index v : one.simplices.vertices) {
    if (v < 0 || v >= samples.input_size()) {
      wrong("a vertex that there is not");
    }
  }
  if (points != nullptr) {
    ask(bytes, *points, one.simplices);
    if (one.simplices.size() > 0) {
      QualityOptions quality;
      quality.dim = options.dim;
      const NeighborSearch search(samples);
      measure_quality(samples, search, one.simplices, quality, {1, nullptr});
    }
  }
}

void paper(const Samples& samples, const ReconstructOptions& given) {
  const ReconstructOptions options = in_time(given, true);
  const PaperReconstruction one = reconstruct_paper(samples, options, {1, nullptr});
  const PaperReconstruction two = reconstruct_paper(samples, options, {2, nullptr});
  same(one.simplices.vertices == two.simplices.vertices &&
       one.edges.vertices == two.edges.vertices);
  note(one.simplices.vertices);
  paper_report(one.simplices, one.edge_sets, one.stars, one.boundary, {1, nullptr});
}

/// Each step, and what must hold after it.
void steps(const Samples& samples, const ReconstructOptions& given, Bytes& bytes) {
  const ReconstructOptions options = in_time(given, false);
  const Execution alone{1, nullptr};
  const NeighborSearch search(samples, {}, alone);
  const Neighborhoods near =
      find_neighborhoods(samples, search, 1 + bytes.below(40), alone);
  verify_neighborhoods(samples, near);
  TangentOptions tangent;
  tangent.dim = options.dim;
  tangent.estimator = options.estimator.value_or(Estimator::kJet);
  const TangentSpaces tangents = compute_tangent_spaces(samples, near, tangent, alone);
  verify_tangent_spaces(samples, tangents);
  const LocalRegions regions =
      compute_local_regions(samples, search, near, tangents, alone);
  verify_local_regions(regions);
  const ManifoldComplex complex =
      build_manifold(samples, near, tangents, regions, options.manifold, {}, alone);
  verify_manifold_complex(complex, samples.size(), alone);
  const Csr graph = edge_graph(regions.edge_sets, options.edges, alone);
  verify_simplices(clique_complex(graph, options.dim, alone), samples.size());
  note(complex.simplices.vertices);
  note(regions.edge_sets.indices);
}

/// A graph of any bytes, which need not be one.
void graph(Bytes& bytes) {
  Csr sets;
  const int rows = bytes.below(16);
  for (int i = 0; i < rows; ++i) {
    for (int j = bytes.below(6); j > 0; --j) {
      sets.indices.push_back(bytes.below(17) - (bytes.below(64) == 0 ? 3 : 0));
    }
    sets.offsets.push_back(
        bytes.below(64) == 0 ? bytes.byte() : static_cast<Offset>(sets.indices.size()));
  }
  const EdgeRule rule = bytes.coin() ? EdgeRule::kMutual : EdgeRule::kEither;
  const Csr symmetric = edge_graph(sets, rule, {1, nullptr});
  graph_edges(symmetric);
  const SimplexArray cliques = clique_complex(symmetric, bytes.below(6), {1, nullptr});
  verify_simplices(cliques, static_cast<Index>(symmetric.rows()));
}

void one_call(Bytes& bytes) {
  const int entry = bytes.below(8);
  if (entry == 0) {
    return graph(bytes);
  }
  const ReconstructOptions options = options_of(bytes);
  const Table points = bytes.below(6) == 0 ? manifold_of(bytes) : points_of(bytes);
  if (entry == 1) {
    const SimplexArray simplices =
        simplices_of(bytes, static_cast<Index>(points.rows()));
    return ask(bytes, points, simplices);
  }
  if (entry == 2 || entry == 3) {
    const Table products = products_of(bytes, points, entry == 2);
    const Samples samples = entry == 2 ? Samples::from_gram(products.view())
                                       : Samples::from_distances(products.view());
    if (bytes.coin()) {
      return paper(samples, options);
    }
    return manifold(samples, options, bytes, nullptr);
  }
  const Samples samples = Samples::from_points(points.view());
  if (entry == 4) {
    return paper(samples, options);
  }
  if (entry == 5) {
    return steps(samples, options, bytes);
  }
  manifold(samples, options, bytes, &points);
}

}  // namespace

std::uint64_t digest_of_all_results();
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  try {
    one_call(bytes);
  } catch (const std::invalid_argument&) {
    // What cannot be reconstructed is refused.
    note(std::vector<int>{1});
  } catch (const std::runtime_error& error) {
    // The approximate search may find too few, and says so.
    if (std::strstr(error.what(), "raise checks") == nullptr) {
      throw;
    }
  }
  return 0;
}

std::uint64_t digest_of_all_results() { return digest; }
