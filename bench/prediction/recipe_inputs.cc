// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/recipe_inputs.h"

#include <vector>

#include "bench/diagnosis/record_checks.h"
#include "bench/diagnosis/record_data.h"
#include "bench/prediction/record_features.h"

namespace strainwave::bench {

Eigen::RowVectorXd RecipeInputs::Of(const daq::Record& record) {
  const std::vector<std::string> channels = VibrationChannelsOf(record);
  std::vector<std::vector<double>> samples;
  std::vector<NamedSignal> signals;
  for (const std::string& channel : channels) samples.push_back(record.CopyAsDoubles(channel));
  for (std::size_t k = 0; k < channels.size(); ++k) signals.push_back({channels[k], samples[k]});
  Eigen::RowVectorXd inputs;
  if (const auto fault = inputs_.Compute(signals, SampleRateOf_hz(record), inputs)) {
    throw RecordRefusal(record, fault->text);
  }
  return inputs;
}

}  // namespace strainwave::bench
