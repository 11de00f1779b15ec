// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/clock_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace strainwave::daq::acquisition {
namespace {

constexpr double kNs_per_s = 1e9;

// How densely pairs lie just above the line says how far below them the truth may be. With a mean distance m
// between them the lowest is within 3 m in 95 of 100 cases, if they lie as densely at the edge as further up;
// two delays in series thin out towards the edge, and 5 m holds for them as well.
constexpr double kCoverage = 5.0;
constexpr std::size_t kFew = 16;  // one of so many tells the density
// A machine that becomes slower adds to every delay from a moment on, which tilts the line. Then not each part
// of the time has a pair near it: how far the furthest part stays away counts twice. Of a step in the middle
// of the time, which tilts most, that is twice the drift it feigns.
constexpr std::size_t kParts = 4;
constexpr double kPartCoverage = 2.0;

}  // namespace

std::chrono::nanoseconds ClockEstimate::ToHost(std::chrono::nanoseconds device) const noexcept {
  const std::chrono::nanoseconds since = device - device_time;
  return host_time + since +
         std::chrono::nanoseconds(std::llround(drift * static_cast<double>(since.count())));
}

ClockModel::ClockModel(ClockModelSettings settings) : settings_(settings) {
  if (settings.segment.count() <= 0 || settings.most_segments < 2) {
    throw std::invalid_argument(
        fmt::format("segment = {} ns and most_segments = {} are not above zero and one",
                    settings.segment.count(), settings.most_segments));
  }
  kept_.resize(settings.most_segments);
  ordered_.reserve(settings.most_segments);
  hull_.reserve(settings.most_segments);
  above_.reserve(settings.most_segments);
}

// How much later than the line says, in ns; without a line, the plain difference.
double ClockModel::DelayAbove(const Pair& pair) const noexcept {
  const auto delay = static_cast<double>(pair.delay_ns);
  if (!estimate_) return delay;
  const std::int64_t line_ns =
      estimate_->ToHost(std::chrono::nanoseconds(pair.device_ns)).count() - pair.device_ns;
  return static_cast<double>(pair.delay_ns - line_ns);
}

void ClockModel::Add(std::chrono::nanoseconds device_time, std::chrono::nanoseconds arrival) noexcept {
  const Pair pair{device_time.count(), (arrival - device_time).count()};
  if (last_) {
    const std::int64_t step_ns = std::abs(pair.delay_ns - last_->delay_ns);
    if (pair.device_ns < last_->device_ns || step_ns > settings_.longest_delay.count()) {
      ++restarts_;
      count_ = next_ = 0;
      pairs_ = 0;
      quickest_.reset();
      estimate_.reset();
    }
  }
  last_ = pair;
  ++pairs_;
  if (!quickest_) segment_begin_ns_ = pair.device_ns;
  if (quickest_ && pair.device_ns - segment_begin_ns_ >= settings_.segment.count()) {
    CloseSegment();
    segment_begin_ns_ = pair.device_ns;
  }
  if (!quickest_ || DelayAbove(pair) < DelayAbove(*quickest_)) quickest_ = pair;
}

void ClockModel::CloseSegment() noexcept {
  kept_[next_] = *quickest_;
  next_ = (next_ + 1) % kept_.size();
  count_ = std::min(count_ + 1, kept_.size());
  quickest_.reset();
  if (count_ >= 2) Fit();
}

void ClockModel::Fit() noexcept {
  ordered_.clear();
  const std::size_t oldest = (next_ + kept_.size() - count_) % kept_.size();
  for (std::size_t i = 0; i < count_; ++i) ordered_.push_back(kept_[(oldest + i) % kept_.size()]);
  // Relative to the first pair, so that doubles hold every nanosecond.
  const Pair origin = ordered_.front();
  const auto x = [&](const Pair& pair) { return static_cast<double>(pair.device_ns - origin.device_ns); };
  const auto y = [&](const Pair& pair) { return static_cast<double>(pair.delay_ns - origin.delay_ns); };
  hull_.clear();
  double mean_x = 0;
  for (const Pair& pair : ordered_) {
    mean_x += x(pair) / static_cast<double>(count_);
    while (hull_.size() >= 2) {
      const Pair& a = hull_[hull_.size() - 2];
      const Pair& b = hull_.back();
      if ((y(b) - y(a)) * (x(pair) - x(a)) < (y(pair) - y(a)) * (x(b) - x(a))) break;
      hull_.pop_back();
    }
    hull_.push_back(pair);
  }
  // Of all lines below the pairs the one with the least sum of distances is the edge over their mean.
  std::size_t edge = 0;
  while (edge + 2 < hull_.size() && x(hull_[edge + 1]) < mean_x) ++edge;
  const Pair& a = hull_[edge];
  const Pair& b = hull_[edge + 1];
  const double slope = (y(b) - y(a)) / (x(b) - x(a));
  const double at_mean = y(a) + slope * (mean_x - x(a));

  above_.clear();
  for (const Pair& pair : ordered_) above_.push_back(y(pair) - at_mean - slope * (x(pair) - mean_x));
  double furthest_ns = 0.0;
  for (std::size_t part = 0; part < kParts; ++part) {
    const auto begin = above_.begin() + static_cast<std::ptrdiff_t>(part * count_ / kParts);
    const auto end = above_.begin() + static_cast<std::ptrdiff_t>((part + 1) * count_ / kParts);
    if (begin != end) furthest_ns = std::max(furthest_ns, *std::min_element(begin, end));
  }
  const std::size_t few = std::min(std::max<std::size_t>(2, count_ / kFew), count_ - 1);
  std::nth_element(above_.begin(), above_.begin() + static_cast<std::ptrdiff_t>(few), above_.end());
  // A half of the pairs pins each end of the edge; beyond its ends the line swings.
  const double edge_ns = x(b) - x(a);
  const double end_ns =
      std::max(kCoverage * 2 * above_[few] / static_cast<double>(few), kPartCoverage * furthest_ns);
  const double beyond_ns = std::max(x(a), x(ordered_.back()) - x(b));
  const auto mean_device_ns = origin.device_ns + std::llround(mean_x);
  const auto host_ns =
      mean_device_ns + origin.delay_ns + std::llround(at_mean) - settings_.least_delay.count();
  estimate_ = ClockEstimate{std::chrono::nanoseconds(mean_device_ns),
                            std::chrono::nanoseconds(host_ns),
                            slope,
                            end_ns * (1 + 2 * beyond_ns / edge_ns) / kNs_per_s,
                            2 * end_ns / edge_ns,
                            static_cast<std::size_t>(pairs_)};
}

}  // namespace strainwave::daq::acquisition
