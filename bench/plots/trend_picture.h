// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace strainwave::bench {

/// One quantity over the cycles of a campaign.
struct Trend {
  std::string label;  // "K₁"
  std::string unit;   // "Nm/rad", the unit that `value` has
  std::span<const double> cycle;
  std::span<const double> value;           // NaN: not measured, a gap in the line
  std::span<const double> standard_error;  // same length; NaN or zero: no band there
};

/// One panel for each trend, above each other over a common axis of cycles, with a band of ± one standard
/// error. Writes `stem`.svg and `stem`.png.
///
/// @return the picture's path, as RenderPicture does.
/// @throws std::invalid_argument if there is no trend, or a trend's columns differ in length or hold no
///   value.
/// @throws GnuplotError, std::filesystem::filesystem_error as RenderPicture does.
std::filesystem::path DrawTrends(const std::string& title, std::span<const Trend> trends,
                                 const std::filesystem::path& stem);

}  // namespace strainwave::bench
