// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

#include "bench/devices/modbus/libmodbus.h"
#include "bench/devices/modbus/modbus_transport.h"

namespace strainwave::bench {

/// Modbus RTU, whose frames have no number. After a time-out or a wrong answer nothing is believed until the
/// device has answered an echo (function 8, sub-function 0) with a number of its own, or has refused it:
/// since a device answers in order, whatever was asked before is then out of the way. Devices that ignore
/// what they do not know (against the standard) must be silent for two answer times instead. Between frames
/// the line is silent for 3.5 characters (Modbus over Serial Line V1.02, 2.5.1.1).
///
/// An answer that is waited for is not interrupted: the device would talk into the next request.
class ModbusRtu final : public ModbusTransport {
 public:
  ModbusRtu(const ModbusSettings& settings, ModbusCounts& counts);

  void Open() override;
  void Close() noexcept override { context_.reset(); }
  bool is_open() const noexcept override { return context_ != nullptr; }
  ModbusReply Ask(const protocols::modbus::Pdu& pdu, std::span<std::uint16_t> words,
                  const Wake* wake) override;

 private:
  bool Send(std::span<const std::uint8_t> pdu);
  ModbusReply Receive(const protocols::modbus::Pdu& pdu, std::span<std::uint16_t> words);
  bool ComeBackInStep();
  bool AwaitEcho();
  bool WaitForSilence(std::chrono::nanoseconds silence, std::chrono::nanoseconds longest);

  const ModbusSettings& settings_;
  const ModbusSerialLine& port_;
  ModbusCounts& counts_;
  std::chrono::nanoseconds silence_;  // between two frames
  bool in_step_{};                    // no older answer can still come
  std::uint16_t echo_{};              // the number that was last sent
  ModbusContext context_;
  int line_{-1};
};

}  // namespace strainwave::bench
