// SPDX-License-Identifier: Apache-2.0
#include "bench/page/cycle_predictor.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <stdexcept>

#include <fmt/core.h>

#include "bench/campaign/campaign.h"
#include "bench/campaign/cycle_results.h"
#include "bench/page/http_text.h"

namespace strainwave::bench {
namespace {

using nlohmann::json;

json FiniteOrNull(double value) { return std::isfinite(value) ? json(value) : json(); }

json PredictedValuesJson(const Predictor& predictor, const RecordPrediction& prediction,
                         const std::vector<Result>& results) {
  json values = json::object();
  for (std::size_t i = 0; i < predictor.outputs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const double value = prediction.value(column);
    const double half_width = prediction.half_width(column);
    json& of_output = values[predictor.outputs[i]] = {{"value", FiniteOrNull(value)},
                                                      {"low", FiniteOrNull(value - half_width)},
                                                      {"high", FiniteOrNull(value + half_width)},
                                                      {"measured", nullptr},
                                                      {"inside", nullptr}};
    const auto result = std::ranges::find(results, predictor.outputs[i], &Result::quantity);
    if (result == results.end() || !IsSound(*result)) continue;
    of_output["measured"] = {{"value", result->value},
                             {"standard_error", FiniteOrNull(result->standard_error)}};
    of_output["inside"] = std::abs(result->value - value) <= half_width;
  }
  return values;
}

json ClassesJson(const Predictor& predictor, const RecordPrediction& prediction) {
  Eigen::Index likely = 0;
  prediction.value.maxCoeff(&likely);
  json probabilities = json::object();
  for (std::size_t i = 0; i < predictor.outputs.size(); ++i) {
    probabilities[predictor.outputs[i]] = FiniteOrNull(prediction.value(static_cast<Eigen::Index>(i)));
  }
  return {{"class", predictor.outputs[static_cast<std::size_t>(likely)]}, {"probabilities", probabilities}};
}

}  // namespace

nlohmann::json PredictionJson(int cycle, const Predictor& predictor,
                              const std::vector<PredictedRecord>& records,
                              const std::vector<Result>& measured) {
  json all = json::array();
  for (const auto& [group, prediction] : records) {
    json record = predictor.classes()
                      ? ClassesJson(predictor, prediction)
                      : json{{"values", PredictedValuesJson(predictor, prediction, measured)}};
    record["group"] = group;
    record["windows"] = prediction.windows;
    record["distance"] = FiniteOrNull(prediction.distance);
    record["outside_training"] = prediction.outside();
    record["outside"] =
        prediction.outside() ? json(OutsideText(prediction.distance, prediction.left)) : json();
    record["warnings"] = prediction.unknown;
    all.push_back(std::move(record));
  }
  return {{"cycle", cycle}, {"coverage", predictor.fitted.band.coverage}, {"records", std::move(all)}};
}

CyclePredictor::CyclePredictor(const CampaignFolder& folder, const std::filesystem::path& predictor,
                               const std::filesystem::path& baseline)
    : folder_(folder), predictor_(predictor, baseline) {}

bool CyclePredictor::Ask(int cycle, Done done) {
  return worker_.Post([this, cycle, done = std::move(done)] {
    try {
      done(200, Predict(cycle));
    } catch (const std::invalid_argument& error) {
      done(400, ErrorJson(error.what()));
    } catch (const std::exception& error) {
      done(503, ErrorJson(fmt::format("nothing can be predicted: {}", error.what())));
    }
  });
}

std::string CyclePredictor::Predict(int cycle) {
  const Journal journal = Journal::OpenAsRead(folder_.Journal());
  const int last = std::max(0, journal.LastCompleteCycle());
  if (cycle > last) {
    throw std::invalid_argument(fmt::format("cycle {} is not complete (expected at most {})", cycle, last));
  }
  const int asked = cycle == 0 ? last : cycle;
  if (asked == newest_.first && !newest_.second.empty()) return newest_.second;
  std::vector<PredictedRecord> records;
  if (asked > 0) {
    for (const daq::Record& record :
         ReadVibrationRecords(folder_.CycleFile(asked), predictor_.motor_torque())) {
      records.push_back({record.source.group, predictor_.Predict(record)});
    }
  }
  newest_ = {
      asked,
      JsonText(PredictionJson(asked, predictor_.predictor(), records, journal.Results(asked, 0))) + "\n"};
  return newest_.second;
}

}  // namespace strainwave::bench
