// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "analysis/noise_level.h"
#include "analysis/samples/running.h"
#include "analysis/units.h"
#include "bench/records/looks.h"
#include "bench/records/record_data.h"
#include "daq/record_rules.h"

namespace strainwave::bench {
namespace {

using analysis::samples::Segment;

constexpr double kFewestRowsPerTurn = 4.0;

std::optional<double> SamplePeriod_s(const daq::Record& record) {
  if (record.FindColumn("time_s") == nullptr) {
    const std::optional<double> rate_hz = daq::MetadataNumber(record, "sample_rate_hz");
    return rate_hz ? std::optional(1.0 / *rate_hz) : std::nullopt;
  }
  const std::vector<double> time_s = record.CopyAsDoubles("time_s");
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < time_s.size(); ++i) steps_s.push_back(time_s[i] - time_s[i - 1]);
  return analysis::Median(std::move(steps_s));
}

// @param speed_rad_per_s  one a row, one for all, or none
Segment TurningRows(const daq::Record& record, const std::vector<double>& speed_rad_per_s) {
  const Segment all{0, record.rows()};
  if (speed_rad_per_s.empty()) return all;
  if (speed_rad_per_s.size() > 1) return analysis::samples::TurningBySpeed(speed_rad_per_s);
  const std::optional<double> period_s = SamplePeriod_s(record);
  if (!period_s || !(*period_s > 0.0)) return all;
  const double rows_per_turn = kTwoPi / (speed_rad_per_s.front() * *period_s);
  if (!(rows_per_turn >= kFewestRowsPerTurn)) return all;
  std::vector<std::vector<double>> channels;
  for (const std::string& name : VibrationChannelsOf(record)) channels.push_back(record.CopyAsDoubles(name));
  return analysis::samples::TurningByLines(channels, rows_per_turn);
}

}  // namespace

// A vibration that was switched on before the machine, or off after it: nothing of a standing machine is true
// of one that runs.
void LookAtRunning(daq::Record& record) {
  const std::size_t rows = record.rows();
  const std::vector<double> speed_rad_per_s = InputSpeedsOf_rad_per_s(record);
  const Segment turning = TurningRows(record, speed_rad_per_s);
  if (turning == Segment{0, rows}) return;
  const char* why = speed_rad_per_s.size() > 1
                        ? "its input speed is next to nothing"
                        : "the lines at 1 and 2 per turn of its input speed are not there";
  for (const Segment& left_out : {Segment{0, turning.first}, Segment{turning.end, rows}}) {
    if (left_out.first == left_out.end) continue;
    NoteAt(record, left_out.first,
           fmt::format("rows {} to {} are left out: the machine stands in them or some of them, {}",
                       left_out.first + 1, left_out.end, why));
  }
  std::vector<bool> kept(rows, false);
  for (std::size_t i = turning.first; i < turning.end; ++i) kept[i] = true;
  KeepRows(record, kept);
}

}  // namespace strainwave::bench
