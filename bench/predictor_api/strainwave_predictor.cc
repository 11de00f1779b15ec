// SPDX-License-Identifier: Apache-2.0
#include "bench/predictor_api/strainwave_predictor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "bench/prediction/exported_predictor.h"

// NOLINTBEGIN(readability-identifier-naming): names of a C library
struct strainwave_predictor {
  strainwave::bench::ExportedPredictor exported;
  strainwave::bench::OperatingPoint operating{};
};
// NOLINTEND(readability-identifier-naming)

namespace {

using strainwave::bench::NamedSignal;
using strainwave::bench::OperatingPoint;
using strainwave::bench::OperatingQuantity;
using strainwave::bench::PredictedOutputs;
using strainwave::bench::SignalFault;

void Say(std::string_view text, char* error, size_t error_size) noexcept {
  if (error == nullptr || error_size == 0) return;
  const std::size_t length = std::min(text.size(), error_size - 1);
  std::memcpy(error, text.data(), length);
  error[length] = '\0';
}

strainwave_status Run(strainwave_predictor& predictor, const double* const* channels, size_t samples,
                      double sample_rate_hz, std::optional<double> input_speed_rpm, strainwave_value* values,
                      double& distance, char* error, size_t error_size) {
  const std::vector<std::string>& names = predictor.exported.recipe().channels;
  std::vector<NamedSignal> signals;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (channels[k] == nullptr) {
      Say("a channel is NULL (expected as many as channel_count)", error, error_size);
      return STRAINWAVE_BAD_ARGUMENT;
    }
    signals.push_back({names[k], {channels[k], samples}});
  }
  constexpr double kSecondsPerMinute = 60.0;
  std::optional<double> samples_per_turn;
  OperatingPoint operating = predictor.operating;
  if (input_speed_rpm) {
    samples_per_turn = sample_rate_hz * kSecondsPerMinute / std::abs(*input_speed_rpm);
    operating[OperatingQuantity::kInputSpeed] = std::abs(*input_speed_rpm);
  }
  const auto predicted = predictor.exported.Predict(signals, sample_rate_hz, samples_per_turn, operating);
  if (const auto* fault = std::get_if<SignalFault>(&predicted)) {
    Say(fault->text, error, error_size);
    return STRAINWAVE_BAD_SIGNAL;
  }
  const auto& outputs = std::get<PredictedOutputs>(predicted);
  for (std::size_t i = 0; i < outputs.value.size(); ++i) {
    const double value = outputs.value[i];
    values[i] = {value, value - outputs.half_width[i], value + outputs.half_width[i]};
  }
  distance = outputs.distance;
  if (!outputs.outside_training()) return STRAINWAVE_OK;
  Say("the window lies outside what the predictor was trained on: " +
          strainwave::bench::OutsideText(outputs.distance, outputs.left),
      error, error_size);
  return STRAINWAVE_OUTSIDE_TRAINING;
}

// Whatever goes wrong becomes a status, and no value that was there before stays.
strainwave_status RunGuarded(strainwave_predictor* predictor, const double* const* channels, size_t samples,
                             double sample_rate_hz, std::optional<double> input_speed_rpm,
                             strainwave_value* values, double* distance, char* error, size_t error_size) {
  Say("", error, error_size);
  if (distance != nullptr) *distance = std::numeric_limits<double>::quiet_NaN();
  if (predictor == nullptr || channels == nullptr || values == nullptr || samples == 0) {
    Say("predictor, channels or values is NULL, or there are no samples", error, error_size);
    return STRAINWAVE_BAD_ARGUMENT;
  }
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::fill_n(values, predictor->exported.outputs().size(), strainwave_value{kNone, kNone, kNone});
  if (input_speed_rpm && !(std::abs(*input_speed_rpm) > 0.0)) {
    Say("input_speed_rpm is 0 or no number (expected the speed of a shaft that turns)", error, error_size);
    return STRAINWAVE_BAD_ARGUMENT;
  }
  try {
    double measured = kNone;
    const strainwave_status status = Run(*predictor, channels, samples, sample_rate_hz, input_speed_rpm,
                                         values, measured, error, error_size);
    if (distance != nullptr) *distance = measured;
    return status;
  } catch (const std::exception& failure) {
    Say(failure.what(), error, error_size);
  } catch (...) {
    Say("the prediction failed", error, error_size);
  }
  return STRAINWAVE_FAILED;
}

const char* NameAt(const std::vector<std::string>& names, size_t at) {
  return at < names.size() ? names[at].c_str() : nullptr;
}

}  // namespace

// NOLINTBEGIN(readability-identifier-naming)
strainwave_predictor* strainwave_predictor_open(const char* folder, char* error, size_t error_size) {
  return strainwave_predictor_open_for(folder, "", error, error_size);
}

strainwave_predictor* strainwave_predictor_open_for(const char* folder, const char* baseline_file,
                                                    char* error, size_t error_size) {
  Say("", error, error_size);
  if (folder == nullptr || baseline_file == nullptr) {
    Say(folder == nullptr ? "folder is NULL (expected a folder that `strainwave export` wrote)"
                          : "baseline_file is NULL (expected a file that `strainwave baseline` wrote)",
        error, error_size);
    return nullptr;
  }
  try {
    auto predictor = std::make_unique<strainwave_predictor>(strainwave::bench::ExportedPredictor(folder));
    predictor->exported.UseBaseline(baseline_file);
    return predictor.release();
  } catch (const std::exception& failure) {
    Say(failure.what(), error, error_size);
  } catch (...) {
    Say("the folder cannot be opened", error, error_size);
  }
  return nullptr;
}

void strainwave_predictor_close(strainwave_predictor* predictor) { delete predictor; }

size_t strainwave_predictor_channel_count(const strainwave_predictor* predictor) {
  return predictor == nullptr ? 0 : predictor->exported.recipe().channels.size();
}

const char* strainwave_predictor_channel_name(const strainwave_predictor* predictor, size_t channel) {
  return predictor == nullptr ? nullptr : NameAt(predictor->exported.recipe().channels, channel);
}

double strainwave_predictor_sample_rate_hz(const strainwave_predictor* predictor) {
  return predictor == nullptr ? 0.0 : predictor->exported.recipe().sample_rate_hz;
}

size_t strainwave_predictor_least_samples(const strainwave_predictor* predictor) {
  return predictor == nullptr ? 0 : predictor->exported.recipe().least_samples;
}

size_t strainwave_predictor_output_count(const strainwave_predictor* predictor) {
  return predictor == nullptr ? 0 : predictor->exported.outputs().size();
}

const char* strainwave_predictor_output_name(const strainwave_predictor* predictor, size_t output) {
  return predictor == nullptr ? nullptr : NameAt(predictor->exported.outputs(), output);
}

int strainwave_predictor_tells_classes(const strainwave_predictor* predictor) {
  return predictor != nullptr && predictor->exported.classes() ? 1 : 0;
}

double strainwave_predictor_coverage(const strainwave_predictor* predictor) {
  return predictor == nullptr ? 0.0 : predictor->exported.coverage();
}

strainwave_status strainwave_predictor_run(strainwave_predictor* predictor, const double* const* channels,
                                           size_t samples, double sample_rate_hz, strainwave_value* values,
                                           double* distance, char* error, size_t error_size) {
  return RunGuarded(predictor, channels, samples, sample_rate_hz, std::nullopt, values, distance, error,
                    error_size);
}

strainwave_status strainwave_predictor_run_at(strainwave_predictor* predictor, const double* const* channels,
                                              size_t samples, double sample_rate_hz, double input_speed_rpm,
                                              strainwave_value* values, double* distance, char* error,
                                              size_t error_size) {
  return RunGuarded(predictor, channels, samples, sample_rate_hz, input_speed_rpm, values, distance, error,
                    error_size);
}

void strainwave_predictor_set_operating_point(strainwave_predictor* predictor, double output_torque_Nm,
                                              double input_speed_rpm, double temperature_degC) {
  if (predictor == nullptr) return;
  const auto known = [](double value) { return std::isfinite(value) ? std::optional(value) : std::nullopt; };
  predictor->operating[OperatingQuantity::kOutputTorque] = known(std::abs(output_torque_Nm));
  predictor->operating[OperatingQuantity::kInputSpeed] = known(std::abs(input_speed_rpm));
  predictor->operating[OperatingQuantity::kTemperature] = known(temperature_degC);
}
// NOLINTEND(readability-identifier-naming)
