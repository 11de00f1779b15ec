// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "analysis/noise_level.h"
#include "analysis/samples/holds.h"
#include "analysis/samples/resolution.h"
#include "bench/records/looks.h"
#include "daq/record_rules.h"

namespace strainwave::bench {
namespace {

namespace samples = analysis::samples;

constexpr std::size_t kFewestRows = 3;  // of one reading: two meet by chance
constexpr double kLeastExcess = 0.005;  // of the reading: drives agree with their encoders to a few tenths
constexpr double kClear = 4.0;          // standard errors

// What the position went while the velocity read `end` all the time, over what the velocity says.
struct AtTheEnd {
  std::size_t rows{};
  double excess{};  // mean, in the velocity's unit and the direction of `end`
  double error{};   // standard error of that, by the position's noise
};

AtTheEnd GoesOnAt(double end, std::span<const samples::Frozen> runs, std::span<const double> time_s,
                  std::span<const double> position, std::span<const double> velocity, double noise) {
  AtTheEnd found;
  double way = 0.0;
  double span_s = 0.0;
  double variance = 0.0;
  for (const samples::Frozen& run : runs) {
    if (velocity[run.first] != end) continue;
    const std::size_t last = run.first + run.count - 1;
    found.rows += run.count;
    way += position[last] - position[run.first];
    span_s += time_s[last] - time_s[run.first];
    variance += 2.0 * noise * noise;
  }
  if (!(span_s > 0.0)) return {};
  found.excess = std::copysign(1.0, end) * (way / span_s - end);
  found.error = std::sqrt(variance) / span_s;
  return found;
}

}  // namespace

void LookAtVelocity(daq::Record& record) {
  const bool linear = daq::IsLinearAxis(record);
  const char* name = linear ? "velocity_m_per_s" : "velocity_rad_per_s";
  if (record.kind != daq::RecordKind::kMotion || record.FindColumn(name) == nullptr) return;
  const std::vector<double> time_s = record.CopyAsDoubles("time_s");
  const std::vector<double> position = record.CopyAsDoubles(linear ? "position_m" : "position_rad");
  const std::vector<double> velocity = record.CopyAsDoubles(name);
  const double noise = analysis::EstimateNoise(position).standard_deviation;
  const double step = samples::QuantisationStep(velocity);
  const std::vector<samples::Frozen> runs = samples::StandingSegments(velocity, kFewestRows);
  const auto [low, high] = std::minmax_element(velocity.begin(), velocity.end());
  for (const double end : {*low, *high}) {
    const AtTheEnd there = GoesOnAt(end, runs, time_s, position, velocity, noise);
    const double least = std::max({kLeastExcess * std::abs(end), step, kClear * there.error});
    if (there.rows == 0 || !(there.excess > least)) continue;
    NoteOn(record,
           fmt::format("{} is saturated: {} samples read {:.4g}, an end of its range, while the position "
                       "goes on by {:.4g} a second: it is left out, the position tells the velocity",
                       name, there.rows, end, end + std::copysign(there.excess, end)));
    std::erase_if(record.columns, [&](const daq::Column& column) { return column.name == name; });
    return;
  }
}

}  // namespace strainwave::bench
