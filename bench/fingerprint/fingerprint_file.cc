// SPDX-License-Identifier: Apache-2.0
#include "bench/fingerprint/fingerprint_file.h"

#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/joint_dynamics/nominal.h"
#include "bench/errors/bench_error.h"
#include "bench/fingerprint/fingerprint_names.h"
#include "bench/json_text.h"
#include "bench/prediction/network_json.h"
#include "bench/prediction/sealed_json.h"
#include "bench/sha256.h"
#include "daq/arrays_file.h"
#include "daq/record_error.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

namespace dynamics = analysis::joint_dynamics;
namespace networks = analysis::networks;
namespace prediction = analysis::prediction;
using Json = nlohmann::ordered_json;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int kFingerprintFormat = 2;
constexpr const char* kFingerprintJson = "fingerprint.json";
constexpr const char* kFingerprintNumbers = "numbers.h5";
constexpr const char* kAsWritten = "a model as `strainwave fingerprint train` writes it";

daq::NamedArray ArrayOf(const std::string& name, const Eigen::MatrixXd& matrix) {
  const RowMajor rows = matrix;
  return {name,
          {static_cast<std::size_t>(matrix.rows()), static_cast<std::size_t>(matrix.cols())},
          {rows.data(), rows.data() + rows.size()}};
}

void AddNetwork(daq::ArraysFile& numbers, const std::string& name, const prediction::Ensemble& ensemble) {
  numbers.arrays.push_back(ArrayOf(name + "_input_offset", ensemble.input.offset));
  numbers.arrays.push_back(ArrayOf(name + "_input_scale", ensemble.input.scale));
  numbers.arrays.push_back(ArrayOf(name + "_output_offset", ensemble.output.offset));
  numbers.arrays.push_back(ArrayOf(name + "_output_scale", ensemble.output.scale));
  numbers.arrays.push_back(ArrayOf(name + "_parameters", ensemble.members.front().transpose()));
}

// Arrays by name, of a shape that the description asks for.
class ModelNumbers {
 public:
  ModelNumbers(const std::filesystem::path& path, const daq::ArraysFile& file) : path_(path), file_(file) {}

  /// @param rows  any number where it is negative.
  Eigen::MatrixXd Take(const std::string& name, Eigen::Index rows, Eigen::Index columns) const {
    const daq::NamedArray* array = file_.Find(name);
    const bool fits = array != nullptr && array->shape.size() == 2 &&
                      array->shape[1] == static_cast<std::size_t>(columns) && array->shape[0] > 0 &&
                      (rows < 0 || array->shape[0] == static_cast<std::size_t>(rows));
    if (!fits)
      Refuse(path_, fmt::format("the array '{}' is missing or of another shape", name),
             fmt::format("{} columns, as {} says", columns, kFingerprintJson));
    return Eigen::Map<const RowMajor>(array->values.data(), static_cast<Eigen::Index>(array->shape[0]),
                                      columns);
  }

  prediction::Ensemble Network(const std::string& name, const Json& design, Eigen::Index inputs,
                               Eigen::Index outputs, bool softmax) const {
    networks::Network network(DesignFrom(design));
    if (network.input_size() != inputs || network.output_size() != outputs)
      throw std::invalid_argument(fmt::format("a network of {} inputs and {} outputs for {} and {}",
                                              network.input_size(), network.output_size(), inputs, outputs));
    Eigen::RowVectorXd input_offset = Take(name + "_input_offset", 1, inputs);
    Eigen::RowVectorXd input_scale = Take(name + "_input_scale", 1, inputs);
    Eigen::RowVectorXd output_offset = Take(name + "_output_offset", 1, outputs);
    Eigen::RowVectorXd output_scale = Take(name + "_output_scale", 1, outputs);
    networks::Vector<double> parameters =
        Take(name + "_parameters", 1, network.parameter_count()).transpose();
    prediction::Ensemble ensemble{.input = {std::move(input_offset), std::move(input_scale)},
                                  .output = {std::move(output_offset), std::move(output_scale)},
                                  .network = std::move(network),
                                  .members = {},
                                  .softmax = softmax};
    ensemble.members.push_back(std::move(parameters));
    return ensemble;
  }

 private:
  const std::filesystem::path& path_;
  const daq::ArraysFile& file_;
};

Json DescriptionOf(const FingerprintModel& model) {
  return {{"format", kFingerprintFormat},
          {"joints", model.joints()},
          {"fingerprint", dynamics::NameOf(model.attribution.fingerprint)},
          {"method", dynamics::NameOf(model.attribution.method)},
          {"coalitions", model.attribution.coalitions},
          {"seed", model.attribution.seed},
          {"samples_per_file", model.samples},
          {"window_s", model.smoothing.window_s},
          {"order", model.smoothing.order},
          {"acceleration", model.acceleration_measured ? "measured" : "from_velocity"},
          {"sample_rate_hz", model.sample_rate_hz},
          {"shortest_s", model.shortest_s},
          {"healthy_class", model.healthy},
          {"background", "states of healthy files, spread evenly over each"},
          {"novelty_limits",
           {{"states", model.state_novelty.limit}, {"fingerprints", model.fingerprint_novelty.limit}}},
          {"nominal", JsonOf(model.nominal.network.design())},
          {"classifier", JsonOf(model.classifier.network.design())}};
}

FingerprintModel ModelFrom(const Json& json, const ModelNumbers& numbers) {
  const auto joints = json.at("joints").get<Eigen::Index>();
  if (joints < 1) throw std::invalid_argument("a model of no joints");
  dynamics::AttributionSettings attribution;
  attribution.fingerprint = FingerprintKindNamed(json.at("fingerprint").get<std::string>());
  attribution.method = AttributionMethodNamed(json.at("method").get<std::string>());
  attribution.coalitions = json.at("coalitions").get<std::size_t>();
  attribution.seed = json.at("seed").get<std::uint64_t>();
  const auto features =
      static_cast<Eigen::Index>(dynamics::NominalNames(attribution.fingerprint, joints).size());
  Smoothing smoothing{json.at("window_s").get<double>(), json.at("order").get<int>(), false};
  const auto samples = json.at("samples_per_file").get<Eigen::Index>();
  if (samples < 1 || smoothing.order < 1 || !(smoothing.window_s > 0.0))
    throw std::invalid_argument("samples, window and order are to be above 0");
  prediction::Ensemble nominal = numbers.Network("nominal", json.at("nominal"), 3 * joints, joints, false);
  prediction::Ensemble classifier = numbers.Network("classifier", json.at("classifier"), features, 2, true);
  Eigen::MatrixXd background = numbers.Take("background", -1, 3 * joints);
  Eigen::MatrixXd healthy_fingerprints = numbers.Take("healthy_fingerprints", -1, features);
  prediction::Novelty of_states{numbers.Take("state_novelty_mean", 1, 3 * joints),
                                numbers.Take("state_novelty_whitening", 3 * joints, 3 * joints),
                                json.at("novelty_limits").at("states").get<double>()};
  prediction::Novelty of_fingerprints{numbers.Take("fingerprint_novelty_mean", 1, features),
                                      numbers.Take("fingerprint_novelty_whitening", features, features),
                                      json.at("novelty_limits").at("fingerprints").get<double>()};
  Eigen::RowVectorXd lowest = numbers.Take("lowest", 1, 3 * joints);
  Eigen::RowVectorXd highest = numbers.Take("highest", 1, 3 * joints);
  const bool measured = json.at("acceleration").get<std::string>() == "measured";
  const auto sample_rate_hz = json.at("sample_rate_hz").get<double>();
  const auto shortest_s = json.at("shortest_s").get<double>();
  if (!(sample_rate_hz > 0.0) || !(shortest_s > 0.0))
    throw std::invalid_argument("rate and shortest record are to be above 0");
  auto healthy = json.at("healthy_class").get<std::string>();
  std::string training = json.at("training").dump();
  // Nothing below throws: g++ 12 destroys the parts of a half-made aggregate twice.
  return {.nominal = std::move(nominal),
          .classifier = std::move(classifier),
          .background = std::move(background),
          .healthy_fingerprints = std::move(healthy_fingerprints),
          .state_novelty = std::move(of_states),
          .fingerprint_novelty = std::move(of_fingerprints),
          .lowest = std::move(lowest),
          .highest = std::move(highest),
          .attribution = attribution,
          .samples = samples,
          .smoothing = smoothing,
          .acceleration_measured = measured,
          .sample_rate_hz = sample_rate_hz,
          .shortest_s = shortest_s,
          .healthy = std::move(healthy),
          .training_json = std::move(training)};
}

}  // namespace

void WriteFingerprintModel(const std::filesystem::path& folder, const FingerprintModel& model) {
  std::filesystem::create_directories(folder);
  daq::ArraysFile numbers;
  AddNetwork(numbers, "nominal", model.nominal);
  AddNetwork(numbers, "classifier", model.classifier);
  numbers.arrays.push_back(ArrayOf("background", model.background));
  numbers.arrays.push_back(ArrayOf("healthy_fingerprints", model.healthy_fingerprints));
  numbers.arrays.push_back(ArrayOf("state_novelty_mean", model.state_novelty.mean));
  numbers.arrays.push_back(ArrayOf("state_novelty_whitening", model.state_novelty.whitening));
  numbers.arrays.push_back(ArrayOf("fingerprint_novelty_mean", model.fingerprint_novelty.mean));
  numbers.arrays.push_back(ArrayOf("fingerprint_novelty_whitening", model.fingerprint_novelty.whitening));
  numbers.arrays.push_back(ArrayOf("lowest", model.lowest));
  numbers.arrays.push_back(ArrayOf("highest", model.highest));
  daq::WriteArraysAtomically(folder / kFingerprintNumbers, numbers);
  Json json = DescriptionOf(model);
  json["numbers"] = {{"file", kFingerprintNumbers},
                     {"sha256", Sha256(daq::ReadWholeFile(folder / kFingerprintNumbers))}};
  json["training"] = Json::parse(model.training_json);
  Seal(json);
  // Last: a folder without it is no model yet.
  daq::WriteFileAtomically(folder / kFingerprintJson, json.dump(2) + "\n");
}

FingerprintModel ReadFingerprintModel(const std::filesystem::path& folder) {
  const std::filesystem::path description = folder / kFingerprintJson;
  const std::filesystem::path numbers = folder / kFingerprintNumbers;
  const std::string text = ReadBounded(description, kAsWritten);
  const std::string bytes = ReadBounded(numbers, kAsWritten);
  try {
    const Json json = ParseJson(text);
    if (json.at("format").get<int>() != kFingerprintFormat)
      Refuse(description, fmt::format("format {}", ShortText(json.at("format"))),
             fmt::format("format {}; train the model again", kFingerprintFormat));
    RequireSeal(description, json);
    if (Sha256(bytes) != json.at("numbers").at("sha256").get<std::string>())
      Refuse(numbers, "the file has changed since it was written",
             fmt::format("the SHA-256 that {} has of it", kFingerprintJson));
    const daq::ArraysFile arrays = daq::ReadArrays(numbers);
    return ModelFrom(json, ModelNumbers(numbers, arrays));
  } catch (const Json::exception& error) {
    Refuse(description, fmt::format("cannot be used: {}", error.what()), kAsWritten);
  } catch (const std::invalid_argument& error) {
    Refuse(description, fmt::format("cannot be used: {}", error.what()), kAsWritten);
  } catch (const daq::RecordError& error) {
    throw BenchError(ExitCode::kWrongInput, error.what());
  }
}

}  // namespace strainwave::bench
