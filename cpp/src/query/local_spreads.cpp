// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/local_spreads.hpp"

#include "base/decompositions.hpp"
#include "base/parallel.hpp"
#include "base/per_thread.hpp"
#include "local/parabola.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace remanifold {
namespace {

constexpr Offset kBlock = 256;

/// One for each thread. D is the dimension of the space, or dynamic.
template <int D>
class SpreadKernel {
 public:
  SpreadKernel(const MatrixView& points, const std::vector<Index>& sizes,
               int num_spreads)
      : points_(points),
        sizes_(sizes),
        ambient_(static_cast<Eigen::Index>(points.cols)),
        num_spreads_(num_spreads) {}

  void measure(Index x, const Index* neighbors, double* out) {
    Eigen::Index known = 0;
    loaded_ = 0;
    vectors_.resize(ambient_, sizes_.back());
    sum_.setZero(ambient_);
    moments_.setZero(ambient_, ambient_);
    for (const Index size : sizes_) {
      load(x, neighbors, size);
      // Of the smaller of the two products, both have the same eigenvalues.
      if (ambient_ <= size + 1) {
        for (; known < size; ++known) {
          const auto vector = vectors_.col(known);
          sum_ += vector;
          moments_.template triangularView<Eigen::Lower>() +=
              vector * vector.transpose();
        }
        const double count = size + 1;
        product_ = moments_ / count - sum_ * sum_.transpose() / (count * count);
        if constexpr (D == Eigen::Dynamic) {
          solver_.compute(product_, Eigen::EigenvaluesOnly);
        } else {
          solver_.computeDirect(product_, Eigen::EigenvaluesOnly);
        }
        write(solver_.eigenvalues(), 1, out);
      } else {
        center(size);
        gram_solver_.compute(gram_, Eigen::EigenvaluesOnly);
        write(gram_solver_.eigenvalues(), 1.0 / (size + 1), out);
      }
      out += num_spreads_;
    }
  }

 private:
  using Square = Eigen::Matrix<double, D, D>;

  /// Vectors from x to its neighbors, in columns.
  void load(Index x, const Index* neighbors, Index size) {
    const double* px = points_.row(x);
    for (; loaded_ < size; ++loaded_) {
      const double* pq = points_.row(neighbors[loaded_]);
      for (Eigen::Index axis = 0; axis < ambient_; ++axis) {
        vectors_(axis, loaded_) = pq[axis] - px[axis];
      }
    }
  }

  /// Products of the vectors from the mean of all, x included.
  void center(Index size) {
    centered_.resize(ambient_, size + 1);
    centered_.col(0).setZero();
    centered_.rightCols(size) = vectors_.leftCols(size);
    const Eigen::VectorXd mean = centered_.rowwise().mean();
    centered_.colwise() -= mean;
    gram_.noalias() = centered_.transpose() * centered_;
  }

  /// \param values  ascending
  template <class Values>
  void write(const Values& values, double factor, double* out) const {
    std::fill_n(out, num_spreads_, 0.0);
    const auto count = std::min<Eigen::Index>(num_spreads_, values.size());
    for (Eigen::Index i = 0; i < count; ++i) {
      out[i] = std::sqrt(std::max(0.0, factor * values[values.size() - 1 - i]));
    }
  }

  const MatrixView& points_;
  const std::vector<Index>& sizes_;
  Eigen::Index ambient_;
  int num_spreads_;
  Index loaded_ = 0;
  Eigen::Matrix<double, D, Eigen::Dynamic> vectors_;
  Eigen::Matrix<double, D, 1> sum_;
  Square moments_;
  Square product_;
  Eigen::MatrixXd centered_;
  Eigen::MatrixXd gram_;
  Eigen::SelfAdjointEigenSolver<Square> solver_;
  detail::SymmetricEigen gram_solver_;
};

template <int D>
void measure_all(const MatrixView& points, const NeighborRows& rows,
                 const std::vector<Index>& sizes, int num_spreads,
                 const Execution& execution, std::vector<double>& out) {
  const std::size_t row_size = sizes.size() * num_spreads;
  detail::ThreadScratch<SpreadKernel<D>> kernels(
      [&] { return SpreadKernel<D>(points, sizes, num_spreads); });
  detail::for_each_block_uncounted(
      rows.count, kBlock, execution, [&](Offset begin, Offset end) {
        kernels.use([&](SpreadKernel<D>& kernel) {
          for (Offset i = begin; i < end; ++i) {
            kernel.measure(rows.samples[i], rows.neighbors + i * rows.width,
                           out.data() + i * row_size);
          }
        });
      });
}

}  // namespace

std::vector<double> local_spreads(const MatrixView& points, const NeighborRows& rows,
                                  const std::vector<Index>& sizes, int num_spreads,
                                  const Execution& execution) {
  std::vector<double> out(static_cast<std::size_t>(rows.count) * sizes.size() *
                          num_spreads);
  const auto run = points.cols == 2   ? measure_all<2>
                   : points.cols == 3 ? measure_all<3>
                                      : measure_all<Eigen::Dynamic>;
  run(points, rows, sizes, num_spreads, execution, out);
  return out;
}

std::vector<std::uint8_t> lie_on_curve(const MatrixView& points,
                                       const NeighborRows& rows,
                                       const Execution& execution) {
  if (rows.width < kCurveNeighbors) {
    throw std::invalid_argument("rows of " + std::to_string(rows.width) +
                                " neighbors, expected at least " +
                                std::to_string(kCurveNeighbors));
  }
  std::vector<std::uint8_t> out(static_cast<std::size_t>(rows.count));
  const auto point = [&](Index x) {
    return Eigen::Map<const Eigen::VectorXd>(points.row(x),
                                             static_cast<Eigen::Index>(points.cols));
  };
  detail::for_each_block_uncounted(
      rows.count, kBlock, execution, [&](Offset begin, Offset end) {
        detail::Chord chord;
        std::array<Index, kCurveNeighbors + 1> places;
        for (Offset i = begin; i < end; ++i) {
          places[0] = rows.samples[i];
          std::copy_n(rows.neighbors + i * rows.width, kCurveNeighbors,
                      places.begin() + 1);
          out[static_cast<std::size_t>(i)] = detail::lie_on_parabola(
              places,
              [&](Index a, Index b) { return (point(a) - point(b)).squaredNorm(); },
              chord);
        }
      });
  return out;
}

}  // namespace remanifold
