// SPDX-License-Identifier: Apache-2.0
// SocketCanBus on a virtual CAN bus, beside can-utils as peers; run by tests/vm/on_can.sh.
#include <gtest/gtest.h>
#include <linux/can.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "bench/devices/can/socket_can_bus.h"
#include "protocols/candump.h"

namespace strainwave::bench::socket_can_test {
namespace {

using protocols::CanFrame;

CanFrame Data(std::uint32_t id, std::uint8_t byte = 0) { return {id, false, false, false, 1, {byte}}; }

std::chrono::nanoseconds Monotonic() {
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

// The frame with which somebody says that all is said. Waits for it as long as the test may take.
constexpr std::uint32_t kEnd = 0x7EE;
std::vector<ReceivedFrame> UntilEnd(CanBus& bus) {
  std::vector<ReceivedFrame> all;
  ReceivedFrame received;
  for (;;) {
    if (!bus.Receive(received)) {
      std::this_thread::yield();
      continue;
    }
    if (received.frame.id == kEnd && !received.frame.error) return all;
    all.push_back(received);
  }
}

void Put(CanBus& bus, const CanFrame& frame) {
  ReceivedFrame ignored;
  while (bus.Send(frame) == CanBus::Sent::kFull) bus.Receive(ignored);
}

// A socket of the test's own, which sends what no SocketCanBus does: error frames.
class RawSocket {
 public:
  explicit RawSocket(const char* interface) : socket_(::socket(PF_CAN, SOCK_RAW, CAN_RAW)) {
    ifreq request{};
    std::strncpy(request.ifr_name, interface, sizeof request.ifr_name - 1);
    ::ioctl(socket_, SIOCGIFINDEX, &request);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = request.ifr_ifindex;
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  RawSocket(const RawSocket&) = delete;
  RawSocket& operator=(const RawSocket&) = delete;
  ~RawSocket() { ::close(socket_); }

  void Error(std::uint32_t error_class, std::uint8_t status = 0) {
    can_frame raw{};
    raw.can_id = CAN_ERR_FLAG | error_class;
    raw.can_dlc = 8;
    raw.data[1] = status;
    EXPECT_EQ(::write(socket_, &raw, sizeof raw), static_cast<ssize_t>(sizeof raw));
  }

 private:
  int socket_;
};

SocketCanSettings On(const char* interface) {
  SocketCanSettings settings;
  settings.interface = interface;
  return settings;
}

std::string MessageOf(const SocketCanSettings& settings) {
  try {
    SocketCanBus bus(settings);
  } catch (const std::system_error& error) {
    return error.what();
  }
  return "none";
}

void Shell(const std::string& command) { ASSERT_EQ(std::system(command.c_str()), 0) << command; }

TEST(SocketCanBus, CarriesFramesOfAllKindsToOthersAndNotToItself) {
  SocketCanBus one(On("vcan0"));
  SocketCanBus two(On("vcan0"));
  const CanFrame frames[] = {{0x7FF, false, true, false, 4, {}},
                             {0x123, true, false, false, 8, {1, 2, 3, 4, 5, 6, 7, 8}},
                             {0x1FFFFFFF, true, true, false, 0, {}},
                             {0x000, false, false, false, 0, {}},
                             {0x181, false, false, false, 3, {0xDE, 0xAD, 0xBE}}};
  for (const CanFrame& frame : frames) Put(one, frame);
  Put(one, Data(kEnd));
  const std::vector<ReceivedFrame> received = UntilEnd(two);
  ASSERT_EQ(received.size(), std::size(frames));
  for (std::size_t i = 0; i < received.size(); ++i) EXPECT_EQ(received[i].frame, frames[i]) << i;
  ReceivedFrame own;
  EXPECT_FALSE(one.Receive(own));
  EXPECT_EQ(one.in_flight(), 0U) << "each frame came back as sent";
}

TEST(SocketCanBus, StampsFramesOnTheMonotonicClock) {
  const std::chrono::nanoseconds zero = Monotonic();
  SocketCanSettings settings = On("vcan0");
  settings.clock_zero = zero;
  SocketCanBus one(settings);
  SocketCanBus two(settings);
  // A virtual bus delivers while it sends. The kernel switches its stamps on in its own time, and stamps the
  // first frames when they are taken.
  bool stamped = false;
  std::chrono::nanoseconds last{};
  for (int i = 0; i < 1000 && !stamped; ++i) {
    Put(one, Data(0x100));
    const std::chrono::nanoseconds sent = Monotonic() - zero;
    Put(one, Data(kEnd));
    const auto received = UntilEnd(two);
    ASSERT_EQ(received.size(), 1U);
    EXPECT_GT(received[0].time, last);
    last = received[0].time;
    stamped = received[0].time <= sent;
  }
  EXPECT_TRUE(stamped) << "the time is that of taking the frame from the kernel";
}

TEST(SocketCanBus, LetsTheKernelFilterAndOpensTheFiltersForWhatItSends) {
  SocketCanBus one(On("vcan0"));
  SocketCanSettings settings = On("vcan0");
  settings.filters = {{0x180, 0x780, false}, {0x181, 0x7FF, false}, {kEnd, 0x7FF, false}};
  SocketCanBus two(settings);
  for (const std::uint32_t id : {0x17FU, 0x181U, 0x1FFU, 0x201U}) Put(one, Data(id));
  CanFrame extended = Data(0x181);
  extended.extended = true;
  Put(one, extended);
  Put(one, Data(kEnd));
  const auto received = UntilEnd(two);
  ASSERT_EQ(received.size(), 2U) << "once each, though two filters let one through";
  EXPECT_EQ(received[0].frame.id, 0x181U);
  EXPECT_EQ(received[1].frame.id, 0x1FFU);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(two.Send(Data(0x601)), CanBus::Sent::kQueued) << i;
  EXPECT_LE(two.in_flight(), settings.most_in_flight);
  Put(two, Data(kEnd));
  EXPECT_EQ(UntilEnd(one).size(), 20U);
}

TEST(SocketCanBus, CountsWhatTheKernelLost) {
  SocketCanBus one(On("vcan0"));
  SocketCanBus two(On("vcan0"));
  constexpr std::uint64_t kFrames = 20000;
  for (std::uint64_t i = 0; i < kFrames; ++i) Put(one, Data(0x100));
  // The loss shows with the next frame that is taken.
  ReceivedFrame received;
  std::uint64_t count = 0;
  while (two.Receive(received)) ++count;
  Put(one, Data(kEnd));
  count += UntilEnd(two).size();
  EXPECT_GT(two.lost_frames(), 0U);
  EXPECT_EQ(count + two.lost_frames(), kFrames);
}

TEST(SocketCanBus, FollowsTheStateOfTheController) {
  SocketCanBus bus(On("vcan0"));
  RawSocket controller("vcan0");
  const auto state_after = [&](std::uint32_t error_class, std::uint8_t status) {
    controller.Error(error_class, status);
    ReceivedFrame received;
    while (!bus.Receive(received)) std::this_thread::yield();
    EXPECT_TRUE(received.frame.error);
    EXPECT_EQ(received.frame.id, error_class);
    return bus.state();
  };
  EXPECT_EQ(bus.state(), CanState::kErrorActive);
  EXPECT_EQ(state_after(0x4, 0x08), CanState::kErrorWarning);
  EXPECT_EQ(state_after(0x4, 0x20), CanState::kErrorPassive);
  EXPECT_EQ(bus.Send(Data(1)), CanBus::Sent::kQueued);
  EXPECT_EQ(state_after(0x40, 0), CanState::kBusOff);
  EXPECT_EQ(bus.Send(Data(1)), CanBus::Sent::kDown);
  EXPECT_EQ(state_after(0x100, 0), CanState::kErrorActive);
  EXPECT_EQ(bus.Send(Data(1)), CanBus::Sent::kQueued);
  EXPECT_EQ(state_after(0x4, 0x01), CanState::kErrorActive);
  EXPECT_EQ(bus.lost_frames(), 1U) << "the controller's own queue ran over";
}

TEST(SocketCanBus, IsSeenByCandump) {
  SocketCanBus bus(On("vcan0"));
  // candump of both interfaces: what it prints first says that it listens.
  const std::unique_ptr<FILE, int (*)(FILE*)> candump(::popen("candump -L -T 3000 vcan0 vcan1", "r"),
                                                      &::pclose);
  ASSERT_NE(candump, nullptr);
  const auto line = [&] {
    char text[256] = "";
    return std::string(std::fgets(text, sizeof text, candump.get()) == nullptr ? "" : text);
  };
  SocketCanBus greeter(On("vcan1"));
  pollfd output{::fileno(candump.get()), POLLIN, 0};
  do greeter.Send(Data(kEnd));
  while (::poll(&output, 1, 50) == 0);
  const CanFrame frames[] = {{0x123, false, false, false, 4, {0xDE, 0xAD, 0xBE, 0xEF}},
                             {0x7FF, false, true, false, 0, {}},
                             {0x1F334455, true, true, false, 8, {}},
                             {0x123, true, false, false, 8, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}},
                             {}};
  for (const CanFrame& frame : frames) Put(bus, frame);
  std::size_t seen = 0;
  while (seen < std::size(frames)) {
    const std::string printed = line();
    ASSERT_FALSE(printed.empty()) << "candump ended after " << seen;
    const auto logged = protocols::ParseCandump(printed, "candump");
    ASSERT_EQ(logged.size(), 1U);
    if (logged[0].interface == "vcan1") continue;
    EXPECT_EQ(logged[0].frame, frames[seen]);
    EXPECT_EQ(protocols::CandumpLine(logged[0]) + "\n", printed) << "our own line is candump's";
    ++seen;
  }
}

TEST(SocketCanBus, HearsCansendAndCangen) {
  SocketCanBus bus(On("vcan0"));
  Shell(
      "cansend vcan0 5A1#11.2233.44556677.88 && cangen vcan0 -g 0 -n 200 -I 42A -L 4 -D i && cansend vcan0 "
      "7EE#");
  const auto received = UntilEnd(bus);
  ASSERT_EQ(received.size(), 201U);
  EXPECT_EQ(received[0].frame,
            (CanFrame{0x5A1, false, false, false, 8, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}}));
  for (std::size_t i = 1; i < received.size(); ++i) {
    EXPECT_EQ(received[i].frame,
              (CanFrame{0x42A, false, false, false, 4, {static_cast<std::uint8_t>(i - 1)}}))
        << i;
  }
  EXPECT_EQ(bus.lost_frames(), 0U);
}

TEST(SocketCanBus, SaysWhatToDoWhereThereIsNoSuchInterface) {
  EXPECT_EQ(MessageOf(On("can77")),
            "CAN interface can77 (ip link show type can; for a virtual one: ip link add dev can77 type vcan; "
            "ip link set "
            "up can77): No such device");
  EXPECT_EQ(
      MessageOf(On("lo")),
      "interface lo is none of CAN (expected one of 'ip link show type can' or 'type vcan'): No such device");
}

// What changes an interface does so in the virtual machine only.
class InterfaceTest : public testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("STRAINWAVE_VM") == nullptr) {
      GTEST_SKIP() << "this changes vcan1, which is not ours outside the virtual machine of tests/vm";
    }
  }
};

TEST_F(InterfaceTest, FeelsThatTheInterfaceGoesAndComes) {
  SocketCanBus bus(On("vcan1"));
  SocketCanBus other(On("vcan1"));
  EXPECT_EQ(bus.Send(Data(1)), CanBus::Sent::kQueued);
  Shell("ip link set vcan1 down");
  EXPECT_EQ(bus.Send(Data(2)), CanBus::Sent::kDown);
  EXPECT_EQ(bus.state(), CanState::kGone);
  EXPECT_EQ(MessageOf(On("vcan1")),
            "CAN interface vcan1 (a real one: ip link set vcan1 type can bitrate 1000000; then: ip link set "
            "up vcan1): "
            "Network is down");
  ReceivedFrame received;
  while (other.state() != CanState::kGone) other.Receive(received);
  while (other.Receive(received)) continue;
  EXPECT_EQ(received.frame, Data(1)) << "what had come in before stays";
  EXPECT_EQ(other.state(), CanState::kGone);
  Shell("ip link set vcan1 up");
  while (bus.Send(Data(3)) != CanBus::Sent::kQueued) continue;
  Put(bus, Data(kEnd));
  EXPECT_EQ(UntilEnd(other).size(), 1U) << "2 was not kept";
  EXPECT_EQ(other.state(), CanState::kErrorActive);
}

TEST_F(InterfaceTest, GivesTheKernelFewFramesAndPurgesTheRest) {
  // An interface that takes a while, as a bus under load does.
  Shell("tc qdisc replace dev vcan1 root netem delay 300ms");
  {
    SocketCanSettings settings = On("vcan1");
    settings.most_in_flight = 3;
    settings.transmit_frames = 5;
    SocketCanBus bus(settings);
    SocketCanBus other(On("vcan1"));
    for (std::uint8_t i = 1; i <= 8; ++i)
      EXPECT_EQ(bus.Send(Data(0x100, i)), CanBus::Sent::kQueued) << int{i};
    EXPECT_EQ(bus.Send(Data(0x100, 9)), CanBus::Sent::kFull);
    EXPECT_EQ(bus.in_flight(), 3U);
    bus.PurgeTransmit();
    EXPECT_EQ(bus.Send(Data(0x200, 10)), CanBus::Sent::kQueued) << "room for the stop itself";
    Put(bus, Data(kEnd));
    ReceivedFrame ignored;
    while (bus.in_flight() > 0) bus.Receive(ignored);
    const auto received = UntilEnd(other);
    std::string order;
    for (const ReceivedFrame& frame : received) order += std::to_string(frame.frame.data[0]) + " ";
    EXPECT_EQ(order, "1 2 3 10 ");
  }
  Shell("tc qdisc del dev vcan1 root");
}

}  // namespace
}  // namespace strainwave::bench::socket_can_test
