// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Units as instruments write them.
namespace strainwave::daq {

/// value · scale + offset is the same in SI (temperatures in °C).
struct ImportUnit {
  std::string_view quantity;  // "torque"
  double scale{1.0};
  double offset{};
};

/// "Nm", "N·m", "mrad", "°", "m/s²", "g"; blanks and brackets around it are left out. Letters' case counts:
/// mNm is not MNm.
std::optional<ImportUnit> FindImportUnit(std::string_view text);

/// What turns values in one unit into another: value · scale + offset. Nothing where they measure different
/// things or one is not known.
struct UnitChange {
  double scale{1.0};
  double offset{};
};
std::optional<UnitChange> ChangeOfUnit(std::string_view from, std::string_view to);

/// "deg, mrad, rad …": those that measure the same as this one, for messages.
std::string UnitsLike(std::string_view unit);

/// The unit in brackets at the end of a name, "Time [s]" or "Torque (Nm)", and the name without it. Both
/// empty where there is none; "loop(:,1)" is a column of a matrix.
struct NamedUnit {
  std::string_view name;
  std::string_view unit;
};
NamedUnit SplitUnit(std::string_view name);

}  // namespace strainwave::daq
