// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/blank_results.h"

#include <algorithm>
#include <cmath>

#include "analysis/series_compliance.h"
#include "analysis/units.h"

namespace strainwave::bench {
namespace {

constexpr const char* kSource = "blank test";

const daq::Record* Find(std::span<const NamedRecord> records, std::string_view name) {
  const auto found =
      std::ranges::find_if(records, [&](const NamedRecord& named) { return named.group.ends_with(name); });
  return found == records.end() ? nullptr : &found->record;
}

std::vector<double> Radians(std::span<const double> angle_deg) {
  std::vector<double> angle_rad;
  for (const double angle : angle_deg) angle_rad.push_back(RadFromDeg(angle));
  return angle_rad;
}

// Amplitude and phase as the two coefficients that the correction is made of; both have the amplitude's
// error.
void AddHarmonic(const analysis::Harmonic& harmonic, const char* cosine_name, const char* sine_name,
                 std::vector<Calibration>& calibrations) {
  const double amplitude = harmonic.amplitude.value;
  const double error = harmonic.amplitude.standard_error;
  calibrations.push_back(
      {cosine_name, amplitude * std::cos(harmonic.phase_rad.value), error, "rad", kSource});
  calibrations.push_back({sine_name, amplitude * std::sin(harmonic.phase_rad.value), error, "rad", kSource});
}

// Standard deviation of what the two harmonics leave of the encoder's error, noise included.
double Residual_rad(std::span<const double> encoder_rad, std::span<const double> reference_rad,
                    const analysis::EncoderError& error) {
  double sum = 0.0;
  double square_sum = 0.0;
  for (std::size_t i = 0; i < encoder_rad.size(); ++i) {
    const double left = encoder_rad[i] - reference_rad[i] - error.At(encoder_rad[i]);
    sum += left;
    square_sum += left * left;
  }
  const double count = static_cast<double>(encoder_rad.size());
  return std::sqrt(std::max(0.0, square_sum / count - sum * sum / (count * count)));
}

}  // namespace

std::vector<Calibration> BlankCalibrations(std::span<const NamedRecord> records) {
  std::vector<Calibration> calibrations;
  if (const daq::Record* ramp = Find(records, "blank_hysteresis_1")) {
    const auto line =
        analysis::FitSeriesCompliance(ramp->Doubles("torque_Nm"), Radians(ramp->Doubles("output_angle_deg")));
    calibrations.push_back({kBlankCalibrations[0], line.compliance.compliance_rad_per_Nm.value,
                            line.compliance.compliance_rad_per_Nm.standard_error, "rad/Nm", kSource});
  }
  if (const daq::Record* turn = Find(records, "blank_transmission_error")) {
    const std::vector<double> encoder_rad = Radians(turn->Doubles("output_angle_deg"));
    const std::vector<double> reference_rad = Radians(turn->Doubles("input_angle_deg"));
    const auto error = analysis::FitEncoderError(encoder_rad, reference_rad);
    AddHarmonic(error.once, kBlankCalibrations[1], kBlankCalibrations[2], calibrations);
    AddHarmonic(error.twice, kBlankCalibrations[3], kBlankCalibrations[4], calibrations);
    const double residual_rad = Residual_rad(encoder_rad, reference_rad, error);
    const double standard_error = residual_rad / std::sqrt(2.0 * static_cast<double>(encoder_rad.size()));
    calibrations.push_back({kBlankCalibrations[5], residual_rad, standard_error, "rad", kSource});
  }
  return calibrations;
}

void Apply(std::span<const Calibration> calibrations, BenchCorrections& corrections) {
  const auto find = [&](std::string_view name) -> const Calibration* {
    const auto found = std::ranges::find(calibrations, name, &Calibration::name);
    return found == calibrations.end() ? nullptr : &*found;
  };
  if (const Calibration* compliance = find(kBlankCalibrations[0])) {
    corrections.series_compliance.compliance_rad_per_Nm = {compliance->value, compliance->standard_error};
  }
  corrections.encoder.harmonics.clear();
  corrections.encoder.standard_error_rad = 0.0;
  if (const Calibration* residual = find(kBlankCalibrations[5])) {
    corrections.encoder.residual_rad = residual->value;
  }
  for (const int order : {1, 2}) {
    const auto place = static_cast<std::size_t>(2 * order - 1);
    const Calibration* cosine = find(kBlankCalibrations[place]);
    const Calibration* sine = find(kBlankCalibrations[place + 1]);
    if (cosine == nullptr || sine == nullptr) continue;
    corrections.encoder.harmonics.push_back({order, cosine->value, sine->value});
    corrections.encoder.standard_error_rad =
        std::hypot(corrections.encoder.standard_error_rad, cosine->standard_error);
  }
}

}  // namespace strainwave::bench
