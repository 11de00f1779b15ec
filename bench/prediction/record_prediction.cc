// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/record_prediction.h"

#include <algorithm>
#include <cstddef>

#include "bench/prediction/baseline_file.h"
#include "bench/prediction/record_operating_point.h"

namespace strainwave::bench {
namespace {

RecordPrediction TogetherOf(const analysis::prediction::FittedPredictor::Prediction& windows) {
  std::vector<double> distances(windows.distance.begin(), windows.distance.end());
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return {windows.value.colwise().mean(), windows.half_width.colwise().mean(), *middle, windows.value.rows()};
}

}  // namespace

RecordPredictor::RecordPredictor(const std::filesystem::path& folder, const std::filesystem::path& baseline)
    : predictor_(ReadPredictor(folder)),
      inputs_(predictor_.recipe),
      baseline_(BaselineFor(predictor_.recipe, predictor_.outputs, baseline)) {}

MotorTorque RecordPredictor::motor_torque() const {
  return MotorTorqueAdded(HasMotorTorque(predictor_.recipe.channels));
}

RecordPrediction RecordPredictor::Predict(const daq::Record& record, const OperatingPoint& given) {
  Eigen::MatrixXd features = inputs_.OfWindows(record);
  if (baseline_) features.rowwise() -= baseline_->features;
  RecordPrediction predicted = TogetherOf(predictor_.fitted.Predict(features));
  if (baseline_) predicted.value += baseline_->values;
  const OperatingPoint own = OperatingPointOf(record);
  const OperatingPoint operating = Completed(own, given);
  const OperatingEnvelope& envelope = predictor_.recipe.envelope;
  predicted.left = envelope.Left(operating);
  predicted.unknown = envelope.NotKnown(operating);
  for (std::string& text : Contradictions(own, given)) predicted.unknown.push_back(std::move(text));
  return predicted;
}

}  // namespace strainwave::bench
