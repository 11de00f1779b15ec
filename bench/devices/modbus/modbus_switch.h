// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <string_view>

#include "bench/devices/modbus/modbus_client.h"

namespace strainwave::bench {

/// Duties of a client whose device switches something with one register: off from the first connection on,
/// off again when the client leaves, and written again each second.
class ModbusSwitch final : public ModbusDuties {
 public:
  /// @throws std::invalid_argument for a map without such a register, or one that cannot be written.
  ModbusSwitch(const protocols::modbus::RegisterMap& map, std::string_view name);

  /// From any thread. @return whether that is new, so that the client should be called.
  bool Set(bool on) noexcept { return on_.exchange(on) != on; }

  std::chrono::nanoseconds WritePeriod() const override { return std::chrono::seconds(1); }
  ModbusReply Connected(ModbusLink& link, ModbusPoller&) override { return Write(link); }
  ModbusReply Write(ModbusLink& link) override;
  void Lost() noexcept override {}
  void Leave(ModbusLink& link) override;

 private:
  const protocols::modbus::RegisterMap map_;
  std::size_t register_;
  std::atomic<bool> on_{false};
};

}  // namespace strainwave::bench
