// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "analysis/diagnosis/separable_study.h"

namespace strainwave::analysis::diagnosis {

/// Samples of transmission-error records, one after the other, as the terms need them.
struct TransmissionErrorSamples {
  std::vector<double> input_rad;
  std::vector<double> output_rad;  // by the input, from the measured angle at the record's first sample
  std::vector<double> error_rad;   // input / ratio − output
  std::vector<double> direction;   // +1 cw, −1 ccw
  std::vector<double> time_s;      // the sample's number where the record has no time
  std::vector<double> torque_Nm;
  std::vector<double> temperature_degC;
  std::vector<std::size_t> record;  // which record a sample belongs to
  std::size_t records{};
  bool has_time{};
  double ratio{80.0};
  double samples_per_turn{};  // of the output, where the steps are even; else 0
};

inline constexpr double kLargest_arcmin = 60.0;  // no gear that still turns errs by more

/// Appends the causes of docs/contract.md and those that docs/effects.md adds (tooth engagement, E2), then
/// the nuisance terms; a cause that the record did not excite is left out, with a warning.
void AddTransmissionErrorCauses(const TransmissionErrorSamples& samples, SeparableModel& model);

/// Whether the sweeps go by the same angle at several times, so that a curve over time is none over the
/// angle.
bool TimeIsApartFromAngle(const TransmissionErrorSamples& samples);

/// A drift over time whose law nobody knows: powers of time 1 to 4. @param rule  of the other forms of drift.
void AddCurveOfDrift(const TransmissionErrorSamples& samples, CauseRule rule, SeparableModel& model);

/// A damaged tooth on both flanks; where the sweeps go both ways, on either one, too.
void AddLocalDamages(const TransmissionErrorSamples& samples, SeparableModel& model);

/// Nuisance terms, which have no physical cause: free lines over the output angle, a ripple in a window,
/// levels in windows of output angle and time, curves over time and torque.
void AddTransmissionErrorNuisanceTerms(const TransmissionErrorSamples& samples, SeparableModel& model);

/// Standard deviation of the noise: of the differences between samples of different sweeps at the same output
/// angle where there are enough, else of second differences; known orders and drifts are taken off before.
double TransmissionErrorFloor_rad(const TransmissionErrorSamples& samples);

/// Cosine and sine of an order over an angle, as a term described by amplitude and phase.
SeparableTerm HarmonicTerm(const std::vector<double>& angle_rad, double order, std::string amplitude_name,
                           std::string unit, double unit_per_si);

/// One column that is given, scaled so that its coefficient reads in `description`'s unit.
SeparableTerm ColumnTerm(std::vector<double> column, NonlinearParameterDescription description);

}  // namespace strainwave::analysis::diagnosis
