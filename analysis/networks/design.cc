// SPDX-License-Identifier: Apache-2.0
#include "analysis/networks/design.h"

#include <fmt/format.h>

#include <cstdint>
#include <stdexcept>

namespace strainwave::analysis::networks {
namespace {

constexpr std::int64_t kMostValues = std::int64_t{1} << 26;  // of a sample between layers

void RequireOneOrMore(std::string_view name, int value) {
  if (value < 1) throw std::invalid_argument(fmt::format("{} = {} is not a number from 1 up", name, value));
}

int WindowCount(std::string_view layer, int length, int size, int stride) {
  if (size > length) {
    throw std::invalid_argument(
        fmt::format("{} of {} does not fit into a series of {} values", layer, size, length));
  }
  return (length - size) / stride + 1;
}

struct ShapeAfter {
  Shape input;

  Shape operator()(const Dense& layer) const {
    RequireOneOrMore("units", layer.units);
    return {layer.units, 1};
  }
  Shape operator()(const Convolution& layer) const {
    RequireOneOrMore("filters", layer.filters);
    RequireOneOrMore("kernel", layer.kernel);
    RequireOneOrMore("stride", layer.stride);
    return {layer.filters, WindowCount("kernel", input.length, layer.kernel, layer.stride)};
  }
  Shape operator()(const MaxPool& layer) const {
    RequireOneOrMore("size", layer.size);
    RequireOneOrMore("stride", layer.stride);
    return {input.channels, WindowCount("pool", input.length, layer.size, layer.stride)};
  }
  Shape operator()(const GlobalAveragePool&) const { return {input.channels, 1}; }
};

}  // namespace

Shape OutputShape(const Layer& layer, const Shape& input) {
  RequireOneOrMore("channels", input.channels);
  RequireOneOrMore("length", input.length);
  const Shape after = std::visit(ShapeAfter{input}, layer);
  for (const Shape& shape : {input, after}) {
    if (std::int64_t{shape.channels} * shape.length > kMostValues) {
      throw std::invalid_argument(fmt::format("a sample of {} × {} values is too large (expected at most {})",
                                              shape.channels, shape.length, kMostValues));
    }
  }
  return after;
}

Design DesignOf(std::string_view name, int inputs, int outputs) {
  RequireOneOrMore("inputs", inputs);
  RequireOneOrMore("outputs", outputs);
  constexpr Activation kSigmoid = Activation::kSigmoid;
  constexpr Activation kRelu = Activation::kRelu;
  Design design{{1, inputs}, {}};
  if (name == "ann") {
    design.layers = {Dense{500, kSigmoid}, Dense{500, kSigmoid}, Dense{200, kSigmoid}, Dense{100, kSigmoid},
                     Dense{outputs}};
  } else if (name == "cnn") {
    design.layers = {Convolution{128, 6, 1, kRelu},
                     Convolution{64, 3, 1, kRelu},
                     MaxPool{3, 2},
                     Convolution{64, 3, 1, kRelu},
                     MaxPool{3, 2},
                     Convolution{128, 3, 1, kRelu},
                     GlobalAveragePool{},
                     Dense{128, kRelu},
                     Dense{outputs}};
  } else {
    throw std::invalid_argument(fmt::format("model = '{}' is not known (expected ann or cnn)", name));
  }
  return design;
}

}  // namespace strainwave::analysis::networks
