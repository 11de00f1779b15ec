// SPDX-License-Identifier: Apache-2.0
#include "protocols/modbus/read_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <tuple>

#include "protocols/modbus/pdu.h"

namespace strainwave::protocols::modbus {
namespace {

int EndOf(const Register& value) { return value.address + Length(value.type); }

// Whether one request may run from `end` to `begin` of the next wanted register.
bool MayCross(const RegisterMap& map, Table table, int end, int begin) {
  int unknown = 0;  // addresses in a row that belong to nothing
  for (int address = end; address < begin;) {
    const auto owner = std::ranges::find_if(map.registers, [&](const Register& value) {
      return value.table == table && value.address <= address && address < EndOf(value);
    });
    if (owner == map.registers.end()) {
      if (++unknown > map.read_gap) return false;
      ++address;
    } else {
      if (!CanRead(*owner)) return false;
      unknown = 0;
      address = EndOf(*owner);
    }
  }
  return true;
}

}  // namespace

std::vector<ReadRequest> PlanReads(const RegisterMap& map, std::span<const std::size_t> wanted) {
  for (const std::size_t index : wanted) {
    if (index >= map.registers.size() || !CanRead(map.registers[index])) {
      throw std::invalid_argument(
          fmt::format("wanted = {} is not a readable register of the map (expected one)", index));
    }
  }
  std::vector<std::size_t> sorted(wanted.begin(), wanted.end());
  std::ranges::sort(sorted, {}, [&](std::size_t index) {
    return std::tuple(map.registers[index].table, map.registers[index].address, index);
  });
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  // Taking what still fits, from the lowest address on, needs the fewest requests: whatever another plan
  // begins later reaches no further.
  std::vector<ReadRequest> plan;
  for (const std::size_t index : sorted) {
    const Register& value = map.registers[index];
    const int most = IsBits(value.table) ? kMostBitsRead : std::min(map.most_registers, kMostRegistersRead);
    ReadRequest* last = plan.empty() ? nullptr : &plan.back();
    const bool joins = last != nullptr && last->table == value.table && EndOf(value) - last->first <= most &&
                       MayCross(map, value.table, last->first + last->count, value.address);
    if (!joins) last = &plan.emplace_back(ReadRequest{value.table, value.address, 0, {}});
    last->count = static_cast<std::uint16_t>(EndOf(value) - last->first);
    last->registers.push_back(index);
  }
  return plan;
}

}  // namespace strainwave::protocols::modbus
