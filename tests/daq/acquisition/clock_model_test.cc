// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/clock_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <vector>

#include "tests/checkout.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::acquisition::clock_model_test {
namespace {

using std::chrono::nanoseconds;

// A device whose clock runs `drift` too slow and began at another time, delivering a block each `period_s`.
struct Device {
  double drift;
  double period_s;
  std::function<double(double, std::mt19937_64&)> delay_s;  // of a delivery at this host time

  nanoseconds HostTime(nanoseconds device) const {
    return kOffset + device + nanoseconds(std::llround(drift * static_cast<double>(device.count())));
  }
  // Lets `seconds` go by, from device time `from_s` on.
  void Run(ClockModel& model, double from_s, double seconds, std::mt19937_64& random) const {
    for (double t = from_s; t < from_s + seconds; t += period_s) {
      const nanoseconds device(std::llround(t * 1e9));
      const nanoseconds host = HostTime(device);
      const double late_s = delay_s(static_cast<double>(host.count()) * 1e-9, random);
      model.Add(device, host + nanoseconds(std::llround(late_s * 1e9)));
    }
  }
  double Error_s(const ClockModel& model, double at_s) const {
    const nanoseconds device(std::llround(at_s * 1e9));
    return static_cast<double>((model.estimate()->ToHost(device) - HostTime(device)).count()) * 1e-9;
  }
  static constexpr nanoseconds kOffset{987'654'321'987'654};
};

// Polled by the host once a frame, and now and then held up by the scheduler.
double PolledDelay_s(double host_s, double frame_s, std::mt19937_64& random) {
  std::exponential_distribution<double> software(1 / 30e-6);
  const double to_frame_s = (std::ceil(host_s / frame_s) - host_s / frame_s) * frame_s;
  const double held_up_s = random() % 100 == 0 ? 5e-3 : 0;
  return to_frame_s + software(random) + held_up_s;
}
double UsbDelay_s(double host_s, std::mt19937_64& random) { return PolledDelay_s(host_s, 125e-6, random); }
double SlowUsbDelay_s(double host_s, std::mt19937_64& random) { return PolledDelay_s(host_s, 1e-3, random); }
// A switched network with other traffic, whose queues empty now and then.
double NetworkDelay_s(double, std::mt19937_64& random) {
  std::exponential_distribution<double> queue(1 / 400e-6);
  return queue(random) + (random() % 50 == 0 ? 20e-3 : 0);
}

struct Case {
  const char* name;
  double drift;
  double period_s;
  double (*delay_s)(double, std::mt19937_64&);
  double allowed_s;
};

class ClockModelCases : public testing::TestWithParam<Case> {};

TEST_P(ClockModelCases, FindsADevicesClockInAMinute) {
  const Device device{GetParam().drift, GetParam().period_s, GetParam().delay_s};
  int covered = 0;
  constexpr int kSeeds = 100;
  double worst_s = 0;
  std::vector<double> stated_s;
  for (int seed = 0; seed < kSeeds; ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    ClockModel model({});
    device.Run(model, 1000.123, 60, random);
    ASSERT_TRUE(model.estimate());
    double worst_here_s = 0;
    for (const double at_s : {1001.0, 1030.0, 1060.0}) {
      worst_here_s = std::max(worst_here_s, std::abs(device.Error_s(model, at_s)));
    }
    worst_s = std::max(worst_s, worst_here_s);
    covered += worst_here_s <= model.estimate()->offset_uncertainty_s;
    EXPECT_NEAR(model.estimate()->drift, device.drift, 1e-6);
    stated_s.push_back(model.estimate()->offset_uncertainty_s);
  }
  std::nth_element(stated_s.begin(), stated_s.begin() + kSeeds / 2, stated_s.end());
  std::printf("%s: of %d runs off by at most %.2f us, %.2f us stated in the median\n", GetParam().name,
              kSeeds, worst_s * 1e6, stated_s[kSeeds / 2] * 1e6);
  EXPECT_LT(stated_s[kSeeds / 2], 4 * GetParam().allowed_s);
  EXPECT_LT(worst_s, GetParam().allowed_s);
  EXPECT_GE(covered, kSeeds * 95 / 100);
}

// Full-speed USB looks once a millisecond: of a minute of blocks only a few come just before it does.
INSTANTIATE_TEST_SUITE_P(Of, ClockModelCases,
                         testing::Values(Case{"usb", 50e-6, 10e-3, UsbDelay_s, 10e-6},
                                         Case{"usb_full_speed", -100e-6, 10.3e-3, SlowUsbDelay_s, 25e-6},
                                         Case{"usb_full_speed_in_step", 50e-6, 10e-3, SlowUsbDelay_s, 25e-6},
                                         Case{"network", 20e-6, 10e-3, NetworkDelay_s, 10e-6},
                                         Case{"network_fast", -80e-6, 5e-3, NetworkDelay_s, 10e-6}),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(ClockModel, HasAMachineThatBecomesSlowerOrQuickerInItsError) {
  constexpr double kSeconds = 20;
  int covered = 0;
  int runs = 0;
  for (const double step_s : {0.6e-3, -0.6e-3}) {
    for (double share = 0.1; share < 0.95; share += 0.05) {
      const double from_s = Device::kOffset.count() * 1e-9 + share * kSeconds;
      const Device device{0.0, 10e-3, [&](double host_s, std::mt19937_64& random) {
                            return 1e-3 + (host_s > from_s ? step_s : 0.0) + UsbDelay_s(host_s, random);
                          }};
      std::mt19937_64 random(3);
      ClockModel model({});
      device.Run(model, 0, kSeconds, random);
      covered += std::abs(model.estimate()->drift) <= model.estimate()->drift_uncertainty;
      ++runs;
    }
  }
  EXPECT_GE(covered, runs * 95 / 100) << "of " << runs;
}

TEST(ClockModel, IsExactWithoutJitter) {
  const Device device{30e-6, 10e-3, [](double, std::mt19937_64&) { return 0.0; }};
  std::mt19937_64 random;
  ClockModel model({});
  device.Run(model, 0, 60, random);
  EXPECT_NEAR(device.Error_s(model, 30), 0, 3e-9);
  EXPECT_NEAR(model.estimate()->drift, 30e-6, 1e-10);
}

TEST(ClockModel, TakesTheLeastDelayThatItIsToldOff) {
  const Device device{0, 10e-3, [](double, std::mt19937_64&) { return 700e-6; }};
  std::mt19937_64 random;
  ClockModel model({.least_delay = std::chrono::microseconds(700)});
  device.Run(model, 0, 2, random);
  EXPECT_NEAR(device.Error_s(model, 1), 0, 2e-9);
}

TEST(ClockModel, FollowsAClockThatWanders) {
  std::mt19937_64 random(1);
  ClockModel model({});
  // Warming up: the drift changes by 20 ppm in ten minutes.
  double host_ns = 0;
  double t = 0;
  for (int i = 0; i < 60000; ++i) {
    t = 0.01 * i;
    host_ns = 1e9 * (t + 10e-6 * t + 20e-6 / 1200 * t * t);
    model.Add(nanoseconds(std::llround(t * 1e9)),
              nanoseconds(std::llround(host_ns + 1e9 * NetworkDelay_s(0, random))));
  }
  const double error_ns =
      static_cast<double>(model.estimate()->ToHost(nanoseconds(std::llround(t * 1e9))).count()) - host_ns;
  EXPECT_LT(std::abs(error_ns), 60e3);
  EXPECT_NEAR(model.estimate()->drift, 10e-6 + 20e-6 / 600 * 570, 1e-6);
}

TEST(ClockModel, StartsAnewWhenTheDevicesClockSteps) {
  const Device device{10e-6, 10e-3, UsbDelay_s};
  std::mt19937_64 random(4);
  ClockModel model({});
  device.Run(model, 1000, 30, random);
  device.Run(model, 0, 60, random);  // switched off and on
  EXPECT_EQ(model.restarts(), 1U);
  Device forward = device;
  EXPECT_LT(std::abs(forward.Error_s(model, 30)), 10e-6);
  model.Add(std::chrono::seconds(100), Device::kOffset + std::chrono::seconds(50));
  EXPECT_EQ(model.restarts(), 2U);
  EXPECT_FALSE(model.estimate());
}

TEST(ClockModel, RefusesSegmentsThatHoldNothing) {
  EXPECT_EQ(MessageOf<std::invalid_argument>([] { ClockModel({.most_segments = 1}); }),
            "segment = 250000000 ns and most_segments = 1 are not above zero and one");
}

// Steps of the time of day (NTP, daylight saving) cannot change an interval that never looks at it.
TEST(Acquisition, NeverReadsTheTimeOfDay) {
  const std::string marks[] = {"system_clock",  "CLOCK_REALTIME", "gettimeofday",
                               "time(nullptr)", "utc_clock",      "high_resolution_clock"};
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(
           std::filesystem::path(SourceFolder()) / "daq/acquisition")) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cc") continue;
    ++files;
    const std::string text = daq::BytesOf(entry.path());
    for (const std::string& mark : marks)
      EXPECT_EQ(text.find(mark), std::string::npos) << entry.path() << ": " << mark;
  }
  EXPECT_GT(files, 10);
}

}  // namespace
}  // namespace strainwave::daq::acquisition::clock_model_test
