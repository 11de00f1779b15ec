// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/predictor_file.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/folder.h"
#include "bench/errors/bench_error.h"
#include "bench/json_text.h"
#include "bench/prediction/network_json.h"
#include "daq/arrays_file.h"
#include "daq/record_error.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

namespace networks = analysis::networks;
namespace prediction = analysis::prediction;
using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr const char* kDescription = "predictor.json";
constexpr const char* kNumbers = "numbers.h5";
constexpr const char* kValues = "values";
constexpr const char* kClasses = "classes";

daq::NamedArray RowOf(const char* name, const Eigen::RowVectorXd& row) {
  return {name, {static_cast<std::size_t>(row.size())}, {row.begin(), row.end()}};
}

daq::NamedArray MatrixOf(const char* name, const Eigen::MatrixXd& matrix) {
  daq::NamedArray array{
      name, {static_cast<std::size_t>(matrix.rows()), static_cast<std::size_t>(matrix.cols())}, {}};
  array.values.reserve(static_cast<std::size_t>(matrix.size()));
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
      array.values.push_back(matrix(row, column));
  }
  return array;
}

daq::ArraysFile NumbersOf(const prediction::FittedPredictor& fitted) {
  const prediction::Ensemble& ensemble = fitted.ensemble;
  Eigen::MatrixXd members(static_cast<Eigen::Index>(ensemble.members.size()),
                          ensemble.network.parameter_count());
  for (std::size_t k = 0; k < ensemble.members.size(); ++k) {
    members.row(static_cast<Eigen::Index>(k)) = ensemble.members[k].transpose();
  }
  daq::ArraysFile numbers{
      .attributes = {},
      .arrays = {RowOf("input_offset", ensemble.input.offset), RowOf("input_scale", ensemble.input.scale),
                 RowOf("output_offset", ensemble.output.offset), RowOf("output_scale", ensemble.output.scale),
                 MatrixOf("members", members), RowOf("residual", fitted.residual),
                 RowOf("interval_factor", fitted.band.factor), RowOf("novelty_mean", fitted.novelty.mean),
                 MatrixOf("novelty_whitening", fitted.novelty.whitening), RowOf("least", fitted.least),
                 RowOf("greatest", fitted.greatest)}};
  if (!ensemble.line.empty()) {
    numbers.arrays.push_back(MatrixOf("line_slope", ensemble.line.slope));
    numbers.arrays.push_back(RowOf("line_lowest", ensemble.line.lowest));
    numbers.arrays.push_back(RowOf("line_highest", ensemble.line.highest));
  }
  return numbers;
}

// Takes arrays of a file by name and shape.
class Numbers {
 public:
  Numbers(const std::filesystem::path& path, const daq::ArraysFile& file) : path_(path), file_(file) {}

  Eigen::MatrixXd Matrix(const char* name, std::size_t rows, std::size_t columns) const {
    const std::vector<double>& values = Values(name, {rows, columns});
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return Eigen::Map<const RowMajor>(values.data(), static_cast<Eigen::Index>(rows),
                                      static_cast<Eigen::Index>(columns));
  }
  Eigen::RowVectorXd Row(const char* name, std::size_t columns) const {
    const std::vector<double>& values = Values(name, {columns});
    return Eigen::Map<const Eigen::RowVectorXd>(values.data(), static_cast<Eigen::Index>(columns));
  }

 private:
  const std::vector<double>& Values(const char* name, const std::vector<std::size_t>& shape) const {
    const daq::NamedArray* array = file_.Find(name);
    if (array == nullptr || array->shape != shape) {
      Refuse(path_, fmt::format("the array '{}' is missing or of another shape", name),
             fmt::format("{} values, as {} says", shape.size() == 1 ? shape[0] : shape[0] * shape[1],
                         kDescription));
    }
    return array->values;
  }

  const std::filesystem::path& path_;
  const daq::ArraysFile& file_;
};

std::string ReadPartOfPredictor(const std::filesystem::path& path) {
  try {
    return daq::ReadWholeFile(path);
  } catch (const daq::RecordError&) {
    Refuse(path, "cannot be read", "a predictor, as `strainwave train` writes it");
  }
}

prediction::FittedPredictor FittedFrom(const Json& json, const Numbers& numbers, std::size_t inputs,
                                       std::size_t outputs) {
  networks::Network network(DesignFrom(json.at("network")));
  if (network.input_size() != static_cast<Eigen::Index>(inputs) ||
      network.output_size() != static_cast<Eigen::Index>(outputs)) {
    throw std::invalid_argument(fmt::format("a network of {} inputs and {} outputs for {} and {}",
                                            network.input_size(), network.output_size(), inputs, outputs));
  }
  const auto members = json.at("members").get<std::size_t>();
  const Eigen::MatrixXd parameters =
      numbers.Matrix("members", members, static_cast<std::size_t>(network.parameter_count()));
  // All that can throw comes first: g++ 12 destroys the parts of a half-made aggregate twice.
  Eigen::RowVectorXd input_offset = numbers.Row("input_offset", inputs);
  Eigen::RowVectorXd input_scale = numbers.Row("input_scale", inputs);
  Eigen::RowVectorXd output_offset = numbers.Row("output_offset", outputs);
  Eigen::RowVectorXd output_scale = numbers.Row("output_scale", outputs);
  prediction::Line line;
  if (json.value("beside_line", false)) {
    line.slope = numbers.Matrix("line_slope", inputs, outputs);
    line.lowest = numbers.Row("line_lowest", inputs);
    line.highest = numbers.Row("line_highest", inputs);
  }
  Eigen::RowVectorXd residual = numbers.Row("residual", outputs);
  Eigen::RowVectorXd factor = numbers.Row("interval_factor", outputs);
  Eigen::RowVectorXd novelty_mean = numbers.Row("novelty_mean", inputs);
  Eigen::MatrixXd whitening = numbers.Matrix("novelty_whitening", inputs, inputs);
  Eigen::RowVectorXd least = numbers.Row("least", inputs);
  Eigen::RowVectorXd greatest = numbers.Row("greatest", inputs);
  const bool softmax = json.value("predicts", kValues) == std::string(kClasses);
  const auto coverage = json.at("interval").at("coverage").get<double>();
  const auto guaranteed = json.at("interval").at("guaranteed").get<bool>();
  const auto novelty_limit = json.at("novelty_limit").get<double>();
  prediction::FittedPredictor fitted{
      .ensemble = {.input = {std::move(input_offset), std::move(input_scale)},
                   .output = {std::move(output_offset), std::move(output_scale)},
                   .line = std::move(line),
                   .network = std::move(network),
                   .members = {},
                   .softmax = softmax},
      .residual = std::move(residual),
      .band = {.coverage = coverage, .factor = std::move(factor), .guaranteed = guaranteed},
      .novelty = {.mean = std::move(novelty_mean), .whitening = std::move(whitening), .limit = novelty_limit},
      .least = std::move(least),
      .greatest = std::move(greatest)};
  for (Eigen::Index k = 0; k < parameters.rows(); ++k) {
    fitted.ensemble.members.emplace_back(parameters.row(k).transpose());
  }
  return fitted;
}

}  // namespace

void WritePredictor(const std::filesystem::path& folder, const Predictor& predictor) {
  std::filesystem::create_directories(folder);
  const prediction::FittedPredictor& fitted = predictor.fitted;
  daq::WriteArraysAtomically(folder / kNumbers, NumbersOf(fitted));
  const Json json{
      {"format", kFormat},
      {"recipe", JsonOf(predictor.recipe)},
      {"predicts", predictor.classes() ? kClasses : kValues},
      {"outputs", predictor.outputs},
      {"network", JsonOf(fitted.ensemble.network.design())},
      {"members", fitted.ensemble.members.size()},
      {"beside_line", !fitted.ensemble.line.empty()},
      {"interval", {{"coverage", fitted.band.coverage}, {"guaranteed", fitted.band.guaranteed}}},
      {"novelty_limit", fitted.novelty.limit},
      {"numbers", {{"file", kNumbers}, {"sha256", Sha256(daq::ReadWholeFile(folder / kNumbers))}}},
      {"training", Json::parse(predictor.training_json)}};
  // Last: a folder without it is no predictor yet.
  daq::WriteFileAtomically(folder / kDescription, json.dump(2) + "\n");
}

Predictor ReadPredictor(const std::filesystem::path& folder) {
  const std::filesystem::path description = folder / kDescription;
  const std::filesystem::path numbers = folder / kNumbers;
  const std::string text = ReadPartOfPredictor(description);
  const std::string bytes = ReadPartOfPredictor(numbers);
  try {
    const Json json = ParseJson(text);
    if (json.at("format").get<int>() != kFormat) {
      Refuse(description, fmt::format("format {}", ShortText(json.at("format"))),
             fmt::format("format {}", kFormat));
    }
    if (Sha256(bytes) != json.at("numbers").at("sha256").get<std::string>()) {
      Refuse(numbers, "the file has changed since it was written",
             "the SHA-256 that predictor.json has of it");
    }
    FeatureRecipe recipe = RecipeFrom(json.at("recipe"), description);
    auto outputs = json.at("outputs").get<std::vector<std::string>>();
    const daq::ArraysFile arrays = daq::ReadArrays(numbers);
    prediction::FittedPredictor fitted =
        FittedFrom(json, Numbers(numbers, arrays), recipe.inputs.size(), outputs.size());
    std::string training = json.at("training").dump();
    return {std::move(recipe), std::move(outputs), std::move(fitted), std::move(training)};
  } catch (const Json::exception& error) {
    Refuse(description, fmt::format("cannot be used: {}", error.what()), "the file as it was written");
  } catch (const std::invalid_argument& error) {
    Refuse(description, fmt::format("cannot be used: {}", error.what()), "the file as it was written");
  } catch (const daq::RecordError& error) {
    throw BenchError(ExitCode::kWrongInput, error.what());
  }
}

}  // namespace strainwave::bench
