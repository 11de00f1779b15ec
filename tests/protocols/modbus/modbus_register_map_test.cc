// SPDX-License-Identifier: Apache-2.0
#include "protocols/modbus/register_map.h"

#include <gtest/gtest.h>

#include <limits>

namespace strainwave::protocols::modbus::modbus_register_map_test {
namespace {

using namespace std::chrono_literals;

Register Named(const char* name, int address, ValueType type = ValueType::kUint16,
               Table table = Table::kHolding) {
  Register value;
  value.name = name;
  value.address = static_cast<std::uint16_t>(address);
  value.type = type;
  value.table = table;
  return value;
}

std::string ProblemsOf(const std::vector<Register>& registers) {
  std::string text;
  for (const MapProblem& problem : CheckMap({{}, registers})) {
    text += std::to_string(problem.index) + ": " + problem.what + "\n";
  }
  return text;
}

TEST(CheckMap, FindsNothingInASoundMap) {
  EXPECT_EQ(ProblemsOf({Named("a", 0, ValueType::kFloat32), Named("b", 2), Named("c", 65535),
                        Named("before", 65534), Named("d", 0, ValueType::kUint16, Table::kInput),
                        Named("e", 0, ValueType::kBit, Table::kCoil)}),
            "");
}

TEST(CheckMap, FindsAddressesAndNamesThatAreThereTwice) {
  EXPECT_EQ(ProblemsOf({Named("a", 0, ValueType::kFloat32), Named("b", 1), Named("a", 7)}),
            "1: 'b' at 1 lies over 'a' at 0 of the holding table (expected each address once)\n"
            "2: 'a' is there twice (expected names that differ)\n");
}

TEST(CheckMap, FindsTypesThatATableCannotHold) {
  EXPECT_EQ(ProblemsOf({Named("a", 0, ValueType::kInt16, Table::kCoil), Named("b", 0, ValueType::kBit),
                        Named("c", 65535, ValueType::kInt32, Table::kInput)}),
            "0: 'a' is a number in the coil table (expected type bit)\n"
            "1: 'b' is a bit in the holding table (expected a number, or the coil or discrete table)\n"
            "2: 'c' at 65535 ends beyond the last address (expected an end up to 65535)\n");
}

TEST(CheckMap, FindsWritesToWhatIsReadOnlyAndReadsOfWhatIsNot) {
  Register input = Named("a", 0, ValueType::kUint16, Table::kInput);
  input.access = Access::kReadWrite;
  Register write_only = Named("b", 0);
  write_only.access = Access::kWrite;
  write_only.poll_period = 1s;
  EXPECT_EQ(ProblemsOf({input, write_only}),
            "0: 'a' is to be written in the input table, which is read-only (expected access read)\n"
            "1: 'b' is polled but cannot be read (expected access read_write, or no poll)\n");
}

TEST(CheckMap, FindsScalesRangesAndTimesThatLetNoValueThrough) {
  Register scale = Named("a", 0);
  scale.scale = 0.0;
  Register range = Named("b", 1);
  range.least = 5;
  range.most = 4;
  Register stale = Named("c", 2);
  stale.poll_period = 2s;
  stale.good_for = 1s;
  Register negative = Named("d", 3);
  negative.poll_period = -1s;
  EXPECT_EQ(ProblemsOf({scale, range, stale, negative}),
            "0: 'a' has scale = 0 and offset = 0 (expected finite numbers, the scale not zero)\n"
            "1: 'b' has least = 5 above most = 4 (expected a range)\n"
            "2: 'c' is stale before it is read again (expected good_for of at least the poll period)\n"
            "3: 'd' has a negative time (expected zero or above)\n");
}

TEST(GoodFor, IsThreePollPeriodsUnlessTheMapSaysOtherwise) {
  Register value = Named("a", 0);
  EXPECT_EQ(GoodFor(value), 0s);
  value.poll_period = 100ms;
  EXPECT_EQ(GoodFor(value), 300ms);
  value.good_for = 150ms;
  EXPECT_EQ(GoodFor(value), 150ms);
}

}  // namespace
}  // namespace strainwave::protocols::modbus::modbus_register_map_test
