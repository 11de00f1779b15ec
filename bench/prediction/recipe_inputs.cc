// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/recipe_inputs.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/campaign/campaign_error.h"
#include "bench/diagnosis/record_checks.h"
#include "bench/diagnosis/record_data.h"
#include "bench/prediction/record_features.h"

namespace strainwave::bench {
namespace {

constexpr double kRateTolerance = 0.01;
// So many equal samples in a row at the very top or bottom are a sensor at its end.
constexpr int kClippedRun = 6;

int LongestRunAt(std::span<const double> signal, double value) {
  int longest = 0;
  int run = 0;
  for (const double sample : signal) {
    run = sample == value ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

void RequireAlive(const daq::Record& record, const std::string& channel, std::span<const double> signal) {
  const auto [low, high] = std::ranges::minmax(signal);
  if (low == high) {
    throw RecordRefusal(
        record,
        fmt::format("{} is {} throughout (expected a signal: is the sensor connected?)", channel, low));
  }
  for (const double end : {low, high}) {
    const int run = LongestRunAt(signal, end);
    if (run >= kClippedRun) {
      throw RecordRefusal(
          record,
          fmt::format("{} stays at its end value {} for {} samples (expected a sensor within its range)",
                      channel, end, run));
    }
  }
}

}  // namespace

RecipeInputs::RecipeInputs(const FeatureRecipe& recipe) : recipe_(recipe), by_wavelet_(recipe.wavelet) {
  const std::vector<std::string> names = by_wavelet_.Names(recipe_.channels);
  values_.resize(names.size());
  for (const std::string& input : recipe_.inputs) {
    const auto found = std::ranges::find(names, input);
    if (found == names.end()) {
      throw CampaignError(
          ExitCode::kWrongInput,
          fmt::format("error: the predictor's input '{}' is no feature of its recipe (expected one of "
                      "the channels {})",
                      input, fmt::join(recipe_.channels, ", ")));
    }
    place_.push_back(found - names.begin());
  }
}

Eigen::RowVectorXd RecipeInputs::Of(const daq::Record& record) {
  const double rate_hz = SampleRateOf_hz(record);
  if (std::abs(rate_hz / recipe_.sample_rate_hz - 1.0) > kRateTolerance) {
    throw RecordRefusal(record, fmt::format("the sampling rate is {:g} Hz (expected {:g} Hz, as in training)",
                                            rate_hz, recipe_.sample_rate_hz));
  }
  if (record.rows() < recipe_.least_samples) {
    throw RecordRefusal(record, fmt::format("{} samples (expected at least {}, as in training)",
                                            record.rows(), recipe_.least_samples));
  }
  const std::size_t per_channel = by_wavelet_.CountPerChannel();
  for (std::size_t k = 0; k < recipe_.channels.size(); ++k) {
    const std::string& channel = recipe_.channels[k];
    if (record.FindColumn(channel) == nullptr) {
      throw RecordRefusal(record, fmt::format("there is no channel {} (expected {})", channel,
                                              fmt::join(recipe_.channels, ", ")));
    }
    const std::vector<double> signal = record.CopyAsDoubles(channel);
    RequireAlive(record, channel, signal);
    by_wavelet_.Compute(signal, std::span(values_).subspan(k * per_channel, per_channel));
  }
  Eigen::RowVectorXd inputs(static_cast<Eigen::Index>(place_.size()));
  for (std::size_t i = 0; i < place_.size(); ++i) {
    const double value = values_[static_cast<std::size_t>(place_[i])];
    if (!std::isfinite(value)) {
      throw RecordRefusal(
          record, fmt::format("{} is not defined for this record (expected a number)", recipe_.inputs[i]));
    }
    inputs(static_cast<Eigen::Index>(i)) = value;
  }
  return inputs;
}

}  // namespace strainwave::bench
