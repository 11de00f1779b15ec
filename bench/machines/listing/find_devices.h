// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "bench/devices/hid/hid_channels.h"
#include "bench/devices/modbus/modbus_settings.h"
#include "bench/machines/listing/found_device.h"
#include "bench/roles/bench_clock.h"
#include "bench/roles/can_bus.h"
#include "protocols/canopen/drive_profile.h"
#include "protocols/canopen/node_scan.h"

namespace strainwave::bench {

/// Files that describe devices, by where they are.
struct KnownProfiles {
  std::map<std::filesystem::path, protocols::canopen::DriveProfile> drives;
  std::map<std::filesystem::path, HidProfile> hid;
  std::vector<std::string> troubles;  // of files that cannot be read

  /// Takes in the profiles of drives and HID devices that are in a folder; others are passed over.
  void AddFolder(const std::filesystem::path& folder);
};

FoundDevice Described(const protocols::canopen::FoundNode& node, const std::string& interface,
                      const KnownProfiles& known);

/// CAN interfaces of this machine, up or not, of any kind.
std::vector<std::string> CanInterfaces();
/// The nodes on an interface; one that cannot be opened is listed with the reason.
void FindOnCan(const std::string& interface, const KnownProfiles& known, FoundPart& part);
/// The same on a bus that is open already.
void FindOnCan(CanBus& bus, BenchClock& clock, const std::string& interface, const KnownProfiles& known,
               FoundPart& part);
/// What this kernel has of CAN, where it has none; empty otherwise.
std::string MissingCan();

/// Units from `first` to `last` that answer to a reading of one register, with a refusal, too.
/// @param settings  but for the unit.
void FindOnModbus(ModbusSettings settings, int first, int last, const std::string& address, FoundPart& part);

FoundPart FindHid(const KnownProfiles& known);
/// IIO devices of this machine, on USB and on the network.
FoundPart FindIio();
/// V4L2 devices that give pictures.
FoundPart FindCameras();

}  // namespace strainwave::bench
