// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/modbus/modbus_switch.h"

#include <array>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "protocols/modbus/write_plan.h"

namespace strainwave::bench {

namespace mb = protocols::modbus;

ModbusSwitch::ModbusSwitch(const mb::RegisterMap& map, std::string_view name) : map_(map) {
  const auto found = Find(map_, name);
  if (!found || !CanWrite(map_.registers[*found])) {
    throw std::invalid_argument(fmt::format(
        "map of {} has no register '{}' to switch (must have one that can be written)", map.device, name));
  }
  register_ = *found;
}

ModbusReply ModbusSwitch::Write(ModbusLink& link) {
  const std::array values{std::pair{register_, on_ ? 1.0 : 0.0}};
  return link.Write(PlanWrites(map_, values));
}

void ModbusSwitch::Leave(ModbusLink& link) {
  on_ = false;
  Write(link);
}

}  // namespace strainwave::bench
