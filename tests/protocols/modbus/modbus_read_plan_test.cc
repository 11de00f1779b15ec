// SPDX-License-Identifier: Apache-2.0
#include "protocols/modbus/read_plan.h"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

namespace strainwave::protocols::modbus::modbus_read_plan_test {
namespace {

Register At(int address, ValueType type = ValueType::kUint16, Table table = Table::kHolding,
            Access access = Access::kRead) {
  Register value;
  value.address = static_cast<std::uint16_t>(address);
  value.type = type;
  value.table = table;
  value.access = access;
  return value;
}

std::vector<std::size_t> All(const RegisterMap& map) {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < map.registers.size(); ++i) all.push_back(i);
  return all;
}

using Plan = std::vector<ReadRequest>;

TEST(PlanReads, MergesNeighboursWhateverTheirOrderInTheMap) {
  const RegisterMap map{{}, {At(12, ValueType::kFloat32), At(10), At(11)}};
  EXPECT_EQ(PlanReads(map, All(map)), (Plan{{Table::kHolding, 10, 4, {1, 2, 0}}}));
}

TEST(PlanReads, KeepsTablesApart) {
  const RegisterMap map{{},
                        {At(0), At(1, ValueType::kUint16, Table::kInput),
                         At(2, ValueType::kBit, Table::kCoil), At(3, ValueType::kBit, Table::kDiscrete)}};
  EXPECT_EQ(PlanReads(map, All(map)), (Plan{{Table::kHolding, 0, 1, {0}},
                                            {Table::kInput, 1, 1, {1}},
                                            {Table::kCoil, 2, 1, {2}},
                                            {Table::kDiscrete, 3, 1, {3}}}));
}

TEST(PlanReads, ReadsNoUnmappedAddressUnlessTheMapAllowsIt) {
  RegisterMap map{{}, {At(10), At(13)}};
  EXPECT_EQ(PlanReads(map, All(map)).size(), 2U);
  map.read_gap = 1;
  EXPECT_EQ(PlanReads(map, All(map)).size(), 2U);
  map.read_gap = 2;
  EXPECT_EQ(PlanReads(map, All(map)), (Plan{{Table::kHolding, 10, 4, {0, 1}}}));
}

TEST(PlanReads, RunsOverRegistersThatAreReadableButNotWanted) {
  const RegisterMap map{{}, {At(10), At(11, ValueType::kInt32), At(13)}};
  const std::size_t wanted[] = {0, 2};
  EXPECT_EQ(PlanReads(map, wanted), (Plan{{Table::kHolding, 10, 4, {0, 2}}}));
}

TEST(PlanReads, NeverRunsOverARegisterThatCanOnlyBeWritten) {
  RegisterMap map{{}, {At(10), At(11, ValueType::kUint16, Table::kHolding, Access::kWrite), At(12)}};
  map.read_gap = 100;
  const std::size_t wanted[] = {0, 2};
  EXPECT_EQ(PlanReads(map, wanted).size(), 2U);
}

TEST(PlanReads, AsksForNoMoreThanTheDeviceGives) {
  RegisterMap map;
  for (int i = 0; i < 100; ++i) map.registers.push_back(At(2 * i, ValueType::kFloat32));
  const Plan plan = PlanReads(map, All(map));
  ASSERT_EQ(plan.size(), 2U);
  EXPECT_EQ(plan[0].count, 124);  // a value is not cut in two
  EXPECT_EQ(plan[1].first, 124);
  EXPECT_EQ(plan[1].count, 76);
  map.most_registers = 10;
  EXPECT_EQ(PlanReads(map, All(map)).size(), 20U);
  map.most_registers = 1000;  // the standard's limit holds all the same
  EXPECT_EQ(PlanReads(map, All(map)).size(), 2U);
}

TEST(PlanReads, TakesUpTo2000Bits) {
  RegisterMap map;
  for (int i = 0; i < 2001; ++i) map.registers.push_back(At(i, ValueType::kBit, Table::kCoil));
  const Plan plan = PlanReads(map, All(map));
  ASSERT_EQ(plan.size(), 2U);
  EXPECT_EQ(plan[0].count, 2000);
  EXPECT_EQ(plan[1].count, 1);
}

TEST(PlanReads, RefusesWhatCannotBeRead) {
  const RegisterMap map{{}, {At(0, ValueType::kUint16, Table::kHolding, Access::kWrite)}};
  for (const std::size_t index : {std::size_t{0}, std::size_t{1}}) {
    try {
      PlanReads(map, std::span(&index, 1));
      FAIL();
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()), "wanted = " + std::to_string(index) +
                                               " is not a readable register of the map (expected one)");
    }
  }
}

// The fewest requests by another way: for each k, the fewest that bring the first k, over all last requests.
std::size_t FewestOf(const RegisterMap& map) {
  std::vector<std::size_t> fewest(map.registers.size() + 1, 1000);
  fewest[0] = 0;
  for (std::size_t end = 1; end <= map.registers.size(); ++end) {
    for (std::size_t begin = 0; begin < end; ++begin) {
      bool whole = true;
      for (std::size_t i = begin + 1; i < end; ++i) {
        const Register& before = map.registers[i - 1];
        whole = whole && map.registers[i].address - (before.address + Length(before.type)) <= map.read_gap;
      }
      const Register& last = map.registers[end - 1];
      const int span = last.address + Length(last.type) - map.registers[begin].address;
      if (whole && span <= map.most_registers) fewest[end] = std::min(fewest[end], fewest[begin] + 1);
    }
  }
  return fewest.back();
}

TEST(PlanReads, NeedsTheFewestRequestsOfAllPlans) {
  std::mt19937 random(4);
  for (int round = 0; round < 500; ++round) {
    RegisterMap map;
    map.read_gap = static_cast<int>(random() % 4);
    map.most_registers = 2 + static_cast<int>(random() % 12);
    int address = 0;
    for (int i = 0; i < 20; ++i) {
      address += static_cast<int>(random() % 5);
      map.registers.push_back(At(address, random() % 2 == 0 ? ValueType::kInt16 : ValueType::kInt32));
      address += Length(map.registers.back().type);
    }
    const Plan plan = PlanReads(map, All(map));
    EXPECT_EQ(plan.size(), FewestOf(map));
    std::size_t brought = 0;
    for (const ReadRequest& request : plan) {
      EXPECT_LE(request.count, map.most_registers);
      for (const std::size_t index : request.registers) {
        const Register& value = map.registers[index];
        EXPECT_GE(value.address, request.first);
        EXPECT_LE(value.address + Length(value.type), request.first + request.count);
        EXPECT_EQ(index, brought++);
      }
    }
    EXPECT_EQ(brought, map.registers.size());
  }
}

}  // namespace
}  // namespace strainwave::protocols::modbus::modbus_read_plan_test
