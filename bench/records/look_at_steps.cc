// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "analysis/samples/holds.h"
#include "analysis/samples/resolution.h"
#include "bench/records/looks.h"
#include "daq/record_rules.h"

namespace strainwave::bench {
namespace {

constexpr double kFewSteps = 300.0;     // from end to end: what is told apart is a share of the whole
constexpr std::size_t kFewLevels = 20;  // of a whole record: it stands on steps, however seldom it takes one
constexpr double kGivesBack = -0.1;     // of all work that passes, over the record

void LookAtSteps(daq::Record& record, const char* column, const char* unit) {
  const std::vector<double> values = record.CopyAsDoubles(column);
  const std::set<double> levels(values.begin(), values.end());
  const bool few_levels = levels.size() > 1 && levels.size() <= kFewLevels;
  const double step = few_levels
                          ? (*levels.rbegin() - *levels.begin()) / static_cast<double>(levels.size() - 1)
                          : analysis::samples::QuantisationStep(values);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  if (!(step > 0.0) || *high - *low >= kFewSteps * step || !analysis::samples::StandsOnSteps(values, step))
    return;
  NoteOn(
      record,
      fmt::format("{} stands on steps of {:.3g} {}, {:.0f} from end to end: nothing finer can be told apart",
                  column, step, unit, (*high - *low) / step));
}

// An axis' and a vibration's study say so themselves.
void LookAtRange(daq::Record& record, const char* column, const char* unit) {
  for (const analysis::samples::Saturated& end :
       analysis::samples::FindSaturated(record.CopyAsDoubles(column))) {
    NoteOn(record, fmt::format("{} is saturated: {} samples read {:.4g} {} to the last digit, an end of its "
                               "range; what lies beyond is not in the record",
                               column, end.count, end.at, unit));
  }
}

// Friction takes work; an axis that gives back more than it takes is driven by a load, or one sign is
// swapped.
void LookAtWork(daq::Record& record) {
  const bool linear = daq::IsLinearAxis(record);
  const char* drive = linear ? "force_N" : "torque_Nm";
  if (record.FindColumn(drive) == nullptr) return;
  const std::vector<double> position = record.CopyAsDoubles(linear ? "position_m" : "position_rad");
  const std::vector<double> torque = record.CopyAsDoubles(drive);
  double work = 0.0;
  double passed = 0.0;
  for (std::size_t i = 1; i < position.size(); ++i) {
    const double part = 0.5 * (torque[i] + torque[i - 1]) * (position[i] - position[i - 1]);
    work += part;
    passed += std::abs(part);
  }
  if (!(work < kGivesBack * passed)) return;
  NoteOn(
      record,
      fmt::format("the axis gives back {:.0f} % of the work that passes, where friction takes some: a load "
                  "drives it, or {} or the position has the other sign",
                  -100.0 * work / passed, drive));
}

}  // namespace

void LookAtSteps(daq::Record& record) {
  if (record.kind == daq::RecordKind::kMotion) LookAtWork(record);
  if (record.kind != daq::RecordKind::kHysteresis) return;
  LookAtSteps(record, "output_angle_deg", "deg");
  LookAtSteps(record, "torque_Nm", "Nm");
  LookAtRange(record, "torque_Nm", "Nm");
  LookAtRange(record, "output_angle_deg", "deg");
}

}  // namespace strainwave::bench
