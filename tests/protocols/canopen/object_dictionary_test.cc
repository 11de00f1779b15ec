// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/object_dictionary.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace strainwave::protocols::canopen::device::object_dictionary_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

EdsFile Objects() {
  EdsFile eds;
  eds.objects[{0x1000, 0}] = {"type", DataType::kUnsigned32, AccessType::kConstant, false, "0x00020192", "",
                              ""};
  eds.objects[{0x1014, 0}] = {
      "EMCY", DataType::kUnsigned32, AccessType::kReadWrite, false, "$NODEID+0x80", "", ""};
  eds.objects[{0x1008, 0}] = {"name", DataType::kVisibleString, AccessType::kReadOnly, false, "Turner", "",
                              ""};
  eds.objects[{0x2000, 0}] = {"key", DataType::kUnsigned16, AccessType::kWriteOnly, false, "", "", ""};
  eds.objects[{0x2001, 0}] = {"offset", DataType::kInteger16, AccessType::kReadWrite, true, "-2", "-100",
                              "0x64"};
  eds.objects[{0x2002, 0}] = {"ratio", DataType::kReal32, AccessType::kReadWrite, true, "1.5", "", ""};
  eds.objects[{0x2003, 0}] = {"notes", DataType::kDomain, AccessType::kReadWrite, false, "", "", ""};
  eds.objects[{0x2004, 0}] = {"flag", DataType::kBoolean, AccessType::kReadWrite, false, "1", "", ""};
  eds.objects[{0x2005, 0}] = {"wide", DataType::kInteger64, AccessType::kReadWrite, false, "-3", "", ""};
  return eds;
}

Bytes Value(const ObjectDictionary& objects, std::uint16_t index) {
  Bytes bytes;
  EXPECT_EQ(objects.Read({index, 0}, bytes), std::nullopt);
  return bytes;
}

TEST(ObjectDictionary, StartsWithTheDefaultsOfThisNode) {
  const ObjectDictionary objects(Objects(), 0x11);
  EXPECT_EQ(Value(objects, 0x1000), (Bytes{0x92, 0x01, 0x02, 0x00}));
  EXPECT_EQ(Value(objects, 0x1014), (Bytes{0x91, 0x00, 0x00, 0x00}));
  EXPECT_EQ(Value(objects, 0x1008), (Bytes{'T', 'u', 'r', 'n', 'e', 'r'}));
  EXPECT_EQ(Value(objects, 0x2001), (Bytes{0xFE, 0xFF}));
  EXPECT_EQ(Value(objects, 0x2002), (Bytes{0x00, 0x00, 0xC0, 0x3F}));  // 1.5 of IEEE 754
  EXPECT_EQ(Value(objects, 0x2003), Bytes{});
  EXPECT_EQ(Value(objects, 0x2004), Bytes{1});
  EXPECT_EQ(Value(objects, 0x2005), (Bytes{0xFD, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}));
  EXPECT_EQ(objects.Integer({0x2001, 0}), -2);
  EXPECT_EQ(objects.Integer({0x2005, 0}), -3);
  EXPECT_EQ(objects.Integer({0x3000, 0}, 7), 7);
}

TEST(ObjectDictionary, TakesValuesOfTheRightLengthWithinTheLimits) {
  ObjectDictionary objects(Objects(), 1);
  const auto write = [&](std::uint16_t index, const Bytes& bytes) {
    return objects.Write({index, 0}, bytes);
  };
  EXPECT_EQ(write(0x2001, {0x64, 0x00}), std::nullopt);
  EXPECT_EQ(objects.Integer({0x2001, 0}), 100);
  EXPECT_EQ(write(0x2001, {0x9C, 0xFF}), std::nullopt);
  EXPECT_EQ(objects.Integer({0x2001, 0}), -100);
  EXPECT_EQ(write(0x2001, {0x9B, 0xFF}), SdoAbort::kValueTooLow);
  EXPECT_EQ(write(0x2001, {0x65, 0x00}), SdoAbort::kValueTooHigh);
  EXPECT_EQ(write(0x2001, {0x01}), SdoAbort::kLengthTooLow);
  EXPECT_EQ(write(0x2001, {0x01, 0x00, 0x00}), SdoAbort::kLengthTooHigh);
  EXPECT_EQ(write(0x2004, {2}), SdoAbort::kInvalidValue);
  EXPECT_EQ(objects.Integer({0x2001, 0}), -100);
  EXPECT_EQ(write(0x2003, Bytes(5, 'n')), std::nullopt);
  EXPECT_EQ(Value(objects, 0x2003), Bytes(5, 'n'));
  EXPECT_EQ(write(0x2003, Bytes(65537, 'n')), SdoAbort::kOutOfMemory);
}

TEST(ObjectDictionary, HoldsToTheAccessAndToWhatThereIs) {
  ObjectDictionary objects(Objects(), 1);
  Bytes bytes;
  EXPECT_EQ(objects.Write({0x1000, 0}, Bytes(4)), SdoAbort::kReadOnlyObject);
  EXPECT_EQ(objects.Write({0x1008, 0}, Bytes(4)), SdoAbort::kReadOnlyObject);
  EXPECT_EQ(objects.Read({0x2000, 0}, bytes), SdoAbort::kWriteOnlyObject);
  EXPECT_EQ(objects.Write({0x2000, 0}, Bytes(2)), std::nullopt);
  EXPECT_EQ(objects.Read({0x2001, 1}, bytes), SdoAbort::kNoSuchSubindex);
  EXPECT_EQ(objects.Write({0x2FFF, 0}, Bytes(2)), SdoAbort::kNoSuchObject);
  EXPECT_EQ(objects.Read({0xFFFF, 0}, bytes), SdoAbort::kNoSuchObject);
}

TEST(ObjectDictionary, AsksTheDeviceBeforeItKeepsAValue) {
  ObjectDictionary objects(Objects(), 1);
  std::int64_t asked = 0;
  objects.CheckWrites({0x2001, 0}, [&](std::int64_t value) -> std::optional<SdoAbort> {
    asked = value;
    if (value == 13) return SdoAbort::kCannotStoreDeviceState;
    return std::nullopt;
  });
  EXPECT_EQ(objects.Write({0x2001, 0}, Bytes{13, 0}), SdoAbort::kCannotStoreDeviceState);
  EXPECT_EQ(asked, 13);
  EXPECT_EQ(objects.Integer({0x2001, 0}), -2);
  EXPECT_EQ(objects.Write({0x2001, 0}, Bytes{14, 0}), std::nullopt);
  EXPECT_EQ(objects.Write({0x2001, 0}, Bytes{0xFF, 0x7F}), SdoAbort::kValueTooHigh);
  EXPECT_EQ(asked, 14) << "asked for a value that the limits refuse";
}

TEST(ObjectDictionary, CutsTheDevicesOwnWordToTheWidthOfTheType) {
  ObjectDictionary objects(Objects(), 1);
  objects.At({0x2001, 0}).Set(32768 + 5);
  EXPECT_EQ(objects.Integer({0x2001, 0}), -32768 + 5);
  objects.At({0x2000, 0}).Set(-1);
  EXPECT_EQ(objects.Integer({0x2000, 0}), 65535);
}

TEST(ObjectDictionary, RestoresARangeOfIndices) {
  ObjectDictionary objects(Objects(), 1);
  objects.At({0x1014, 0}).Set(5);
  objects.At({0x2001, 0}).Set(5);
  objects.Restore(0x1000, 0x1FFF);
  EXPECT_EQ(objects.Integer({0x1014, 0}), 0x81);
  EXPECT_EQ(objects.Integer({0x2001, 0}), 5);
}

TEST(ObjectDictionary, RefusesAnObjectOnCommand) {
  ObjectDictionary objects(Objects(), 1);
  objects.Refuse({0x2001, 0}, SdoAbort::kHardwareError);
  Bytes bytes;
  EXPECT_EQ(objects.Read({0x2001, 0}, bytes), SdoAbort::kHardwareError);
  EXPECT_EQ(objects.Write({0x2001, 0}, Bytes{0, 0}), SdoAbort::kHardwareError);
  objects.Refuse({0x2001, 0}, std::nullopt);
  EXPECT_EQ(objects.Read({0x2001, 0}, bytes), std::nullopt);
}

std::string MessageOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "none";
}

TEST(ObjectDictionary, NamesWhatIsWrong) {
  EXPECT_EQ(MessageOf([] { ObjectDictionary(Objects(), 0); }), "node_id = 0 (must be from 1 to 127)");
  EXPECT_EQ(MessageOf([] { ObjectDictionary(Objects(), 128); }), "node_id = 128 (must be from 1 to 127)");
  EXPECT_EQ(MessageOf([] {
              ObjectDictionary(Objects(), 1).At({0x6040, 2});
            }),
            "the device has no object 6040:02 (its EDS file must have it)");
}

}  // namespace
}  // namespace strainwave::protocols::canopen::device::object_dictionary_test
