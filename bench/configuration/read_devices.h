// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "bench/configuration/bench_description.h"
#include "schedules/reader/yaml_map.h"

namespace strainwave::bench {

/// The sections of a bench file that say which real devices play its parts. Files that they name are looked
/// for in `folder`.
std::vector<DeviceDescription> ReadDevices(std::vector<schedules::YamlMap> maps,
                                           const std::filesystem::path& folder,
                                           schedules::ReadContext& context);
DriveLink ReadDriveLink(schedules::YamlMap map, const std::filesystem::path& folder);
std::vector<ChannelLink> ReadChannelLinks(std::vector<schedules::YamlMap> maps,
                                          schedules::ReadContext& context);

/// Whether the sections fit together, and nothing that a bench needs is without a device: both drives, and
/// the channels of `kNeededChannels`. Speed and torque of the motor come from its drive unless a channel has
/// them.
void CheckDevices(const BenchDescription& bench, int line, schedules::ReadContext& context);

inline constexpr const char* kNeededChannels[] = {"input_angle", "output_angle", "output_torque",
                                                  "gear_temperature"};
inline constexpr const char* kFurtherChannels[] = {"input_speed", "motor_torque", "ambient_temperature"};

}  // namespace strainwave::bench
