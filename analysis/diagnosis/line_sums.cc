// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/line_sums.h"

#include <algorithm>

#include "analysis/diagnosis/phasors.h"

namespace strainwave::analysis::diagnosis {

using Complex = std::complex<double>;

double LineSums::Drop() const {
  if (!(w > 0.0)) return 0.0;
  const double own_yc = yc - y * c / w;
  const double own_ys = ys - y * s / w;
  const double own_cc = cc - c * c / w;
  const double own_ss = ss - s * s / w;
  const double own_cs = cs - c * s / w;
  const double determinant = own_cc * own_ss - own_cs * own_cs;
  // Where cosine and sine fall together (a folded order at a symmetric place) one of them is left.
  if (determinant < 1e-9 * w * w) {
    const double left = std::max(own_cc, own_ss);
    const double common = own_cc > own_ss ? own_yc : own_ys;
    return left > 1e-9 * w ? common * common / left : 0.0;
  }
  return (own_ss * own_yc * own_yc + own_cc * own_ys * own_ys - 2.0 * own_cs * own_yc * own_ys) / determinant;
}

LineSumsNear::LineSumsNear(std::span<const double> angle_rad, std::span<const double> residual,
                           std::span<const double> weights, double order, double reach)
    : order_(order), reach_(reach), segments_(kSegments) {
  const auto [low, high] = std::ranges::minmax(angle_rad);
  first_rad_ = low;
  length_rad_ = (high - low) / static_cast<double>(kSegments);
  const double per_length = length_rad_ > 0.0 ? 1.0 / length_rad_ : 0.0;
  ForEachPhasor(angle_rad, order, [&](std::size_t i, Complex phasor) {
    const double w = weights[i];
    if (!(w > 0.0)) return;
    const double along = (angle_rad[i] - first_rad_) * per_length;
    const std::size_t s = std::min(kSegments - 1, static_cast<std::size_t>(along));
    const double beside = (along - static_cast<double>(s) - 0.5) * length_rad_ * reach_;
    Complex lines = w * phasor;
    Complex data = residual[i] * lines;
    Complex doubled = Product(lines, phasor);
    weight_ += w;
    value_ += w * residual[i];
    for (std::size_t power = 0; power < kPowers; ++power) {
      segments_[s].lines[power] += lines;
      segments_[s].data[power] += data;
      segments_[s].doubled[power] += doubled;
      lines *= beside;
      data *= beside;
      doubled *= 2.0 * beside;
    }
  });
}

double LineSumsNear::Drop(double order) const {
  const double further = order - order_;
  const double share = further / reach_;
  Moments factors{1.0};  // (i · share)ᵏ / k!
  for (std::size_t power = 1; power < kPowers; ++power)
    factors[power] = factors[power - 1] * Complex(0.0, share / static_cast<double>(power));
  const auto sum_of = [&factors](const Moments& moments) {
    Complex sum = 0.0;
    for (std::size_t power = 0; power < kPowers; ++power) sum += Product(factors[power], moments[power]);
    return sum;
  };
  Complex lines = 0.0;
  Complex data = 0.0;
  Complex doubled = 0.0;
  for (std::size_t s = 0; s < kSegments; ++s) {
    const double middle_rad = first_rad_ + (static_cast<double>(s) + 0.5) * length_rad_;
    const Complex turn = std::polar(1.0, further * middle_rad);
    lines += Product(turn, sum_of(segments_[s].lines));
    data += Product(turn, sum_of(segments_[s].data));
    doubled += Product(Product(turn, turn), sum_of(segments_[s].doubled));
  }
  return LineSums{.w = weight_,
                  .y = value_,
                  .c = lines.real(),
                  .s = lines.imag(),
                  .yc = data.real(),
                  .ys = data.imag(),
                  .cc = 0.5 * (weight_ + doubled.real()),
                  .ss = 0.5 * (weight_ - doubled.real()),
                  .cs = 0.5 * doubled.imag()}
      .Drop();
}

}  // namespace strainwave::analysis::diagnosis
