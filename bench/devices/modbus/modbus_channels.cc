// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/modbus/modbus_channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "protocols/modbus/register_codec.h"

namespace strainwave::bench {
namespace {

namespace mb = protocols::modbus;

std::size_t Needed(const mb::RegisterMap& map, const char* name, const char* unit, bool write) {
  const auto found = Find(map, name);
  const bool fits = found && map.registers[*found].unit == unit &&
                    map.registers[*found].poll_period.count() > 0 &&
                    (!write || CanWrite(map.registers[*found]));
  if (!fits) {
    throw std::invalid_argument(
        fmt::format("map of {} has no register '{}' (expected one in '{}' that is polled{})", map.device,
                    name, unit, write ? " and can be written" : ""));
  }
  return *found;
}

}  // namespace

ModbusTorqueAmplifier::ModbusTorqueAmplifier(ModbusSettings settings, const mb::RegisterMap& map,
                                             const BenchClock& clock)
    : torque_(Needed(map, "torque", "Nm", false)),
      status_(Needed(map, "status", "", false)),
      client_(std::move(settings), map, clock) {}

ChannelValue ModbusTorqueAmplifier::Torque() const noexcept {
  ChannelValue torque = client_.Value(torque_);
  const ChannelValue status = client_.Value(status_);
  torque.good = torque.good && status.good;
  torque.time = std::min(torque.time, status.time);
  return torque;
}

std::chrono::nanoseconds ModbusTorqueAmplifier::poll_period() const {
  const auto& registers = client_.map().registers;
  return std::max(registers[torque_].poll_period, registers[status_].poll_period);
}

std::string ModbusTorqueAmplifier::trouble() const {
  std::string trouble = client_.trouble();
  const ChannelValue status = client_.Value(status_);
  if (!trouble.empty() || status.good || !std::isfinite(status.value)) return trouble;
  const mb::Register& limits = client_.map().registers[status_];
  return fmt::format("its status is {:g} (expected {:g} to {:g}): the torque is not believed", status.value,
                     limits.least.value_or(-std::numeric_limits<double>::infinity()),
                     limits.most.value_or(std::numeric_limits<double>::infinity()));
}

ModbusTemperatureController::ModbusTemperatureController(ModbusSettings settings, const mb::RegisterMap& map,
                                                         const BenchClock& clock,
                                                         std::chrono::nanoseconds write_period)
    : map_(map),
      temperature_(Needed(map, "temperature", "degC", false)),
      set_point_(Needed(map, "set_point", "degC", true)),
      heating_(Needed(map, "heating", "", true)),
      write_period_(write_period),
      wanted_degC_(std::numeric_limits<double>::quiet_NaN()),
      client_(std::move(settings), map, clock, this) {}

void ModbusTemperatureController::Heat(double set_point_degC) {
  if (Encode(map_.registers[set_point_], set_point_degC).problem != mb::CodecProblem::kNone) {
    throw std::invalid_argument(
        fmt::format("set_point_degC = {} is not one that {} takes", set_point_degC, map_.device));
  }
  wanted_degC_ = set_point_degC;
  client_.Call();
}

void ModbusTemperatureController::Stop() noexcept {
  wanted_degC_ = std::numeric_limits<double>::quiet_NaN();
  client_.Call();
}

ModbusReply ModbusTemperatureController::Write(ModbusLink& link) {
  const double wanted_degC = wanted_degC_;
  std::vector<std::pair<std::size_t, double>> values{{heating_, std::isnan(wanted_degC) ? 0.0 : 1.0}};
  if (!std::isnan(wanted_degC)) values.emplace_back(set_point_, wanted_degC);
  return link.Write(PlanWrites(map_, values));
}

void ModbusTemperatureController::Leave(ModbusLink& link) {
  Stop();
  Write(link);
}

}  // namespace strainwave::bench
