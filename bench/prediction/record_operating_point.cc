// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/record_operating_point.h"

#include <deque>
#include <variant>
#include <vector>

namespace strainwave::bench {

std::vector<double> OperatingValuesOf(const daq::Record& record, std::string_view name) {
  const daq::Column* const column = record.FindColumn(name);
  if (column != nullptr && !std::holds_alternative<std::vector<daq::Direction>>(column->values))
    return record.CopyAsDoubles(name);
  const auto text = record.Metadata(name);
  const auto number = text ? daq::NumberFromText(*text) : std::nullopt;
  return number ? std::vector{*number} : std::vector<double>{};
}

OperatingPoint OperatingPointOf(const daq::Record& record) {
  std::deque<std::vector<double>> values;  // what the signals look at
  std::vector<NamedSignal> signals;
  for (const OperatingName& name : OperatingNames()) {
    values.push_back(OperatingValuesOf(record, name.name));
    signals.push_back({name.name, values.back()});
  }
  return OperatingPointOf(signals);
}

void AddOperatingPoint(daq::Record& vibration, const daq::Record& rotation) {
  const OperatingPoint own = OperatingPointOf(vibration);
  const std::vector<double> torque_Nm = rotation.CopyAsDoubles("output_torque_Nm");
  std::vector<NamedSignal> signals{{"output_torque_Nm", torque_Nm}};
  std::vector<double> temperature_degC;
  if (rotation.FindColumn("temperature_degC") != nullptr) {
    temperature_degC = rotation.CopyAsDoubles("temperature_degC");
    signals.push_back({"temperature_degC", temperature_degC});
  }
  const OperatingPoint logged = OperatingPointOf(signals);
  for (const OperatingQuantity quantity : kOperatingQuantities) {
    if (!own[quantity] && logged[quantity]) vibration.SetMetadata(NameOf(quantity), *logged[quantity]);
  }
}

}  // namespace strainwave::bench
