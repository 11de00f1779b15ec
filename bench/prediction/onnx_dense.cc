// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/onnx_dense.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <onnx/onnx_pb.h>

namespace strainwave::bench {
namespace {

namespace networks = analysis::networks;
namespace prediction = analysis::prediction;

[[noreturn]] void RefuseOnnx(const std::string& what) {
  throw std::invalid_argument(
      fmt::format("the ONNX file {} (expected one network of dense layers, as `export` writes it)", what));
}

const onnx::TensorProto* FindTensor(const onnx::GraphProto& graph, std::string_view name) {
  const auto found = std::ranges::find(graph.initializer(), name, &onnx::TensorProto::name);
  return found == graph.initializer().end() ? nullptr : &*found;
}

// rows × columns; a tensor of one dimension is a row.
Eigen::MatrixXd Values(const onnx::GraphProto& graph, const std::string& name, Eigen::Index columns) {
  const onnx::TensorProto* tensor = FindTensor(graph, name);
  if (tensor == nullptr) RefuseOnnx(fmt::format("has no array '{}'", name));
  const Eigen::Index count = tensor->float_data_size();
  if (columns < 1 || count < columns || count % columns != 0)
    RefuseOnnx(fmt::format("has an array '{}' of {} values", name, count));
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(tensor->float_data().data(), count / columns, columns).cast<double>();
}

Eigen::RowVectorXd Row(const onnx::GraphProto& graph, const std::string& name, Eigen::Index size) {
  const Eigen::MatrixXd values = Values(graph, name, size);
  if (values.rows() != 1) RefuseOnnx(fmt::format("has an array '{}' of more than one row", name));
  return values.row(0);
}

bool HasNode(const onnx::GraphProto& graph, std::string_view operation, std::string_view output) {
  return std::ranges::any_of(graph.node(), [&](const onnx::NodeProto& node) {
    return node.op_type() == operation &&
           (output.empty() || (node.output_size() == 1 && node.output(0) == output));
  });
}

networks::Activation ActivationAt(const onnx::GraphProto& graph, const std::string& layer) {
  using networks::Activation;
  constexpr std::pair<const char*, Activation> kOperations[] = {
      {"Tanh", Activation::kTanh}, {"Relu", Activation::kRelu}, {"Sigmoid", Activation::kSigmoid}};
  for (const auto& [operation, activation] : kOperations) {
    if (HasNode(graph, operation, layer + "_value")) return activation;
  }
  return Activation::kLinear;
}

}  // namespace

prediction::Ensemble DenseEnsembleFrom(const std::string& onnx_bytes) {
  onnx::ModelProto model;
  if (!model.ParseFromString(onnx_bytes)) RefuseOnnx("cannot be parsed");
  const onnx::GraphProto& graph = model.graph();
  if (FindTensor(graph, "member1_layer0_weights") != nullptr || FindTensor(graph, "line_slope") != nullptr)
    RefuseOnnx("has more than one network");
  if (HasNode(graph, "Conv", {})) RefuseOnnx("has convolutions");
  const onnx::TensorProto* offset = FindTensor(graph, "input_offset");
  if (offset == nullptr) RefuseOnnx("has no array 'input_offset'");
  networks::Design design{.input = {1, offset->float_data_size()}, .layers = {}};
  std::vector<double> parameters;
  int width = design.input.size();
  for (int k = 0;; ++k) {
    const std::string layer = fmt::format("member0_layer{}", k);
    if (FindTensor(graph, layer + "_weights") == nullptr) break;
    const Eigen::MatrixXd weights = Values(graph, layer + "_weights", width).transpose();  // row after row
    width = static_cast<int>(weights.cols());
    const Eigen::RowVectorXd biases = Row(graph, layer + "_bias", width);
    parameters.insert(parameters.end(), weights.data(), weights.data() + weights.size());
    parameters.insert(parameters.end(), biases.begin(), biases.end());
    design.layers.emplace_back(networks::Dense{width, ActivationAt(graph, layer)});
  }
  if (design.layers.empty()) RefuseOnnx("has no dense layer");
  const Eigen::Index inputs = design.input.size();
  const bool softmax = HasNode(graph, "Softmax", {});
  prediction::Scaler output{Eigen::RowVectorXd::Zero(width), Eigen::RowVectorXd::Ones(width)};
  if (!softmax) output = {Row(graph, "level", width), Row(graph, "output_scale", width)};
  prediction::Scaler input{Row(graph, "input_offset", inputs), Row(graph, "input_scale", inputs)};
  networks::Network network(std::move(design));
  networks::Vector<double> member =
      Eigen::Map<const Eigen::VectorXd>(parameters.data(), static_cast<Eigen::Index>(parameters.size()));
  prediction::Ensemble ensemble{.input = std::move(input),
                                .output = std::move(output),
                                .network = std::move(network),
                                .members = {},
                                .softmax = softmax};
  ensemble.members.push_back(std::move(member));
  return ensemble;
}

}  // namespace strainwave::bench
