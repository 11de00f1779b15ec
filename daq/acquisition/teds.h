// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daq/acquisition/calibration.h"

/// The electronic data sheet in a sensor, IEEE 1451.4.
namespace strainwave::daq::acquisition {

/// The first 64 bits of every data sheet: who made the sensor and which one it is.
struct BasicTeds {
  std::uint16_t manufacturer_id{};  // 14 bits, 17 to 16381
  std::uint16_t model_number{};     // 15 bits
  char version_letter{};            // 5 bits, A to Z
  std::uint8_t version_number{};    // 6 bits
  std::uint32_t serial_number{};    // 24 bits

  bool operator==(const BasicTeds&) const = default;
};

constexpr std::size_t kBasicTeds_bytes = 8;

/// Fields follow each other from the lowest bit of the first byte on.
/// @throws std::invalid_argument naming the field that is out of its range.
BasicTeds BasicTedsFrom(std::span<const std::uint8_t, kBasicTeds_bytes> bytes);
std::array<std::uint8_t, kBasicTeds_bytes> BytesOf(const BasicTeds& teds);

/// Fields that are kept by name with a calibration: the basic ones ("Manufacturer ID", "Model Number",
/// "Version Letter", "Version Number", "Serial Number"); of the template for accelerometers and force
/// transducers (25), in its order, "%Sens@Ref", "%TF_HP_S", "%Direction", "%Weight", "%Sign", the transfer
/// function "%TF_SP", "%TF_KPr", "%TF_KPq", "%TF_SL" and "%TempCoef", "%RefFreq", "%RefTemp"; of the template
/// for bridges (33), as torque transducers are, "%ElecSigType", "%PhysMeasType", "%MinPhysVal",
/// "%MaxPhysVal", "%MinElecVal", "%MaxElecVal", "%MapMeth", "%BridgeType", "%SensorImped", "%RespTime",
/// "%ExciteAmplNom", "%ExciteAmplMin", "%ExciteAmplMax"; and of both the calibration part "%CalDate",
/// "%CalInitials", "%CalPeriod" (days), "%MeasID".
///
/// Held against National Instruments, "IEEE 1451.4 Sensor Templates Overview" (basic part: widths and
/// ranges), the fields that the open reader of SDL-MCI/SDLMA-Core takes from template 25, and those that the
/// drivers of ADLINK (UD-DASK), Dewetron (TRION) and Data Translation (DtOl) name of bridges.
bool IsTedsField(std::string_view name);
/// Those of the templates and the calibration part, all but the basic ones.
std::vector<std::string_view> TedsTemplateFields();

/// The calibration that a data sheet speaks of: the sensor's number, date, and due date "%CalPeriod" days
/// later. The sensitivity is "%Sens@Ref" times "%Sign" (volts per m/s^2 or N); of a bridge the line from
/// "%MinElecVal" at "%MinPhysVal" to "%MaxElecVal" at "%MaxPhysVal" (V/V, in the sensor's unit), zero
/// included.
/// @param raw_per_volt  of the converter; of a bridge raw per V/V.
/// @throws std::invalid_argument for a field with an unknown name, a number that is none, a "%MapMeth" that
///   is not linear ("0"), or where there is neither "%Sens@Ref" nor such a line.
Calibration CalibrationFromTeds(const BasicTeds& basic, const Attributes& fields, double raw_per_volt);

}  // namespace strainwave::daq::acquisition
