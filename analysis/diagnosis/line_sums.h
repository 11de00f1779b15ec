// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::analysis::diagnosis {

/// Weighted sums over samples, of which a line's least squares with a floating mean consist: of a residual y,
/// of c = cos and s = sin of order × angle, and of their products.
struct LineSums {
  double w, y, c, s, yc, ys, cc, ss, cs;

  /// Of the weighted sum of squares, by the line.
  double Drop() const;
};

/// Drops by lines near one order, made in one pass over the samples. Each segment of the angle has sums of
/// its own, and their moments about its middle: a line of another order turns the segment as a whole, and
/// within it by so little that powers up to the third are exact to 1e-11.
class LineSumsNear {
 public:
  /// @param reach  the farthest of these lines; reach times the angle's span is no more than a quarter turn
  LineSumsNear(std::span<const double> angle_rad, std::span<const double> residual,
               std::span<const double> weights, double order, double reach);

  double Drop(double order) const;

 private:
  static constexpr std::size_t kSegments = 512;
  static constexpr std::size_t kPowers = 4;
  using Moments = std::array<std::complex<double>, kPowers>;
  /// Sums of what each sample has, times powers of reach · (its angle beside the segment's middle).
  struct Segment {
    Moments lines{};
    Moments data{};
    Moments doubled{};  // of twice the order; twice the reach
  };

  double order_{};
  double reach_{};
  double first_rad_{};
  double length_rad_{};
  double weight_{};
  double value_{};
  std::vector<Segment> segments_;
};

}  // namespace strainwave::analysis::diagnosis
