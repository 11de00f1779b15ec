// SPDX-License-Identifier: Apache-2.0
#include "protocols/modbus/write_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <tuple>

#include "protocols/modbus/pdu.h"
#include "protocols/modbus/register_codec.h"

namespace strainwave::protocols::modbus {
std::vector<WriteRequest> PlanWrites(const RegisterMap& map,
                                     std::span<const std::pair<std::size_t, double>> values) {
  std::vector<std::pair<std::size_t, double>> sorted(values.begin(), values.end());
  for (const auto& [index, number] : sorted) {
    if (index >= map.registers.size() || !CanWrite(map.registers[index])) {
      throw std::invalid_argument(
          fmt::format("index = {} is not a register to be written (expected one of the map)", index));
    }
  }
  std::ranges::sort(sorted, {}, [&](const auto& value) {
    return std::tuple(map.registers[value.first].table, map.registers[value.first].address);
  });
  std::vector<WriteRequest> plan;
  for (const auto& [index, number] : sorted) {
    const Register& value = map.registers[index];
    const Encoded encoded = Encode(value, number);
    if (encoded.problem != CodecProblem::kNone) {
      throw std::invalid_argument(fmt::format("{} = {} {} is {} (expected a value that the register holds)",
                                              value.name, number, value.unit, Name(encoded.problem)));
    }
    const auto most =
        static_cast<std::size_t>(IsBits(value.table) ? kMostBitsWritten : kMostRegistersWritten);
    const bool joins = !plan.empty() && plan.back().table == value.table &&
                       plan.back().first + plan.back().words.size() == value.address &&
                       plan.back().words.size() + encoded.length <= most;
    if (!joins) plan.push_back({value.table, value.address, {}});
    plan.back().words.insert(plan.back().words.end(), encoded.span().begin(), encoded.span().end());
  }
  return plan;
}

}  // namespace strainwave::protocols::modbus
