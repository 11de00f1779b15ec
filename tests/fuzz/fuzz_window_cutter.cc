// SPDX-License-Identifier: Apache-2.0
// Any stream of a device that counts its samples, cut by any rule: a window without a fault holds
// consecutive samples, as many as the rule says, and no sample is in two windows.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "bench/monitor/window.h"

namespace {

using namespace strainwave::bench;

class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> data) : data_(data) {}
  std::uint8_t Next() {
    if (data_.empty()) return 0;
    const std::uint8_t byte = data_[0];
    data_ = data_.subspan(1);
    return byte;
  }
  bool empty() const { return data_.empty(); }

 private:
  std::span<const std::uint8_t> data_;
};

constexpr double kRate_hz = 1000.0;

WindowRule AnyRule(Bytes& bytes) {
  WindowRule rule;
  rule.by = static_cast<WindowRule::By>(bytes.Next() % 3);
  if (bytes.Next() % 2 == 0) rule.trigger_channel = "trigger_V";
  rule.trigger_level = 100.0;
  rule.trigger_samples = 1U + bytes.Next();
  rule.ratio = 1.0 + bytes.Next() % 4;
  rule.turns = 0.1 + bytes.Next() / 64.0;
  rule.length.samples = bytes.Next();
  rule.length.turns = bytes.Next() % 4;
  rule.most_samples = 1000;
  return rule;
}

// Channel 0 is the running number of each sample.
class Stream {
 public:
  VibrationChunk Next(Bytes& bytes) {
    const std::uint8_t kind = bytes.Next();
    VibrationChunk chunk;
    chunk.sample_rate_hz = kRate_hz;
    chunk.is_counted = true;
    if (kind % 16 == 1) {
      chunk.trouble = "lost (expected samples)";
      number_ += 7;
      return chunk;
    }
    if (kind % 16 == 2) {
      chunk.gap = "samples were lost";
      number_ += 1U + bytes.Next();
    }
    chunk.begins_measurement = (kind & 16U) != 0;
    chunk.ends_measurement = (kind & 32U) != 0;
    chunk.channels = {"a", "trigger_V"};
    if ((kind & 64U) != 0) chunk.channels[0] = "b";
    chunk.samples.resize(2);
    const std::uint8_t count = bytes.Next();
    const double step = static_cast<double>(static_cast<std::int8_t>(bytes.Next())) / 1024.0;
    chunk.time_ns = static_cast<std::int64_t>(number_) * 1'000'000;
    for (int i = 0; i < count; ++i) {
      chunk.samples[0].push_back(static_cast<double>(number_++));
      chunk.samples[1].push_back(i % 16 == 0 ? bytes.Next() : 0.0);
      if ((kind & 128U) != 0) chunk.output_turns.push_back(turns_);
      turns_ += step;
    }
    return chunk;
  }

 private:
  std::uint64_t number_{};
  double turns_{};
};

void Require(bool holds) {
  if (!holds) std::abort();
}

void Check(const std::vector<VibrationWindow>& windows, const WindowRule& rule, double& next) {
  for (const VibrationWindow& window : windows) {
    if (window.fault) {
      Require(window.samples.empty());
      continue;
    }
    const std::vector<double>& numbers = window.samples.at(0);
    if (numbers.empty()) continue;  // a measurement without samples
    Require(window.samples.at(1).size() == numbers.size());
    Require(numbers.front() >= next);
    for (std::size_t i = 1; i < numbers.size(); ++i) Require(numbers[i] == numbers[i - 1] + 1.0);
    next = numbers.back() + 1.0;
    const bool by_samples = rule.by == WindowRule::By::kTraining && rule.length.turns == 0;
    if (by_samples && rule.length.samples > 0) Require(numbers.size() == rule.length.samples);
    if (rule.by == WindowRule::By::kTrigger && !rule.trigger_channel.empty())
      Require(numbers.size() == rule.trigger_samples);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes({data, size});
  const WindowRule rule = AnyRule(bytes);
  WindowCutter cutter(rule);
  Stream stream;
  double next = 0.0;
  while (!bytes.empty()) Check(cutter.Add(stream.Next(bytes)), rule, next);
  Check(cutter.Finish(), rule, next);
  return 0;
}
