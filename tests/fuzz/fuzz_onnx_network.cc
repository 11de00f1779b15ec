// SPDX-License-Identifier: Apache-2.0
// Any bytes as an exported network: what is taken runs, all else is refused before OpenCV sees it.
#include <cstdint>
#include <stdexcept>
#include <string>

#include "bench/prediction/onnx_network.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using strainwave::bench::OnnxNetwork;
  constexpr Eigen::Index kInputs = 8, kOutputs = 2;
  if (size == 0) return 0;
  const auto predicts =
      (data[0] & 1U) != 0 ? OnnxNetwork::Predicts::kClasses : OnnxNetwork::Predicts::kValues;
  try {
    OnnxNetwork network(std::string(reinterpret_cast<const char*>(data + 1), size - 1), kInputs, kOutputs,
                        predicts);
    network.Run(Eigen::RowVectorXd::Constant(kInputs, 0.5));
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
