// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/noise_level.h"
#include "analysis/samples/stamps.h"

namespace strainwave::analysis::diagnosis {
namespace {

using samples::kGap;
constexpr double kEvenEnough = 0.01;          // of a step
constexpr std::size_t kShortestSegment = 40;  // samples of a segment that is of use

// Rows of a record that are kept, with their times.
struct Rows {
  std::vector<std::size_t> row;
  std::vector<double> time_s;
};

bool SameRow(const MotionData& record, std::size_t a, std::size_t b) {
  return record.position[a] == record.position[b] && record.torque[a] == record.torque[b] &&
         (record.velocity.empty() || record.velocity[a] == record.velocity[b]);
}

// Equal stamps on different rows, up to the next one.
void SpreadRepeated(std::vector<double>& time_s) {
  for (std::size_t i = 0; i < time_s.size();) {
    std::size_t next = i + 1;
    while (next < time_s.size() && !(time_s[next] > time_s[i])) ++next;
    // After the last stamps that differ there is nothing to measure a step by but the record's mean.
    const double mean = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
    const double span =
        next < time_s.size() ? time_s[next] - time_s[i] : mean * static_cast<double>(next - i);
    const double start = time_s[i];
    for (std::size_t k = i; k < next; ++k)
      time_s[k] = start + span * static_cast<double>(k - i) / static_cast<double>(next - i);
    i = next;
  }
}

Rows DistinctRows(const MotionData& record, const std::string& name, std::vector<std::string>& warnings) {
  Rows rows;
  const auto same = [&](std::size_t i) {
    return i > 0 && record.time_s[i] <= record.time_s[i - 1] && SameRow(record, i, i - 1);
  };
  std::size_t dropped = 0;
  for (std::size_t i = 0; i < record.time_s.size(); ++i) dropped += same(i) ? 1 : 0;
  // Where a coarse clock makes most stamps repeat, a row of equal values is the next sample of a coarse
  // column.
  const bool is_coarse = samples::RepeatedStamps(record.time_s) > 2 * dropped;
  if (is_coarse) dropped = 0;
  for (std::size_t i = 0; i < record.time_s.size(); ++i) {
    if (!is_coarse && same(i)) continue;
    rows.row.push_back(i);
    rows.time_s.push_back(record.time_s[i]);
  }
  const std::size_t repeated = samples::RepeatedStamps(rows.time_s);
  bool by_tick = repeated > 0;
  if (by_tick) {
    std::vector<double> even(rows.time_s);
    by_tick = samples::EvenWithinTicks(even);
    if (by_tick) {
      rows.time_s = std::move(even);
    } else {
      SpreadRepeated(rows.time_s);
    }
  }
  if (dropped > 0) {
    warnings.push_back(
        fmt::format("{}{} rows repeat the one before, time stamp and all: left out", name, dropped));
  }
  if (repeated > 0) {
    warnings.push_back(
        fmt::format("{}{} time stamps repeat the one before with other values: {}", name, repeated,
                    by_tick ? "within a tick of the clock of even steps, which take their place"
                            : "spread evenly up to the next one"));
  }
  return rows;
}

// Cubic through a point and its neighbours, with slopes from both sides (uneven steps).
double Interpolate(std::span<const double> time_s, std::span<const double> values, std::size_t i,
                   double at_s) {
  const auto slope = [&](std::size_t k) {
    if (k == 0) return (values[1] - values[0]) / (time_s[1] - time_s[0]);
    if (k + 1 == values.size()) return (values[k] - values[k - 1]) / (time_s[k] - time_s[k - 1]);
    const double left = time_s[k] - time_s[k - 1];
    const double right = time_s[k + 1] - time_s[k];
    return ((values[k] - values[k - 1]) / left * right + (values[k + 1] - values[k]) / right * left) /
           (left + right);
  };
  const double step = time_s[i + 1] - time_s[i];
  const double u = (at_s - time_s[i]) / step;
  const double m0 = slope(i) * step;
  const double m1 = slope(i + 1) * step;
  const double a = 2.0 * (values[i] - values[i + 1]) + m0 + m1;
  const double b = -3.0 * (values[i] - values[i + 1]) - 2.0 * m0 - m1;
  return values[i] + u * (m0 + u * (b + u * a));
}

std::vector<double> Resample(std::span<const double> time_s, std::span<const double> values, double step_s) {
  std::vector<double> even;
  const auto count = static_cast<std::size_t>((time_s.back() - time_s.front()) / step_s + 1e-6) + 1;
  even.reserve(count);
  std::size_t i = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double at = time_s.front() + static_cast<double>(k) * step_s;
    while (i + 2 < time_s.size() && time_s[i + 1] <= at) ++i;
    even.push_back(Interpolate(time_s, values, i, at));
  }
  return even;
}

std::vector<double> Pick(const std::vector<double>& column, std::span<const std::size_t> rows) {
  std::vector<double> picked;
  if (column.empty()) return picked;
  picked.reserve(rows.size());
  for (const std::size_t row : rows) picked.push_back(column[row]);
  return picked;
}

}  // namespace

std::vector<EvenSegment> EvenSegments(const MotionData& record, const std::vector<bool>& clipped,
                                      const std::string& name, std::vector<std::string>& warnings) {
  const Rows rows = DistinctRows(record, name, warnings);
  std::vector<EvenSegment> segments;
  if (rows.row.size() < kShortestSegment) return segments;
  std::vector<double> steps;
  for (std::size_t i = 1; i < rows.time_s.size(); ++i) steps.push_back(rows.time_s[i] - rows.time_s[i - 1]);
  const double step_s = Median(steps);
  std::vector<double> deviations;
  for (const double step : steps) deviations.push_back(std::abs(step / step_s - 1.0));
  const double jitter = 1.4826 * Median(deviations);

  // Do the stamps know more than the row's number? The white part of the position says.
  bool by_number = jitter < kEvenEnough;
  if (!by_number) {
    const std::vector<double> position = Pick(record.position, rows.row);
    by_number = WhiteNoiseLevel(position) < 0.8 * WhiteNoiseLevel(Resample(rows.time_s, position, step_s));
    warnings.push_back(fmt::format(
        "{}time stamps jitter by {:.2g} % of their step of {:.4g} ms: {}", name, 100.0 * jitter, 1e3 * step_s,
        by_number ? "taken as even, the position is smoother like that" : "brought onto even steps"));
  }

  std::size_t gaps = 0;
  std::size_t bridged = 0;
  for (std::size_t first = 0; first < rows.row.size();) {
    std::size_t last = first + 1;
    bool holes = false;
    while (last < rows.row.size() && steps[last - 1] <= kGap * step_s) {
      if (steps[last - 1] > 1.6 * step_s) holes = true, ++bridged;
      ++last;
    }
    if (last < rows.row.size()) ++gaps;
    const std::size_t count = last - first;
    if (count >= kShortestSegment) {
      const std::span<const std::size_t> picked(rows.row.data() + first, count);
      const std::span<const double> time(rows.time_s.data() + first, count);
      EvenSegment segment;
      segment.start_s = time.front();
      const bool as_they_are = by_number && !(holes && jitter < 0.2);
      segment.step_s = as_they_are ? (time.back() - time.front()) / static_cast<double>(count - 1) : step_s;
      segment.resampled = !as_they_are;
      const auto even = [&](const std::vector<double>& column) {
        const std::vector<double> values = Pick(column, picked);
        return as_they_are || values.empty() ? values : Resample(time, values, step_s);
      };
      segment.position = even(record.position);
      if (as_they_are) {
        std::vector<double> even_s;
        for (std::size_t i = 0; i < count; ++i) even_s.push_back(static_cast<double>(i) * segment.step_s);
        segment.stamp_error_s = StampError_s(even_s, segment.position);
      } else {
        segment.stamp_error_s = StampError_s(time, Pick(record.position, picked));
      }
      segment.torque = even(record.torque);
      segment.velocity = even(record.velocity);
      segment.temperature_degC = even(record.temperature_degC);
      segment.clipped.assign(segment.position.size(), false);
      for (std::size_t i = 0; i < count; ++i) {
        if (!clipped[picked[i]]) continue;
        const double at = as_they_are ? static_cast<double>(i) : (time[i] - time.front()) / step_s;
        for (const double k : {std::floor(at), std::ceil(at)}) {
          if (k < static_cast<double>(segment.clipped.size()))
            segment.clipped[static_cast<std::size_t>(k)] = true;
        }
      }
      segments.push_back(std::move(segment));
    }
    first = last;
  }
  if (gaps > 0) {
    warnings.push_back(
        fmt::format("{}{} gap{} of more than {} steps: what lies between is taken piece by piece", name, gaps,
                    gaps == 1 ? "" : "s", kGap));
  }
  if (bridged > 0 && jitter < 0.2) {
    warnings.push_back(fmt::format("{}{} samples are missing one or two at a time: bridged", name, bridged));
  }
  return segments;
}

}  // namespace strainwave::analysis::diagnosis
