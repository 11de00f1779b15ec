// SPDX-License-Identifier: Apache-2.0
// What the device side plays over Modbus: drives, thermometers, amplifiers, controllers and switches.
#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "bench/configuration/read_register_map.h"
#include "bench/devices/tcp_address.h"
#include "bench/machines/device_side/device_side.h"
#include "bench/machines/device_side/device_side_parts.h"

namespace strainwave::bench {

void DeviceSide::AddModbusDrive(const DeviceDescription& device, Drive& drive) {
  const ModbusProfile profile = ReadModbusProfile(device.file);
  if (!profile.servo) {
    throw std::invalid_argument(
        fmt::format("{} describes no servo drive (must, as it drives one)", device.file.string()));
  }
  if (profile.servo->shaft == ModbusServoProfile::Shaft::kOutput) drive.reducer_ratio = 1.0;
  drive.modbus = std::make_unique<ModbusServoModel>(profile.map, *profile.servo);
  ModbusServoModel* const model = drive.modbus.get();
  Serve(device, profile.map,
        {[this, model](std::size_t index) { return model->Read(index, clock_.Now()); },
         [this, model](std::size_t index, double value) { return model->Write(index, value, clock_.Now()); },
         [this, model] { model->Hear(clock_.Now()); }});
}

// A line is a pseudo terminal of its own.
void DeviceSide::Serve(const DeviceDescription& device, const protocols::modbus::RegisterMap& map,
                       ModbusDevice::Behaviour behaviour) {
  auto& place = modbus_[device.name];
  if (device.address.starts_with("rtu:")) {
    place = std::make_unique<ModbusDevice>(map, device.unit, std::move(behaviour));
    return;
  }
  // Within the program any free port will do.
  const TcpAddress at = IsInProcess(device) ? TcpAddress{"127.0.0.1", 0} : ParseTcpAddress(device.address);
  place = std::make_unique<ModbusDevice>(map, device.unit, std::move(behaviour),
                                         ModbusDevice::Tcp{at.host, at.port});
}

void DeviceSide::AddModbus(const DeviceDescription& device) {
  ModbusProfile profile = ReadModbusProfile(device.file);
  std::vector<std::string> names;
  for (auto& value : profile.map.registers) {
    names.push_back(value.name);
    // The limits are the reader's: a device gives what it has.
    if (!CanWrite(value)) value.least = value.most = std::nullopt;
  }
  const auto has = [&](const char* name) { return std::ranges::find(names, name) != names.end(); };
  if (device.kind == DeviceDescription::Kind::kModbus && !has("gear_temperature") &&
      !has("ambient_temperature")) {
    throw std::invalid_argument(
        fmt::format("{} has neither gear_temperature nor ambient_temperature (must have one "
                    "to be played here)",
                    device.file.string()));
  }
  ModbusDevice::Behaviour behaviour;
  behaviour.read = [this, names](std::size_t index) {
    const std::string& name = names[index];
    if (name == "gear_temperature") return gear_temperature_degC_.load();
    if (name == "ambient_temperature" || name == "temperature") return ambient_temperature_degC_.load();
    if (name == "torque") return output_torque_Nm_.load();
    if (name == "set_point") return set_point_degC_.load();
    if (name == "heating") return heats_ ? 1.0 : 0.0;
    if (name == "shunt") return shunted_ ? 1.0 : 0.0;
    return 0.0;
  };
  behaviour.write = [this, names](std::size_t index, double value) {
    const std::string& name = names[index];
    if (name == "set_point") set_point_degC_ = value;
    if (name == "heating") heats_ = value > 0.5;
    if (name == "shunt") shunted_ = value > 0.5;
    return true;
  };
  Serve(device, profile.map, std::move(behaviour));
}

}  // namespace strainwave::bench
