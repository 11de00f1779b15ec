// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/record_results.h"

#include <cmath>
#include <initializer_list>
#include <numbers>

#include "analysis/units.h"
#include "daq/record_rules.h"

namespace strainwave::bench {
namespace {

namespace quantities = analysis::quantities;

bool AnglesAreAbsolute(const daq::Record& record) { return record.Metadata("absolute") == "true"; }

// Radians, zeroed at the first sample unless the record says that its angles are absolute.
std::vector<double> AngleColumn(const daq::Record& record, std::string_view column) {
  const auto angle_deg = record.Doubles(column);
  const double zero_deg = AnglesAreAbsolute(record) || angle_deg.empty() ? 0.0 : angle_deg.front();
  std::vector<double> angle_rad(angle_deg.size());
  for (std::size_t i = 0; i < angle_deg.size(); ++i) angle_rad[i] = RadFromDeg(angle_deg[i] - zero_deg);
  return angle_rad;
}

void TakeOff(const EncoderCorrection& correction, std::span<const double> encoder_deg,
             std::vector<double>& angle_rad) {
  if (correction.harmonics.empty() || angle_rad.empty()) return;
  const double first = correction.At(encoder_deg.front());
  for (std::size_t i = 0; i < angle_rad.size(); ++i) angle_rad[i] -= correction.At(encoder_deg[i]) - first;
}

double RootOfSquares(std::initializer_list<double> parts) {
  double sum = 0.0;
  for (const double part : parts) sum += part * part;
  return std::sqrt(sum);
}

double RepeatabilityOf(const BenchCorrections& corrections, std::string_view quantity) {
  const auto found = corrections.repeatability.find(quantity);
  return found == corrections.repeatability.end() ? 0.0 : found->second;
}

struct Sweep {
  std::vector<double> input_rad;
  std::vector<double> output_rad;
};

// What an angle is made of, as far as the encoder's errors go.
enum class AngleKind {
  kRange,   // difference of two readings
  kMean,    // mean over a turn
  kZeroed,  // depends on the angle of one sample
};

AngleKind KindOf(const analysis::Quantity& quantity) {
  const auto is = [&](const analysis::Quantity& one) { return quantity.name == one.name; };
  if (is(quantities::kEMax) || is(quantities::kEMaxCcw)) return AngleKind::kRange;
  return is(quantities::kEAvg) || is(quantities::kEAvgCcw) ? AngleKind::kZeroed : AngleKind::kMean;
}

}  // namespace

double EncoderCorrection::At(double reading_deg) const {
  double error_rad = 0.0;
  for (const Harmonic& harmonic : harmonics) {
    const double phase = harmonic.order * RadFromDeg(reading_deg);
    error_rad += harmonic.cosine_rad * std::cos(phase) + harmonic.sine_rad * std::sin(phase);
  }
  return error_rad;
}

bool KnowsCompliance(const BenchCorrections& corrections) {
  const analysis::Estimate& compliance = corrections.series_compliance.compliance_rad_per_Nm;
  return compliance.value != 0.0 || compliance.standard_error > 0.0;
}

analysis::TransmissionError TransmissionErrorOf(const daq::Record& record,
                                                const BenchCorrections& corrections) {
  const auto directions = record.Directions("direction");
  const std::vector<double> input_rad = AngleColumn(record, "input_angle_deg");
  std::vector<double> output_rad = AngleColumn(record, "output_angle_deg");
  TakeOff(corrections.encoder, record.Doubles("output_angle_deg"), output_rad);
  Sweep cw;
  Sweep ccw;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    Sweep& sweep = directions[i] == daq::Direction::kClockwise ? cw : ccw;
    sweep.input_rad.push_back(input_rad[i]);
    sweep.output_rad.push_back(output_rad[i]);
  }
  return analysis::ComputeTransmissionError({cw.input_rad, cw.output_rad}, {ccw.input_rad, ccw.output_rad},
                                            *daq::MetadataNumber(record, "ratio"));
}

analysis::TestTorques TestTorquesOf(const daq::Record& record) {
  return {*daq::MetadataNumber(record, "t1_Nm"), *daq::MetadataNumber(record, "t2_Nm"),
          *daq::MetadataNumber(record, "t3_Nm")};
}

analysis::TorsionalStiffness StiffnessOf(const daq::Record& record, analysis::StiffnessMethod method,
                                         const BenchCorrections& corrections) {
  const std::vector<double> twist_rad = AngleColumn(record, "output_angle_deg");
  const analysis::TorsionLoop loop{record.Doubles("time_s"), record.Doubles("torque_Nm"), twist_rad};
  const analysis::SeriesCompliance value_only{
      {corrections.series_compliance.compliance_rad_per_Nm.value, 0.0}};
  return analysis::MeasureStiffness(loop, TestTorquesOf(record), method, value_only, 0.0);
}

analysis::Estimate WithBenchUncertainty(const analysis::Estimate& stiffness, std::string_view quantity,
                                        const BenchCorrections& corrections) {
  const double from_gain = stiffness.value * corrections.torque_gain_relative_se;
  const double from_compliance =
      stiffness.value * stiffness.value * corrections.series_compliance.compliance_rad_per_Nm.standard_error;
  return {stiffness.value, RootOfSquares({stiffness.standard_error, from_gain, from_compliance,
                                          RepeatabilityOf(corrections, quantity)})};
}

analysis::Estimate WithEncoderUncertainty(const analysis::Estimate& angle_arcmin,
                                          const analysis::Quantity& quantity,
                                          const BenchCorrections& corrections) {
  const AngleKind kind = KindOf(quantity);
  // Half widths are those of rectangular distributions. An error of the reference is one of the corrected
  // encoder, at worst of opposite sign at the two readings of a range.
  const EncoderCorrection& encoder = corrections.encoder;
  const bool corrected = !encoder.harmonics.empty();
  const double reference_rad = corrected ? encoder.reference_accuracy_rad / std::sqrt(3.0) : 0.0;
  const double at_zero_rad =
      kind == AngleKind::kZeroed ? corrections.encoder_accuracy_rad / std::sqrt(3.0) : 0.0;
  const double of_range_rad =
      kind == AngleKind::kRange
          ? RootOfSquares({std::numbers::sqrt2 * encoder.residual_rad, 2.0 * reference_rad})
          : 0.0;
  return {angle_arcmin.value,
          RootOfSquares({angle_arcmin.standard_error, ArcminFromRad(encoder.standard_error_rad),
                         ArcminFromRad(at_zero_rad), ArcminFromRad(of_range_rad),
                         RepeatabilityOf(corrections, quantity.name)})};
}

}  // namespace strainwave::bench
