// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <string>

#include "bench/devices/modbus/modbus_client.h"
#include "bench/roles/channel_value.h"

namespace strainwave::bench {

/// A torque transducer's amplifier on Modbus, with registers `torque` in N·m and `status`, whose limits let
/// through only what says that the torque can be believed.
class ModbusTorqueAmplifier {
 public:
  /// @throws std::invalid_argument for a map without these registers.
  ModbusTorqueAmplifier(ModbusSettings settings, const protocols::modbus::RegisterMap& map,
                        const BenchClock& clock);

  /// N·m. Good only while the status is, too. Never waits.
  ChannelValue Torque() const noexcept;
  /// How often torque and status are asked for, the slower of them.
  std::chrono::nanoseconds poll_period() const;
  bool connected() const noexcept { return client_.connected(); }
  /// What is wrong now, a status that is not good included; empty while all is well.
  std::string trouble() const;

 private:
  std::size_t torque_, status_;
  ModbusClient client_;
};

/// A controller of a chamber's temperature on Modbus, with registers `temperature` and `set_point` in °C and
/// `heating`, written every `write_period`. It does not heat before it is told to, nor after this object is
/// gone; while the connection is gone it keeps its last set point.
class ModbusTemperatureController : private ModbusDuties {
 public:
  /// @throws std::invalid_argument for a map without these registers.
  ModbusTemperatureController(ModbusSettings settings, const protocols::modbus::RegisterMap& map,
                              const BenchClock& clock,
                              std::chrono::nanoseconds write_period = std::chrono::seconds(1));
  ~ModbusTemperatureController() override = default;

  /// °C. Never waits.
  ChannelValue Temperature() const noexcept { return client_.Value(temperature_); }
  /// °C, as the controller says it.
  ChannelValue SetPoint() const noexcept { return client_.Value(set_point_); }

  /// @throws std::invalid_argument for a temperature that the register does not hold.
  void Heat(double set_point_degC);
  void Stop() noexcept;
  bool connected() const noexcept { return client_.connected(); }
  std::string trouble() const { return client_.trouble(); }

 private:
  std::chrono::nanoseconds WritePeriod() const override { return write_period_; }
  ModbusReply Connected(ModbusLink& link, ModbusPoller&) override { return Write(link); }
  ModbusReply Write(ModbusLink& link) override;
  void Lost() noexcept override {}
  void Leave(ModbusLink& link) override;

  const protocols::modbus::RegisterMap map_;
  std::size_t temperature_, set_point_, heating_;
  std::chrono::nanoseconds write_period_;
  std::atomic<double> wanted_degC_;  // NaN: not heating
  ModbusClient client_;              // last: its thread uses all of the above
};

}  // namespace strainwave::bench
