// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/onnx_network.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <onnx/onnx_pb.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>

namespace strainwave::bench {
namespace {

constexpr std::string_view kOperators[] = {"Sub",     "Div",  "Reshape", "Conv",    "Relu",
                                           "Sigmoid", "Tanh", "MaxPool", "Flatten", "GlobalAveragePool",
                                           "Gemm",    "Mul",  "Add",     "Sqrt"};
constexpr std::int64_t kMostValues = std::int64_t{1} << 26;

[[noreturn]] void Refuse(const std::string& what) {
  throw std::invalid_argument("the ONNX file " + what + " (expected one that `strainwave export` wrote)");
}

void RequireShape(const onnx::ValueInfoProto& value, std::string_view name, std::int64_t columns) {
  const auto& shape = value.type().tensor_type().shape();
  if (value.name() != name || shape.dim_size() != 2 || shape.dim(0).dim_value() != 1 ||
      shape.dim(1).dim_value() != columns ||
      value.type().tensor_type().elem_type() != onnx::TensorProto::FLOAT) {
    Refuse(fmt::format("has '{}' where '{}' of 1 × {} should be", value.name(), name, columns));
  }
}

// The sizes say how many values there are, and so many there are.
void RequireWhole(const onnx::TensorProto& tensor) {
  std::int64_t count = 1;
  for (const std::int64_t size : tensor.dims()) {
    if (size < 0 || size > kMostValues)
      Refuse(fmt::format("has an array '{}' of size {}", tensor.name(), size));
    count *= size;
    if (count > kMostValues)
      Refuse(fmt::format("has an array '{}' of more than {} values", tensor.name(), kMostValues));
  }
  const bool whole = tensor.data_type() == onnx::TensorProto::FLOAT   ? tensor.float_data_size() == count
                     : tensor.data_type() == onnx::TensorProto::INT64 ? tensor.int64_data_size() == count
                                                                      : false;
  if (!whole) Refuse(fmt::format("has an array '{}' whose values are not those of its sizes", tensor.name()));
}

// Every value is made before it is used.
void RequireOrder(const onnx::GraphProto& graph) {
  std::vector<std::string_view> made{graph.input(0).name()};
  for (const auto& tensor : graph.initializer()) made.push_back(tensor.name());
  const auto is_made = [&made](std::string_view name) { return std::ranges::find(made, name) != made.end(); };
  for (const onnx::NodeProto& node : graph.node()) {
    if (std::ranges::find(kOperators, node.op_type()) == std::end(kOperators)) {
      Refuse(fmt::format("has an operator '{}'", node.op_type()));
    }
    for (const std::string& input : node.input()) {
      if (!is_made(input)) Refuse(fmt::format("uses '{}' before it is made", input));
    }
    if (node.output_size() != 1 || is_made(node.output(0))) {
      Refuse(fmt::format("has a node '{}' that makes no value of its own", node.name()));
    }
    made.push_back(node.output(0));
  }
}

void RequireOurs(const std::string& bytes, std::int64_t inputs, std::int64_t outputs) {
  onnx::ModelProto model;
  if (!model.ParseFromString(bytes)) Refuse("cannot be parsed");
  const onnx::GraphProto& graph = model.graph();
  if (graph.input_size() != 1 || graph.output_size() != 3) {
    Refuse(fmt::format("has {} inputs and {} outputs", graph.input_size(), graph.output_size()));
  }
  RequireShape(graph.input(0), "features", inputs);
  RequireShape(graph.output(0), "prediction", outputs);
  RequireShape(graph.output(1), "half_width", outputs);
  RequireShape(graph.output(2), "distance", 1);
  for (const onnx::TensorProto& tensor : graph.initializer()) RequireWhole(tensor);
  RequireOrder(graph);
}

}  // namespace

struct OnnxNetwork::Net {
  cv::dnn::Net net;
  cv::Mat features;
  std::vector<cv::Mat> results;
  std::vector<std::string> names{"prediction", "half_width", "distance"};
};

OnnxNetwork::OnnxNetwork(const std::string& bytes, Eigen::Index inputs, Eigen::Index outputs)
    : net_(std::make_unique<Net>()), inputs_(inputs), outputs_(outputs) {
  RequireOurs(bytes, inputs, outputs);
  // What it has to say comes as an exception, too.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  try {
    net_->net = cv::dnn::readNetFromONNX(bytes.data(), bytes.size());
    net_->features = cv::Mat::zeros(1, static_cast<int>(inputs), CV_32F);
    net_->net.setInput(net_->features, "features");
    net_->net.forward(net_->results, net_->names);
  } catch (const cv::Exception& error) {
    Refuse(fmt::format("cannot be run: {}", error.err));
  } catch (
      const std::exception& error) {  // sizes that no memory holds, and what else a hostile file provokes
    Refuse(fmt::format("cannot be run: {}", error.what()));
  }
  if (net_->results.size() != 3 || net_->results[0].total() != static_cast<std::size_t>(outputs) ||
      net_->results[1].total() != static_cast<std::size_t>(outputs) || net_->results[2].total() != 1) {
    Refuse("gives results of another shape");
  }
}

OnnxNetwork::OnnxNetwork(OnnxNetwork&&) noexcept = default;
OnnxNetwork& OnnxNetwork::operator=(OnnxNetwork&&) noexcept = default;
OnnxNetwork::~OnnxNetwork() = default;

OnnxNetwork::Output OnnxNetwork::Run(const Eigen::RowVectorXd& features) {
  if (features.size() != inputs_) {
    throw std::invalid_argument(fmt::format("{} features (expected {})", features.size(), inputs_));
  }
  for (int i = 0; i < static_cast<int>(inputs_); ++i)
    net_->features.at<float>(i) = static_cast<float>(features(i));
  net_->net.setInput(net_->features, "features");
  net_->net.forward(net_->results, net_->names);
  using Values = Eigen::Map<const Eigen::RowVectorXf>;
  return {.prediction = Values(net_->results[0].ptr<float>(), outputs_).cast<double>(),
          .half_width = Values(net_->results[1].ptr<float>(), outputs_).cast<double>(),
          .distance = static_cast<double>(*net_->results[2].ptr<float>())};
}

}  // namespace strainwave::bench
