// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/emergency.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "protocols/canopen/wire_bytes.h"

namespace strainwave::protocols::canopen {
namespace {

struct ErrorCode {
  std::uint16_t code;
  std::string_view words;
};

// Sorted. A code that ends in zeros also speaks for the ones below it that are not listed.
constexpr ErrorCode kErrorCodes[] = {
    {0x0000, "no error, or errors taken back"},
    {0x1000, "error of no particular kind"},
    {0x2000, "current"},
    {0x2100, "current on the supply side"},
    {0x2110, "short circuit or earth leakage on the supply side"},
    {0x2120, "earth leakage on the supply side"},
    {0x2130, "short circuit on the supply side"},
    {0x2200, "current inside the drive"},
    {0x2220, "continuous over-current inside the drive"},
    {0x2230, "short circuit or earth leakage inside the drive"},
    {0x2240, "earth leakage inside the drive"},
    {0x2250, "short circuit inside the drive"},
    {0x2300, "current on the motor side"},
    {0x2310, "continuous over-current on the motor side"},
    {0x2320, "short circuit or earth leakage on the motor side"},
    {0x2330, "earth leakage on the motor side"},
    {0x2340, "short circuit on the motor side"},
    {0x3000, "voltage"},
    {0x3100, "mains voltage"},
    {0x3110, "mains over-voltage"},
    {0x3120, "mains under-voltage"},
    {0x3130, "mains phase missing"},
    {0x3140, "mains frequency"},
    {0x3200, "DC link voltage"},
    {0x3210, "DC link over-voltage"},
    {0x3220, "DC link under-voltage"},
    {0x3230, "load error"},
    {0x3300, "output voltage"},
    {0x3310, "output over-voltage"},
    {0x3320, "armature circuit"},
    {0x3330, "field circuit"},
    {0x4000, "temperature"},
    {0x4100, "ambient temperature"},
    {0x4110, "ambient temperature too high"},
    {0x4120, "ambient temperature too low"},
    {0x4200, "temperature of the drive"},
    {0x4210, "drive too hot"},
    {0x4220, "drive too cold"},
    {0x4300, "temperature of the motor"},
    {0x4310, "motor too hot"},
    {0x4320, "motor too cold"},
    {0x4400, "temperature of the supply"},
    {0x4410, "supply too hot"},
    {0x4420, "supply too cold"},
    {0x5000, "hardware of the drive"},
    {0x5100, "supply of the drive's electronics"},
    {0x5110, "low voltage in the supply of the drive's electronics"},
    {0x5120, "intermediate circuit of the supply"},
    {0x5200, "control hardware"},
    {0x5210, "measuring circuit"},
    {0x5220, "computing circuit"},
    {0x5300, "operating unit"},
    {0x5400, "power section"},
    {0x5410, "output stages"},
    {0x5420, "brake chopper"},
    {0x5430, "input stages"},
    {0x5440, "contactors"},
    {0x5450, "fuses"},
    {0x5500, "memory hardware"},
    {0x5510, "working memory (RAM)"},
    {0x5520, "program memory (ROM)"},
    {0x5530, "parameter memory (EEPROM)"},
    {0x6000, "software of the drive"},
    {0x6010, "software reset by the drive's watchdog"},
    {0x6100, "internal software"},
    {0x6200, "user software"},
    {0x6300, "parameter set"},
    {0x6310, "parameters lost"},
    {0x6320, "parameter error"},
    {0x7000, "additional modules"},
    {0x7100, "power module"},
    {0x7110, "brake chopper"},
    {0x7111, "failure of the brake chopper"},
    {0x7112, "over-current in the brake chopper"},
    {0x7113, "protective circuit of the brake chopper"},
    {0x7120, "motor"},
    {0x7121, "motor blocked"},
    {0x7122, "motor error or wrong commutation"},
    {0x7123, "motor tilted"},
    {0x7200, "measuring module"},
    {0x7300, "sensor"},
    {0x7301, "tacho fault"},
    {0x7302, "tacho with wrong polarity"},
    {0x7303, "resolver 1 fault"},
    {0x7304, "resolver 2 fault"},
    {0x7305, "incremental encoder 1 fault"},
    {0x7306, "incremental encoder 2 fault"},
    {0x7307, "incremental encoder 3 fault"},
    {0x7310, "speed sensor"},
    {0x7320, "position sensor"},
    {0x7400, "computing module"},
    {0x7500, "communication module"},
    {0x7510, "serial interface 1"},
    {0x7520, "serial interface 2"},
    {0x7600, "data storage module"},
    {0x8000, "monitoring"},
    {0x8100, "communication"},
    {0x8110, "CAN overrun: messages were lost in the node"},
    {0x8120, "CAN error passive: many errors on the bus"},
    {0x8130, "heartbeat or life guarding: the node misses the one it watches"},
    {0x8140, "recovered from bus-off"},
    {0x8150, "two nodes use the same CAN identifier"},
    {0x8200, "protocol error"},
    {0x8210, "PDO not processed: too short"},
    {0x8220, "PDO longer than its mapping"},
    {0x8230, "multiplexed PDO for an object that is not there"},
    {0x8240, "SYNC of unexpected length"},
    {0x8250, "PDO not received in time"},
    {0x8300, "torque control"},
    {0x8311, "torque too high"},
    {0x8312, "difficult start-up"},
    {0x8313, "torque at standstill"},
    {0x8321, "torque too low"},
    {0x8331, "torque fault"},
    {0x8400, "speed controller"},
    {0x8500, "position controller"},
    {0x8600, "positioning"},
    {0x8611, "following error too large"},
    {0x8612, "reference limit"},
    {0x8700, "synchronisation"},
    {0x8800, "winding"},
    {0x8900, "monitoring of process data"},
    {0x8A00, "monitoring of control"},
    {0x9000, "external error"},
    {0xF000, "additional functions"},
    {0xF001, "deceleration"},
    {0xF002, "sub-synchronous run"},
    {0xF003, "stroke operation"},
    {0xF004, "control"},
    {0xFF00, "maker's own error"},
};

static_assert(std::is_sorted(std::begin(kErrorCodes), std::end(kErrorCodes),
                             [](const ErrorCode& a, const ErrorCode& b) { return a.code < b.code; }));

}  // namespace

std::optional<Emergency> EmergencyOf(const CanFrame& frame) noexcept {
  constexpr std::uint32_t kBase = 0x80;
  if (frame.id <= kBase || frame.id > kBase + 127) return std::nullopt;  // 80h itself is SYNC
  if (!IsDataFrame(frame, frame.id) || frame.length != 8) return std::nullopt;
  Emergency emergency{.node_id = static_cast<std::uint8_t>(frame.id - kBase),
                      .code = static_cast<std::uint16_t>(FromLittleEndian(std::span(frame.data).first(2))),
                      .error_register = frame.data[2]};
  std::copy_n(frame.data.begin() + 3, emergency.vendor_bytes.size(), emergency.vendor_bytes.begin());
  return emergency;
}

std::string_view ErrorCodeWords(std::uint16_t code) noexcept {
  for (const unsigned mask : {0xFFFFU, 0xFFF0U, 0xFF00U, 0xF000U}) {
    const auto group = static_cast<std::uint16_t>(code & mask);
    const auto* const found =
        std::lower_bound(std::begin(kErrorCodes), std::end(kErrorCodes), group,
                         [](const ErrorCode& row, std::uint16_t wanted) { return row.code < wanted; });
    if (found != std::end(kErrorCodes) && found->code == group) return found->words;
  }
  return "a code that neither CiA 301 nor CiA 402 knows";
}

std::string Words(const Emergency& emergency) {
  return fmt::format("node {} reports {:04X}h: {} (error register {:02X}h, maker's bytes {:02X})",
                     emergency.node_id, emergency.code, ErrorCodeWords(emergency.code),
                     emergency.error_register, fmt::join(emergency.vendor_bytes, " "));
}

}  // namespace strainwave::protocols::canopen
