// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/acquisition_source.h"

#include <bit>
#include <chrono>
#include <deque>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::monitor_source_test {
namespace {

using daq::acquisition::NextResult;
using daq::acquisition::SampleBlock;
using daq::acquisition::SampleType;
using daq::acquisition::SourceDescription;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using Got = VibrationSource::Got;

constexpr double kRate_hz = 1000.0;
constexpr std::uint32_t kBlock = 10;

// What `Next` gives, one after the other: blocks by the counter of their first sample, or something else.
struct Step {
  NextResult result{NextResult::kBlock};
  std::uint64_t counter{};
  nanoseconds arrival{};
};

// A speed and an acceleration in counts: of sample n 60 and 2n.
class ScriptedSource final : public daq::acquisition::SampleSource {
 public:
  explicit ScriptedSource(std::deque<Step> steps) : steps_(std::move(steps)) {
    description_ = {.name = "scripted", .rate_hz = kRate_hz, .most_samples_a_block = kBlock};
    description_.channels.push_back({.name = "input_speed_rpm", .unit = "rpm"});
    description_.channels.push_back({.name = "accel_x", .unit = "m/s^2"});
    description_.channels[1].calibration.sensitivity = 4.0;
  }
  void Start() override {}
  void Stop() noexcept override {}
  const SourceDescription& description() const override { return description_; }
  std::string trouble() const override { return "the cable is out"; }
  NextResult Next(SampleBlock& block, nanoseconds) override {
    if (steps_.empty()) return NextResult::kEnded;
    const Step step = steps_.front();
    steps_.pop_front();
    if (step.result != NextResult::kBlock) return step.result;
    block.header = {
        .channels = 2, .samples = kBlock, .type = SampleType::kInt32, .device_counter = step.counter};
    block.header.arrival = step.arrival;
    block.header.rate_hz = kRate_hz;
    for (std::uint32_t i = 0; i < kBlock; ++i) {
      block.words()[2 * i] = 60;
      block.words()[2 * i + 1] = static_cast<std::uint32_t>(2 * (step.counter + i));
    }
    return step.result;
  }

 private:
  std::deque<Step> steps_;
  SourceDescription description_;
};

AcquisitionSource SourceOf(std::deque<Step> steps, AcquisitionStream stream = {}) {
  return AcquisitionSource(std::make_unique<ScriptedSource>(std::move(steps)), std::move(stream));
}

AcquisitionStream Replayed() {
  AcquisitionStream stream;
  stream.pace = std::numeric_limits<double>::infinity();
  stream.start_ns = 5'000'000'000;
  return stream;
}

TEST(AcquisitionSource, GivesCalibratedSamplesUnderThePredictorsNames) {
  AcquisitionStream stream = Replayed();
  stream.ratio = 2.0;
  AcquisitionSource source = SourceOf({{.counter = 100}, {.counter = 110}}, stream);
  EXPECT_EQ(source.channels(), (std::vector<std::string>{"input_speed_rpm", "accel_x_m_per_s2"}));
  VibrationChunk chunk;
  ASSERT_EQ(source.Next(milliseconds(0), chunk), Got::kChunk);
  EXPECT_EQ(chunk.time_ns, 5'000'000'000);
  EXPECT_EQ(chunk.samples[1][0], 50.0);
  EXPECT_EQ(chunk.samples[1][9], 54.5);
  EXPECT_TRUE(chunk.is_counted);
  ASSERT_EQ(source.Next(milliseconds(0), chunk), Got::kChunk);
  EXPECT_EQ(chunk.gap, "");
  EXPECT_EQ(chunk.time_ns, 5'010'000'000);
  EXPECT_EQ(source.NowNanoseconds(), 5'020'000'000);
  // One turn of the input a second, of which the output makes half: 0.5 thousandths a sample, from the
  // eleventh on.
  EXPECT_NEAR(chunk.output_turns[0], 0.005, 1e-12);
  EXPECT_NEAR(chunk.output_turns[9], 0.0095, 1e-12);
  EXPECT_EQ(source.Next(milliseconds(0), chunk), Got::kEnd);
}

TEST(AcquisitionSource, RenamesChannelsAndTakesASpeedFromItsUser) {
  AcquisitionStream stream = Replayed();
  stream.ratio = 1.0;
  stream.renamed = {{"accel_x", "accel_motor_z_m_per_s2"}, {"input_speed_rpm", "other_rpm"}};
  stream.input_speed_rad_per_s = 2.0 * std::numbers::pi;
  AcquisitionSource source = SourceOf({{.counter = 0}}, stream);
  EXPECT_EQ(source.channels(), (std::vector<std::string>{"other_rpm", "accel_motor_z_m_per_s2"}));
  VibrationChunk chunk;
  ASSERT_EQ(source.Next(milliseconds(0), chunk), Got::kChunk);
  EXPECT_NEAR(chunk.output_turns[9], 0.009, 1e-12);
  stream.renamed = {{"accel_y", "accel_y_m_per_s2"}};
  EXPECT_EQ(daq::MessageOf<std::invalid_argument>([&] { SourceOf({}, stream); }),
            "scripted has no channel accel_y (expected one of input_speed_rpm, accel_x)");
}

TEST(AcquisitionSource, SaysWhatIsMissingBeforeAChunk) {
  AcquisitionSource source = SourceOf({{.counter = 0}, {.counter = 11}, {.counter = 21}}, Replayed());
  VibrationChunk chunk;
  source.Next(milliseconds(0), chunk);
  ASSERT_EQ(source.Next(milliseconds(0), chunk), Got::kChunk);
  EXPECT_EQ(chunk.gap, "1 samples were lost");
  EXPECT_EQ(chunk.time_ns, 5'011'000'000);
  ASSERT_EQ(source.Next(milliseconds(0), chunk), Got::kChunk);
  EXPECT_EQ(chunk.gap, "");
}

TEST(AcquisitionSource, TellsALostDeviceOnceUntilSamplesComeAgain) {
  AcquisitionSource source = SourceOf({{.result = NextResult::kFailed},
                                       {.result = NextResult::kFailed},
                                       {.counter = 0},
                                       {.result = NextResult::kFailed}});
  VibrationChunk chunk;
  ASSERT_EQ(source.Next(milliseconds(0), chunk), Got::kChunk);
  EXPECT_EQ(chunk.trouble, "the cable is out (expected samples; the device is tried again)");
  EXPECT_TRUE(chunk.samples.empty());
  EXPECT_EQ(source.Next(milliseconds(0), chunk), Got::kNothingYet);
  ASSERT_EQ(source.Next(milliseconds(0), chunk), Got::kChunk);
  EXPECT_EQ(chunk.trouble, "");
  ASSERT_EQ(source.Next(milliseconds(0), chunk), Got::kChunk);
  EXPECT_NE(chunk.trouble, "");
}

TEST(AcquisitionSource, ADeviceThatIsSilentForTooLongIsTrouble) {
  const auto silent_after = [](nanoseconds time) {
    AcquisitionStream stream;
    stream.silent_after = time;
    AcquisitionSource source = SourceOf({{.result = NextResult::kNothingYet}}, stream);
    VibrationChunk chunk;
    return source.Next(milliseconds(0), chunk) == Got::kChunk ? chunk.trouble : "none";
  };
  EXPECT_EQ(silent_after(std::chrono::hours(1)), "none");
  EXPECT_EQ(silent_after(nanoseconds(0)), "scripted has sent no samples for 0 s (expected 1000 a second)");
}

TEST(AcquisitionSource, SamplesOfADeviceHaveTheTimeAtWhichTheyWereHere) {
  const auto utc_ns = [] { return nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count(); };
  const std::int64_t before_ns = utc_ns();
  AcquisitionSource source =
      SourceOf({{.counter = 0, .arrival = std::chrono::steady_clock::now().time_since_epoch()}});
  VibrationChunk chunk;
  source.Next(milliseconds(0), chunk);
  const std::int64_t after_ns = utc_ns();
  constexpr std::int64_t kLength_ns = 10'000'000;
  // Which UTC a steady time is can be read to the time between two readings of a clock, and no better.
  constexpr std::int64_t kReading_ns = 1'000'000;
  EXPECT_GE(chunk.time_ns, before_ns - kLength_ns - kReading_ns);
  EXPECT_LE(chunk.time_ns, after_ns - kLength_ns + kReading_ns);
}

}  // namespace
}  // namespace strainwave::bench::monitor_source_test
