// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/onnx_model.h"

#include <fmt/format.h>
#include <onnx/onnx_pb.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <stdexcept>
#include <variant>

namespace strainwave::bench {
namespace {

namespace networks = analysis::networks;
namespace prediction = analysis::prediction;

constexpr int kIrVersion = 7;

// Builds a graph node by node; every value has one name.
class Graph {
 public:
  explicit Graph(onnx::GraphProto& graph) : graph_(graph) {}

  void Floats(const std::string& name, std::initializer_list<std::int64_t> shape,
              std::span<const double> values) {
    onnx::TensorProto& tensor = *graph_.add_initializer();
    tensor.set_name(name);
    tensor.set_data_type(onnx::TensorProto::FLOAT);
    for (const std::int64_t size : shape) tensor.add_dims(size);
    for (const double value : values) tensor.add_float_data(static_cast<float>(value));
  }

  void Integers(const std::string& name, std::initializer_list<std::int64_t> values) {
    onnx::TensorProto& tensor = *graph_.add_initializer();
    tensor.set_name(name);
    tensor.set_data_type(onnx::TensorProto::INT64);
    tensor.add_dims(static_cast<std::int64_t>(values.size()));
    for (const std::int64_t value : values) tensor.add_int64_data(value);
  }

  onnx::NodeProto& Node(const char* operation, std::initializer_list<std::string> inputs,
                        const std::string& output) {
    onnx::NodeProto& node = *graph_.add_node();
    node.set_op_type(operation);
    node.set_name(output);
    for (const std::string& input : inputs) node.add_input(input);
    node.add_output(output);
    return node;
  }

  void Interface(onnx::ValueInfoProto& value, const char* name, std::int64_t columns) {
    value.set_name(name);
    auto& tensor = *value.mutable_type()->mutable_tensor_type();
    tensor.set_elem_type(onnx::TensorProto::FLOAT);
    tensor.mutable_shape()->add_dim()->set_dim_param("records");
    tensor.mutable_shape()->add_dim()->set_dim_value(columns);
  }

  onnx::GraphProto& proto() { return graph_; }

 private:
  onnx::GraphProto& graph_;
};

void SetInteger(onnx::NodeProto& node, const char* name, std::int64_t value) {
  onnx::AttributeProto& attribute = *node.add_attribute();
  attribute.set_name(name);
  attribute.set_type(onnx::AttributeProto::INT);
  attribute.set_i(value);
}

void SetIntegers(onnx::NodeProto& node, const char* name, std::initializer_list<std::int64_t> values) {
  onnx::AttributeProto& attribute = *node.add_attribute();
  attribute.set_name(name);
  attribute.set_type(onnx::AttributeProto::INTS);
  for (const std::int64_t value : values) attribute.add_ints(value);
}

// The stages of one member, from the scaled features to scaled outputs.
class MemberWriter {
 public:
  MemberWriter(Graph& graph, const networks::Vector<double>& parameters, int member, std::string input)
      : graph_(graph), parameters_(parameters), member_(member), at_(std::move(input)) {}

  void Write(const networks::Network::Stage& stage) {
    stage_ = &stage;
    ++number_;
    std::visit(*this, stage.layer);
  }
  const std::string& at() const { return at_; }

  void operator()(const networks::Dense& dense) {
    Flatten();
    graph_.Floats(Name("weights"), {dense.units, stage_->input.size()}, Weights());
    graph_.Floats(Name("bias"), {dense.units}, Biases());
    SetInteger(graph_.Node("Gemm", {at_, Name("weights"), Name("bias")}, Name("sum")), "transB", 1);
    at_ = Name("sum");
    Activate(dense.activation);
  }

  void operator()(const networks::Convolution& convolution) {
    MakeImage();
    graph_.Floats(Name("weights"), {convolution.filters, stage_->input.channels, 1, convolution.kernel},
                  Weights());
    graph_.Floats(Name("bias"), {convolution.filters}, Biases());
    onnx::NodeProto& node = graph_.Node("Conv", {at_, Name("weights"), Name("bias")}, Name("sum"));
    SetIntegers(node, "kernel_shape", {1, convolution.kernel});
    SetIntegers(node, "strides", {1, convolution.stride});
    at_ = Name("sum");
    Activate(convolution.activation);
  }

  void operator()(const networks::MaxPool& pool) {
    MakeImage();
    onnx::NodeProto& node = graph_.Node("MaxPool", {at_}, Name("pooled"));
    SetIntegers(node, "kernel_shape", {1, pool.size});
    SetIntegers(node, "strides", {1, pool.stride});
    at_ = Name("pooled");
  }

  void operator()(const networks::GlobalAveragePool&) {
    MakeImage();
    graph_.Node("GlobalAveragePool", {at_}, Name("mean"));
    at_ = Name("mean");
  }

 private:
  std::string Name(const char* what) const {
    return fmt::format("member{}_layer{}_{}", member_, number_, what);
  }

  std::span<const double> Weights() const {
    return {parameters_.data() + stage_->weights_begin, static_cast<std::size_t>(stage_->weights)};
  }
  std::span<const double> Biases() const {
    return {parameters_.data() + stage_->weights_begin + stage_->weights,
            static_cast<std::size_t>(stage_->biases)};
  }

  void MakeImage() {
    if (is_image_) return;
    constexpr std::int64_t kAsManyAsThereAre = -1;
    graph_.Integers(Name("shape"), {kAsManyAsThereAre, stage_->input.channels, 1, stage_->input.length});
    graph_.Node("Reshape", {at_, Name("shape")}, Name("image"));
    at_ = Name("image");
    is_image_ = true;
  }

  void Flatten() {
    if (!is_image_) return;
    SetInteger(graph_.Node("Flatten", {at_}, Name("flat")), "axis", 1);
    at_ = Name("flat");
    is_image_ = false;
  }

  void Activate(networks::Activation activation) {
    const char* operation = nullptr;
    switch (activation) {
      case networks::Activation::kLinear:
        return;
      case networks::Activation::kRelu:
        operation = "Relu";
        break;
      case networks::Activation::kSigmoid:
        operation = "Sigmoid";
        break;
      case networks::Activation::kTanh:
        operation = "Tanh";
        break;
    }
    graph_.Node(operation, {at_}, Name("value"));
    at_ = Name("value");
  }

  Graph& graph_;
  const networks::Vector<double>& parameters_;
  int member_;
  std::string at_;
  const networks::Network::Stage* stage_{};
  int number_{-1};
  bool is_image_{false};
};

std::span<const double> ValuesOf(const Eigen::RowVectorXd& row) {
  return {row.data(), static_cast<std::size_t>(row.size())};
}

void WriteMean(Graph& graph, const std::vector<std::string>& members, const char* name) {
  std::string sum = members.front();
  for (std::size_t k = 1; k < members.size(); ++k) {
    const std::string next = fmt::format("sum_to_member{}", k);
    graph.Node("Add", {sum, members[k]}, next);
    sum = next;
  }
  graph.Floats("share_of_member", {1, 1}, std::vector<double>{1.0 / static_cast<double>(members.size())});
  graph.Node("Mul", {sum, "share_of_member"}, name);
}

// What the outputs of the networks are told from: the line where there is one, else a constant.
void WriteLevel(Graph& graph, const prediction::Ensemble& ensemble) {
  const std::int64_t outputs = ensemble.network.output_size();
  if (ensemble.line.empty()) {
    graph.Floats("level", {1, outputs}, ValuesOf(ensemble.output.offset));
    return;
  }
  const std::int64_t inputs = ensemble.network.input_size();
  const Eigen::MatrixXd& slope = ensemble.line.slope;  // column-major: one row of its transpose after another
  graph.Floats("line_lowest", {1, inputs}, ValuesOf(ensemble.line.lowest));
  graph.Floats("line_highest", {1, inputs}, ValuesOf(ensemble.line.highest));
  graph.Floats("line_slope", {outputs, inputs}, {slope.data(), static_cast<std::size_t>(slope.size())});
  graph.Floats("line_offset", {outputs}, ValuesOf(ensemble.output.offset));
  // Held within two limits by what lies above each: Clip has one pair of limits for all inputs.
  graph.Node("Sub", {"scaled", "line_lowest"}, "line_from_lowest");
  graph.Node("Relu", {"line_from_lowest"}, "line_above_lowest");
  graph.Node("Sub", {"scaled", "line_highest"}, "line_from_highest");
  graph.Node("Relu", {"line_from_highest"}, "line_above_highest");
  graph.Node("Sub", {"line_above_lowest", "line_above_highest"}, "line_between");
  graph.Node("Add", {"line_between", "line_lowest"}, "line_held");
  SetInteger(graph.Node("Gemm", {"line_held", "line_slope", "line_offset"}, "level"), "transB", 1);
}

// The width of the interval, from how far the members are apart.
void WriteInterval(Graph& graph, const prediction::FittedPredictor& fitted,
                   const std::vector<std::string>& members) {
  const std::int64_t outputs = fitted.ensemble.network.output_size();
  const auto count = static_cast<double>(members.size());
  const Eigen::RowVectorXd residual_squared = fitted.residual.array().square();
  graph.Floats("residual_squared", {1, outputs}, ValuesOf(residual_squared));
  graph.Floats("share_of_variance", {1, 1}, std::vector<double>{1.0 / std::max(1.0, count - 1.0)});
  graph.Floats("interval_factor", {1, outputs}, ValuesOf(fitted.band.factor));
  std::string squares;
  for (std::size_t k = 0; k < members.size(); ++k) {
    const std::string off = fmt::format("member{}_off", k);
    graph.Node("Sub", {members[k], "prediction"}, off);
    graph.Node("Mul", {off, off}, off + "_squared");
    if (k == 0) {
      squares = off + "_squared";
      continue;
    }
    const std::string next = fmt::format("squares_to_member{}", k);
    graph.Node("Add", {squares, off + "_squared"}, next);
    squares = next;
  }
  graph.Node("Mul", {squares, "share_of_variance"}, "variance_of_members");
  graph.Node("Add", {"variance_of_members", "residual_squared"}, "variance");
  graph.Node("Sqrt", {"variance"}, "deviation");
  graph.Node("Mul", {"deviation", "interval_factor"}, "half_width");
}

// ‖(x − mean) · whitening‖ / (√inputs · limit); the sum of squares is a product with ones.
void WriteDistance(Graph& graph, const prediction::Novelty& novelty) {
  const std::int64_t inputs = novelty.mean.size();
  const double scale = 1.0 / (std::sqrt(static_cast<double>(inputs)) * novelty.limit);
  const Eigen::MatrixXd columns =
      scale * novelty.whitening;  // column-major: one row of its transpose after another
  graph.Floats("novelty_mean", {1, inputs}, ValuesOf(novelty.mean));
  graph.Floats("novelty_whitening", {inputs, inputs},
               {columns.data(), static_cast<std::size_t>(columns.size())});
  graph.Floats("novelty_ones", {1, inputs}, std::vector<double>(static_cast<std::size_t>(inputs), 1.0));
  graph.Floats("novelty_zeros", {inputs}, std::vector<double>(static_cast<std::size_t>(inputs), 0.0));
  graph.Floats("novelty_zero", {1}, std::vector<double>{0.0});
  graph.Node("Sub", {"scaled", "novelty_mean"}, "novelty_centred");
  SetInteger(graph.Node("Gemm", {"novelty_centred", "novelty_whitening", "novelty_zeros"}, "novelty_white"),
             "transB", 1);
  graph.Node("Mul", {"novelty_white", "novelty_white"}, "novelty_squares");
  SetInteger(graph.Node("Gemm", {"novelty_squares", "novelty_ones", "novelty_zero"}, "distance_squared"),
             "transB", 1);
  graph.Node("Sqrt", {"distance_squared"}, "distance");
}

void AddMetadata(onnx::ModelProto& model, const std::string& key, const std::string& value) {
  onnx::StringStringEntryProto& entry = *model.add_metadata_props();
  entry.set_key(key);
  entry.set_value(value);
}

}  // namespace

std::string OnnxBytes(const prediction::FittedPredictor& fitted, const OnnxMetadata& metadata) {
  const prediction::Ensemble& ensemble = fitted.ensemble;
  if (ensemble.members.empty())
    throw std::invalid_argument("the ensemble has no network (expected one or more)");
  const std::int64_t inputs = ensemble.network.input_size();
  const std::int64_t outputs = ensemble.network.output_size();

  onnx::ModelProto file;
  file.set_ir_version(kIrVersion);
  file.set_producer_name("strainwave");
  file.add_opset_import()->set_version(kOnnxOpset);
  Graph graph(*file.mutable_graph());
  graph.proto().set_name("predictor");
  graph.Interface(*graph.proto().add_input(), "features", inputs);
  if (ensemble.softmax) {
    graph.Interface(*graph.proto().add_output(), "probability", outputs);
  } else {
    graph.Interface(*graph.proto().add_output(), "prediction", outputs);
    graph.Interface(*graph.proto().add_output(), "half_width", outputs);
  }
  graph.Interface(*graph.proto().add_output(), "distance", 1);

  graph.Floats("input_offset", {1, inputs}, ValuesOf(ensemble.input.offset));
  graph.Floats("input_scale", {1, inputs}, ValuesOf(ensemble.input.scale));
  if (!ensemble.softmax) {
    graph.Floats("output_scale", {1, outputs}, ValuesOf(ensemble.output.scale));
  }
  graph.Node("Sub", {"features", "input_offset"}, "centred");
  graph.Node("Div", {"centred", "input_scale"}, "scaled");
  if (!ensemble.softmax) WriteLevel(graph, ensemble);

  std::vector<std::string> members;
  for (std::size_t k = 0; k < ensemble.members.size(); ++k) {
    MemberWriter writer(graph, ensemble.members[k], static_cast<int>(k), "scaled");
    for (const networks::Network::Stage& stage : ensemble.network.stages()) writer.Write(stage);
    members.push_back(fmt::format("member{}_prediction", k));
    if (ensemble.softmax) {
      SetInteger(graph.Node("Softmax", {writer.at()}, members.back()), "axis", 1);
      continue;
    }
    graph.Node("Mul", {writer.at(), "output_scale"}, members.back() + "_above_level");
    graph.Node("Add", {members.back() + "_above_level", "level"}, members.back());
  }
  WriteMean(graph, members, ensemble.softmax ? "probability" : "prediction");
  if (!ensemble.softmax) WriteInterval(graph, fitted, members);
  WriteDistance(graph, fitted.novelty);
  for (const auto& [key, value] : metadata) AddMetadata(file, key, value);
  return file.SerializeAsString();
}

}  // namespace strainwave::bench
