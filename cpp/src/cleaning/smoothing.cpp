// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/smoothing.hpp"

#include "base/parallel.hpp"
#include "base/per_thread.hpp"
#include "cleaning/local_quadric.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>

namespace remanifold {
namespace {

using detail::LocalQuadric;

constexpr double kEverywhere = std::numeric_limits<double>::infinity();

// ------------------------------------------------- which size of neighborhoods, which noise

/// Sizes tried: this many neighbors an unknown of the quadric, times the root of two each.
constexpr double kFirstSize = 1.5;
/// No neighborhood holds a larger share of the samples, or more than that.
constexpr Index kLargestShare = 4;
constexpr Index kLargest = 1 << 14;
/// Neighborhoods in which samples on lines are looked at for others beside these.
constexpr Index kWidestLines = 1 << 9;
/// Samples at which sizes are tried: few for large neighborhoods, so that no size costs
/// more than looking at each sample this many times.
constexpr Offset kLooks = 2;
constexpr Index kFewestProbes = 24;
constexpr Index kMostProbes = 100;
constexpr int kLevelsAtOnce = 4;
/// The test that tells clean samples: two sizes, at a few probes and some more where there
/// are many samples. A smaller one says how far off they are at most.
constexpr int kNarrowest = 1;
constexpr int kNarrow = 3;
constexpr int kWide = 5;
constexpr Index kTestProbes = 12;
constexpr Index kSamplesPerTestProbe = 500;
/// Where the scatter about the quadric grows by more than this when the neighborhood
/// doubles, it is shape, of which cubic terms grow 2^(3/K) times and a crease 2^(1/K)
/// times; noise stays. Half of the probes decide.
constexpr double kShapeGrowth = 1.25;
/// Scatter below this share of the distance to the nearest neighbor is not worth a move.
constexpr double kLeastNoise = 0.01;
/// Noise is where neighborhoods of so many unknowns predict better than smaller ones, where
/// the scatter at some size grows by less than this when that doubles (rough terrain and
/// coasts grow at all sizes), and where the foot of a sample is known this much better than
/// the sample.
constexpr double kLeastNoisySize = 8;
constexpr double kPlateau = 1.15;
constexpr double kWorthIt = 0.6;
/// Neighborhoods that are this thick, compared with how wide they are, at all sizes fill
/// more than K dimensions. (Balls of K + 1 to K + 3 dimensions: 0.95 to 1.6. Noise of four
/// spacings: 1.4 at small sizes, below 0.75 at larger ones. Coasts: 0.55.)
constexpr double kThick = 0.8;
/// Neighborhoods of a larger share of the samples are as the whole shape is.
constexpr Index kSmallShare = 8;
/// Where the nearest two others are equally far from so many samples, up to rounding, they
/// were put there: on a lattice. That is no noise.
constexpr double kEquallyFar = 1e-9;
constexpr double kMostTies = 0.3;
/// The worst probes do not count, for a few outliers and creases.
constexpr double kTrimmed = 0.05;
/// Where the scatter is this many times the noise, the neighborhood is more than the graph
/// of a quadric: it has a crease, or part of another sheet.
constexpr double kNoGraph = 1.35;
/// Where it has become that, and grows so fast when the neighborhood doubles as only shape
/// can, larger sizes are not tried.
constexpr double kHopelessGrowth = 1.35;

/// Noise drowns the shape where what remains of it, or the noise in one direction itself,
/// is this share of the radius of curvature.
constexpr double kDrowningError = 0.3;
constexpr double kDrowningNoise = 0.5;

/// Nor is it noise where the narrowest neighborhoods have less than this share of the
/// scatter, and are thin, compared with how wide they are: one sheet of several. (Noise of
/// more than a spacing has less of it in narrow ones as well, but these are as thick as
/// wide.)
constexpr double kShareInNarrow = 0.5;
constexpr double kThin = 0.5;
/// What has one peak and is symmetric has a kurtosis of 9/5 at least, that of even noise
/// within limits; two layers have 1. Known up to so many standard errors.
constexpr double kLeastKurtosis = 1.8;
constexpr double kKurtosisErrors = 3;

/// Samples nearer to each other than this many times the error that remains show it, not
/// the shape; but the shape needs samples at this share of the radius of curvature.
constexpr double kResolution = 4;
constexpr double kResolutionOfShape = 0.5;

// ------------------------------------------------------------------------- projecting

constexpr Offset kBlock = 16;
constexpr Offset kBatch = 512;
/// Neighborhoods of the centers overlap so many times.
constexpr Index kOverlap = 10;
/// A quadric counts as far as this share of its reach, with weights falling to zero;
/// samples that have this weight in all are done with.
constexpr double kBlend = 0.7;
constexpr double kEnough = 0.15;
/// Samples farther than this many times the scatter off a quadric are not of its sheet; nor
/// is that many times the noise of all the noise of some.
constexpr double kOwnSheet = 5;
constexpr int kPasses = 6;
/// Noise of this share of the radius of the neighborhoods mixes up who belongs to them:
/// they are looked for again among the samples as moved.
constexpr double kConfusing = 0.12;
constexpr int kMostRounds = 3;

double trimmed_mean(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(),
                              [](double v) { return !std::isfinite(v); }),
               values.end());
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  std::sort(values.begin(), values.end());
  const auto kept = std::max<std::size_t>(
      1, values.size() -
             static_cast<std::size_t>(kTrimmed * static_cast<double>(values.size())));
  double sum = 0;
  for (std::size_t i = 0; i < kept; ++i) {
    sum += values[i];
  }
  return sum / static_cast<double>(kept);
}

double median(std::vector<double> values) {
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto middle = values.begin() + static_cast<Offset>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Whether samples moved by so much in one normal direction each lie in two layers.
bool are_two_layers(const std::vector<double>& squared_moves) {
  const auto count = static_cast<double>(squared_moves.size());
  double sum = 0;
  double squares = 0;
  for (const double square : squared_moves) {
    sum += square;
    squares += square * square;
  }
  const double mean = sum / count;
  if (!(mean > 0)) {
    return false;
  }
  double deviations = 0;
  for (const double square : squared_moves) {
    deviations += std::pow(square * square - squares / count, 2);
  }
  const double kurtosis = squares / count / (mean * mean);
  const double error = std::sqrt(deviations) / count / (mean * mean);
  return kurtosis + kKurtosisErrors * error < kLeastKurtosis;
}

/// Neighborhoods in one arrangement of the samples (the given one, or a smoothed one) with
/// the given positions of their members, and quadrics through these.
class Fitter {
 public:
  /// \param arranged  the samples where the neighborhoods are looked for; numbers of the
  ///                  given samples are its input numbers
  Fitter(const Samples& given, const Samples& arranged, const NeighborSearch& search,
         const Execution& execution, int dim)
      : given_(given),
        arranged_(arranged),
        query_(search.query(execution)),
        fit_(dim),
        part_(dim),
        same_(&given == &arranged) {}

  /// Loads the `count` nearest of an arranged sample, the sample itself first.
  void load(Index center, Index count) {
    query_->nearest(center, count, kEverywhere, found_);
    const auto size = static_cast<Eigen::Index>(found_.size()) + 1;
    const int dim = given_.ambient_dim();
    rows_.resize(size, dim);
    distances_.resize(size);
    members_.resize(size);
    const double* origin = arranged_.point(center);
    for (Eigen::Index i = 0; i < size; ++i) {
      const Index at = i == 0 ? center : found_[i - 1].index;
      distances_[i] = i == 0 ? 0 : std::sqrt(found_[i - 1].squared_distance) * factor_;
      members_[i] = same_ ? at : arranged_.input_index(at);
      const double* point = given_.point(members_[i]);
      for (int axis = 0; axis < dim; ++axis) {
        rows_(i, axis) = point[axis] - origin[axis] * factor_;
      }
    }
  }
  bool fit(Eigen::Index count) { return fit_.fit(rows_, distances_, count, same_); }
  /// Fits to half as many while the scatter shrinks with the neighborhood. Scatter that
  /// stays is noise, though there be more of it here than elsewhere.
  /// \param noise  variance, where it is known
  /// \returns false where there is no quadric at any size, down to the fewest
  bool fit_to_part(double noise, Eigen::Index fewest) {
    Eigen::Index count = size() / 2;
    while (fit_.variance() > kNoGraph * kNoGraph * noise) {
      if (count < fewest || !part_.fit(rows_, distances_, count, same_)) {
        return false;
      }
      if (!(part_.variance() * kNoGraph * kNoGraph < fit_.variance())) {
        break;
      }
      std::swap(fit_, part_);
      count /= 2;
    }
    return !(fit_.variance() > kOwnSheet * kOwnSheet * noise);
  }
  /// Canonical lengths of the given samples are so many of the arranged ones.
  void set_factor(double factor) { factor_ = factor; }

  Eigen::Index size() const { return rows_.rows(); }
  double distance(Eigen::Index i) const { return distances_[i]; }
  const std::vector<Index>& members() const { return members_; }
  const LocalQuadric& quadric() const { return fit_; }

 private:
  const Samples& given_;
  const Samples& arranged_;
  std::unique_ptr<NeighborSearch::Query> query_;
  LocalQuadric fit_;
  LocalQuadric part_;
  bool same_;
  double factor_ = 1;
  std::vector<Neighbor> found_;
  std::vector<Index> members_;
  Eigen::MatrixXd rows_;
  Eigen::VectorXd distances_;
};

/// What the probes say about neighborhoods of one size. Squared canonical lengths.
struct Level {
  Index count = 0;
  double scatter = 0;    // about the quadrics
  double typical = 0;    // the median of that
  double gain = 0;       // variance of a foot over that of a sample
  double bias = 0;       // of the feet
  double growth = 0;     // of the root of the scatter since half the size
  double radius = 0;     // a length
  double curvature = 0;  // root of the mean square
  double nearest = 0;    // median distance to the nearest other
  double ties = 0;       // share of the probes with two of them
  double thickness = 0;  // median of the variances off over along the quadrics
  double wide = 0;       // median of the directions that are filled, K at most
};

/// What one probe says about one of them.
struct At {
  double scatter, gain, difference, gain_difference, growth, radius, curvature, nearest,
      tie, thickness, wide;
};
static_assert(sizeof(At) == kNoiseValues * sizeof(double));

struct Choice {
  Index num_neighbors = 0;
  double noise = std::numeric_limits<double>::quiet_NaN();  // variance
  double risk = std::numeric_limits<double>::quiet_NaN();   // of the feet
  double gain = 0;
  double radius = 0;
  double curvature = 0;
  bool noisy = false;
  bool layers = false;
  double narrow_noise = 0;  // at most, by narrow neighborhoods
  double narrow_risk = 0;
  double drowning = 0;  // drowned from 1 on
  int fitting_dim = 0;
};

class Smoother {
 public:
  Smoother(const Samples& samples, const SmoothingOptions& options,
           const Execution& execution)
      : samples_(samples),
        options_(options),
        execution_(execution),
        unknowns_(LocalQuadric::unknowns(options.dim)),
        num_axes_(samples.affine_dim()) {}

  Smoothing run(const NeighborSearch& search) {
    const Choice choice = samples_.size() > unknowns_ ? choose(search) : Choice{};
    Smoothing result = judged(choice.noise, choice.risk, choice.fitting_dim);
    if (options_.only_noise && !choice.noisy) {
      result.layers = choice.layers;
      return result;
    }
    const Index count = std::min(
        options_.num_neighbors > 0 ? options_.num_neighbors : choice.num_neighbors,
        samples_.size() - 1);
    if (count < options_.dim + 1) {
      return result;
    }
    result.num_neighbors = count;
    result.remaining_error = std::sqrt(choice.risk);
    result.resolution = std::min(kResolution * result.remaining_error,
                                 kResolutionOfShape / choice.curvature);
    result.drowned = choice.drowning >= 1;
    // At the best size the error falls with this power of the number of samples.
    result.growth =
        std::pow(std::max(1.0, choice.drowning), (8.0 + options_.dim) / 4.0);
    if (choice.noisy && options_.num_neighbors == 0) {
      noise_ = choice.noise;
    }
    result.points = project(samples_, search, count);
    result.rounds = 1;
    const double one_way = std::sqrt(choice.noise / codim());
    while (result.rounds < kMostRounds && one_way > kConfusing * choice.radius) {
      const Samples moved = Samples::from_points(
          {result.points.data(), samples_.size(), samples_.ambient_dim()}, execution_);
      const NeighborSearch again(moved, options_.search, execution_);
      result.points = project(moved, again, count);
      ++result.rounds;
    }
    if (options_.only_noise && num_axes_ - options_.dim == 1 &&
        are_two_layers(squared_moves(result.points))) {
      result = judged(choice.narrow_noise, choice.narrow_risk, choice.fitting_dim);
      result.layers = true;
    }
    return result;
  }

  /// The first test of choose() at some samples, and what it says.
  std::vector<At> test_at(const NeighborSearch& search,
                          const std::vector<Index>& places) const {
    return measure_at(search, kNarrowest, kWide, kNarrow - kNarrowest, places);
  }
  bool shows_noise(const std::vector<At>& at) const {
    const std::vector<Level> test =
        levels_of(at, kNarrowest, kWide, kNarrow - kNarrowest);
    const int fitting_dim = dim_of(test);
    return fitting_dim > options_.dim || !is_clean(test, fitting_dim < options_.dim);
  }

 private:
  Smoothing judged(double noise, double risk, int fitting_dim) const {
    Smoothing result;
    result.noise = std::sqrt(noise);
    result.prediction_error = std::sqrt(noise + risk);
    result.remaining_error = result.noise;
    result.fitting_dim = fitting_dim > 0 ? fitting_dim : options_.dim;
    return result;
  }

  /// Dimension of the normal space, of which directions without extent are no part.
  int codim() const { return std::max(1, num_axes_ - options_.dim); }

  std::vector<double> squared_moves(const std::vector<double>& points) const {
    const auto dim = static_cast<std::size_t>(samples_.ambient_dim());
    std::vector<double> squares(samples_.size(), 0.0);
    for (Index x = 0; x < samples_.size(); ++x) {
      for (std::size_t axis = 0; axis < dim; ++axis) {
        const double move = points[x * dim + axis] - samples_.point(x)[axis];
        squares[x] += move * move;
      }
    }
    return squares;
  }

  Index size_of(int level) const {
    return static_cast<Index>(
        std::ceil(kFirstSize * unknowns_ * std::pow(2.0, level / 2.0)));
  }
  Index largest() const {
    return std::min(kLargest,
                    std::max<Index>(size_of(0), samples_.size() / kLargestShare));
  }

  /// Evenly spread for any number of them.
  Index probe(Offset i) const {
    return static_cast<Index>(noise_probe(i, samples_.size()));
  }

  /// Levels first, first + step ... last, the bias from two levels before.
  std::vector<Level> measure(const NeighborSearch& search, int first, int last,
                             int step, Index probes) const {
    std::vector<Index> places;
    for (Offset i = 0; i < probes; ++i) {
      places.push_back(probe(i));
    }
    return levels_of(measure_at(search, first, last, step, places), first, last, step);
  }

  /// What each of some samples says about each level.
  std::vector<At> measure_at(const NeighborSearch& search, int first, int last,
                             int step, const std::vector<Index>& places) const {
    const int num_levels = (last - first) / step + 1;
    const int half = 2 / step;
    const auto probes = static_cast<Offset>(places.size());
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<At> at(static_cast<std::size_t>(probes) * num_levels,
                       {nan, nan, nan, nan, nan, nan, nan, nan, 0, nan, nan});
    over(samples_, search, probes, [&](Fitter& fitter, Offset i) {
      fitter.load(places[i], std::min(size_of(last), samples_.size() - 1));
      std::vector<Eigen::VectorXd> feet(num_levels);
      std::vector<Eigen::VectorXd> influences(num_levels);
      for (int k = 0; k < num_levels; ++k) {
        At& out = at[i * num_levels + k];
        const auto count =
            std::min<Eigen::Index>(size_of(first + k * step), fitter.size());
        if (!fitter.fit(count)) {
          continue;
        }
        const LocalQuadric& quadric = fitter.quadric();
        feet[k] = quadric.foot();
        influences[k] = quadric.influence();
        out.scatter = quadric.variance();
        out.gain = quadric.gain();
        out.thickness = out.scatter / (codim() * quadric.spread());
        out.wide = quadric.wide_directions();
        out.radius = fitter.distance(count - 1);
        out.nearest = fitter.distance(1);
        out.tie = count > 2 && fitter.distance(2) <= (1 + kEquallyFar) * out.nearest;
        out.curvature = quadric.curvature() * quadric.curvature();
        if (k >= half && feet[k - half].size() > 0) {
          const Eigen::VectorXd& before = influences[k - half];
          out.difference = (feet[k] - feet[k - half]).squaredNorm();
          out.gain_difference = out.gain + before.squaredNorm() -
                                2 * before.dot(influences[k].head(before.size()));
          out.growth = std::sqrt(out.scatter / at[i * num_levels + k - half].scatter);
        }
      }
    });
    return at;
  }

  std::vector<Level> levels_of(const std::vector<At>& at, int first, int last,
                               int step) const {
    const int num_levels = (last - first) / step + 1;
    const int half = 2 / step;
    const auto probes = static_cast<Index>(at.size() / num_levels);
    std::vector<Level> levels(num_levels);
    const double decay = 1 - std::pow(2.0, -4.0 / options_.dim);
    for (int k = 0; k < num_levels; ++k) {
      const auto middle = [&](double At::*member) {
        std::vector<double> values;
        for (Index i = 0; i < probes; ++i) {
          const double value = at[static_cast<std::size_t>(i) * num_levels + k].*member;
          if (std::isfinite(value)) {
            values.push_back(value);
          }
        }
        return median(std::move(values));  // NaN where no fit says
      };
      const auto mean = [&](double At::*member) {
        std::vector<double> values(probes);
        for (Index i = 0; i < probes; ++i) {
          values[i] = at[static_cast<std::size_t>(i) * num_levels + k].*member;
        }
        return trimmed_mean(std::move(values));
      };
      Level& level = levels[k];
      level.count = size_of(first + k * step);
      level.scatter = mean(&At::scatter);
      level.gain = mean(&At::gain);
      level.radius = mean(&At::radius);
      level.curvature = std::sqrt(mean(&At::curvature));
      std::vector<double> nearest;
      for (Index i = 0; i < probes; ++i) {
        const At& one = at[static_cast<std::size_t>(i) * num_levels + k];
        level.ties += one.tie / probes;
        nearest.push_back(one.nearest >= 0 ? one.nearest : 0);
      }
      level.nearest = median(std::move(nearest));
      level.typical = middle(&At::scatter);
      level.thickness = middle(&At::thickness);
      level.wide = middle(&At::wide);
      std::vector<double> growths;
      for (Index i = 0; i < probes; ++i) {
        const At& one = at[static_cast<std::size_t>(i) * num_levels + k];
        growths.push_back(one.growth > 0 ? one.growth : kEverywhere);
      }
      level.growth = median(std::move(growths));
      if (k >= half) {
        const double excess =
            mean(&At::difference) - level.scatter * mean(&At::gain_difference);
        level.bias = std::max(0.0, excess) / (decay * decay);
      }
    }
    return levels;
  }

  static double filled_dim(const Level& before, const Level& last) {
    return std::log(static_cast<double>(last.count) / before.count) /
           std::log(last.radius / before.radius);
  }

  /// The dimension that neighborhoods of all these sizes show. That of what they fill
  /// follows from how fast their radii grow with the number of neighbors.
  int dim_of(const std::vector<Level>& levels) const {
    const int dim = options_.dim;
    const Level& last = levels.back();
    if (samples_.whole_size() / kSmallShare < last.count) {
      return dim;
    }
    double wide = 0;
    bool thick = num_axes_ > dim;
    for (const Level& level : levels) {
      wide = std::max(wide, level.wide);
      thick = thick && level.thickness > kThick * kThick;
    }
    if (wide < dim) {
      return std::max(1, static_cast<int>(wide));
    }
    if (!thick) {
      return dim;
    }
    const double filled = filled_dim(levels[levels.size() - 2], last);
    return std::clamp(static_cast<int>(std::lround(filled)), dim + 1, num_axes_);
  }

  /// Whether larger neighborhoods fill K dimensions: samples may be dense along lines. What
  /// begins to spread in K directions only because it bends does not fill them.
  bool spreads_farther(const NeighborSearch& search) const {
    int last = kWide;
    while (size_of(last + 1) <= std::min(largest(), kWidestLines)) {
      ++last;
    }
    const Index probes = std::min(samples_.size(), kFewestProbes);
    const std::vector<Level> levels = measure(search, kWide, last, 1, probes);
    const auto wide =
        std::find_if(levels.begin(), levels.end(),
                     [&](const Level& level) { return level.wide >= options_.dim; });
    // From there on, each time to twice as many.
    bool fills = levels.end() - wide > 2;
    for (auto level = wide; levels.end() - level > 2; ++level) {
      fills = fills && std::lround(filled_dim(level[0], level[2])) >= options_.dim;
    }
    return fills;
  }

  static bool is_clean(const std::vector<Level>& test, bool thin) {
    return thin || test[2].ties > kMostTies || !(test[2].growth < kShapeGrowth) ||
           !(std::sqrt(test[2].scatter) > kLeastNoise * test[2].nearest);
  }

  Choice choose(const NeighborSearch& search) const {
    Choice choice;
    const Index size = samples_.size();
    const auto few = static_cast<Index>(num_noise_probes(size));
    const std::vector<Level> test =
        measure(search, kNarrowest, kWide, kNarrow - kNarrowest, few);
    // Where it is not noise, most of it is that of a few probes at creases and between
    // sheets.
    choice.noise = choice.narrow_noise = test[0].typical;
    choice.risk = choice.narrow_risk = choice.noise * test[0].gain;
    choice.gain = test[1].gain;
    choice.radius = test[1].radius;
    choice.num_neighbors = test[1].count;
    const double nearest = test[2].nearest;
    choice.fitting_dim = dim_of(test);
    const bool thick = choice.fitting_dim > options_.dim;
    const bool thin = choice.fitting_dim < options_.dim;
    if (thin && spreads_farther(search)) {
      choice.fitting_dim = options_.dim;
    }
    const bool clean = is_clean(test, thin);
    if (clean && !thick && options_.only_noise) {
      return choice;
    }
    std::vector<Level> levels;
    for (int first = kNarrow; size_of(first) <= largest() || levels.empty();
         first += kLevelsAtOnce) {
      int last = first + kLevelsAtOnce - 1;
      while (last > first && size_of(last) > largest()) {
        --last;
      }
      const auto looks = static_cast<Index>(kLooks * size / size_of(last));
      const Index probes =
          std::min(size, std::clamp(looks, kFewestProbes, kMostProbes));
      std::vector<Level> more = measure(search, first - 2, last, 1, probes);
      levels.insert(levels.end(), more.begin() + 2, more.end());
      const Level& end = levels.back();
      const auto least = std::min_element(
          levels.begin(), levels.end(),
          [](const Level& a, const Level& b) { return a.scatter < b.scatter; });
      if (end.growth > kHopelessGrowth &&
          end.scatter > kNoGraph * kNoGraph * least->scatter) {
        break;
      }
    }
    // Noise is the scatter where it grows least.
    std::size_t flat = 0;
    for (std::size_t k = 0; k < levels.size(); ++k) {
      if (levels[k].growth < levels[flat].growth) {
        flat = k;
      }
    }
    // Neighborhoods wider than two sheets are apart have another such size.
    for (std::size_t k = 0; k < flat; ++k) {
      const bool grows =
          std::any_of(levels.begin() + static_cast<Offset>(k),
                      levels.begin() + static_cast<Offset>(flat),
                      [](const Level& level) { return level.growth > kShapeGrowth; });
      if (levels[k].growth < kPlateau && grows) {
        flat = k;
      }
    }
    choice.noise = levels[flat].scatter;
    double best = kEverywhere;
    for (const Level& level : levels) {
      const double risk = level.bias + choice.noise * level.gain;
      if (risk < best && level.scatter < kNoGraph * kNoGraph * choice.noise) {
        best = risk;
        choice.num_neighbors = level.count;
        choice.gain = level.gain;
        choice.radius = level.radius;
        choice.curvature = level.curvature;
      }
    }
    choice.risk = best;
    if (options_.num_neighbors > 0) {
      const Level& level = *std::min_element(
          levels.begin(), levels.end(), [&](const Level& a, const Level& b) {
            return std::abs(a.count - options_.num_neighbors) <
                   std::abs(b.count - options_.num_neighbors);
          });
      choice.risk = level.bias + choice.noise * level.gain;
      choice.radius = level.radius;
      choice.curvature = level.curvature;
    }
    if (thick && std::any_of(levels.begin(), levels.end(), [](const Level& level) {
          return level.thickness < kThick * kThick;
        })) {
      choice.fitting_dim = options_.dim;  // it was noise
    }
    choice.noisy = choice.fitting_dim == options_.dim && !clean &&
                   levels[flat].growth < kPlateau &&
                   levels[flat].count <= choice.num_neighbors &&
                   choice.num_neighbors >= kLeastNoisySize * unknowns_ &&
                   choice.risk < kWorthIt * kWorthIt * choice.noise &&
                   std::sqrt(choice.noise) > kLeastNoise * nearest;
    choice.layers = choice.noisy &&
                    test[0].typical < kShareInNarrow * kShareInNarrow * choice.noise &&
                    test[0].thickness < kThin * kThin;
    choice.noisy = choice.noisy && !choice.layers;
    choice.narrow_noise = std::min(choice.noise, test[0].typical);
    choice.narrow_risk = choice.narrow_noise * test[0].gain;
    if (!choice.noisy && options_.only_noise) {
      choice.noise = choice.narrow_noise;
      choice.risk = choice.narrow_risk;
    }
    const double one_way = std::sqrt(choice.noise / codim());
    choice.drowning =
        choice.noisy
            ? choice.curvature * std::max(std::sqrt(choice.risk) / kDrowningError,
                                          one_way / kDrowningNoise)
            : 0;
    return choice;
  }

  template <class Body>
  void over(const Samples& arranged, const NeighborSearch& search, Offset count,
            const Body& body) const {
    detail::ThreadScratch<Fitter> fitters([&] {
      Fitter fitter(samples_, arranged, search, execution_, options_.dim);
      fitter.set_factor(&arranged == &samples_ ? 1 : arranged.scale());
      return fitter;
    });
    detail::for_each_block(count, kBlock, execution_, [&](Offset begin, Offset end) {
      fitters.use([&](Fitter& fitter) {
        for (Offset i = begin; i < end; ++i) {
          body(fitter, i);
        }
      });
    });
  }

  /// Every sample moved to the mean of the quadrics that it is near the middle of.
  std::vector<double> project(const Samples& arranged, const NeighborSearch& search,
                              Index count) const {
    const auto dim = static_cast<std::size_t>(samples_.ambient_dim());
    const Index size = samples_.size();
    std::vector<double> moves(size * dim, 0.0);
    std::vector<double> weights(size, 0.0);
    detail::begin_step(execution_, Step::kSmoothing, arranged.size());

    std::vector<Index> open(arranged.size());
    std::iota(open.begin(), open.end(), Index{0});
    Index stride = std::max<Index>(1, count / kOverlap);
    struct Share {
      Index sample;
      double weight;
    };
    struct Fit {
      std::vector<Share> shares;
      std::vector<double> moves;
    };
    for (int pass = 0; pass < kPasses && !open.empty(); ++pass) {
      if (pass == kPasses - 1) {
        stride = 1;
      }
      std::vector<Index> centers;
      for (std::size_t i = stride / 2; i < open.size(); i += stride) {
        centers.push_back(open[i]);
      }
      if (centers.empty()) {
        centers.push_back(open[0]);
      }
      const bool own_only = stride == 1;
      for (std::size_t begin = 0; begin < centers.size(); begin += kBatch) {
        const std::size_t batch = std::min<std::size_t>(kBatch, centers.size() - begin);
        std::vector<Fit> fits(batch);
        over(arranged, search, static_cast<Offset>(batch),
             [&](Fitter& fitter, Offset i) {
               fitter.load(centers[begin + i], count);
               share(fitter, own_only, fits[i].shares, fits[i].moves);
             });
        for (const Fit& fit : fits) {
          for (std::size_t k = 0; k < fit.shares.size(); ++k) {
            const Share& share = fit.shares[k];
            weights[share.sample] += share.weight;
            for (std::size_t axis = 0; axis < dim; ++axis) {
              moves[share.sample * dim + axis] +=
                  share.weight * fit.moves[k * dim + axis];
            }
          }
        }
      }
      open.erase(std::remove_if(open.begin(), open.end(),
                                [&](Index a) {
                                  const Index x = &arranged == &samples_
                                                      ? a
                                                      : arranged.input_index(a);
                                  return weights[x] >= kEnough;
                                }),
                 open.end());
      if (own_only) {
        break;
      }
      stride = std::max<Index>(1, stride / 4);
    }
    std::vector<double> points(size * dim);
    for (Index x = 0; x < size; ++x) {
      const double* from = samples_.point(x);
      for (std::size_t axis = 0; axis < dim; ++axis) {
        points[x * dim + axis] =
            from[axis] + (weights[x] > 0 ? moves[x * dim + axis] / weights[x] : 0.0);
      }
    }
    // Given samples that were moved to the same place stay there.
    if (&arranged != &samples_) {
      for (Index x = 0; x < size; ++x) {
        const Index first = arranged.representatives()[x];
        if (first != x) {
          std::copy_n(points.data() + first * dim, dim, points.data() + x * dim);
        }
      }
    }
    return points;
  }

  template <class Shares>
  void share(Fitter& fitter, bool own_only, Shares& shares,
             std::vector<double>& moves) const {
    if (!fitter.fit(fitter.size()) || !fitter.fit_to_part(noise_, size_of(0))) {
      return;
    }
    const LocalQuadric& quadric = fitter.quadric();
    const auto dim = static_cast<Eigen::Index>(samples_.ambient_dim());
    const double widest = kOwnSheet * kOwnSheet * quadric.variance();
    const Eigen::Index size = own_only ? 1 : quadric.squared_residuals().size();
    for (Eigen::Index i = 0; i < size; ++i) {
      const double ratio = quadric.tangential(i) / kBlend;
      const bool own = i == 0;
      if (!own && !(ratio < 1 && quadric.squared_residuals()[i] <= widest)) {
        continue;
      }
      const double rest = std::max(0.0, 1 - ratio * ratio);
      const double weight = own ? 1.0 : rest * rest * rest;
      shares.push_back({fitter.members()[i], weight});
      for (Eigen::Index axis = 0; axis < dim; ++axis) {
        moves.push_back(-quadric.residuals()(i, axis));
      }
    }
  }

  const Samples& samples_;
  const SmoothingOptions& options_;
  const Execution& execution_;
  int unknowns_;
  int num_axes_;
  /// Variance; neighborhoods with more scatter are looked at once more.
  double noise_ = kEverywhere;
};

}  // namespace

Offset num_noise_probes(Offset size) {
  return std::min<Offset>(size, kTestProbes + size / kSamplesPerTestProbe);
}

Offset noise_probe(Offset i, Offset size) {
  constexpr double golden = 0.6180339887498949;
  const double turn = static_cast<double>(i) * golden + 0.5;
  return static_cast<Offset>((turn - std::floor(turn)) * static_cast<double>(size));
}

std::vector<double> test_noise_at(const Samples& samples, const NeighborSearch& search,
                                  int dim, const std::vector<Index>& probes,
                                  const Execution& execution) {
  SmoothingOptions options;
  options.dim = dim;
  const std::vector<At> at =
      Smoother(samples, options, execution).test_at(search, probes);
  std::vector<double> values;
  for (const At& one : at) {
    values.insert(
        values.end(),
        {one.scatter, one.gain, one.difference, one.gain_difference, one.growth,
         one.radius, one.curvature, one.nearest, one.tie, one.thickness, one.wide});
  }
  return values;
}

bool shows_noise(const Samples& samples, int dim, const std::vector<double>& tests) {
  SmoothingOptions options;
  options.dim = dim;
  std::vector<At> at(tests.size() / kNoiseValues);
  for (std::size_t i = 0; i < at.size(); ++i) {
    const double* v = tests.data() + i * kNoiseValues;
    at[i] = {v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8], v[9], v[10]};
  }
  const Execution execution;
  return Smoother(samples, options, execution).shows_noise(at);
}

Smoothing smooth(const Samples& samples, const NeighborSearch& search,
                 const SmoothingOptions& options, const Execution& execution) {
  if (!samples.has_points()) {
    throw std::invalid_argument("smoothing needs points");
  }
  if (options.dim < 1 || options.dim > samples.ambient_dim()) {
    throw std::invalid_argument("dim is " + std::to_string(options.dim) +
                                ", expected 1 to " +
                                std::to_string(samples.ambient_dim()));
  }
  if (options.num_neighbors != 0 && options.num_neighbors < options.dim + 1) {
    throw std::invalid_argument(
        "num_neighbors is " + std::to_string(options.num_neighbors) +
        ", expected at least dim + 1 = " + std::to_string(options.dim + 1));
  }
  detail::begin_step(execution, Step::kSmoothing, 0);
  return Smoother(samples, options, execution).run(search);
}

}  // namespace remanifold
