// SPDX-License-Identifier: Apache-2.0
// A device that loses, repeats, counts anew, fails and falls silent as it likes: no window without a fault
// holds anything but samples that the device counted one after the other.
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>

#include "bench/monitor/acquisition_source.h"
#include "bench/monitor/window.h"

namespace {

using namespace strainwave::bench;
using namespace strainwave::daq::acquisition;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr std::uint32_t kMostSamples = 16;
constexpr std::size_t kWindow = 24;

class AnyDevice final : public SampleSource {
 public:
  explicit AnyDevice(std::span<const std::uint8_t> data) : data_(data) {
    description_ = {.name = "any", .rate_hz = 1000.0, .most_samples_a_block = kMostSamples};
    description_.counter_bits = Byte() % 2 == 0 ? 64 : 16;
    description_.channels.push_back({.name = "counter", .unit = "1"});
  }
  void Start() override {}
  void Stop() noexcept override {}
  const SourceDescription& description() const override { return description_; }
  std::string trouble() const override { return "lost"; }

  NextResult Next(SampleBlock& block, nanoseconds) override {
    if (data_.empty()) return NextResult::kEnded;
    const std::uint8_t kind = Byte();
    if (kind % 8 == 1) return NextResult::kFailed;
    if (kind % 8 == 2) return NextResult::kNothingYet;
    if (kind % 8 == 3) counter_ += 1U + Byte();
    if (kind % 8 == 4) counter_ -= Byte();
    if (kind % 8 == 5 && description_.counter_bits == 64) CountAnew();
    const std::uint32_t samples = 1U + Byte() % kMostSamples;
    arrival_ += milliseconds(kind % 16 < 8 ? samples : Byte());
    const std::uint64_t mask = ~std::uint64_t{0} >> (64U - description_.counter_bits);
    block.header = {.channels = 1, .samples = samples, .device_counter = counter_ & mask};
    block.header.arrival = arrival_;
    block.header.rate_hz = description_.rate_hz;
    for (std::uint32_t i = 0; i < samples; ++i)
      block.words()[i] = era_ + static_cast<std::uint32_t>((counter_ + i) & 0xFFFFU);
    counter_ += samples;
    return NextResult::kBlock;
  }

 private:
  // To where it has not been near: a place shortly before the furthest is what samples that come again look
  // like, and is taken for them.
  void CountAnew() {
    const std::uint64_t place = Byte() % 2 == 0 ? ++highest_ : --lowest_;
    counter_ = place << 32U | Byte();
    era_ += 1U << 24U;
  }
  std::uint8_t Byte() {
    if (data_.empty()) return 0;
    const std::uint8_t byte = data_[0];
    data_ = data_.subspan(1);
    return byte;
  }

  std::span<const std::uint8_t> data_;
  SourceDescription description_;
  std::uint64_t counter_{};
  std::uint64_t highest_{1U << 20U};  // of the places it went to
  std::uint64_t lowest_{highest_};
  std::uint32_t era_{};  // tells samples apart that the counter does not
  nanoseconds arrival_{std::chrono::hours(1)};
};

void Check(const std::vector<VibrationWindow>& windows) {
  for (const VibrationWindow& window : windows) {
    if (window.fault) continue;
    const std::vector<double>& numbers = window.samples.at(0);
    if (numbers.size() != kWindow) std::abort();
    for (std::size_t i = 1; i < numbers.size(); ++i) {
      const double step = numbers[i] - numbers[i - 1];
      if (step != 1.0 && step != -65535.0) std::abort();  // the latter as 16 bits begin anew
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  AcquisitionSource source(std::make_unique<AnyDevice>(std::span(data, size)), AcquisitionStream{});
  WindowRule rule;
  rule.length.samples = kWindow;
  WindowCutter cutter(rule);
  VibrationChunk chunk;
  while (true) {
    const VibrationSource::Got got = source.Next(milliseconds(0), chunk);
    if (got == VibrationSource::Got::kEnd) break;
    if (got == VibrationSource::Got::kChunk) Check(cutter.Add(chunk));
  }
  Check(cutter.Finish());
  return 0;
}
