// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/model_card.h"

#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "bench/prediction/network_worth.h"

namespace strainwave::bench {
namespace {

using Json = nlohmann::ordered_json;

std::string Rule(std::size_t columns) {
  std::string rule = "|";
  for (std::size_t i = 0; i < columns; ++i) rule += " --- |";
  return rule + "\n";
}

std::string WindowText(const WindowLength& window) {
  if (window.turns > 0) return fmt::format(", in windows of {} turns of the input shaft", window.turns);
  if (window.samples > 0) return fmt::format(", in windows of {} samples", window.samples);
  return "";
}

std::string SearchText(const Json& training) {
  if (!training.contains("search")) return "";
  const Json& winner = training.at("search").front();
  return fmt::format(" (hidden layers {}, weight decay {:g}: the winner of {} candidates)",
                     winner.at("hidden").dump(), winner.at("weight_decay").get<double>(),
                     training.at("search").size());
}

// Where outputs may be zero, of which nothing is a percentage.
std::string RmseText(const Json& split, const Predictor& predictor) {
  std::string text =
      fmt::format("Root mean square error:\n\n| | {} |\n", fmt::join(predictor.outputs, " | ")) +
      Rule(predictor.outputs.size() + 1);
  constexpr std::pair<const char*, const char*> kRows[] = {
      {"rmse", "network"}, {"ridge_rmse", "ridge"}, {"mean_rmse", "mean"}};
  for (const auto& [key, name] : kRows) {
    text += fmt::format("| {}", name);
    for (const std::string& output : predictor.outputs)
      text += fmt::format(" | {:.4f}", split.at(key).at(output).get<double>());
    text += " |\n";
  }
  return text;
}

std::string SplitText(const Json& split, const Predictor& predictor) {
  std::string text = fmt::format("\n## Error on {}\n\n{}; trained on {}, tested on {} records. ",
                                 split.at("split").get<std::string>(), split.at("meaning").get<std::string>(),
                                 split.at("train").get<std::size_t>(), split.at("test").get<std::size_t>());
  if (split.contains("rmse")) return text + RmseText(split, predictor);
  if (predictor.classes()) {
    text += "Accuracy in percent:\n\n| | accuracy |\n" + Rule(2);
    for (const auto& [name, scores] : split.at("scores").items()) {
      text += fmt::format("| {} | {:.2f} |\n", name, scores.at("accuracy_percent").get<double>());
    }
    return text;
  }
  text += fmt::format("Mean absolute percentage error:\n\n| | {} |\n", fmt::join(predictor.outputs, " | ")) +
          Rule(predictor.outputs.size() + 1);
  for (const auto& [name, scores] : split.at("scores").items()) {
    text += "| " + name;
    for (const std::string& output : predictor.outputs) {
      text += fmt::format(" | {:.3f}", scores.at(output).at("mape_percent").get<double>());
    }
    text += " |\n";
  }
  return text;
}

// Of classes: how often each was taken for which.
std::string FoldsText(const Json& folds, const Predictor& predictor) {
  std::string text = fmt::format("\n## Folds of {}\n\n", folds.at("of").get<std::string>());
  if (!predictor.classes()) {
    return text + fmt::format("Mean absolute percentage error {:.3f} %.\n",
                              folds.at("network").at("mean_mape_percent").get<double>());
  }
  text += fmt::format("Accuracy {:.2f} %. Rows: own class; columns: predicted.\n\n| | {} |\n",
                      folds.at("network").at("accuracy_percent").get<double>(),
                      fmt::join(predictor.outputs, " | ")) +
          Rule(predictor.outputs.size() + 1);
  for (const auto& [own, row] : folds.at("network").at("confusion").items()) {
    text += "| " + own;
    for (const Json& count : row) text += fmt::format(" | {}", count.get<int>());
    text += " |\n";
  }
  return text;
}

std::string WorthText(const Json& training) {
  const std::string sentence = WorthSentence(training);
  return sentence.empty() ? "" : "**" + sentence + "**\n\n";
}

std::string EnvelopeText(const OperatingEnvelope& envelope) {
  std::string text = "\n## Operating range\n\n| | least | greatest |\n" + Rule(3);
  for (const OperatingQuantity quantity : kOperatingQuantities) {
    const auto range = envelope.RangeOf(quantity);
    text += range ? fmt::format("| {} | {:.4g} | {:.4g} |\n", NameOf(quantity), range->least, range->greatest)
                  : fmt::format("| {} | not known | not known |\n", NameOf(quantity));
  }
  return text +
         "\nOf the records that were trained on. Beyond these, by more than a twentieth of torque or speed "
         "or 5 K, "
         "what is predicted is outside, however near the signal's features lie. Under what training did not "
         "know, "
         "nothing is noticed.\n";
}

Json CardJson(const Predictor& predictor, const std::string& date) {
  const auto& fitted = predictor.fitted;
  Json range;
  for (std::size_t i = 0; i < predictor.recipe.inputs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    range[predictor.recipe.inputs[i]] = {fitted.least(column), fitted.greatest(column)};
  }
  return {{"exported_utc", date},
          {"predicts", predictor.classes() ? "classes" : "values"},
          {"outputs", predictor.outputs},
          {"operating_envelope", predictor.recipe.envelope.Json()},
          {"training", Json::parse(predictor.training_json)},
          {"valid_range", std::move(range)}};
}

std::string CardText(const Predictor& predictor, const Json& card) {
  const Json& training = card.at("training");
  std::string text = fmt::format(
      "# Predictor of {}\n\nFrom {} ({} at {:g} Hz{}, features: {}, at least {} samples). Exported "
      "{}.\n\n{}"
      "## Trained on\n\n| source | specimen | records |\n| --- | --- | --- |\n",
      predictor.classes() ? fmt::format("the class: {}", fmt::join(predictor.outputs, ", "))
                          : fmt::format("{}", fmt::join(predictor.outputs, ", ")),
      predictor.recipe.features.set == FeatureSet::kPackets ? "motor signals" : "vibration",
      fmt::join(predictor.recipe.channels, ", "), predictor.recipe.sample_rate_hz,
      WindowText(predictor.recipe.window), NameOf(predictor.recipe.features.set),
      predictor.recipe.least_samples, card.at("exported_utc").get<std::string>(), WorthText(training));
  for (const Json& campaign : training.at("campaigns")) {
    text +=
        fmt::format("| {} | {} | {} |\n", campaign.at("folder").get<std::string>(),
                    campaign.at("specimen").get<std::string>(), campaign.at("records").get<std::size_t>());
  }
  text += fmt::format("\nSHA-256 of features and targets: `{}`. Design `{}`{}, {} networks{}.\n",
                      training.at("data_sha256").get<std::string>(), training.at("design").get<std::string>(),
                      SearchText(training), predictor.fitted.ensemble.members.size(),
                      predictor.fitted.ensemble.line.empty() ? "" : " beside a line (ridge)");
  text += EnvelopeText(predictor.recipe.envelope);
  if (predictor.recipe.baseline_records > 0) {
    text += fmt::format(
        "\n## Baseline\n\nIt tells changes: the means over a reducer's first {} records are taken off the "
        "inputs and added to the outputs. Every reducer needs its own, from `strainwave baseline`; without "
        "it nothing is predicted. The network's inputs and outputs are differences.\n",
        predictor.recipe.baseline_records);
  }
  for (const Json& split : training.at("splits")) text += SplitText(split, predictor);
  if (training.contains("folds")) text += FoldsText(training.at("folds"), predictor);
  if (predictor.classes()) {
    text +=
        "\n## Probabilities\n\nThe mean over the networks of their softmax. They are not calibrated: a class "
        "that no "
        "training record had is never named. Valid where `distance` is at most 1: beyond, a record lies "
        "outside "
        "what was trained on and nothing is promised. The range of each input in training is in "
        "`model_card.json`.\n";
    return text;
  }
  text += fmt::format(
      "\n## Intervals\n\nThey hold {:.0f} % of records of {}. Valid where `distance` is at most 1: beyond, a "
      "record lies "
      "outside what was trained on and nothing is promised. The range of each input in training is in "
      "`model_card.json`.\n",
      100.0 * predictor.fitted.band.coverage,
      predictor.fitted.band.guaranteed
          ? "a reducer like those trained on"
          : "those seen; there were too few reducers to promise it for another one");
  return text;
}

}  // namespace

ModelCard ModelCardOf(const Predictor& predictor, const std::string& exported_utc) {
  const Json card = CardJson(predictor, exported_utc);
  return {CardText(predictor, card), card.dump(2) + "\n"};
}

}  // namespace strainwave::bench
