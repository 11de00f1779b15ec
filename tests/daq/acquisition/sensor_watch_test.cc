// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/sensor_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/daq/acquisition/sample_blocks.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::acquisition::sensor_watch_test {
namespace {

using Signal = std::function<double(std::uint64_t, std::size_t)>;

SourceDescription Watched(double rate_hz, RawLimits limits, SampleType type = SampleType::kInt32) {
  SourceDescription source = SourceOf(1, rate_hz, type);
  source.channels[0].name = "torque_Nm";
  source.channels[0].sensor_serial = "0815";
  source.channels[0].limits = limits;
  return source;
}

RawLimits OfA16BitTransducer() {
  return {.least = -25000,
          .most = 25000,
          .saturation_low = -32768,
          .saturation_high = 32767,
          .quantum = 1,
          .noise = 1.5};
}

// Samples after `from` until the fault is seen, block by block; nothing within three seconds.
std::optional<std::uint64_t> FoundAfter(SensorWatch& watch, const SourceDescription& source,
                                        std::uint64_t from, SensorFault fault, const Signal& signal,
                                        std::uint32_t block = 100) {
  for (std::uint64_t n = 0; static_cast<double>(n) < 3 * source.rate_hz; n += block) {
    watch.Judge(BlockAt(source, from + n, block, signal));
    if (watch.fault(0) == fault) return n + block;
  }
  return std::nullopt;
}

Signal Noisy(double mean, double noise, std::uint64_t seed) {
  auto random = std::make_shared<std::mt19937_64>(seed);
  auto normal = std::make_shared<std::normal_distribution<double>>(mean, noise);
  return [random, normal](std::uint64_t, std::size_t) { return (*normal)(*random); };
}

struct Case {
  const char* name;
  SensorFault fault;
  Signal signal;
  std::string reason;
};

class SensorFaults : public testing::TestWithParam<Case> {};

TEST_P(SensorFaults, AreFoundWithinTwoSecondsWithTheReasonInWords) {
  for (const double rate_hz : {100.0, 1000.0, 51200.0}) {
    const SourceDescription source = Watched(rate_hz, OfA16BitTransducer(), SampleType::kFloat32);
    SensorWatch watch(source);
    const std::uint32_t block = rate_hz < 1000 ? 10 : 100;
    const Signal clean = Noisy(137, 1.5, 1);
    const Signal rounded = [&clean](std::uint64_t n, std::size_t c) { return std::round(clean(n, c)); };
    EXPECT_EQ(FoundAfter(watch, source, 0, GetParam().fault, rounded, block), std::nullopt);
    EXPECT_TRUE(watch.is_good()) << watch.ReasonOf(0);
    EXPECT_EQ(watch.BlindSpotsOf(0), "");
    const auto from = static_cast<std::uint64_t>(std::ceil(3 * rate_hz / block)) * block;
    const std::optional<std::uint64_t> found =
        FoundAfter(watch, source, from, GetParam().fault, GetParam().signal, block);
    ASSERT_TRUE(found) << rate_hz;
    EXPECT_LE(static_cast<double>(*found), 2 * rate_hz);
    if (rate_hz == 1000) {
      EXPECT_EQ(watch.ReasonOf(0), GetParam().reason);
    }
    // And it is over a second after the sensor came back.
    for (std::uint64_t n = 0; static_cast<double>(n) < 2.1 * rate_hz; n += block) {
      watch.Judge(BlockAt(source, from + *found + n, block, rounded));
    }
    EXPECT_TRUE(watch.is_good()) << rate_hz << ": " << watch.ReasonOf(0);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, SensorFaults,
    testing::Values(Case{"stuck", SensorFault::kStuck, [](std::uint64_t, std::size_t) { return 137.0; },
                         "torque_Nm (sensor 0815) is stuck: 137 for 0.30 s"},
                    Case{"saturated", SensorFault::kSaturated,
                         [](std::uint64_t, std::size_t) { return 32767.0; },
                         "torque_Nm (sensor 0815) is saturated: 32767 is an end of the converter"},
                    Case{"low", SensorFault::kSaturated, [](std::uint64_t, std::size_t) { return -32768.0; },
                         "torque_Nm (sensor 0815) is saturated: -32768 is an end of the converter"},
                    // Behind the broken cable the amplifier still makes 46 steps of 1 in 500 samples: 0.2893
                    // of deviation.
                    Case{"flat", SensorFault::kFlat,
                         [](std::uint64_t n, std::size_t) { return n % 11 == 0 ? 5.0 : 4.0; },
                         "torque_Nm (sensor 0815) is flat: noise 0.289, 1.5 with nothing to measure"},
                    Case{"outside", SensorFault::kOutOfRange,
                         [](std::uint64_t n, std::size_t) { return 26000 + 3 * static_cast<double>(n % 2); },
                         "torque_Nm (sensor 0815) is out of range: 26003 (expected -25000 to 25000)"},
                    Case{"nan", SensorFault::kNotFinite, [](std::uint64_t, std::size_t) { return NAN; },
                         "torque_Nm (sensor 0815) gives nan, which is no number"}),
    [](const auto& of) { return std::string(of.param.name); });

// The thresholds allow for one false alarm in 10^18 samples, so a million of each kind has none.
TEST(SensorWatch, RaisesNoFalseAlarmOverLongCleanRecords) {
  struct Clean {
    const char* name;
    double rate_hz;
    RawLimits limits;
    Signal signal;
  };
  const auto slow = [](double noise, std::uint64_t seed) -> Signal {
    const Signal jitter = Noisy(0, noise, seed);
    return [jitter](std::uint64_t n, std::size_t c) {
      return std::round(2500 + 80 * std::sin(static_cast<double>(n) / 40000) + jitter(n, c));
    };
  };
  const auto filtered = [](std::uint64_t seed) -> Signal {  // an amplifier with a low-pass far below the rate
    const Signal white = Noisy(0, 1, seed);
    auto state = std::make_shared<double>(0);
    return [white, state](std::uint64_t n, std::size_t c) {
      *state += 0.1 * (white(n, c) * 1.5 * std::sqrt(1.9 / 0.1) - *state);
      return std::round(*state);
    };
  };
  const Clean cases[] = {
      {"torque", 1000, OfA16BitTransducer(), Noisy(0.5, 1.5, 1)},
      {"noise of half a step", 5000, {.quantum = 1, .noise = 0.5}, Noisy(0, 0.5, 2)},
      {"noise of a third of a step", 5000, {.quantum = 1, .noise = 0.34}, Noisy(0, 0.34, 3)},
      {"thermometer that moves a step a minute",
       10,
       {.least = 0, .most = 5000, .quantum = 1, .noise = 0.05},
       slow(0.05, 4)},
      {"thermometer at 10 Hz with noise", 10, {.quantum = 1, .noise = 1}, slow(1, 5)},
      {"filtered amplifier", 10000, {.quantum = 1, .noise = 1.5}, filtered(6)},
      {"quieter than its data sheet", 5000, {.quantum = 1, .noise = 1.5}, Noisy(0, 0.6, 7)},
      {"nothing known", 1000, {}, [](std::uint64_t, std::size_t) { return 0.0; }},
  };
  for (const Clean& clean : cases) {
    const SourceDescription source = Watched(clean.rate_hz, clean.limits);
    SensorWatch watch(source);
    for (std::uint64_t n = 0; n < 1'000'000; n += 100) {
      watch.Judge(BlockAt(source, n, 100, clean.signal));
      ASSERT_TRUE(watch.is_good()) << clean.name << " at sample " << n << ": " << watch.ReasonOf(0);
    }
  }
}

TEST(SensorWatch, SaysWhatItCannotJudge) {
  const SensorWatch coarse(Watched(10, {.least = 0, .most = 100, .quantum = 1, .noise = 0.1}));
  EXPECT_EQ(coarse.BlindSpotsOf(0),
            "torque_Nm cannot be told from a good sensor within 2 s: a stuck value, a flat line, saturation");
}

TEST(SensorWatch, LetsASpikeOfTwoSamplesPass) {
  const SourceDescription source = Watched(1000, OfA16BitTransducer());
  SensorWatch watch(source);
  watch.Judge(BlockAt(source, 0, 100, [](std::uint64_t n, std::size_t) {
    return n == 99 || n == 50 || n == 51 ? 32767 : static_cast<double>(n);
  }));
  EXPECT_TRUE(watch.is_good());
  // Two more behind the border of the blocks make three in a row.
  watch.Judge(BlockAt(source, 100, 100,
                      [](std::uint64_t n, std::size_t) { return n < 102 ? 32767 : static_cast<double>(n); }));
  EXPECT_EQ(watch.fault(0), SensorFault::kSaturated);
}

TEST(SensorWatch, SeesADeviceWhoseClockSteps) {
  const SourceDescription source = Watched(1000, OfA16BitTransducer());
  SensorWatch watch(source);
  const Signal signal = Noisy(0, 1.5, 3);
  std::uint64_t n = 0;
  const auto judge = [&](std::chrono::nanoseconds off) {
    SampleBlock block = BlockAt(source, n, 100, signal);
    // 500 ppm of drift is a clock's right.
    block.header.device_time += off + block.header.device_time / 2000;
    watch.Judge(block);
    n += 100;
  };
  for (int i = 0; i < 20; ++i) judge({});
  n += 1700;  // lost samples are no step of the clock
  judge({});
  EXPECT_TRUE(watch.is_good()) << watch.ReasonOf(0);
  judge(std::chrono::milliseconds(-40));
  EXPECT_EQ(watch.ReasonOf(0),
            "torque_Nm (sensor 0815) steps in time: the device's clock moved -0.03995 s against its samples");
}

TEST(SensorWatch, SeesThatNothingComesAndForgetsItWithTheNextBlock) {
  const SourceDescription source = Watched(1000, OfA16BitTransducer());
  SensorWatch watch(source);
  const Signal signal = Noisy(0, 1.5, 3);
  watch.Judge(BlockAt(source, 0, 100, signal));
  watch.Tick(std::chrono::milliseconds(1099));
  EXPECT_TRUE(watch.is_good());
  watch.Tick(std::chrono::milliseconds(1300));
  EXPECT_EQ(watch.ReasonOf(0), "torque_Nm (sensor 0815) is silent: nothing came for 1.2 s");
  watch.Judge(BlockAt(source, 1300, 100, signal));
  EXPECT_TRUE(watch.is_good());
  SensorWatch never(source);
  never.Tick(std::chrono::seconds(100));
  EXPECT_TRUE(never.is_good());
  never.Tick(std::chrono::seconds(101));
  EXPECT_EQ(never.fault(0), SensorFault::kSilent);
}

}  // namespace
}  // namespace strainwave::daq::acquisition::sensor_watch_test
