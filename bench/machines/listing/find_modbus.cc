// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <system_error>

#include <fmt/format.h>

#include "bench/devices/modbus/modbus_link.h"
#include "bench/machines/listing/find_devices.h"
#include "protocols/modbus/pdu.h"

namespace strainwave::bench {
namespace {

// A gateway answers so for units that are not behind it.
constexpr std::uint8_t kNoPathToUnit = 0x0A;
constexpr std::uint8_t kUnitIsSilent = 0x0B;

}  // namespace

void FindOnModbus(ModbusSettings settings, int first, int last, const std::string& address, FoundPart& part) {
  settings.retries = 0;
  bool none = true;
  for (int unit = first; unit <= last; ++unit) {
    settings.unit = unit;
    ModbusLink link(settings, nullptr);
    try {
      link.Open();
    } catch (const std::system_error& error) {
      part.notes.emplace_back(error.what());
      return;
    }
    std::array<std::uint16_t, 1> word{};
    const ModbusReply reply = link.Read({protocols::modbus::Table::kHolding, 0, 1, {}}, word);
    const bool refuses = reply.outcome == ModbusReply::Outcome::kException;
    const bool is_there =
        reply.good() || (refuses && reply.exception != kNoPathToUnit && reply.exception != kUnitIsSilent);
    if (!is_there) continue;
    none = false;
    FoundDevice found;
    found.where = fmt::format("{}, unit {}", address, unit);
    found.what = reply.good() ? fmt::format("answers; holding register 0 is {}", word[0])
                              : fmt::format("answers; refuses holding register 0 (exception {})",
                                            protocols::modbus::ExceptionText(reply.exception));
    found.fields.emplace_back("address", address);
    found.fields.emplace_back("unit", std::int64_t{unit});
    part.devices.push_back(std::move(found));
  }
  if (!none) return;
  part.notes.push_back(
      fmt::format("{}: no unit from {} to {} answers within {} ms (check unit, and on a line baud rate, "
                  "parity and wiring)",
                  address, first, last, settings.answer_time.count()));
}

}  // namespace strainwave::bench
