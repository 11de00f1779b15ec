// SPDX-License-Identifier: Apache-2.0
#include "bench/fingerprint/exported_fingerprint.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/joint_dynamics/nominal.h"
#include "bench/errors/bench_error.h"
#include "bench/fingerprint/fingerprint_names.h"
#include "bench/json_text.h"
#include "bench/prediction/exported_predictor.h"
#include "bench/prediction/onnx_dense.h"
#include "bench/prediction/sealed_json.h"
#include "daq/joint_columns.h"

namespace strainwave::bench {
namespace {

namespace dynamics = analysis::joint_dynamics;
using Eigen::Index;
using Json = nlohmann::ordered_json;

constexpr const char* kExportedAsWritten = "a folder that `strainwave fingerprint export` wrote";

Eigen::RowVectorXd RowOf(const Json& json, Index size) {
  const auto values = json.get<std::vector<double>>();
  if (values.size() != static_cast<std::size_t>(size))
    throw std::invalid_argument(fmt::format("a row of {} values in place of {}", values.size(), size));
  return Eigen::Map<const Eigen::RowVectorXd>(values.data(), size);
}

OnnxNetwork NetworkOf(const std::filesystem::path& file, const std::string& bytes, Index inputs,
                      Index outputs, OnnxNetwork::Predicts predicts) {
  try {
    return {bytes, inputs, outputs, predicts};
  } catch (const std::invalid_argument& error) {
    throw BenchError(ExitCode::kWrongInput, fmt::format("{}: error: {}", file.string(), error.what()));
  }
}

analysis::prediction::Ensemble LayersOf(const std::filesystem::path& file, const std::string& bytes) {
  try {
    return DenseEnsembleFrom(bytes);
  } catch (const std::invalid_argument& error) {
    throw BenchError(ExitCode::kWrongInput, fmt::format("{}: error: {}", file.string(), error.what()));
  }
}

std::vector<std::string> ChannelsOf(Index joints, Acceleration acceleration) {
  using daq::JointQuantity;
  std::vector<std::string> channels;
  for (std::size_t j = 1; j <= static_cast<std::size_t>(joints); ++j) {
    for (const JointQuantity quantity : {JointQuantity::kPosition, JointQuantity::kVelocity,
                                         JointQuantity::kTorque, JointQuantity::kAcceleration}) {
      if (quantity != JointQuantity::kAcceleration || acceleration == Acceleration::kAsThere)
        channels.push_back(daq::JointColumnName(quantity, j));
    }
  }
  return channels;
}

double MiddleOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

bool IsExportedFingerprint(const std::filesystem::path& folder) {
  const std::string text = ReadBounded(folder / kExportedRecipe, "a folder that `strainwave export` wrote");
  try {
    const Json json = ParseJson(text);
    return json.is_object() && json.contains("kind") && json.at("kind") == "fingerprint";
  } catch (const Json::exception&) {
    return false;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

ExportedFingerprint::Parts ExportedFingerprint::Read(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kExportedRecipe;
  try {
    const Json json = ParseJson(ReadBounded(file, kExportedAsWritten));
    if (json.at("format") != kFingerprintExportFormat)
      Refuse(file, fmt::format("format {}", ShortText(json.at("format"))),
             fmt::format("format {}; export the model again", kFingerprintExportFormat));
    RequireSeal(file, json);
    for (const char* card : {"model_card_json", "model_card_md"})
      ReadListed(folder, json.at(card), kExportedAsWritten);
    Parts parts;
    parts.joints = json.at("joints").get<Index>();
    parts.samples = json.at("samples_per_file").get<Index>();
    parts.sample_rate_hz = json.at("sample_rate_hz").get<double>();
    parts.least_samples = json.at("least_samples").get<std::size_t>();
    const Json& filter = json.at("filter");
    parts.smoothing = {filter.at("window_s").get<double>(), filter.at("order").get<int>(), false};
    parts.acceleration =
        filter.at("acceleration") == "measured" ? Acceleration::kAsThere : Acceleration::kDerived;
    parts.attribution = {.fingerprint = FingerprintKindNamed(json.at("fingerprint").at("name")),
                         .method = AttributionMethodNamed(json.at("fingerprint").at("method")),
                         .coalitions = json.at("fingerprint").at("coalitions").get<std::size_t>(),
                         .seed = json.at("fingerprint").at("seed").get<std::uint64_t>()};
    parts.classes = json.at("classes").get<std::vector<std::string>>();
    if (parts.joints < 1 || parts.samples < 1 || !(parts.sample_rate_hz > 0.0) || parts.classes.size() != 2 ||
        parts.smoothing.order < 1 || !(parts.smoothing.window_s > 0.0))
      throw std::invalid_argument("joints, samples, rate, classes or filter are out of range");
    for (const Json& row : json.at("background")) {
      parts.background.conservativeResize(parts.background.rows() + 1, 3 * parts.joints);
      parts.background.bottomRows(1) = RowOf(row, 3 * parts.joints);
    }
    const auto numbers =
        static_cast<Index>(dynamics::NominalNames(parts.attribution.fingerprint, parts.joints).size());
    for (const Json& golden : json.at("self_test").at("nominal"))
      parts.nominal_golden.push_back(
          {RowOf(golden.at("features"), 3 * parts.joints), RowOf(golden.at("prediction"), parts.joints)});
    for (const Json& golden : json.at("self_test").at("classifier"))
      parts.classifier_golden.push_back(
          {RowOf(golden.at("features"), numbers), RowOf(golden.at("prediction"), 2)});
    if (parts.background.rows() == 0 || parts.nominal_golden.empty() || parts.classifier_golden.empty())
      Refuse(file, "there is no background or no golden vector", kExportedAsWritten);
    if (parts.attribution.method == dynamics::Method::kGradients)
      Refuse(file, "its fingerprints are expected gradients, which an exported network does not give",
             "a model that was trained with --method exact or kernel");
    parts.nominal_bytes = ReadListed(folder, json.at("nominal"), kExportedAsWritten);
    parts.classifier_bytes = ReadListed(folder, json.at("classifier"), kExportedAsWritten);
    return parts;
  } catch (const Json::exception& error) {
    Refuse(file, fmt::format("cannot be used: {}", error.what()), kExportedAsWritten);
  } catch (const std::invalid_argument& error) {
    Refuse(file, fmt::format("cannot be used: {}", error.what()), kExportedAsWritten);
  }
}

ExportedFingerprint::ExportedFingerprint(const std::filesystem::path& folder)
    : parts_(Read(folder)),
      channels_(ChannelsOf(parts_.joints, parts_.acceleration)),
      nominal_(NetworkOf(folder / kNominalOnnx, parts_.nominal_bytes, 3 * parts_.joints, parts_.joints,
                         OnnxNetwork::Predicts::kValues)),
      classifier_(NetworkOf(folder / kClassifierOnnx, parts_.classifier_bytes,
                            parts_.classifier_golden.front().features.size(), 2,
                            OnnxNetwork::Predicts::kClasses)),
      nominal_layers_(LayersOf(folder / kNominalOnnx, parts_.nominal_bytes)) {
  const auto worst_of = [](OnnxNetwork& network, const std::vector<Golden>& golden,
                           const Eigen::RowVectorXd& scale) {
    double worst = 0.0;
    for (const Golden& vector : golden) {
      const Eigen::RowVectorXd off = (network.Run(vector.features).prediction - vector.prediction).cwiseAbs();
      const double share = off.cwiseQuotient(scale).maxCoeff();
      if (!(share <= worst)) worst = std::isnan(share) ? std::numeric_limits<double>::infinity() : share;
    }
    return worst;
  };
  worst_disagreement_ =
      std::max(worst_of(nominal_, parts_.nominal_golden, nominal_layers_.output.scale),
               worst_of(classifier_, parts_.classifier_golden, Eigen::RowVectorXd::Ones(2)));
  if (!(worst_disagreement_ <= kExportAgreement))
    Refuse(folder, fmt::format("the self-test fails: off the golden vectors by {:.1e}", worst_disagreement_),
           fmt::format("at most {:.0e}", kExportAgreement));
}

SignalNeeds ExportedFingerprint::needs() const {
  return {.records = daq::RecordKind::kJoints,
          .signals = {channels_, parts_.sample_rate_hz, false},
          .window = {},
          .least_samples = parts_.least_samples};
}

std::variant<PredictedOutputs, SignalFault> ExportedFingerprint::Predict(
    std::span<const NamedSignal> signals, double sample_rate_hz, std::optional<double> /*samples_per_turn*/,
    const OperatingPoint& /*operating*/) {
  const SignalSettings settings = needs().signals;
  if (DecimationFactor(sample_rate_hz, settings) == 0) return RateFault(sample_rate_hz, settings);
  daq::Record record{.kind = daq::RecordKind::kJoints, .metadata = {}, .columns = {}, .source = {}};
  for (const std::string& channel : channels_) {
    const auto signal = std::ranges::find(signals, std::string_view(channel), &NamedSignal::name);
    if (signal == signals.end()) return MissingChannel(channel, settings);
    // A joint may well stand: only a torque that never changes is a sensor that is not connected.
    auto fault = SensorFault(channel, signal->samples);
    if (fault && (fault->kind == SignalFaultKind::kNotFinite || channel.starts_with("tau")))
      return *std::move(fault);
    record.columns.push_back(
        {channel, std::vector<double>(signal->samples.begin(), signal->samples.end()), {}, {}});
  }
  dynamics::JointMotion motion;
  try {
    motion = SmoothedMotion(record, parts_.smoothing, sample_rate_hz, parts_.acceleration);
  } catch (const std::invalid_argument& error) {
    return SignalFault{SignalFaultKind::kTooShort, error.what()};
  }
  const dynamics::JointMotion samples =
      dynamics::RowsOf(motion, dynamics::EvenRows(motion.size(), parts_.samples));
  const Eigen::MatrixXd fingerprints = dynamics::NominalFingerprints(
      nominal_layers_, samples,
      dynamics::Attribute(nominal_layers_, samples.states, parts_.background, parts_.attribution)
          .fingerprints);
  PredictedOutputs predicted{.value = {0.0, 0.0}, .half_width = {0.0, 0.0}};
  std::vector<double> distances;
  for (Index row = 0; row < samples.size(); ++row) {
    const OnnxNetwork::Output of_classes = classifier_.Run(fingerprints.row(row));
    for (Index k = 0; k < 2; ++k)
      predicted.value[static_cast<std::size_t>(k)] +=
          of_classes.prediction(k) / static_cast<double>(samples.size());
    distances.push_back(std::max(nominal_.Run(samples.states.row(row)).distance, of_classes.distance));
  }
  predicted.distance = MiddleOf(std::move(distances));
  if (!std::isfinite(predicted.value.front()) || !std::isfinite(predicted.distance))
    return SignalFault{SignalFaultKind::kUndefined,
                       "the prediction is not a number (expected signals like those trained on)"};
  return predicted;
}

}  // namespace strainwave::bench
