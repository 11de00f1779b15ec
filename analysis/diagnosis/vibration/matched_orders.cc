// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/matched_orders.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/diagnosis/vibration/impulse_train_match.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Complex = std::complex<double>;

constexpr double kDamping = 0.03;  // of the resonances that are tried; a match to twice or half of it is good
constexpr double kEdge = 4.0;      // half-widths of the resonance that count
constexpr std::size_t kPadding = 4;
constexpr std::size_t kSpeeds = 48;
constexpr std::size_t kFewestRatios = 24;
constexpr double kLeastNoise = 0.3;  // of the resonance's peak: bins that tell how large the noise is there

}  // namespace

ResonanceMatcher::ResonanceMatcher(const VibrationResidual& residual, const SpeedBand& band)
    : residual_(residual),
      run_(residual.samples().runs.front()),
      band_(band),
      filtered_(run_.channels.size(), std::vector<Complex>(run_.size())) {
  const std::size_t speeds = run_.speed_spread < 0.01 ? 1 : kSpeeds;
  double turned = 0.0;
  for (std::size_t i = 1; i < run_.size() && speeds_rad_per_s_.size() < speeds; ++i) {
    if (!band_.Holds(run_.speed_rad_per_s[i])) continue;
    turned += (run_.angle_rad[i] - run_.angle_rad[i - 1]) / kTwoPi;
    const auto next = [&] {
      return band_.turns * (static_cast<double>(speeds_rad_per_s_.size()) + 0.5) /
             static_cast<double>(speeds);
    };
    while (speeds_rad_per_s_.size() < speeds && turned >= next())
      speeds_rad_per_s_.push_back(run_.speed_rad_per_s[i]);
  }
}

OrderRange ResonanceMatcher::Range(const VibrationRun& run, const SpeedBand& band, double resonance_Hz,
                                   double reach, double widest) {
  const double natural = kTwoPi * resonance_Hz;
  const double to_next = 0.55 * widest * run.mean_speed_rad_per_s;
  const double edge = std::max(kEdge * kDamping * natural, to_next);
  const double first = std::max(0.5, (natural - edge) / band.fastest_rad_per_s - reach);
  const double highest = kPi / run.period_s / band.slowest_rad_per_s;
  return {first, std::max(first + 1.0, std::min(highest, (natural + edge) / band.slowest_rad_per_s + reach))};
}

MatchedOrders ResonanceMatcher::Match(double resonance_Hz, double reach, double widest) {
  const double natural = kTwoPi * resonance_Hz;
  const Complex step =
      std::exp(Complex(-kDamping * natural, natural * std::sqrt(1.0 - kDamping * kDamping)) * run_.period_s);
  const double half_width = kDamping * natural;
  const auto [first, last] = Range(run_, band_, resonance_Hz, reach, widest);
  const double centre = 0.5 * (first + last);
  // What is matched to a narrow resonance changes slowly beside it: a few samples a bandwidth are enough.
  const auto points = static_cast<std::size_t>(1.3 * (last - first) * run_.turns) + 8;
  const std::size_t size = std::bit_ceil(kPadding * points);
  const double angle_step = run_.angle_rad.back() / static_cast<double>(points);
  const Directions& directions = Directions::Table();
  std::vector<Complex> turns(run_.size());
  for (std::size_t i = 0; i < run_.size(); ++i) {
    if (band_.Holds(run_.speed_rad_per_s[i]))
      turns[i] = directions.After(-centre / kTwoPi * run_.angle_rad[i]);
  }

  MatchedOrders matched;
  matched.step = kTwoPi / (static_cast<double>(size) * angle_step);
  matched.per_order = 1.0 / matched.step;
  const auto below = static_cast<std::size_t>((centre - first) / matched.step);
  const auto above = static_cast<std::size_t>((last - centre) / matched.step);
  matched.first = centre - matched.step * static_cast<double>(below);
  matched.power.resize(below + above + 1, 0.0F);
  const double scale =
      angle_step * std::sqrt((1.0 - std::norm(step)) / (residual_.base().variance() * band_.turns)) / kTwoPi;
  Predict(natural, half_width, matched);
  MatchBackwards(residual_.side_by_side(0), step,
                 [&](std::size_t first_channel, std::size_t i, const InCommon& common) {
                   const std::size_t here = std::min(SideBySide::kTogether, filtered_.size() - first_channel);
                   for (std::size_t c = 0; c < here; ++c) {
                     const Complex own(common[c], -common[SideBySide::kTogether + c]);
                     filtered_[first_channel + c][i] = Product(own, turns[i]);
                   }
                 });
  for (const std::vector<Complex>& filtered : filtered_) {
    values_.assign(size, Complex{});
    std::size_t i = 0;
    for (std::size_t p = 0; p < points; ++p) {
      const double angle = angle_step * static_cast<double>(p);
      while (i + 2 < run_.size() && run_.angle_rad[i + 1] <= angle) ++i;
      const double gap = run_.angle_rad[i + 1] - run_.angle_rad[i];
      const double u = gap > 0.0 ? std::clamp((angle - run_.angle_rad[i]) / gap, 0.0, 1.0) : 0.0;
      values_[p] = scale * ((1.0 - u) * filtered[i] + u * filtered[i + 1]);
    }
    transform_.fwd(spectrum_, values_);
    std::vector<Complex> lines(matched.power.size());
    // Phases from the middle of the record, so that they change slowly with the order.
    const double turn = 0.5 * matched.step * run_.angle_rad.back();
    const Complex further = std::polar(1.0, turn);
    Complex back = std::polar(1.0, -turn * static_cast<double>(below));
    for (std::size_t k = 0; k < lines.size(); ++k) {
      lines[k] = Product(spectrum_[(size + k - below) % size], back);
      back = Product(back, further);
    }
    const double relative_noise = RelativeNoise(lines, matched);
    const double noise_amplitude = std::sqrt(relative_noise);
    matched.relative_noise += relative_noise / static_cast<double>(run_.channels.size());
    std::vector<std::complex<float>>& own = matched.of_channel.emplace_back(lines.size());
    for (std::size_t k = 0; k < lines.size(); ++k) {
      own[k] = lines[k] / noise_amplitude;
      matched.power[k] += std::norm(own[k]);
    }
  }
  return matched;
}

void ResonanceMatcher::Predict(double natural, double half_width, MatchedOrders& matched) const {
  matched.noise.assign(matched.power.size(), 0.0F);
  constexpr std::size_t kEvery = 8;  // bins; the noise is smooth
  const auto speeds = static_cast<double>(speeds_rad_per_s_.size());
  for (const double speed : speeds_rad_per_s_) {
    for (std::size_t k = 0; k < matched.noise.size(); k += kEvery) {
      const double order = matched.first + matched.step * static_cast<double>(k);
      const double off = (order * speed - natural) / half_width;
      matched.noise[k] += static_cast<float>(speed / (kPi * half_width * (1.0 + off * off)) / speeds);
    }
  }
  for (std::size_t k = 0; k < matched.noise.size(); ++k)
    matched.noise[k] = matched.noise[k / kEvery * kEvery];
}

double ResonanceMatcher::RelativeNoise(const std::vector<Complex>& lines, const MatchedOrders& matched) {
  const float least = static_cast<float>(kLeastNoise) * std::ranges::max(matched.noise);
  ratios_.clear();
  for (std::size_t k = 0; k < lines.size(); k += kPadding) {
    if (matched.noise[k] < least) continue;
    ratios_.push_back(std::norm(lines[k]) / static_cast<double>(matched.noise[k]));
  }
  if (ratios_.size() < kFewestRatios) return 1.0;
  const auto middle = ratios_.begin() + static_cast<std::ptrdiff_t>(ratios_.size() / 2);
  std::ranges::nth_element(ratios_, middle);
  return std::max(*middle / std::numbers::ln2, 1e-300);
}

}  // namespace strainwave::analysis::diagnosis
