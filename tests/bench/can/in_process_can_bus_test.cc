// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/can/in_process_can_bus.h"

#include <gtest/gtest.h>

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "bench/devices/can/candump_log.h"
#include "bench/devices/can/wire_bits.h"
#include "tests/bench/real_time.h"

namespace strainwave::bench::in_process_can_bus_test {
namespace {

using protocols::CanFrame;
using std::chrono::microseconds;
using std::chrono::milliseconds;

// The frame as a string of zeros and ones, its checksum by long division, its stuff bits by looking back.
int BitsByHand(const CanFrame& frame) {
  const auto digits = [](std::uint32_t value, int count) {
    std::string text;
    for (int i = count - 1; i >= 0; --i) text += (value >> i & 1U) != 0 ? '1' : '0';
    return text;
  };
  std::string bits = "0";
  if (frame.extended) {
    bits +=
        digits(frame.id, 29).substr(0, 11) + "11" + digits(frame.id, 18) + (frame.remote ? "1" : "0") + "00";
  } else {
    bits += digits(frame.id, 11) + (frame.remote ? "1" : "0") + "00";
  }
  bits += digits(frame.length, 4);
  for (int i = 0; i < frame.length && !frame.remote; ++i)
    bits += digits(frame.data[static_cast<std::size_t>(i)], 8);
  std::string rest = bits + std::string(15, '0');
  const std::string generator = "1100010110011001";  // x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1
  for (std::size_t i = 0; i < bits.size(); ++i) {
    if (rest[i] == '0') continue;
    for (std::size_t j = 0; j < generator.size(); ++j) rest[i + j] = rest[i + j] == generator[j] ? '0' : '1';
  }
  bits += rest.substr(bits.size());
  std::string wire;
  for (const char bit : bits) {
    wire += bit;
    if (wire.size() >= 5 && wire.substr(wire.size() - 5) == std::string(5, bit))
      wire += bit == '0' ? '1' : '0';
  }
  return static_cast<int>(wire.size()) + 13;
}

TEST(WireBits, CountsTheStuffBits) {
  // 34 zeros: a one after every five of them, six in all; 13 bits behind.
  EXPECT_EQ(WireBits({}), 34 + 6 + 13);
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    CanFrame frame;
    frame.extended = random() % 2 == 0;
    frame.remote = random() % 8 == 0;
    frame.id = static_cast<std::uint32_t>(random() & (frame.extended ? 0x1FFFFFFFU : 0x7FFU));
    frame.length = static_cast<std::uint8_t>(random() % 9);
    for (std::size_t j = 0; j < frame.length && !frame.remote; ++j) {
      frame.data[j] = static_cast<std::uint8_t>(random() % 3 == 0 ? 0 : random() & 0xFFU);
    }
    ASSERT_EQ(WireBits(frame), BitsByHand(frame)) << frame.id;
  }
}

CanFrame Data(std::uint32_t id, std::uint8_t byte = 0) { return {id, false, false, false, 1, {byte}}; }

std::vector<std::uint32_t> Ids(CanBus& end) {
  std::vector<std::uint32_t> ids;
  ReceivedFrame received;
  while (end.Receive(received)) ids.push_back(received.frame.id);
  return ids;
}

using IdList = std::vector<std::uint32_t>;

TEST(InProcessCanBus, GivesEachFrameToAllOthers) {
  InProcessCanBus bus({.ends = 3});
  EXPECT_EQ(bus.end(0).Send(Data(0x123)), CanBus::Sent::kQueued);
  bus.Exchange(milliseconds(1));
  EXPECT_EQ(Ids(bus.end(0)), IdList{});
  EXPECT_EQ(Ids(bus.end(1)), IdList{0x123});
  EXPECT_EQ(Ids(bus.end(2)), IdList{0x123});
}

TEST(InProcessCanBus, LetsTheLowestIdGoFirstAndKeepsTheOrderOfEachEnd) {
  InProcessCanBus bus({.ends = 4});
  bus.end(0).Send(Data(0x300));
  bus.end(0).Send(Data(0x100));
  bus.end(1).Send(Data(0x200));
  bus.end(1).Send(Data(0x201));
  CanFrame extended = Data(0x200U << 18U);
  extended.extended = true;
  bus.end(2).Send(extended);
  bus.Exchange(milliseconds(5));
  EXPECT_EQ(Ids(bus.end(3)), (IdList{0x200, 0x200U << 18U, 0x201, 0x300, 0x100}));
}

TEST(InProcessCanBus, TakesTheTimeOfTheBits) {
  InProcessCanBus bus({.bitrate = 500'000});
  const CanFrame frame = Data(0x123, 0x55);
  const std::chrono::nanoseconds length(WireBits(frame) * 2000);
  bus.Exchange(milliseconds(1));
  bus.end(0).Send(frame);
  bus.end(0).Send(frame);
  // Called often, with less than a frame between two calls.
  ReceivedFrame received;
  std::vector<std::chrono::nanoseconds> times;
  for (int i = 1; i <= 50; ++i) {
    const auto now = milliseconds(1) + i * microseconds(7);
    bus.Exchange(now);
    while (bus.end(1).Receive(received)) {
      EXPECT_LE(received.time, now) << "heard before it is over";
      times.push_back(received.time);
    }
  }
  ASSERT_EQ(times.size(), 2U);
  EXPECT_EQ(times[0], milliseconds(1) + length);
  EXPECT_EQ(times[1], milliseconds(1) + 2 * length);
  EXPECT_EQ(bus.busy(), 2 * length);
  EXPECT_EQ(bus.carried_frames(), 2U);
}

TEST(InProcessCanBus, SaysFullWhenTheBusIsTooSlow) {
  InProcessCanBus bus({.bitrate = 10'000, .transmit_frames = 3});
  for (int i = 0; i < 3; ++i) EXPECT_EQ(bus.end(0).Send(Data(1)), CanBus::Sent::kQueued);
  EXPECT_EQ(bus.end(0).Send(Data(1)), CanBus::Sent::kFull);
  bus.Exchange(milliseconds(1));  // the first is on the wire
  EXPECT_EQ(bus.end(0).Send(Data(1)), CanBus::Sent::kQueued);
  EXPECT_EQ(bus.end(0).Send(Data(1)), CanBus::Sent::kFull);
}

TEST(InProcessCanBus, SendsNothingThatWasQueuedBeforeAPurge) {
  InProcessCanBus bus({.bitrate = 0, .transmit_frames = 3});
  for (std::uint32_t id = 1; id <= 3; ++id) bus.end(0).Send(Data(id));
  bus.end(0).PurgeTransmit();
  EXPECT_EQ(bus.end(0).Send(Data(9)), CanBus::Sent::kQueued) << "no room for the stop itself";
  bus.Exchange(milliseconds(1));
  EXPECT_EQ(Ids(bus.end(1)), IdList{9});
}

TEST(InProcessCanBus, StopsAnEndThatIsBusOff) {
  InProcessCanBus bus({.ends = 3, .bitrate = 0});
  bus.end(0).Send(Data(1));
  bus.SetBusOff(0, true);
  EXPECT_EQ(bus.end(0).state(), CanState::kBusOff);
  EXPECT_EQ(bus.end(0).Send(Data(2)), CanBus::Sent::kDown);
  bus.end(1).Send(Data(3));
  bus.Exchange(milliseconds(1));
  EXPECT_EQ(Ids(bus.end(2)), IdList{3});
  ReceivedFrame received;
  ASSERT_TRUE(bus.end(0).Receive(received));
  EXPECT_TRUE(received.frame.error);
  EXPECT_EQ(received.frame.id, 0x40U);
  EXPECT_FALSE(bus.end(0).Receive(received));
  bus.SetBusOff(0, false);
  EXPECT_EQ(bus.end(0).state(), CanState::kErrorActive);
  bus.end(0).Send(Data(4));
  bus.Exchange(milliseconds(2));
  EXPECT_EQ(Ids(bus.end(2)), IdList{4}) << "what was queued before bus-off must not come";
}

TEST(InProcessCanBus, KeepsAFrameThatNobodyHears) {
  InProcessCanBus bus({});
  bus.SetBusOff(1, true);
  bus.end(0).Send(Data(1));
  bus.Exchange(milliseconds(5));
  EXPECT_EQ(bus.end(0).state(), CanState::kErrorPassive);
  EXPECT_EQ(bus.carried_frames(), 0U);
  bus.SetBusOff(1, false);
  bus.Exchange(milliseconds(9));
  bus.Exchange(milliseconds(10));
  EXPECT_EQ(bus.end(0).state(), CanState::kErrorActive);
  EXPECT_EQ(bus.carried_frames(), 1U);
}

TEST(InProcessCanBus, CountsWhatIsLostOnTheWayIn) {
  InProcessCanBus bus({.bitrate = 0, .transmit_frames = 100, .receive_frames = 8});
  bus.LoseNext(1, 2);
  for (std::uint32_t id = 1; id <= 12; ++id) bus.end(0).Send(Data(id));
  bus.Exchange(milliseconds(1));
  EXPECT_EQ(Ids(bus.end(1)), (IdList{3, 4, 5, 6, 7, 8, 9, 10}));
  EXPECT_EQ(bus.end(1).lost_frames(), 4U);
  EXPECT_EQ(bus.end(0).lost_frames(), 0U);
}

TEST(InProcessCanBus, LosesAndSwapsNothingBetweenTwoThreads) {
  constexpr std::uint32_t kFrames = 20000;
  InProcessCanBus bus({.bitrate = 0, .receive_frames = 64});
  std::thread sender([&] {
    for (std::uint32_t i = 0; i < kFrames;) {
      CanFrame frame = Data(0x100);
      frame.length = 4;
      for (std::size_t j = 0; j < 4; ++j) frame.data[j] = static_cast<std::uint8_t>(i >> 8 * j & 0xFFU);
      if (bus.end(0).Send(frame) == CanBus::Sent::kQueued) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  std::uint32_t expected = 0;
  for (std::int64_t tick = 0; expected < kFrames; ++tick) {
    bus.Exchange(microseconds(tick));
    ReceivedFrame received;
    while (bus.end(1).Receive(received)) {
      std::uint32_t number = 0;
      for (std::size_t j = 4; j-- > 0;) number = number << 8 | received.frame.data[j];
      EXPECT_EQ(number, expected);
      expected = number + 1;
    }
    std::this_thread::yield();
  }
  sender.join();
  EXPECT_EQ(bus.end(1).lost_frames(), 0U);
}

std::string MessageOf(const InProcessCanSettings& settings) {
  try {
    InProcessCanBus bus(settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "none";
}

TEST(InProcessCanBus, RefusesABusThatIsNone) {
  EXPECT_EQ(MessageOf({.ends = 1}), "ends = 1 (must be at least 2)");
  EXPECT_EQ(MessageOf({.transmit_frames = 0}), "transmit_frames = 0 (must be at least 1)");
  EXPECT_EQ(MessageOf({.receive_frames = 0}), "receive_frames = 0 (must be at least 1)");
}

// Two who talk, and the log's own end.
class LoggedBus : public testing::Test {
 protected:
  LoggedBus() { std::filesystem::create_directories(folder_); }
  ~LoggedBus() override { std::filesystem::remove_all(folder_); }

  CandumpLogSettings Settings(std::uint64_t most_file_bytes = 1'000'000) {
    return {.folder = folder_, .interface = "can7", .most_file_bytes = most_file_bytes, .most_files = 3};
  }
  // Frames 0, 1, 2, … by turns from either end.
  CanFrame Talk(std::uint32_t number) {
    CanFrame frame{.id = 0x100 + number % 0x400};
    frame.length = 4;
    for (std::size_t i = 0; i < 4; ++i) frame.data[i] = static_cast<std::uint8_t>(number >> (8 * i));
    EXPECT_EQ(bus_.end(static_cast<int>(number % 2)).Send(frame), CanBus::Sent::kQueued);
    clock_.SleepUntil(clock_.now + milliseconds(1));
    bus_.Exchange(clock_.now);
    ReceivedFrame received;
    while (bus_.end(0).Receive(received) || bus_.end(1).Receive(received)) continue;
    return frame;
  }
  std::vector<std::filesystem::path> Files() const {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
  }
  static std::vector<protocols::LoggedFrame> Read(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::ostringstream text;
    text << file.rdbuf();
    return protocols::ParseCandump(text.str(), path.string());
  }

  struct OwnClock final : BenchClock {
    std::chrono::nanoseconds Now() const noexcept override { return now; }
    void SleepUntil(std::chrono::nanoseconds time) noexcept override { now = time; }
    std::uint64_t Overruns() const noexcept override { return 0; }
    std::chrono::nanoseconds now{};
  };

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("strainwave-candump-" + std::to_string(::getpid()));
  OwnClock clock_;
  InProcessCanBus bus_{{.ends = 3}};
};

// Point 15.
TEST_F(LoggedBus, IsWrittenDownFrameByFrameAsPythonCanReadsIt) {
  std::vector<CanFrame> said;
  {
    const CandumpLog log(bus_.end(2), clock_, Settings());
    for (std::uint32_t i = 0; i < 500; ++i) said.push_back(Talk(i));
    ASSERT_TRUE(Until([&] { return log.frames() == said.size(); }));
    EXPECT_EQ(log.lost(), 0U);
    EXPECT_EQ(log.trouble(), "");
  }
  ASSERT_EQ(Files().size(), 1U);
  const auto frames = Read(Files()[0]);
  ASSERT_EQ(frames.size(), said.size());
  for (std::size_t i = 0; i < said.size(); ++i) {
    ASSERT_EQ(frames[i].frame, said[i]);
    EXPECT_EQ(frames[i].interface, "can7");
    // A frame a millisecond; on the wire within it.
    EXPECT_NEAR(static_cast<double>((frames[i].time - frames[0].time).count()),
                1000.0 * static_cast<double>(i), 200.0);
  }
  const std::string command =
      "/usr/bin/python3 -c \"import can, sys; sys.exit(sum(1 for m in can.CanutilsLogReader(sys.argv[1]) if "
      "m.channel == 'can7' and len(m.data) == 4) != 500)\" " +
      Files()[0].string();
  EXPECT_EQ(std::system(command.c_str()), 0) << "python3-can reads it otherwise";
}

TEST_F(LoggedBus, TakesNoMoreRoomThanItMayAndKeepsTheNewest) {
  std::uint32_t last = 0;
  {
    const CandumpLog log(bus_.end(2), clock_, Settings(2000));
    for (; last < 1000; ++last) Talk(last);
    ASSERT_TRUE(Until([&] { return log.frames() == last; }));
  }
  const auto files = Files();
  ASSERT_EQ(files.size(), 3U);
  for (const auto& file : files) EXPECT_LT(std::filesystem::file_size(file), 2100U);
  EXPECT_EQ(Read(files.back()).back().frame.data[0], (last - 1) & 0xFF);
  // One file goes on where the other ends.
  EXPECT_EQ((Read(files[1]).back().frame.data[0] + 1) & 0xFF, Read(files[2]).front().frame.data[0]);
}

TEST_F(LoggedBus, EndsInWordsWhereItsFolderCannotBeListed) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "skipped, because a sanitizer takes a descriptor to look at an object's type";
#endif
  CandumpFiles files(Settings());
  // One descriptor is left, which the file itself takes.
  rlimit before{};
  ::getrlimit(RLIMIT_NOFILE, &before);
  const int next = ::dup(STDIN_FILENO);
  ::close(next);
  rlimit one_more = before;
  one_more.rlim_cur = static_cast<rlim_t>(next) + 1;
  ::setrlimit(RLIMIT_NOFILE, &one_more);
  const bool written = files.Write({microseconds(0), "can7", CanFrame{.id = 1}});
  ::setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_FALSE(written);
  EXPECT_EQ(files.trouble(),
            "filesystem error: directory iterator cannot open directory: Too many open files [" +
                folder_.string() + "]");
  EXPECT_FALSE(files.Write({microseconds(1), "can7", CanFrame{.id = 2}})) << "with room again";
}

TEST_F(LoggedBus, KeepsWhatWasSaidAroundATrip) {
  std::uint32_t last = 0;
  const auto stem = folder_ / "000012-345s";
  std::uint32_t trip = 0;
  {
    CandumpLog log(bus_.end(2), clock_, Settings(2000));
    for (; last < 300; ++last) Talk(last);
    ASSERT_TRUE(Until([&] { return log.frames() == last; }));
    trip = last;
    log.Keep(stem);
    for (; last < 1000; ++last) Talk(last);
    ASSERT_TRUE(Until([&] { return log.frames() == last; }));
  }
  const auto number = [](const protocols::LoggedFrame& logged) {
    return logged.frame.data[0] + 256U * logged.frame.data[1];
  };
  const auto before = Read(stem.string() + ".can7.before.log");
  const auto around = Read(stem.string() + ".can7.log");
  EXPECT_EQ(number(before.back()) + 1, number(around.front()));
  EXPECT_LT(number(around.front()), trip);
  EXPECT_GT(number(around.back()), trip) << "what came after the trip is in it, too";
}

TEST_F(LoggedBus, CountsWhatItMisses) {
  for (std::uint32_t i = 0; i < 10; ++i) Talk(i);  // before the log begins: nobody's loss
  const CandumpLog log(bus_.end(2), clock_, Settings());
  bus_.LoseNext(2, 7);
  for (std::uint32_t i = 0; i < 50; ++i) Talk(i);
  EXPECT_TRUE(Until([&] { return log.frames() == 43 && log.lost() == 7; }))
      << log.frames() << ", " << log.lost();
}

}  // namespace
}  // namespace strainwave::bench::in_process_can_bus_test
