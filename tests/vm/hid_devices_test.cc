// SPDX-License-Identifier: Apache-2.0
// HID devices through the kernel: made with uhid (hid_peer.h), read by ours. Skipped without /dev/uhid; in a
// virtual machine that has it: tests/vm/run.sh build/tests/hid_devices_test.
#include <gtest/gtest.h>

#include <optional>

#include "bench/devices/hid/hid_channels.h"
#include "bench/devices/hid/pendant.h"
#include "bench/devices/hid/sto_contact.h"
#include "tests/bench/real_time.h"
#include "tests/vm/hid_peer.h"

namespace strainwave::bench::hid_devices_test {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint16_t kVendor = 0x1209, kProduct = 0x5701;

protocols::HidField Bit(unsigned bit) {
  protocols::HidField field;
  field.report_length = 2;
  field.first_bit = bit;
  field.bits = 1;
  return field;
}

class HidDevices : public testing::Test {
 protected:
  void SetUp() override {
    if (::access("/dev/uhid", R_OK | W_OK) != 0)
      GTEST_SKIP() << "skipped: this kernel has no /dev/uhid for us";
    Plug();
    ASSERT_TRUE(peer_->made());
  }
  void Plug() { peer_.emplace(kVendor, kProduct, "P1", 2); }
  void Unplug() { peer_.reset(); }
  bool Press(std::uint8_t keys) { return peer_->Send(Bytes{keys, 0}); }

  SteadyBenchClock clock_;
  std::optional<HidPeer> peer_;
  HidSettings settings_{kVendor, kProduct, "P1", {}, {}};
};

class Pendants : public HidDevices {
 protected:
  static constexpr std::uint8_t kStop = 1, kReset = 2, kStart = 4;
  bool Comes(const Pendant& pendant, PendantState state) {
    return Until([&] { return pendant.Actual().state == state; });
  }
  // A pendant sends a report when a key moves, and this one again and again until it is heard.
  bool Hears(const Pendant& pendant, std::uint8_t keys) {
    return Until([&] {
      const PendantKeys heard = pendant.Actual().keys;
      return Press(keys) && pendant.Actual().connected && heard.quick_stop == ((keys & kStop) != 0) &&
             heard.reset == ((keys & kReset) != 0) && heard.start == ((keys & kStart) != 0);
    });
  }
  bool Releases(const Pendant& pendant) {
    return Hears(pendant, 0) && Hears(pendant, kReset) && Comes(pendant, PendantState::kReset) &&
           Hears(pendant, 0) && Hears(pendant, kStart) && Comes(pendant, PendantState::kReleased) &&
           Hears(pendant, 0);
  }
  PendantProfile profile_{settings_, Bit(0), Bit(1), Bit(2), {}};
};

TEST_F(Pendants, AreStoppedUntilResetAndStart) {
  Pendant pendant(profile_, clock_);
  EXPECT_EQ(pendant.Actual().state, PendantState::kStopped);
  EXPECT_TRUE(pendant.Actual().keys.quick_stop);
  ASSERT_TRUE(Until([&] { return pendant.Actual().connected; }));
  EXPECT_TRUE(pendant.Actual().keys.quick_stop) << "nothing was said yet";
  ASSERT_TRUE(Hears(pendant, 0));
  ASSERT_TRUE(Hears(pendant, kStart));
  EXPECT_EQ(pendant.Actual().state, PendantState::kStopped) << "start alone is not enough";
  EXPECT_TRUE(Releases(pendant));
}

TEST_F(Pendants, StopWhenTheKeyIsPressedAndStayStoppedWhenItIsReleased) {
  Pendant pendant(profile_, clock_);
  ASSERT_TRUE(Releases(pendant));
  const auto pressed = clock_.Now();
  ASSERT_TRUE(Press(kStop));
  ASSERT_TRUE(Comes(pendant, PendantState::kStopped));
  std::printf("from the press to the state: %.2f ms\n",
              std::chrono::duration<double, std::milli>(pendant.Actual().stop_time - pressed).count());
  ASSERT_TRUE(Hears(pendant, 0));
  EXPECT_EQ(pendant.Actual().state, PendantState::kStopped);
  EXPECT_TRUE(Releases(pendant));
}

TEST_F(Pendants, StopWhenTheyAreUnpluggedAndComeBackStopped) {
  Pendant pendant(profile_, clock_);
  ASSERT_TRUE(Releases(pendant));
  Unplug();
  ASSERT_TRUE(Comes(pendant, PendantState::kStopped));
  ASSERT_TRUE(Until([&] { return !pendant.Actual().connected; }));
  Plug();
  ASSERT_TRUE(Until([&] { return pendant.Actual().connected; }));
  EXPECT_EQ(pendant.Actual().state, PendantState::kStopped);
  EXPECT_TRUE(Releases(pendant));
}

TEST_F(Pendants, StopUponAReportOfTheWrongLength) {
  Pendant pendant(profile_, clock_);
  ASSERT_TRUE(Releases(pendant));
  ASSERT_TRUE(peer_->Send(Bytes{0, 0, 0}));  // shorter ones the kernel keeps to itself
  ASSERT_TRUE(Comes(pendant, PendantState::kStopped));
  EXPECT_EQ(pendant.Actual().refused_reports, 1U);
}

TEST_F(Pendants, StopWhenTheyFallSilent) {
  profile_.report_period = 1s;
  Pendant pendant(profile_, clock_);
  ASSERT_TRUE(Releases(pendant));
  EXPECT_TRUE(Comes(pendant, PendantState::kStopped));
  ASSERT_TRUE(Hears(pendant, 0));
  EXPECT_EQ(pendant.Actual().state, PendantState::kStopped) << "the silence was a press";
}

TEST_F(HidDevices, WithAnotherSerialNumberIsNotTaken) {
  settings_.serial = "P2";
  Pendant pendant({settings_, Bit(0), Bit(1), Bit(2), {}}, clock_);
  HidPeer other(kVendor, kProduct, "P2", 2);
  ASSERT_TRUE(Until([&] { return pendant.Actual().connected; }));
  ASSERT_TRUE(Until([&] { return other.Send(Bytes{0, 0}) && !pendant.Actual().keys.quick_stop; }));
}

TEST_F(HidDevices, TheTorqueOffContactIsLoggedWithItsLatency) {
  StoContact contact(settings_, Bit(8), clock_);
  EXPECT_FALSE(contact.Actual().good);
  const auto report = [&](std::uint8_t closed) {
    return Until([&] {
      return peer_->Send(Bytes{0, closed}) && contact.Actual().good && contact.Actual().open == (closed == 0);
    });
  };
  ASSERT_TRUE(report(1));
  EXPECT_TRUE(contact.TakeOpenings().empty());
  const auto asked = clock_.Now();
  contact.Asked(asked);
  contact.Asked(asked + 1h);  // the first counts
  ASSERT_TRUE(report(0));
  const std::vector<StoOpening> openings = contact.TakeOpenings();
  ASSERT_EQ(openings.size(), 1U);
  ASSERT_TRUE(openings[0].latency);
  EXPECT_EQ(*openings[0].latency, openings[0].time - asked);
  EXPECT_GT(*openings[0].latency, 0ns);
  ASSERT_TRUE(report(1));
  ASSERT_TRUE(report(0));
  const std::vector<StoOpening> unasked = contact.TakeOpenings();
  ASSERT_EQ(unasked.size(), 1U);
  EXPECT_FALSE(unasked[0].latency) << "nobody had asked";
  Unplug();
  EXPECT_TRUE(Until([&] { return !contact.Actual().good; }));
}

TEST_F(HidDevices, AThermometerIsAskedAndItsValueGrowsStale) {
  settings_.request = {0, 1, 0x80};
  settings_.request_period = 50ms;
  protocols::HidField field = Bit(0);
  field.bits = 16;
  field.is_signed = true;
  field.high_byte_first = true;
  field.scale = 1.0 / 256;
  HidChannels channels({"thermometer", settings_, {field}, 2s}, clock_);
  ASSERT_EQ(peer_->Take(30s), (Bytes{0, 1, 0x80}));
  ASSERT_TRUE(peer_->Send(Bytes{0xFF, 0x40}));
  ASSERT_TRUE(Until([&] { return channels.Value(0).good; }));
  EXPECT_EQ(channels.Value(0).value, -0.75);
  EXPECT_TRUE(Until([&] { return !channels.Value(0).good; })) << "it is asked, and does not answer";
  ASSERT_TRUE(Until([&] { return peer_->Send(Bytes{0, 0}) && channels.Value(0).good; }));
  Unplug();
  EXPECT_TRUE(Until([&] { return !channels.Value(0).good && !channels.connected(); }));
}

}  // namespace
}  // namespace strainwave::bench::hid_devices_test
