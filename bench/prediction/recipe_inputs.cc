// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/recipe_inputs.h"

#include <vector>

#include <fmt/format.h>

#include "bench/prediction/record_windows.h"
#include "bench/records/record_refusal.h"

namespace strainwave::bench {

Eigen::MatrixXd RecipeInputs::OfWindows(const daq::Record& record) {
  const RecordSignals signals = SignalsOf(record, recipe_.signals());
  if (recipe_.window.turns > 0 && !signals.samples_per_turn) {
    throw RecordRefusal(record, fmt::format("there is no steady speed of the input shaft (expected one, for "
                                            "windows of {} turns, as in training)",
                                            recipe_.window.turns));
  }
  const std::vector<Window> windows = WindowsOf(signals.rows(), signals.samples_per_turn, recipe_.window);
  if (windows.empty()) {
    throw RecordRefusal(record, fmt::format("{} samples (expected at least {}, as in training)",
                                            signals.rows(), recipe_.least_samples));
  }
  // Of the whole record, as in training: where little moves, a window's own highest value may well last.
  RequireAlive(record, signals, recipe_.channels);
  Eigen::MatrixXd inputs(static_cast<Eigen::Index>(windows.size()),
                         static_cast<Eigen::Index>(recipe_.inputs.size()));
  std::vector<std::span<const double>> channels(signals.channels.size());
  Eigen::RowVectorXd row;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    for (std::size_t c = 0; c < channels.size(); ++c)
      channels[c] = std::span(signals.channels[c]).subspan(windows[k].begin, windows[k].count);
    if (const auto fault = inputs_.OfChannels(channels, signals.samples_per_turn, row))
      throw RecordRefusal(record, fault->text);
    inputs.row(static_cast<Eigen::Index>(k)) = row;
  }
  return inputs;
}

}  // namespace strainwave::bench
