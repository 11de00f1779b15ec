// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/node_pdos.h"

#include <gtest/gtest.h>

#include "tests/protocols/canopen/drive_node_fixture.h"

namespace strainwave::protocols::canopen::device::node_pdos_test {
namespace {

constexpr std::int64_t kOff = 0x80000000;
constexpr std::int64_t kNoRemote = 0x40000000;

class NodePdosTest : public DriveNodeTest {
 protected:
  // The order of CiA 301: off, no entries, entries, their number, on.
  void Map(bool receive, int number, int type, std::initializer_list<std::int64_t> entries) {
    const auto communication = static_cast<std::uint16_t>((receive ? 0x1400 : 0x1800) + number);
    const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
    const std::int64_t id = (receive ? 0x201 : kNoRemote + 0x181) + 0x100 * number;
    ASSERT_EQ(Set(communication, 1, id | kOff), std::nullopt);
    ASSERT_EQ(Set(communication, 2, type), std::nullopt);
    ASSERT_EQ(Set(mapping, 0, 0), std::nullopt);
    std::uint8_t sub = 0;
    for (const std::int64_t entry : entries) ASSERT_EQ(Set(mapping, ++sub, entry), std::nullopt) << entry;
    ASSERT_EQ(Set(mapping, 0, sub), std::nullopt);
    ASSERT_EQ(Set(communication, 1, id), std::nullopt);
  }
  void Silence() { ASSERT_EQ(Set(0x1800, 1, kOff | kNoRemote | 0x181), std::nullopt); }
};

TEST_F(NodePdosTest, RefusesAMappingWhileThePdoIsOn) {
  BootUp();
  EXPECT_EQ(Set(0x1A00, 0, 0), SdoAbort::kCannotStoreDeviceState);
  EXPECT_EQ(Set(0x1A00, 1, 0x60640020), SdoAbort::kCannotStoreDeviceState);
  Silence();
  EXPECT_EQ(Set(0x1A00, 1, 0x60640020), SdoAbort::kCannotStoreDeviceState) << "one entry is still in force";
  EXPECT_EQ(Set(0x1A00, 0, 0), std::nullopt);
  EXPECT_EQ(Set(0x1A00, 1, 0x60640020), std::nullopt);
  EXPECT_EQ(Set(0x1A00, 0, 1), std::nullopt);
}

TEST_F(NodePdosTest, RefusesWhatCannotBeMapped) {
  BootUp();
  Silence();
  Set(0x1A00, 0, 0);
  EXPECT_EQ(Set(0x1A00, 1, 0x50000020), SdoAbort::kNoSuchObject);
  EXPECT_EQ(Set(0x1A00, 1, 0x60650020), SdoAbort::kNotMappable);   // following error window
  EXPECT_EQ(Set(0x1A00, 1, 0x60640010), SdoAbort::kNotMappable);   // 16 of its 32 bits
  EXPECT_EQ(Set(0x1A00, 1, 0x00070020), SdoAbort::kNoSuchObject);  // a dummy is for RPDOs
  Set(0x1400, 1, kOff | 0x201);
  Set(0x1600, 0, 0);
  EXPECT_EQ(Set(0x1600, 1, 0x60410010), SdoAbort::kNotMappable);  // read only
  EXPECT_EQ(Set(0x1600, 1, 0x00070020), std::nullopt);
  EXPECT_EQ(Set(0x1600, 2, 0x607A0020), std::nullopt);
  EXPECT_EQ(Set(0x1600, 3, 0x60600008), std::nullopt);
  EXPECT_EQ(Set(0x1600, 0, 3), SdoAbort::kMappingTooLong);  // 72 bits
  EXPECT_EQ(Set(0x1600, 0, 9), SdoAbort::kMappingTooLong);
  EXPECT_EQ(Set(0x1600, 0, 2), std::nullopt);
}

TEST_F(NodePdosTest, KeepsTheRulesOfTheCobId) {
  BootUp();
  EXPECT_EQ(Set(0x1800, 1, kNoRemote | 0x181), std::nullopt) << "the value that it has";
  EXPECT_EQ(Set(0x1800, 1, kNoRemote | 0x182), SdoAbort::kInvalidValue) << "another id while it is on";
  EXPECT_EQ(Set(0x1800, 1, kOff | 0x181), SdoAbort::kInvalidValue) << "bit 30 lost";
  EXPECT_EQ(Set(0x1800, 1, kOff | kNoRemote | 0x182), std::nullopt);
  EXPECT_EQ(Set(0x1800, 1, kNoRemote | 0x183), std::nullopt);
  Set(0x1800, 1, kOff | kNoRemote | 0x183);
  for (const std::int64_t id :
       {0x000, 0x07F, 0x101, 0x180, 0x581, 0x5FF, 0x601, 0x67F, 0x6E0, 0x701, 0x7FF}) {
    EXPECT_EQ(Set(0x1800, 1, kNoRemote | id), SdoAbort::kInvalidValue) << id;
  }
  EXPECT_EQ(Set(0x1800, 1, kNoRemote | 0x20000000 | 0x181), SdoAbort::kInvalidValue) << "29 bits";
  EXPECT_EQ(Set(0x1800, 3, 10), std::nullopt);
  EXPECT_EQ(Set(0x1800, 1, kNoRemote | 0x181), std::nullopt);
  EXPECT_EQ(Set(0x1800, 3, 11), SdoAbort::kCannotStoreDeviceState);
  EXPECT_EQ(Set(0x1800, 2, 240), std::nullopt);
  for (const int type : {241, 252, 253}) EXPECT_EQ(Set(0x1800, 2, type), SdoAbort::kInvalidValue) << type;
}

TEST_F(NodePdosTest, SamplesEveryNthSync) {
  BootUp();
  Silence();
  Map(false, 1, 1, {0x60410010, 0x60640020});
  Map(false, 2, 3, {0x60770010, 0x606C0020});
  Give("000#01 01");
  motor.reading.position_inc = 0x01020304;
  motor.reading.torque_permille = -2;
  EXPECT_EQ(Run(5), "");
  EXPECT_EQ(Give("080#"), "281#50 42 04 03 02 01");
  EXPECT_EQ(Give("080#"), "281#50 42 04 03 02 01");
  motor.reading.torque_permille = -2;
  motor.reading.speed_inc_per_s = 256;
  EXPECT_EQ(Give("080#"), "281#50 42 04 03 02 01\n381#FE FF 00 01 00 00");
  EXPECT_EQ(Give("080#"), "281#50 42 04 03 02 01");
}

TEST_F(NodePdosTest, SamplesOfTypeZeroAtASyncAfterAChange) {
  BootUp();
  Silence();
  Map(false, 1, 0, {0x60640020});
  Give("000#01 01");
  Run(5);
  EXPECT_EQ(Give("080#"), "281#00 00 00 00");
  EXPECT_EQ(Give("080#"), "");
  motor.reading.position_inc = 7;
  EXPECT_EQ(Run(2), "");
  EXPECT_EQ(Give("080#"), "281#07 00 00 00");
}

TEST_F(NodePdosTest, SendsAtAChangeAndWhenTheEventTimeHasPassed) {
  BootUp();
  Silence();
  Set(0x1801, 3, 50);  // 5 ms
  Map(false, 1, 254, {0x60640020});
  Set(0x1801, 5, 20);
  Give("000#01 01");
  EXPECT_EQ(Run(), "281#00 00 00 00");
  motor.reading.position_inc = 1;
  EXPECT_EQ(Run(4), "") << "inhibited";
  EXPECT_EQ(Run(), "281#01 00 00 00");
  EXPECT_EQ(Run(19), "");
  EXPECT_EQ(Run(), "281#01 00 00 00");
}

TEST_F(NodePdosTest, GivesEffectAtOnceOrWithTheSync) {
  BootUp();
  Silence();
  Map(true, 1, 255, {0x60600008, 0x60FF0020});
  Map(true, 2, 0, {0x00060010, 0x607A0020});
  Give("000#01 01");
  Give("301#03 04 03 02 01");
  EXPECT_EQ(Get(0x6060), 3);
  EXPECT_EQ(Get(0x60FF), 0x01020304);
  Give("401#FF FF 78 56 34 12");
  Run(5);
  EXPECT_EQ(Get(0x607A), 0);
  Give("080#");
  EXPECT_EQ(Get(0x607A), 0x12345678);
  // A value that the object refuses is left out, the rest is taken.
  Give("301#07 05 00 00 00");
  EXPECT_EQ(Get(0x6060), 3);
  EXPECT_EQ(Get(0x60FF), 5);
}

TEST_F(NodePdosTest, TakesPdosInOperationalOnly) {
  BootUp();
  Give("201#06 00");
  EXPECT_EQ(Get(0x6040), 0);
  Give("000#01 01");
  Give("201#06 00");
  EXPECT_EQ(Get(0x6040), 6);
}

TEST_F(NodePdosTest, TellsOfPdosThatAreTooShortOrTooLong) {
  Start();
  EXPECT_EQ(Give("201#06"), "081#10 82 11 00 00 00 00 00");
  EXPECT_EQ(Get(0x6040), 0) << "not processed";
  EXPECT_EQ(Give("201#06 00 99"), "081#00 00 00 00 00 00 00 00\n081#20 82 11 00 00 00 00 00");
  EXPECT_EQ(Get(0x6040), 6) << "its beginning is";
  EXPECT_EQ(Give("201#06 00"), "081#00 00 00 00 00 00 00 00");
}

TEST_F(NodePdosTest, MissesAnRpdoThatItHasHeard) {
  Start();
  Set(0x1400, 5, 20);
  Enable(3);
  EXPECT_EQ(Run(19), "181#37 16");
  EXPECT_EQ(node.power_state(), PowerState::kOperationEnabled);
  EXPECT_EQ(Run(), "081#50 82 11 00 00 00 00 00\n181#1F 06");  // fault reaction
  EXPECT_EQ(Run(), "181#18 42");                               // fault, brake engaged
  EXPECT_EQ(Get(0x603F), 0x8250);
  EXPECT_EQ(Give("201#00 00"), "");
  EXPECT_EQ(Run(), "081#00 00 00 00 00 00 00 00");
}

TEST_F(NodePdosTest, DoesNotMissAnRpdoThatNeverCame) {
  Set(0x1400, 5, 20);
  Start();
  EXPECT_EQ(Run(200), "");
}

}  // namespace
}  // namespace strainwave::protocols::canopen::device::node_pdos_test
