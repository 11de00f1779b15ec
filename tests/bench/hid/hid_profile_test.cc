// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/read_hid_profile.h"
#include "tests/checkout.h"

#include <gtest/gtest.h>

namespace strainwave::bench::hid_profile_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

const std::filesystem::path kProfiles = std::filesystem::path(SourceFolder()) / "bench/devices/profiles";

std::string ErrorsOf(const std::string& text) {
  try {
    ParseHidProfile(text, "d.yaml");
  } catch (const HidProfileError& error) {
    return error.what();
  }
  return "none";
}

TEST(HidProfile, OfTheThermometerReadsWhatThermometersSend) {
  const HidProfile profile = ReadHidProfile(kProfiles / "hid_thermometer.yaml");
  EXPECT_EQ(profile.device.vendor, 0x0C45);
  EXPECT_EQ(profile.device.product, 0x7401);
  EXPECT_EQ(profile.device.request, (Bytes{0, 1, 0x80, 0x33, 1, 0, 0, 0, 0}));
  ASSERT_EQ(profile.channels.size(), 1U);
  EXPECT_EQ(TakeField(profile.channels[0], Bytes{0x80, 0x02, 0x17, 0x80, 0, 0, 0, 0}).value, 23.5);
}

TEST(HidProfile, OfTheTorqueReadOutRefusesAnOverload) {
  const HidProfile profile = ReadHidProfile(kProfiles / "hid_torque_readout.yaml");
  ASSERT_EQ(profile.channels.size(), 2U);
  const Bytes good{1, 0xC8, 0xAF, 0x00, 0x00, 0, 0};
  const Bytes overload{1, 0xC8, 0xAF, 0x00, 0x00, 1, 0};
  EXPECT_DOUBLE_EQ(TakeField(profile.channels[0], good).value, 45.0);
  EXPECT_EQ(TakeField(profile.channels[1], good).problem, protocols::HidProblem::kNone);
  EXPECT_EQ(TakeField(profile.channels[1], overload).problem, protocols::HidProblem::kOutOfRange);
}

TEST(HidProfile, RefusesToTakeAnOldValueForANewOne) {
  EXPECT_EQ(
      ErrorsOf("hid_device: 1\ndevice: d\nvendor: 1234\nproduct: 1234\ngood_for: 1 h\nchannels:\n"
               "  - {name: a, report_length: 2, first_bit: 0, bits: 8}\n"),
      "d.yaml:5:11: error: good_for = 1 h is above 3 min (expected no more, since an older value is none)");
}

TEST(HidProfile, TellsAllMistakesWithTheirPlace) {
  EXPECT_EQ(
      ErrorsOf("hid_device: 1\n"
               "device: d\n"
               "vendor: 1234\n"
               "product: 12g4\n"
               "request: 00 1ff\n"
               "good_for: 1 s\n"
               "channels:\n"
               "  - {name: a, report_length: 2, first_bit: 9, bits: 8}\n"
               "  - {name: b, report_length: 2, first_bit: 0, bits: 8, sign: true}\n"),
      "d.yaml:4:10: error: product = 12g4 is not usable (expected four hexadecimal digits, as lsusb prints "
      "them)\n"
      "d.yaml:5:10: error: request has '1ff' (expected bytes of two hexadecimal digits, as in '00 80 33')\n"
      "d.yaml:8:53: error: the number ends beyond the report (expected bits within report_length)\n"
      "d.yaml:9:56: error: unknown key 'sign', did you mean 'signed'? (expected name, report_id, "
      "report_length, first_bit, bits, signed, high_byte_first, scale, offset, unit, least, most)");
}

}  // namespace
}  // namespace strainwave::bench::hid_profile_test
