// SPDX-License-Identifier: Apache-2.0
#include "bench/faults/fault_model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "analysis/features/envelope_prominence.h"
#include "analysis/units.h"
#include "bench/errors/bench_error.h"
#include "bench/faults/fault_features.h"
#include "bench/json_text.h"
#include "bench/prediction/record_features.h"
#include "bench/prediction/record_windows.h"
#include "bench/prediction/sealed_json.h"
#include "bench/prediction/signal_inputs.h"
#include "bench/records/record_refusal.h"
#include "bench/sha256.h"
#include "daq/record_error.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

namespace faults = analysis::faults;
using Json = nlohmann::ordered_json;

constexpr int kFaultFormat = 1;
constexpr const char* kFaultFile = "faults.json";
constexpr const char* kAsWritten = "the file as `strainwave faults train` has written it";

std::string TextOfModel(const std::filesystem::path& path) {
  return ReadBounded(path, "a model, as `strainwave faults train` writes it");
}

Json BearingJson(const analysis::RollingBearing& bearing) {
  return {{"elements", bearing.elements},
          {"element_diameter_mm", 1e3 * bearing.element_diameter_m},
          {"pitch_diameter_mm", 1e3 * bearing.pitch_diameter_m},
          {"contact_angle_deg", DegFromRad(bearing.contact_angle_rad)}};
}

// The fewest samples that its features can be made of; shorter records than those of the training will do.
std::size_t FewestSamples(const FeatureRecipe& recipe) {
  if (recipe.features.set != FeatureSet::kDetails) return 2;
  const auto& details = recipe.features.details;
  const std::size_t filter = analysis::wavelets::FilterBankOf(details.wavelet).length();
  return (filter - 1) << static_cast<unsigned>(details.levels);
}

std::string JoinedLabels(const std::vector<std::string>& outputs, const std::vector<bool>& present) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    if (present[k]) names.push_back(outputs[k]);
  }
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, "+"));
}

// As the options or the model have it, else as the record does.
std::optional<analysis::RollingBearing> BearingFor(const FaultModel& model, const daq::Record& record) {
  if (model.bearing) return model.bearing;
  const auto number = [&](const char* key) {
    const auto text = record.Metadata(key);
    return text ? daq::NumberFromText(*text) : std::nullopt;
  };
  const auto elements = number("bearing_elements");
  const auto element_mm = number("bearing_element_diameter_mm");
  const auto pitch_mm = number("bearing_pitch_diameter_mm");
  if (!elements || !element_mm || !pitch_mm) return std::nullopt;
  const bool fits = *elements >= 1.0 && *elements <= 1000.0 && *element_mm > 0.0 && *element_mm < *pitch_mm;
  if (!fits) return std::nullopt;
  return analysis::RollingBearing{.elements = static_cast<int>(*elements),
                                  .element_diameter_m = 1e-3 * *element_mm,
                                  .pitch_diameter_m = 1e-3 * *pitch_mm,
                                  .contact_angle_rad = RadFromDeg(std::clamp(
                                      number("bearing_contact_angle_deg").value_or(0.0), 0.0, 89.0))};
}

std::vector<BearingSign> SignsOf(const analysis::RollingBearing& bearing,
                                 const std::vector<std::vector<double>>& channels, double samples_per_turn,
                                 double rate_hz) {
  const analysis::BearingOrders orders = analysis::BearingOrdersOf(bearing);
  const std::vector<double> values{orders.outer_race, orders.inner_race, orders.element, orders.cage};
  constexpr const char* kParts[] = {"outer_race", "inner_race", "element", "cage"};
  std::vector<BearingSign> signs;
  for (std::size_t k = 0; k < values.size(); ++k)
    signs.push_back({kParts[k], values[k], values[k] * rate_hz / samples_per_turn, std::nan("")});
  for (const std::vector<double>& channel : channels) {
    const std::vector<double> found =
        analysis::features::EnvelopeProminences_dB(channel, samples_per_turn, values);
    for (std::size_t k = 0; k < found.size(); ++k)
      signs[k].prominence_dB = std::fmax(signs[k].prominence_dB, found[k]);
  }
  return signs;
}

// Why nothing is decided, where nothing is.
std::string WhyUndecided(const FaultModel& model, const FaultVerdict& verdict) {
  if (!verdict.undecided) return "";
  if (!(verdict.distance <= 1.0))
    return fmt::format("it lies outside what was trained on, by {:.2g} times", verdict.distance);
  if (model.labels) return "a probability lies next to its threshold";
  const double most = *std::ranges::max_element(verdict.probability);
  if (most < model.rule.least_probability)
    return fmt::format("no class has a probability of {:g} or more", model.rule.least_probability);
  return fmt::format("two classes are less than {:g} apart", model.rule.least_margin);
}

}  // namespace

void WriteFaultModel(const std::filesystem::path& folder, const FaultModel& model) {
  WritePredictor(folder, model.predictor);
  Json json{
      {"format", kFaultFormat},
      {"labels", model.labels},
      {"line", faults::NameOf(model.line)},
      {"undecided",
       {{"least_probability", model.rule.least_probability}, {"least_margin", model.rule.least_margin}}},
      {"thresholds", std::vector<double>(model.thresholds.begin(), model.thresholds.end())},
      {"predictor_sha256", Sha256(daq::ReadWholeFile(folder / "predictor.json"))},
      {"report", Json::parse(model.report_json)}};
  if (model.bearing) json["bearing"] = BearingJson(*model.bearing);
  Seal(json);
  // Last: a folder without it is no model of faults yet.
  daq::WriteFileAtomically(folder / kFaultFile, json.dump(2) + "\n");
}

FaultModel ReadFaultModel(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / kFaultFile;
  const std::string text = TextOfModel(path);
  Predictor predictor = ReadPredictor(folder);
  try {
    const Json json = ParseJson(text);
    if (json.at("format").get<int>() != kFaultFormat)
      Refuse(path, fmt::format("format {}", ShortText(json.at("format"))),
             fmt::format("format {}", kFaultFormat));
    RequireSeal(path, json);
    if (Sha256(TextOfModel(folder / "predictor.json")) != json.at("predictor_sha256").get<std::string>())
      Refuse(folder / "predictor.json", "the file is of another training",
             "the SHA-256 that faults.json has");
    const auto thresholds = json.at("thresholds").get<std::vector<double>>();
    const bool labels = json.at("labels").get<bool>();
    if (labels && thresholds.size() != predictor.outputs.size())
      Refuse(path, fmt::format("{} thresholds", thresholds.size()),
             fmt::format("{}, one a fault", predictor.outputs.size()));
    std::optional<analysis::RollingBearing> bearing;
    if (json.contains("bearing")) {
      const Json& at = json.at("bearing");
      bearing =
          analysis::RollingBearing{.elements = at.at("elements").get<int>(),
                                   .element_diameter_m = 1e-3 * at.at("element_diameter_mm").get<double>(),
                                   .pitch_diameter_m = 1e-3 * at.at("pitch_diameter_mm").get<double>(),
                                   .contact_angle_rad = RadFromDeg(at.at("contact_angle_deg").get<double>())};
      analysis::BearingOrdersOf(*bearing);
    }
    const faults::UndecidedRule rule{
        .least_probability = json.at("undecided").at("least_probability").get<double>(),
        .least_margin = json.at("undecided").at("least_margin").get<double>()};
    const faults::FaultLine line = faults::FaultLineOf(json.at("line").get<std::string>());
    std::string report = json.at("report").dump();
    return {.predictor = std::move(predictor),
            .labels = labels,
            .line = line,
            .rule = rule,
            .thresholds = Eigen::Map<const Eigen::RowVectorXd>(thresholds.data(),
                                                               static_cast<Eigen::Index>(thresholds.size())),
            .bearing = bearing,
            .report_json = std::move(report)};
  } catch (const Json::exception& error) {
    Refuse(path, fmt::format("cannot be used: {}", error.what()), kAsWritten);
  } catch (const std::invalid_argument& error) {
    Refuse(path, fmt::format("cannot be used: {}", error.what()), kAsWritten);
  }
}

FaultVerdict Judge(const FaultModel& model, const daq::Record& record, std::optional<double> speed_rpm) {
  FeatureRecipe recipe = model.predictor.recipe;
  recipe.least_samples = std::min(recipe.least_samples, FewestSamples(recipe));
  const RecordSignals signals = SignalsOf(record, recipe.signals());
  for (std::size_t c = 0; c < signals.channels.size(); ++c) {
    const auto fault = SensorFault(recipe.channels[c], signals.channels[c]);
    // A sensor at its end says less, not nothing.
    if (fault && fault->kind != SignalFaultKind::kClipped) throw RecordRefusal(record, fault->text);
  }
  const std::optional<double> samples_per_turn = SamplesPerTurnOf(record, recipe.sample_rate_hz, speed_rpm);
  SignalInputs inputs(recipe);
  Eigen::RowVectorXd features;
  const std::vector<std::span<const double>> channels(signals.channels.begin(), signals.channels.end());
  if (const auto fault = inputs.OfChannels(channels, samples_per_turn, features))
    throw RecordRefusal(record, fault->text);
  const auto predicted = model.predictor.fitted.Predict(features);
  FaultVerdict verdict{.file = record.source.file,
                       .group = record.source.group,
                       .name = {},
                       .probability = {predicted.value.row(0).begin(), predicted.value.row(0).end()},
                       .present = {},
                       .undecided = {},
                       .distance = predicted.distance(0),
                       .why = {},
                       .bearing = {}};
  if (model.labels) {
    const auto decision =
        faults::DecideLabels(predicted.value.row(0), model.thresholds, verdict.distance, model.rule);
    verdict.present = decision.present;
    verdict.undecided = decision.undecided;
    verdict.name = JoinedLabels(model.predictor.outputs, decision.present);
  } else {
    const auto decision = faults::DecideClass(predicted.value.row(0), verdict.distance, model.rule);
    verdict.undecided = decision.undecided;
    verdict.name = model.predictor.outputs[static_cast<std::size_t>(decision.most_probable)];
  }
  verdict.why = WhyUndecided(model, verdict);
  const auto bearing = BearingFor(model, record);
  constexpr double kTurnsForSigns = 4.0;
  const bool turns =
      samples_per_turn && static_cast<double>(signals.rows()) >= kTurnsForSigns * *samples_per_turn;
  if (bearing && turns)
    verdict.bearing = SignsOf(*bearing, signals.channels, *samples_per_turn, recipe.sample_rate_hz);
  return verdict;
}

}  // namespace strainwave::bench
