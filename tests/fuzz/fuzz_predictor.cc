// SPDX-License-Identifier: Apache-2.0
// Any text as predictor.json, and beside it numbers of other shapes and values: refused in words, or of use.
// The text gets the digest of these numbers; behind its first NUL are changes to them, two bytes each.
// longest: 4096
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string>

#include "bench/errors/bench_error.h"
#include "bench/prediction/predictor_file.h"
#include "bench/prediction/signal_inputs.h"
#include "bench/sha256.h"
#include "daq/arrays_file.h"
#include "tests/bench/random_predictor.h"
#include "tests/fuzz/folder_in_memory.h"

namespace {

using namespace strainwave;
using Json = nlohmann::ordered_json;
namespace networks = strainwave::analysis::networks;

// Of two inputs and two outputs, beside a line.
daq::ArraysFile SomeNumbers(const FolderInMemory& folder) {
  bench::FeatureRecipe recipe;
  recipe.channels = {"accel_x_m_per_s2"};
  recipe.sample_rate_hz = 12000.0;
  recipe.window.turns = 8;
  recipe.least_samples = 3000;
  recipe.inputs = {"accel_x_m_per_s2.a1.mean", "accel_x_m_per_s2.a2.median"};
  const networks::Design design{{1, 2},
                                {networks::Dense{3, networks::Activation::kTanh}, networks::Dense{2}}};
  const auto fitted = bench::RandomPredictor(design, 2, bench::Head::kValues, true);
  bench::WritePredictor(folder.path(), {recipe, {"k1_Nm_per_rad", "k2_Nm_per_rad"}, fitted, "{}"});
  return daq::ReadArrays(folder.path() / "numbers.h5");
}

void Change(daq::ArraysFile& file, std::uint8_t which, std::uint8_t how) {
  constexpr std::array kOdd{0.0, -1.0, 1e300, std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity()};
  if (file.arrays.empty()) return;
  const auto at = file.arrays.begin() + which % static_cast<std::ptrdiff_t>(file.arrays.size());
  switch (how % 4) {
    case 0:
      file.arrays.erase(at);
      return;
    case 1:
      std::ranges::reverse(at->shape);
      return;
    case 2: {  // as many rows, or values, as it says
      const std::size_t others = at->shape.size() == 2 ? at->shape[1] : 1;
      at->shape[0] = how / 4;
      at->values.resize(at->shape[0] * others, 0.5);
      return;
    }
    default:
      std::ranges::fill(at->values, kOdd[(how / 4) % kOdd.size()]);
  }
}

void Try(const FolderInMemory& folder) {
  try {
    const bench::Predictor predictor = bench::ReadPredictor(folder.path());
    try {
      (void)bench::SignalInputs(predictor.recipe);
    } catch (const std::invalid_argument&) {
    }
    const Eigen::Index inputs = predictor.fitted.ensemble.network.input_size();
    const auto predicted = predictor.fitted.Predict(Eigen::MatrixXd::Ones(2, inputs));
    if (predicted.value.cols() != static_cast<Eigen::Index>(predictor.outputs.size())) std::abort();
  } catch (const bench::BenchError& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FolderInMemory folder;
  static const daq::ArraysFile whole = SomeNumbers(folder);
  const std::span<const std::uint8_t> input(data, size);
  const auto end = std::ranges::find(input, 0);
  daq::ArraysFile numbers = whole;
  if (end != input.end()) {
    constexpr std::size_t kMostChanges = 4;
    const auto changes = std::span(end + 1, input.end());
    for (std::size_t i = 0; i < std::min(kMostChanges, changes.size() / 2); ++i)
      Change(numbers, changes[2 * i], changes[2 * i + 1]);
  }
  std::string text(input.begin(), end);
  Json json = Json::parse(text, nullptr, false);
  if (!json.is_discarded() && json.is_object() && json.contains("numbers") && json["numbers"].is_object()) {
    daq::WriteArraysAtomically(folder.path() / "numbers.h5", numbers);
    json["numbers"]["sha256"] = bench::Sha256OfFile(folder.path() / "numbers.h5");
    text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  folder.Write("predictor.json", std::as_bytes(std::span(text)));
  Try(folder);
  return 0;
}
