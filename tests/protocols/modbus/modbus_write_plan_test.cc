// SPDX-License-Identifier: Apache-2.0
#include "protocols/modbus/write_plan.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace strainwave::protocols::modbus::modbus_write_plan_test {
namespace {

using Plan = std::vector<WriteRequest>;
using Values = std::vector<std::pair<std::size_t, double>>;

Register At(int address, ValueType type = ValueType::kInt16, Table table = Table::kHolding) {
  Register value;
  value.name = "speed";
  value.unit = "rad/s";
  value.address = static_cast<std::uint16_t>(address);
  value.type = type;
  value.table = table;
  value.access = Access::kReadWrite;
  return value;
}

TEST(PlanWrites, PutsNeighboursIntoOneRequest) {
  const RegisterMap map{{}, {At(4, ValueType::kInt32), At(3), At(7), At(0, ValueType::kBit, Table::kCoil)}};
  EXPECT_EQ(
      PlanWrites(map, Values{{0, -2}, {3, 1}, {2, 5}, {1, 9}}),
      (Plan{{Table::kHolding, 3, {9, 0xFFFF, 0xFFFE}}, {Table::kHolding, 7, {5}}, {Table::kCoil, 0, {1}}}));
}

TEST(PlanWrites, SendsNoMoreThanAFrameHolds) {
  RegisterMap map;
  Values values;
  for (int i = 0; i < 124; ++i) {
    map.registers.push_back(At(i));
    values.emplace_back(i, i);
  }
  const Plan plan = PlanWrites(map, values);
  ASSERT_EQ(plan.size(), 2U);
  EXPECT_EQ(plan[0].words.size(), 123U);
  EXPECT_EQ(plan[1], (WriteRequest{Table::kHolding, 123, {123}}));
}

TEST(PlanWrites, RefusesWhatIsNotToBeWrittenAndWhatDoesNotFit) {
  RegisterMap map{{}, {At(0), At(1)}};
  map.registers[1].access = Access::kRead;
  const auto message = [&](const Values& values) -> std::string {
    try {
      PlanWrites(map, values);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_EQ(message({{1, 0}}), "index = 1 is not a register to be written (expected one of the map)");
  EXPECT_EQ(message({{2, 0}}), "index = 2 is not a register to be written (expected one of the map)");
  EXPECT_EQ(message({{0, 40000}}),
            "speed = 40000 rad/s is out of range (expected a value that the register holds)");
}

}  // namespace
}  // namespace strainwave::protocols::modbus::modbus_write_plan_test
