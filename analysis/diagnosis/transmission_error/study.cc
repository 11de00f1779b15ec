// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "analysis/diagnosis/records.h"
#include "analysis/diagnosis/temperature.h"
#include "analysis/diagnosis/transmission_error/folded_orders.h"
#include "analysis/diagnosis/transmission_error/terms.h"
#include "analysis/harmonic_regression.h"
#include "analysis/mean_over_angle.h"
#include "analysis/noise_level.h"
#include "analysis/quantities.h"
#include "analysis/samples/resolution.h"
#include "analysis/transmission_orders.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kLeastSamples = 60;
constexpr double kLeastTravel_rad = 0.5 * kPi;

void RequireSomethingToHoldOut(const TransmissionErrorData& record) {
  const auto [low, high] =
      std::minmax_element(record.output_angle_rad.begin(), record.output_angle_rad.end());
  if (record.output_angle_rad.size() < kLeastSamples) {
    throw std::invalid_argument(
        fmt::format("the record is too short to hold anything out: {} samples (expected at "
                    "least {})",
                    record.output_angle_rad.size(), kLeastSamples));
  }
  if (!(*high > *low)) {
    throw std::invalid_argument("output_angle_deg is constant (expected a sweep over the output)");
  }
  if (*high - *low < kLeastTravel_rad) {
    throw std::invalid_argument(
        fmt::format("the output turns by {:.1f} deg only (expected at least {:.0f} deg)",
                    DegFromRad(*high - *low), DegFromRad(kLeastTravel_rad)));
  }
}

TransmissionErrorSamples Join(std::span<const TransmissionErrorData> records) {
  TransmissionErrorSamples all;
  all.records = records.size();
  all.ratio = records.front().ratio;
  all.has_time = std::all_of(records.begin(), records.end(), [](const auto& r) { return !r.time_s.empty(); });
  const bool torque =
      std::all_of(records.begin(), records.end(), [](const auto& r) { return !r.torque_Nm.empty(); });
  const bool temperature =
      std::all_of(records.begin(), records.end(), [](const auto& r) { return !r.temperature_degC.empty(); });
  for (std::size_t k = 0; k < records.size(); ++k) {
    const TransmissionErrorData& record = records[k];
    RequireSomethingToHoldOut(record);
    if (record.ratio != all.ratio) {
      throw std::invalid_argument(
          fmt::format("records of ratio {} and {} together (expected one ratio)", all.ratio, record.ratio));
    }
    if (temperature) {
      const std::vector<double> slow_degC = SlowTemperature(record.temperature_degC);
      all.temperature_degC.insert(all.temperature_degC.end(), slow_degC.begin(), slow_degC.end());
    }
    for (std::size_t i = 0; i < record.output_angle_rad.size(); ++i) {
      all.input_rad.push_back(record.input_angle_rad[i]);
      // Where the output was bound to be, without the error: the measured angle carries the response into all
      // that is a function of it, and at as many orders a turn as there are samples that is the error itself.
      all.output_rad.push_back(record.output_angle_rad[0] +
                               (record.input_angle_rad[i] - record.input_angle_rad[0]) / record.ratio);
      const double input = record.input_angle_rad[i] - (record.absolute ? 0.0 : record.input_angle_rad[0]);
      const double output = record.output_angle_rad[i] - (record.absolute ? 0.0 : record.output_angle_rad[0]);
      all.error_rad.push_back(input / record.ratio - output);
      all.direction.push_back(record.direction[i] > 0 ? 1.0 : -1.0);
      all.time_s.push_back(all.has_time ? record.time_s[i] : static_cast<double>(i));
      if (torque) all.torque_Nm.push_back(record.torque_Nm[i]);
      all.record.push_back(k);
    }
  }
  return all;
}

// Where the steps of all sweeps are even within a twentieth; else 0.
double SamplesPerTurn(const TransmissionErrorSamples& samples) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < samples.output_rad.size(); ++i) {
    if (samples.direction[i] == samples.direction[i - 1] && samples.record[i] == samples.record[i - 1]) {
      steps.push_back(std::abs(samples.output_rad[i] - samples.output_rad[i - 1]));
    }
  }
  if (steps.empty()) return 0.0;
  const double step = Median(steps);
  const auto uneven = std::count_if(steps.begin(), steps.end(),
                                    [&](double here) { return std::abs(here - step) > 0.05 * step; });
  if (!(step > 0.0) || uneven * 20 >= static_cast<std::ptrdiff_t>(steps.size())) return 0.0;
  // The mean step, without the gaps; a division of the turn where it is one.
  double sum = 0.0;
  for (const double here : steps) sum += std::abs(here - step) > 0.05 * step ? step : here;
  const double per_turn = kTwoPi * static_cast<double>(steps.size()) / sum;
  const double whole = std::round(per_turn);
  return std::abs(per_turn - whole) < 2e-3 * whole ? whole : per_turn;
}

std::vector<std::size_t> SegmentsOf(const TransmissionErrorSamples& samples) {
  std::vector<std::size_t> segments{0};
  for (std::size_t i = 1; i < samples.output_rad.size(); ++i) {
    if (samples.direction[i] != samples.direction[i - 1] || samples.record[i] != samples.record[i - 1]) {
      segments.push_back(i);
    }
  }
  return segments;
}

// Mean and range over the first turn of the clockwise sweep of the first record.
std::vector<UserQuantity> MeanAndRange(const TransmissionErrorSamples& samples,
                                       const Eigen::VectorXd& predicted) {
  std::vector<double> measured;
  std::vector<double> modelled;
  std::vector<double> angle_rad;
  double first = 0.0;
  for (std::size_t i = 0; i < samples.error_rad.size() && samples.record[i] == 0; ++i) {
    if (samples.direction[i] < 0.0) continue;
    if (measured.empty()) first = samples.output_rad[i];
    // As many steps as the turn has: its last sample is the first one of the next.
    const double quarter_step_rad =
        samples.samples_per_turn > 0.0 ? 0.25 * kTwoPi / samples.samples_per_turn : 0.0;
    if (std::abs(samples.output_rad[i] - first) >= kTwoPi - quarter_step_rad) break;
    measured.push_back(ArcminFromRad(samples.error_rad[i]));
    modelled.push_back(ArcminFromRad(predicted(static_cast<Eigen::Index>(i))));
    angle_rad.push_back(samples.output_rad[i] - samples.error_rad[i]);  // as measured, but for a constant
  }
  if (measured.size() < kLeastSamples / 2 || angle_rad.back() == angle_rad.front()) return {};
  // As `ComputeTransmissionError` has it.
  const auto mean = [&](const std::vector<double>& values) {
    return MeanOverAngle({angle_rad, AnalyseOrders(angle_rad, values, samples.ratio).fit}).value;
  };
  const auto range = [](const std::vector<double>& values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return *high - *low;
  };
  return {{std::string(quantities::kEAvg.name), mean(measured), mean(modelled)},
          {std::string(quantities::kEMax.name), range(measured), range(modelled)}};
}

void LeaveOpen(SeparableTerm& term) {
  term.describe = [describe = std::move(term.describe)](std::span<const double> numbers,
                                                        const Eigen::MatrixXd& covariance) {
    std::vector<ParameterValue> values = describe(numbers, covariance);
    for (ParameterValue& value : values) value.standard_error = std::numeric_limits<double>::infinity();
    return values;
  };
}

// What tells the second harmonic from other orders, where the steps do not, is what the steps are off by.
void LeaveOpenWhatIsNotSeen(const TransmissionErrorSamples& samples, SeparableModel& model) {
  const double ratio = std::abs(samples.ratio);
  const std::string why = WhyNotSeen(samples, 2.0 * ratio,
                                     {{ratio, "the first harmonic"},
                                      {4.0 * ratio, "the fourth harmonic"},
                                      {1.0, "once per turn of the output"},
                                      {2.0, "twice per turn of the output"}});
  if (why.empty()) return;
  model.warnings.push_back("the second harmonic of the wave generator is not known: " + why);
  LeaveOpen(model.nominal.back());
  if (FoldedOrder(2.0 * ratio, samples.samples_per_turn) >= 0.5) return;
  for (std::size_t k = 0; k < samples.records; ++k) LeaveOpen(model.nominal[k]);
}

// Standard deviation of what the encoders' steps do to the transmission error.
double Rounding_rad(std::span<const TransmissionErrorData> records) {
  double rounding_rad = 0.0;
  for (const TransmissionErrorData& record : records) {
    const double step_rad =
        std::hypot(samples::QuantisationStepOfSweep(record.output_angle_rad),
                   samples::QuantisationStepOfSweep(record.input_angle_rad) / record.ratio);
    rounding_rad = std::max(rounding_rad, step_rad / std::sqrt(12.0));
  }
  return rounding_rad;
}

std::vector<Regressor> RegressorsOf(const TransmissionErrorSamples& samples) {
  std::vector<Regressor> regressors{
      {"output_angle", "output angle / deg", DegFromRad(1.0), samples.output_rad, true},
      {"input_angle", "input angle / deg", DegFromRad(1.0), samples.input_rad, true},
      {"direction", "direction (1 cw, -1 ccw)", 1.0, samples.direction, false},
      {"time", samples.has_time ? "time / s" : "sample", 1.0, samples.time_s, false}};
  if (!samples.torque_Nm.empty())
    regressors.push_back({"torque", "torque / Nm", 1.0, samples.torque_Nm, false});
  if (!samples.temperature_degC.empty()) {
    regressors.push_back({"temperature", "temperature / degC", 1.0, samples.temperature_degC, false});
  }
  return regressors;
}

}  // namespace

std::unique_ptr<Study> MakeTransmissionErrorStudy(std::span<const TransmissionErrorData> records) {
  if (records.empty()) throw std::invalid_argument("no record to diagnose");
  TransmissionErrorSamples samples = Join(records);
  samples.samples_per_turn = SamplesPerTurn(samples);
  SeparableModel model;
  model.measured = samples.error_rad;
  model.segments = SegmentsOf(samples);
  for (std::size_t k = 0; k < samples.records; ++k) {
    std::vector<double> here(samples.error_rad.size());
    for (std::size_t i = 0; i < here.size(); ++i) here[i] = samples.record[i] == k ? 1.0 : 0.0;
    model.nominal.push_back(ColumnTerm(
        std::move(here),
        {k == 0 ? "offset_arcmin" : fmt::format("offset_{}_arcmin", k + 1), "arcmin", ArcminFromRad(1.0)}));
  }
  model.nominal.push_back(
      HarmonicTerm(samples.input_rad, 2.0, "second_harmonic_amplitude_arcmin", "arcmin", ArcminFromRad(1.0)));
  LeaveOpenWhatIsNotSeen(samples, model);
  AddTransmissionErrorCauses(samples, model);
  model.regressors = RegressorsOf(samples);
  model.turn_angles_rad = samples.output_rad;
  model.unit = "arcmin";
  model.unit_per_si = ArcminFromRad(1.0);
  model.noise_floor = TransmissionErrorFloor_rad(samples);
  model.rounding = Rounding_rad(records);
  const auto n = samples.error_rad.size();
  // Whole turns where each segment has three or more; else blocks that leave twenty in the record.
  const double turn = samples.samples_per_turn;
  const double turns_a_segment =
      turn > 0.0 ? static_cast<double>(n) / turn / static_cast<double>(model.segments.size()) : 0.0;
  model.block_length =
      turns_a_segment > 2.9 ? static_cast<std::size_t>(std::lround(turn)) : std::max<std::size_t>(8, n / 20);
  model.quantities = [samples](const Eigen::VectorXd& predicted) { return MeanAndRange(samples, predicted); };
  return std::make_unique<SeparableStudy>(std::move(model));
}

}  // namespace strainwave::analysis::diagnosis
