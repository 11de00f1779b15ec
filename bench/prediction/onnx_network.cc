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

// The operators that a file of ours has, with the number of their inputs.
struct Operator {
  std::string_view name;
  int inputs;
};
constexpr Operator kOperators[] = {
    {"Sub", 2},     {"Div", 2},  {"Reshape", 2}, {"Conv", 3},    {"Relu", 1},
    {"Sigmoid", 1}, {"Tanh", 1}, {"MaxPool", 1}, {"Flatten", 1}, {"Gemm", 3},
    {"Mul", 2},     {"Add", 2},  {"Sqrt", 1},    {"Softmax", 1}, {"GlobalAveragePool", 1}};
constexpr std::int64_t kLongestWindow = 1 << 16;
constexpr std::int64_t kMostValues = std::int64_t{1} << 26;

[[noreturn]] void Refuse(const std::string& what) {
  throw std::invalid_argument("the ONNX file " + what + " (expected one that `strainwave export` wrote)");
}

void RequireShape(const onnx::ValueInfoProto& value, std::string_view name, std::int64_t columns) {
  const auto& shape = value.type().tensor_type().shape();
  // Files of earlier versions are of one record; others leave open how many.
  const bool fits = shape.dim_size() == 2 && (!shape.dim(0).has_dim_value() || shape.dim(0).dim_value() == 1);
  if (value.name() != name || !fits || shape.dim(1).dim_value() != columns ||
      value.type().tensor_type().elem_type() != onnx::TensorProto::FLOAT) {
    Refuse(fmt::format("has '{}' where '{}' of records × {} should be", value.name(), name, columns));
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

// Windows are one high and so many long; the other attributes say that a row is one sample.
void RequireAttribute(const onnx::NodeProto& node, const onnx::AttributeProto& attribute) {
  const bool window = attribute.name() == "kernel_shape" || attribute.name() == "strides";
  const bool fits = window
                        ? attribute.ints_size() == 2 && attribute.ints(0) == 1 && attribute.ints(1) >= 1 &&
                              attribute.ints(1) <= kLongestWindow
                        : (attribute.name() == "axis" || attribute.name() == "transB") && attribute.i() == 1;
  if (!fits) Refuse(fmt::format("has a node '{}' with an odd '{}'", node.name(), attribute.name()));
}

// Every value is made before it is used.
void RequireOrder(const onnx::GraphProto& graph) {
  std::vector<std::string_view> made{graph.input(0).name()};
  for (const auto& tensor : graph.initializer()) made.push_back(tensor.name());
  const auto is_made = [&made](std::string_view name) { return std::ranges::find(made, name) != made.end(); };
  for (const onnx::NodeProto& node : graph.node()) {
    const auto known = std::ranges::find(kOperators, node.op_type(), &Operator::name);
    if (known == std::end(kOperators)) Refuse(fmt::format("has an operator '{}'", node.op_type()));
    if (node.input_size() != known->inputs) {
      Refuse(fmt::format("has a node '{}' of {} inputs", node.name(), node.input_size()));
    }
    for (const onnx::AttributeProto& attribute : node.attribute()) RequireAttribute(node, attribute);
    for (const std::string& input : node.input()) {
      if (!is_made(input)) Refuse(fmt::format("uses '{}' before it is made", input));
    }
    if (node.output_size() != 1 || is_made(node.output(0))) {
      Refuse(fmt::format("has a node '{}' that makes no value of its own", node.name()));
    }
    made.push_back(node.output(0));
  }
}

// What a file of ours gives, in its order.
std::vector<cv::String> OutputNames(OnnxNetwork::Predicts predicts) {
  if (predicts == OnnxNetwork::Predicts::kClasses) return {"probability", "distance"};
  return {"prediction", "half_width", "distance"};
}

// The same file with one record, as OpenCV 4.6 takes it.
std::string RequireOurs(const std::string& bytes, std::int64_t inputs, std::int64_t outputs,
                        const std::vector<cv::String>& names) {
  onnx::ModelProto model;
  if (!model.ParseFromString(bytes)) Refuse("cannot be parsed");
  const onnx::GraphProto& graph = model.graph();
  if (graph.input_size() != 1 || graph.output_size() != static_cast<int>(names.size())) {
    Refuse(fmt::format("has {} inputs and {} outputs", graph.input_size(), graph.output_size()));
  }
  RequireShape(graph.input(0), "features", inputs);
  for (int k = 0; k < graph.output_size(); ++k) {
    const bool last = k + 1 == graph.output_size();
    RequireShape(graph.output(k), names[static_cast<std::size_t>(k)], last ? 1 : outputs);
  }
  for (const onnx::TensorProto& tensor : graph.initializer()) RequireWhole(tensor);
  RequireOrder(graph);
  const auto set_one = [](onnx::ValueInfoProto& value) {
    value.mutable_type()->mutable_tensor_type()->mutable_shape()->mutable_dim(0)->set_dim_value(1);
  };
  set_one(*model.mutable_graph()->mutable_input(0));
  for (onnx::ValueInfoProto& output : *model.mutable_graph()->mutable_output()) set_one(output);
  return model.SerializeAsString();
}

}  // namespace

struct OnnxNetwork::Net {
  cv::dnn::Net net;
  cv::Mat features;
  std::vector<cv::Mat> results;
  std::vector<cv::String> names;
};

OnnxNetwork::OnnxNetwork(const std::string& bytes, Eigen::Index inputs, Eigen::Index outputs,
                         Predicts predicts)
    : net_(std::make_unique<Net>()), inputs_(inputs), outputs_(outputs) {
  net_->names = OutputNames(predicts);
  const std::string of_one_record = RequireOurs(bytes, inputs, outputs, net_->names);
  // What it has to say comes as an exception, too.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  try {
    net_->net = cv::dnn::readNetFromONNX(of_one_record.data(), of_one_record.size());
    net_->features = cv::Mat::zeros(1, static_cast<int>(inputs), CV_32F);
    net_->net.setInput(net_->features, "features");
    net_->net.forward(net_->results, net_->names);
  } catch (const cv::Exception& error) {
    Refuse(fmt::format("cannot be run: {}", error.err));
  } catch (
      const std::exception& error) {  // sizes that no memory holds, and what else a hostile file provokes
    Refuse(fmt::format("cannot be run: {}", error.what()));
  }
  if (net_->results.size() != net_->names.size()) Refuse("gives results of another shape");
  for (const cv::Mat& result : net_->results) {
    const bool last = &result == &net_->results.back();
    if (result.type() != CV_32F || result.total() != (last ? 1U : static_cast<std::size_t>(outputs))) {
      Refuse("gives results of another shape");
    }
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
  const auto values = [this](const cv::Mat& result) -> Eigen::RowVectorXd {
    return Values(result.ptr<float>(), outputs_).cast<double>();
  };
  const bool has_intervals = net_->results.size() > 2;
  return {.prediction = values(net_->results.front()),
          .half_width = has_intervals ? values(net_->results[1]) : Eigen::RowVectorXd::Zero(outputs_),
          .distance = static_cast<double>(*net_->results.back().ptr<float>())};
}

}  // namespace strainwave::bench
