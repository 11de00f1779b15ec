// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/recipe_inputs.h"

#include <cmath>
#include <unordered_map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/campaign/campaign_error.h"
#include "bench/diagnosis/record_checks.h"

namespace strainwave::bench {

RecipeInputs::RecipeInputs(const FeatureRecipe& recipe) : recipe_(recipe), features_(recipe.features) {
  const std::vector<std::string> names = features_.Names(recipe_.channels);
  std::unordered_map<std::string, Eigen::Index> places;
  for (std::size_t i = 0; i < names.size(); ++i) places.emplace(names[i], static_cast<Eigen::Index>(i));
  for (const std::string& input : recipe_.inputs) {
    const auto found = places.find(input);
    if (found == places.end()) {
      throw CampaignError(
          ExitCode::kWrongInput,
          fmt::format("error: the predictor's input '{}' is no feature of its recipe (expected one of "
                      "the channels {})",
                      input, fmt::join(recipe_.channels, ", ")));
    }
    place_.push_back(found->second);
  }
}

Eigen::MatrixXd RecipeInputs::OfWindows(const daq::Record& record) {
  const RecordSignals signals = SignalsOf(record, recipe_.signals());
  if (recipe_.window.turns > 0 && !signals.samples_per_turn) {
    throw RecordRefusal(record, fmt::format("there is no steady speed of the input shaft (expected one, for "
                                            "windows of {} turns, as in training)",
                                            recipe_.window.turns));
  }
  const std::vector<Window> windows = WindowsOf(signals.rows(), signals.samples_per_turn, recipe_.window);
  // The speed may differ a little from that of training, and with it the samples of so many turns.
  const bool too_short =
      windows.empty() || (recipe_.window.turns == 0 && windows[0].count < recipe_.least_samples);
  if (too_short) {
    throw RecordRefusal(record, fmt::format("{} samples (expected at least {}, as in training)",
                                            signals.rows(), recipe_.least_samples));
  }
  RequireAlive(record, signals, recipe_.channels);
  Eigen::MatrixXd inputs(static_cast<Eigen::Index>(windows.size()), static_cast<Eigen::Index>(place_.size()));
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const std::vector<double> values = FeaturesOfWindow(record, signals, windows[k], features_);
    for (std::size_t i = 0; i < place_.size(); ++i) {
      const double value = values[static_cast<std::size_t>(place_[i])];
      if (!std::isfinite(value)) {
        throw RecordRefusal(
            record, fmt::format("{} is not defined for this record (expected a number)", recipe_.inputs[i]));
      }
      inputs(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = value;
    }
  }
  return inputs;
}

}  // namespace strainwave::bench
