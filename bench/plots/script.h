// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include "analysis/transmission_error.h"

/// The pieces of gnuplot script that the pictures share.
namespace strainwave::bench {

/// Colours that stay apart for every kind of colour vision (the palette of Okabe and Ito), and a pale and a
/// dark companion of each.
struct PictureColour {
  std::string_view plain;
  std::string_view pale;
  std::string_view dark;
};
inline constexpr PictureColour kFirstColour{"#0072B2", "#8CC3E3", "#00405F"};  // blue
inline constexpr PictureColour kLastColour{"#D55E00", "#F2B48A", "#7A3300"};   // vermilion
inline constexpr std::string_view kMeasuredColour = "#444444";                 // beside both

/// `text` as a gnuplot string that means exactly these characters; control characters become spaces.
std::string Quoted(std::string_view text);

/// A named block of inline data, one row for each index.
/// @throws std::invalid_argument if the columns differ in length or there is none.
std::string DataBlock(std::string_view name, std::initializer_list<std::span<const double>> columns);

/// "16020 ± 35 Nm/rad": the standard error with two digits, the value to the same place. A standard error
/// that is zero or not finite is left out; a value that is not finite is "no value".
std::string EstimateText(const analysis::Estimate& estimate, std::string_view unit);

/// Border, grid, tics and key as every picture has them.
std::string CommonStyle();

}  // namespace strainwave::bench
