// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/running_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace strainwave::daq::acquisition {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

RunningStatistics::RunningStatistics(const Moments& moments) noexcept
    : count_(static_cast<std::uint64_t>(moments.count)),
      mean_(moments.mean),
      m2_(moments.second * moments.count),
      m3_(moments.third * moments.count),
      m4_(moments.fourth * moments.count),
      least_(moments.least),
      most_(moments.most) {}

RunningStatistics::Moments RunningStatistics::moments() const noexcept {
  if (count_ == 0) return {};
  const auto n = static_cast<double>(count_);
  return {n, mean_, m2_ / n, m3_ / n, m4_ / n, least_, most_};
}

void RunningStatistics::Add(double value) noexcept {
  if (!std::isfinite(value)) {
    ++not_finite_;
    return;
  }
  least_ = count_ == 0 ? value : std::min(least_, value);
  most_ = count_ == 0 ? value : std::max(most_, value);
  const auto before = static_cast<double>(count_);
  const double n = static_cast<double>(++count_);
  const double change = value - mean_;
  const double part = change / n;
  const double part2 = part * part;
  const double term = change * part * before;
  mean_ += part;
  m4_ += term * part2 * (n * n - 3 * n + 3) + 6 * part2 * m2_ - 4 * part * m3_;
  m3_ += term * part * (n - 2) - 3 * part * m2_;
  m2_ += term;
}

void RunningStatistics::Merge(const RunningStatistics& other) noexcept {
  not_finite_ += other.not_finite_;
  if (other.count_ == 0) return;
  if (count_ == 0) {
    const std::uint64_t not_finite = not_finite_;
    *this = other;
    not_finite_ = not_finite;
    return;
  }
  const auto a = static_cast<double>(count_), b = static_cast<double>(other.count_);
  const double n = a + b;
  const double d = other.mean_ - mean_;
  const double d2 = d * d;
  m4_ += other.m4_ + d2 * d2 * a * b * (a * a - a * b + b * b) / (n * n * n) +
         6 * d2 * (a * a * other.m2_ + b * b * m2_) / (n * n) + 4 * d * (a * other.m3_ - b * m3_) / n;
  m3_ += other.m3_ + d2 * d * a * b * (a - b) / (n * n) + 3 * d * (a * other.m2_ - b * m2_) / n;
  m2_ += other.m2_ + d2 * a * b / n;
  mean_ += d * b / n;
  count_ += other.count_;
  least_ = std::min(least_, other.least_);
  most_ = std::max(most_, other.most_);
}

double RunningStatistics::mean() const { return count_ == 0 ? kNan : mean_; }
double RunningStatistics::variance() const { return count_ == 0 ? kNan : m2_ / static_cast<double>(count_); }
double RunningStatistics::rms() const { return std::sqrt(mean() * mean() + variance()); }
double RunningStatistics::least() const { return count_ == 0 ? kNan : least_; }
double RunningStatistics::most() const { return count_ == 0 ? kNan : most_; }
double RunningStatistics::peak() const {
  return count_ == 0 ? kNan : std::max(std::abs(least_), std::abs(most_));
}
double RunningStatistics::crest_factor() const { return rms() > 0 ? peak() / rms() : kNan; }
double RunningStatistics::kurtosis() const {
  return m2_ > 0 ? static_cast<double>(count_) * m4_ / (m2_ * m2_) : kNan;
}

void AddBlock(const SampleBlock& block, std::span<RunningStatistics> channels) {
  if (block.header.channels != channels.size()) {
    throw std::invalid_argument(
        fmt::format("a block of {} channels, {} expected", block.header.channels, channels.size()));
  }
  for (std::size_t i = 0; i < block.header.samples; ++i) {
    for (std::size_t c = 0; c < channels.size(); ++c) channels[c].Add(block.Value(i, c));
  }
}

}  // namespace strainwave::daq::acquisition
