// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/check_results.h"

#include <cmath>
#include <numeric>
#include <vector>

#include <fmt/core.h>

#include "daq/acquisition/sensor_checks.h"

namespace strainwave::bench {
namespace {

using daq::acquisition::CheckKind;
using daq::acquisition::CheckLimits;

constexpr double kArcminPerDegree = 60.0;
constexpr const char* kExpectedAngle = "expected_arcmin";

CheckKind KindOf(const daq::Record& record) {
  const std::string kind = record.Metadata("check").value_or("");
  if (kind == "shunt_check") return CheckKind::kShunt;
  return kind == "reference_check" ? CheckKind::kReference : CheckKind::kZero;
}

const char* UnitOfCheck(const daq::Record& record) {
  return KindOf(record) == CheckKind::kReference ? "arcmin" : "Nm";
}

double Number(const daq::Record& record, const std::string& key) {
  return daq::NumberFromText(record.Metadata(key).value_or("")).value_or(std::nan(""));
}

double MeanOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

struct CheckValues {
  std::vector<double> values;
  double zero_variance{};  // of the mean that was taken off
};

CheckValues ValuesOf(const daq::Record& record) {
  CheckValues readings;
  if (KindOf(record) == CheckKind::kReference) {
    const double ratio = Number(record, "ratio");
    const auto input_deg = record.Doubles("input_angle_deg");
    const auto output_deg = record.Doubles("output_angle_deg");
    for (std::size_t i = 0; i < input_deg.size(); ++i) {
      readings.values.push_back(kArcminPerDegree * (input_deg[i] / ratio - output_deg[i]));
    }
    return readings;
  }
  const auto shunt = record.Doubles("shunt");
  const auto torque_Nm = record.Doubles("torque_Nm");
  std::vector<double> without;
  for (std::size_t i = 0; i < shunt.size(); ++i) {
    (shunt[i] > 0.5 ? readings.values : without).push_back(torque_Nm[i]);
  }
  if (KindOf(record) == CheckKind::kZero) return {std::move(without), 0.0};
  if (without.empty()) return readings;
  const double zero_Nm = MeanOf(without);
  double squares = 0.0;
  for (const double torque : without) squares += (torque - zero_Nm) * (torque - zero_Nm);
  const double count = static_cast<double>(without.size());
  readings.zero_variance = squares / count / count;
  for (double& torque : readings.values) torque -= zero_Nm;
  return readings;
}

}  // namespace

bool IsSensorCheck(const daq::Record& record) { return record.Metadata("check").has_value(); }

std::string CheckQuantity(const daq::Record& record, const std::string& phase) {
  return fmt::format("{}_{}", phase, UnitOfCheck(record));
}

void SetExpected(daq::Record& record, double expected_arcmin) {
  record.SetMetadata(kExpectedAngle, expected_arcmin);
}

Result SensorCheckResult(const daq::Record& record, const std::string& phase) {
  const CheckValues readings = ValuesOf(record);
  const std::string unit = UnitOfCheck(record);
  CheckLimits limits{Number(record, "expected_" + unit), Number(record, "allowed_" + unit),
                     Number(record, "most_noise_" + unit)};
  // The first one of a campaign is what the others are held against.
  if (std::isnan(limits.expected) && !readings.values.empty()) limits.expected = MeanOf(readings.values);
  const auto judged = daq::acquisition::JudgeCheck(KindOf(record), readings.values, limits);
  return {CheckQuantity(record, phase), judged.mean,
          std::sqrt(judged.standard_error * judged.standard_error + readings.zero_variance),
          judged.passed ? "" : fmt::format("{} (in {})", judged.reason, unit)};
}

std::string AdviceAfter(const daq::Record& record) {
  switch (KindOf(record)) {
    case CheckKind::kZero:
      return "look for a torque that is locked in between the brakes and for a loose plug, then zero the "
             "amplifier or have the transducer calibrated";
    case CheckKind::kShunt:
      return "look at the transducer's cable, the supply of its bridge and the amplifier's gain, and at the "
             "shunt's value on the certificate; have the transducer calibrated";
    case CheckKind::kReference:
      return "a coupling has slipped or the gear has jumped a tooth: look at both couplings and both "
             "encoders "
             "before anything turns again";
  }
  return "";
}

}  // namespace strainwave::bench
