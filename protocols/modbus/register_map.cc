// SPDX-License-Identifier: Apache-2.0
#include "protocols/modbus/register_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace strainwave::protocols::modbus {
namespace {

std::string_view Word(Table table) {
  switch (table) {
    case Table::kHolding:
      return "holding";
    case Table::kInput:
      return "input";
    case Table::kCoil:
      return "coil";
    case Table::kDiscrete:
      return "discrete";
  }
  return "";
}

// What is wrong with one register for itself.
void CheckOne(const Register& value, std::size_t index, std::vector<MapProblem>& problems) {
  const auto add = [&](std::string what) { problems.push_back({index, std::move(what)}); };
  const bool bit = value.type == ValueType::kBit;
  if (IsBits(value.table) && !bit) {
    add(fmt::format("'{}' is a number in the {} table (expected type bit)", value.name, Word(value.table)));
  } else if (!IsBits(value.table) && bit) {
    add(fmt::format("'{}' is a bit in the {} table (expected a number, or the coil or discrete table)",
                    value.name, Word(value.table)));
  }
  if (value.address + Length(value.type) > kAddresses) {
    add(fmt::format("'{}' at {} ends beyond the last address (expected an end up to 65535)", value.name,
                    value.address));
  }
  const bool read_only_table = value.table == Table::kInput || value.table == Table::kDiscrete;
  if (read_only_table && value.access != Access::kRead) {
    add(fmt::format("'{}' is to be written in the {} table, which is read-only (expected access read)",
                    value.name, Word(value.table)));
  }
  if (!CanRead(value) && value.poll_period.count() != 0) {
    add(fmt::format("'{}' is polled but cannot be read (expected access read_write, or no poll)",
                    value.name));
  }
  if (value.poll_period.count() < 0 || value.good_for.count() < 0) {
    add(fmt::format("'{}' has a negative time (expected zero or above)", value.name));
  } else if (value.good_for.count() != 0 && value.good_for < value.poll_period) {
    add(fmt::format("'{}' is stale before it is read again (expected good_for of at least the poll period)",
                    value.name));
  }
  if (!std::isfinite(value.scale) || value.scale == 0.0 || !std::isfinite(value.offset)) {
    add(fmt::format("'{}' has scale = {} and offset = {} (expected finite numbers, the scale not zero)",
                    value.name, value.scale, value.offset));
  }
  if ((value.least && value.most && *value.least > *value.most) ||
      (value.least && std::isnan(*value.least)) || (value.most && std::isnan(*value.most))) {
    add(fmt::format("'{}' has least = {} above most = {} (expected a range)", value.name,
                    value.least.value_or(0), value.most.value_or(0)));
  }
}

}  // namespace

int Length(ValueType type) {
  switch (type) {
    case ValueType::kInt16:
    case ValueType::kUint16:
    case ValueType::kBit:
      return 1;
    case ValueType::kInt32:
    case ValueType::kUint32:
    case ValueType::kFloat32:
      return 2;
  }
  return 1;
}

bool IsBits(Table table) { return table == Table::kCoil || table == Table::kDiscrete; }

bool CanRead(const Register& value) { return value.access != Access::kWrite; }

bool CanWrite(const Register& value) { return value.access != Access::kRead; }

std::chrono::nanoseconds GoodFor(const Register& value) {
  return value.good_for.count() != 0 ? value.good_for : 3 * value.poll_period;
}

std::optional<std::size_t> Find(const RegisterMap& map, std::string_view name) {
  const auto found = std::ranges::find(map.registers, name, &Register::name);
  if (found == map.registers.end()) return std::nullopt;
  return static_cast<std::size_t>(found - map.registers.begin());
}

std::vector<MapProblem> CheckMap(const RegisterMap& map) {
  std::vector<MapProblem> problems;
  for (std::size_t i = 0; i < map.registers.size(); ++i) {
    const Register& value = map.registers[i];
    CheckOne(value, i, problems);
    for (std::size_t k = 0; k < i; ++k) {
      const Register& other = map.registers[k];
      if (other.name == value.name) {
        problems.push_back({i, fmt::format("'{}' is there twice (expected names that differ)", value.name)});
      }
      const bool apart = value.address + Length(value.type) <= other.address ||
                         other.address + Length(other.type) <= value.address;
      if (value.table == other.table && !apart) {
        problems.push_back(
            {i, fmt::format("'{}' at {} lies over '{}' at {} of the {} table (expected each address once)",
                            value.name, value.address, other.name, other.address, Word(value.table))});
      }
    }
  }
  return problems;
}

}  // namespace strainwave::protocols::modbus
