// SPDX-License-Identifier: Apache-2.0
// What a host without CAN is told, and what needs no kernel.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <stdexcept>
#include <string>
#include <system_error>

#include "bench/devices/can/device_clock.h"
#include "bench/devices/can/socket_can_bus.h"

namespace strainwave::bench::no_can_test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(SocketCanBus, SaysHowToGetACanWhereTheKernelHasNone) {
  if (const int socket = ::socket(PF_CAN, SOCK_RAW, 1); socket >= 0) {
    ::close(socket);
    GTEST_SKIP() << "this kernel has CAN";
  }
  SocketCanSettings settings;
  settings.interface = "vcan0";
  try {
    SocketCanBus bus(settings);
    FAIL() << "no std::system_error";
  } catch (const std::system_error& error) {
    EXPECT_EQ(error.code(), std::errc::address_family_not_supported);
    EXPECT_STREQ(
        error.what(),
        "CAN interface vcan0: this kernel has no CAN (try: modprobe can can_raw vcan; ip link add dev vcan0 "
        "type vcan; ip link set up vcan0; or use the in-process bus): Address family not supported by "
        "protocol");
  }
}

TEST(SocketCanBus, RefusesQueuesOfNoFrame) {
  SocketCanSettings settings;
  settings.interface = "vcan0";
  settings.most_in_flight = 0;
  try {
    SocketCanBus bus(settings);
    FAIL() << "no std::invalid_argument";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "most_in_flight = 0, transmit_frames = 32 (both must be at least 1)");
  }
}

TEST(DeviceClock, TakesTheSmallestDelayForTheTruth) {
  DeviceClock clock;
  const auto offset = seconds(1000);
  // True time t on our clock is t - 1000 s on the device's; each frame arrives later by its delay.
  EXPECT_EQ(clock.ToOurs(seconds(1), seconds(1) + offset + microseconds(500)),
            seconds(1) + offset + microseconds(500));
  const auto second =
      clock.ToOurs(seconds(1) + milliseconds(1), seconds(1) + milliseconds(1) + offset + microseconds(50));
  EXPECT_EQ(second, seconds(1) + milliseconds(1) + offset + microseconds(50));
  // A frame that lay in a queue for 20 ms keeps its place in time, but for the drift that is allowed for.
  const auto third = clock.ToOurs(seconds(1) + milliseconds(2), seconds(1) + milliseconds(22) + offset);
  const auto truth = seconds(1) + milliseconds(2) + offset;
  EXPECT_GT(third, truth);
  EXPECT_LT(third - truth, microseconds(50 + 5));
}

TEST(DeviceClock, FollowsADriftAndAJump) {
  DeviceClock clock;
  std::chrono::nanoseconds device{};
  std::chrono::nanoseconds arrival = seconds(7);
  for (int i = 0; i < 10000; ++i) {  // 100 ppm slow for ten seconds
    device += microseconds(1000);
    arrival += std::chrono::nanoseconds(1'000'100);
    const auto ours = clock.ToOurs(device, arrival);
    ASSERT_LE(ours, arrival);
    ASSERT_GT(ours, arrival - microseconds(1));
  }
  // The interface was reset: its clock begins at zero again.
  EXPECT_EQ(clock.ToOurs(milliseconds(1), arrival + milliseconds(1)), arrival + milliseconds(1));
}

TEST(TimeOfFrame, IsTheInterfacesWhereItHasOne) {
  DeviceClock clock;
  const timespec kernels{5000, 0};
  // The interface's clock began 60 s after ours; the first frame was on its way for the shortest time.
  EXPECT_EQ(TimeOfFrame(std::array{kernels, timespec{}, timespec{40, 0}}, seconds(100), seconds(5000), clock),
            seconds(100));
  // The next lay in a queue for 20 ms; what the kernel says about it does not matter.
  const auto truth = seconds(100) + milliseconds(2);
  const auto second = TimeOfFrame(std::array{kernels, timespec{}, timespec{40, 2'000'000}},
                                  truth + milliseconds(20), seconds(5000), clock);
  EXPECT_GE(second, truth);
  EXPECT_LT(second - truth, microseconds(5));
}

TEST(TimeOfFrame, IsElseTheKernelsUnlessTheWallClockWasSet) {
  DeviceClock clock;
  const auto at = [&](const timespec& kernels) {
    return TimeOfFrame(std::array{kernels, timespec{}, timespec{}}, seconds(100), seconds(5000), clock);
  };
  EXPECT_EQ(at({4999, 997'000'000}), seconds(100) - milliseconds(3));
  EXPECT_EQ(at({4000, 0}), seconds(100)) << "set forward meanwhile";
  EXPECT_EQ(at({5000, 1}), seconds(100)) << "set back meanwhile";
  EXPECT_EQ(at({}), seconds(100)) << "no stamp at all";
}

}  // namespace
}  // namespace strainwave::bench::no_can_test
