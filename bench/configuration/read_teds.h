// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daq/acquisition/calibration.h"
#include "schedules/reader/yaml_map.h"

namespace strainwave::bench {

/// The data sheet of a sensor that the bench file copies, in place of a calibration (IEEE 1451.4):
///
///   teds:
///     basic: 2B C0 F2 66 30 87 D6 12     # its first 64 bits, the lowest byte first
///     counts_per_volt: 3276.8            # of the converter; of a bridge counts per V/V
///     fields: {"%Sens@Ref": 0.0102, "%CalDate": 2026-03-01, "%CalPeriod": 365}
///
/// `fields` are those of the template and of the calibration part, by their names in daq/acquisition/teds.h.
/// Nothing where the sensor has no such section, or one with mistakes, which are findings.
std::optional<daq::acquisition::Calibration> ReadTeds(schedules::YamlMap& sensor);

}  // namespace strainwave::bench
