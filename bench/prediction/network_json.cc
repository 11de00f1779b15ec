// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/network_json.h"

#include <stdexcept>
#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

#include "bench/json_text.h"

namespace strainwave::bench {
namespace {

namespace networks = analysis::networks;
using Json = nlohmann::ordered_json;

constexpr std::pair<networks::Activation, const char*> kActivations[] = {
    {networks::Activation::kLinear, "linear"},
    {networks::Activation::kRelu, "relu"},
    {networks::Activation::kSigmoid, "sigmoid"},
    {networks::Activation::kTanh, "tanh"}};

std::string NameOf(networks::Activation activation) {
  for (const auto& [value, name] : kActivations) {
    if (value == activation) return name;
  }
  throw std::logic_error("an activation without a name");
}

networks::Activation ActivationFrom(const Json& json) {
  const auto text = json.get<std::string>();
  for (const auto& [value, name] : kActivations) {
    if (text == name) return value;
  }
  throw std::invalid_argument("activation " + ShortText(json) + " (expected linear, relu, sigmoid or tanh)");
}

struct LayerWriter {
  Json operator()(const networks::Dense& dense) const {
    return {{"dense", dense.units}, {"activation", NameOf(dense.activation)}};
  }
  Json operator()(const networks::Convolution& convolution) const {
    return {{"convolution", convolution.filters},
            {"kernel", convolution.kernel},
            {"stride", convolution.stride},
            {"activation", NameOf(convolution.activation)}};
  }
  Json operator()(const networks::MaxPool& pool) const {
    return {{"max_pool", pool.size}, {"stride", pool.stride}};
  }
  Json operator()(const networks::GlobalAveragePool&) const { return {{"global_average_pool", true}}; }
};

networks::Layer LayerFrom(const Json& json) {
  if (json.contains("dense")) {
    return networks::Dense{json.at("dense").get<int>(), ActivationFrom(json.at("activation"))};
  }
  if (json.contains("convolution")) {
    return networks::Convolution{json.at("convolution").get<int>(), json.at("kernel").get<int>(),
                                 json.at("stride").get<int>(), ActivationFrom(json.at("activation"))};
  }
  if (json.contains("max_pool")) {
    return networks::MaxPool{json.at("max_pool").get<int>(), json.at("stride").get<int>()};
  }
  if (json.contains("global_average_pool")) return networks::GlobalAveragePool{};
  throw std::invalid_argument("layer " + ShortText(json) +
                              " (expected dense, convolution, max_pool or global_average_pool)");
}

}  // namespace

Json JsonOf(const networks::Design& design) {
  Json layers = Json::array();
  for (const networks::Layer& layer : design.layers) layers.push_back(std::visit(LayerWriter{}, layer));
  return {{"input", {design.input.channels, design.input.length}}, {"layers", std::move(layers)}};
}

networks::Design DesignFrom(const Json& json) {
  networks::Design design;
  design.input = {json.at("input").at(0).get<int>(), json.at("input").at(1).get<int>()};
  for (const Json& layer : json.at("layers")) design.layers.push_back(LayerFrom(layer));
  return design;
}

}  // namespace strainwave::bench
