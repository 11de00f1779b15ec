// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace strainwave::protocols::modbus {

/// Addresses of one table.
inline constexpr int kAddresses = 65536;

/// The four tables of a Modbus device (Modbus Application Protocol V1.1b3, 4.3).
enum class Table : std::uint8_t { kHolding, kInput, kCoil, kDiscrete };

/// What one value is made of. Coils and discrete inputs are bits; a bit is nothing else.
enum class ValueType : std::uint8_t { kInt16, kUint16, kInt32, kUint32, kFloat32, kBit };

/// Which of the two registers of a 32-bit value comes first. The standard does not say; makers differ.
enum class WordOrder : std::uint8_t { kHighFirst, kLowFirst };

/// The bytes within a register: high first as the standard has it, or the wrong way round.
enum class ByteOrder : std::uint8_t { kHighFirst, kLowFirst };

enum class Access : std::uint8_t { kRead, kWrite, kReadWrite };

/// One value of a device: value = number on the wire × scale + offset.
struct Register {
  std::string name;
  std::uint16_t address{};  // as it is sent, from 0; a maker's 40001 is 0 here
  Table table{Table::kHolding};
  ValueType type{ValueType::kUint16};
  WordOrder word_order{WordOrder::kHighFirst};
  ByteOrder byte_order{ByteOrder::kHighFirst};
  double scale{1.0};
  double offset{};
  std::string unit;  // of the value, SI or °C where it is known ("rad/s"); empty: a bare number
  Access access{Access::kRead};
  std::optional<double> least, most;       // a value outside is none, read or written
  std::chrono::nanoseconds poll_period{};  // 0: read only when asked for
  std::chrono::nanoseconds good_for{};     // an older value is stale; 0: three poll periods
};

/// The registers of one kind of device.
struct RegisterMap {
  std::string device;  // maker and type, for people
  std::vector<Register> registers;
  int most_registers{125};  // that the device gives in one answer
  int read_gap{};           // addresses without a register that one request may run over
};

/// How many registers a value takes: 1 or 2. A bit takes one address.
int Length(ValueType type);
/// Whether a table holds bits.
bool IsBits(Table table);
bool CanRead(const Register& value);
bool CanWrite(const Register& value);
/// How long a value of this register may be looked at; zero for one that is not polled.
std::chrono::nanoseconds GoodFor(const Register& value);
/// Position of the register of that name.
std::optional<std::size_t> Find(const RegisterMap& map, std::string_view name);

/// Something wrong with the register at `index`, as "WHAT (expected …)".
struct MapProblem {
  std::size_t index{};
  std::string what;

  bool operator==(const MapProblem&) const = default;
};

/// All that a map contradicts itself in: addresses used twice, names used twice, a type that its table cannot
/// hold, a value beyond the last address, writing to a table that is read-only, polling what cannot be read,
/// scales and ranges that let no value through. Empty when it is sound.
std::vector<MapProblem> CheckMap(const RegisterMap& map);

}  // namespace strainwave::protocols::modbus
