// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/modbus_registers.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <span>

namespace strainwave::bench {
namespace {

void Put(std::span<std::uint16_t> to, std::uint32_t value) {
  to[0] = static_cast<std::uint16_t>(value >> 16);
  to[1] = static_cast<std::uint16_t>(value);
}

void Put(std::span<std::uint16_t> to, double value) {
  Put(to, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

std::uint16_t InRegister(auto value) { return static_cast<std::uint16_t>(value); }

}  // namespace

std::vector<std::uint16_t> ModbusRegisters(const MonitorState& state, const MonitorFrame& frame,
                                           std::int64_t now_ms) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const ValueStatus status = StatusOf(state, frame, now_ms);
  const bool good = status == ValueStatus::kGood;
  std::vector<std::uint16_t> registers(kFirstOutputRegister + kRegistersPerOutput * frame.outputs.size());
  const std::span<std::uint16_t> all(registers);
  all[0] = 1;
  all[1] = InRegister(status);
  Put(all.subspan(8), good || status == ValueStatus::kOutsideTraining ? state.last->distance : kNone);
  all[11] = InRegister(frame.outputs.size());
  all[13] = InRegister(now_ms / 1000 & 0xFFFF);
  if (state.last) {
    all[2] = InRegister(state.last->alarm);
    all[3] = state.last->fault ? InRegister(state.last->fault->kind) : InRegister(0);
    Put(all.subspan(4), static_cast<std::uint32_t>(state.last->number));
    Put(all.subspan(6), static_cast<std::uint32_t>(state.last->end_ms / 1000));
    all[10] = InRegister(std::clamp<std::int64_t>((now_ms - state.last->end_ms) / 1000, 0, 65535));
  }
  if (frame.classes && good) all[12] = InRegister(1 + LikeliestOf(state.last->outputs));
  for (std::size_t k = 0; k < frame.outputs.size(); ++k) {
    const auto at = all.subspan(kFirstOutputRegister + kRegistersPerOutput * k, kRegistersPerOutput);
    const MonitoredOutput output = good ? state.last->outputs[k] : MonitoredOutput{kNone, kNone, kNone};
    Put(at.subspan(0), output.value);
    Put(at.subspan(2), output.low);
    Put(at.subspan(4), output.high);
    at[6] = state.last ? InRegister(state.last->alarms[k]) : InRegister(0);
    at[7] = InRegister(status);
  }
  return registers;
}

}  // namespace strainwave::bench
