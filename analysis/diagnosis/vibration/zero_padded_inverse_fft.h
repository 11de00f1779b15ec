// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace strainwave::analysis::diagnosis {

/// Several lists of lines, each summed with the phases of even points: ∑ₖ lineₖ exp(2πi k p / points) for
/// every point p, by a fast transform that has the lists side by side in vectors.
class ZeroPaddedInverseFft {
 public:
  static constexpr std::size_t kLists = 8;

  /// All lines zero.
  /// @param points  a power of two
  void Clear(std::size_t points);
  std::size_t points() const { return points_; }

  /// @param k  below half the points, or zero
  void Set(std::size_t list, std::size_t k, std::complex<float> line) {
    real_[k * kLists + list] = line.real();
    imaginary_[k * kLists + list] = line.imag();
  }

  /// The sums take the place of the lines.
  void Sum();

  /// By point, then by list.
  const std::vector<float>& real() const { return real_; }
  const std::vector<float>& imaginary() const { return imaginary_; }

 private:
  std::size_t points_{};
  std::size_t turned_{};  // points that the directions are for
  std::vector<std::complex<float>> directions_;
  std::vector<float> real_;
  std::vector<float> imaginary_;
  std::vector<float> next_real_;
  std::vector<float> next_imaginary_;
};

}  // namespace strainwave::analysis::diagnosis
