// SPDX-License-Identifier: Apache-2.0
// Any JSON as the description of a model of health or of faults, sealed as it came, beside a predictor as it
// was written; and as the description of that predictor.
#include <cstdint>
#include <cstdlib>
#include <string>

#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"
#include "bench/faults/fault_model.h"
#include "bench/health/health_file.h"
#include "bench/prediction/predictor_file.h"
#include "bench/prediction/sealed_json.h"
#include "bench/sha256.h"
#include "daq/whole_file.h"
#include "tests/bench/random_predictor.h"
#include "tests/fuzz/folder_in_memory.h"

namespace {

using namespace strainwave::bench;
using Json = nlohmann::ordered_json;

// A small predictor of two outputs.
struct Made {
  Made() {
    WritePredictor(folder.path(), APredictor());
    description = Json::parse(strainwave::daq::ReadWholeFile(folder.path() / "predictor.json"));
  }
  static Predictor APredictor() {
    Predictor predictor;
    predictor.recipe.channels = {"accel_x_m_per_s2"};
    predictor.recipe.sample_rate_hz = 1000.0;
    predictor.recipe.inputs = {"a", "b"};
    predictor.outputs = {"k1_Nm_per_rad", "k2_Nm_per_rad"};
    namespace networks = strainwave::analysis::networks;
    predictor.fitted = RandomPredictor({{1, 2}, {networks::Dense{2}}}, 2);
    predictor.training_json = "{}";
    return predictor;
  }
  FolderInMemory folder;
  Json description;
};

template <typename Read>
void RefusedInWords(Read read) {
  try {
    read();
  } catch (const BenchError& error) {
    if (error.exit_code() != ExitCode::kWrongInput) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Made made;
  Json json = Json::parse(data, data + size, nullptr, false);
  if (json.is_discarded() || !json.is_object()) return 0;
  const auto write = [](const char* name, const std::string& text) {
    made.folder.Write(name, std::as_bytes(std::span(text)));
  };
  Json predictor = made.description;
  predictor.merge_patch(json);
  try {
    write("predictor.json", predictor.dump());
    json["predictor_sha256"] = Sha256(predictor.dump());
    json.erase("sha256");
    Seal(json);
  } catch (const Json::exception&) {
    return 0;  // no UTF-8, which no seal is made of
  }
  write("health.json", json.dump());
  write("faults.json", json.dump());
  RefusedInWords([] { (void)ReadPredictor(made.folder.path()); });
  RefusedInWords([] { (void)ReadHealthModel(made.folder.path()); });
  RefusedInWords([] { (void)ReadFaultModel(made.folder.path()); });
  return 0;
}
