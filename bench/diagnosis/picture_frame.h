// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/diagnosis/diagnosis_report.h"
#include "bench/diagnosis/study_kind.h"

/// What the pictures of a diagnosis share.
namespace strainwave::bench {

inline constexpr std::size_t kMostDrawn = 4000;

/// Left edge of the panels, a share of the picture's width: room for the axis' name beside ticks like
/// -0.0003.
inline constexpr double kPanelLeft = 0.105;

/// True where something was added to the nominal model.
bool IsExtended(const DiagnosisReport& report);

/// "measured", "nominal model", "+ backlash", as keys and titles call them.
std::string NominalName(const DiagnosisReport& report);
std::string ExtendedName(const DiagnosisReport& report);

/// "twist", "transmission error": what the response of a kind is.
std::string ResponseName(StudyKind kind);

/// "loop.csv: measured and simulated": what is shown, of which record.
std::string TitleOf(const DiagnosisReport& report, const std::string& what);

/// "torque / Nm" as all pictures have it: "torque (Nm)".
std::string AxisTitle(const std::string& title);

/// Size of dots for so many of them: few are large.
double DotSize(std::size_t count);

/// Panels one above the other: from the top in pixels, each between its edges.
struct PanelEdges {
  double top{};  // share of the picture's height
  double bottom{};
};
struct PanelLayout {
  double height_px{};
  std::vector<PanelEdges> panels;
};
/// @param gap_px  between panels: for a key, or for an axis and a key.
PanelLayout StackPanels(std::size_t count, double panel_px, double gap_px);

std::string PanelMargins(const PanelEdges& panel);
std::string TitleLabel(const std::string& title, double height_px);

/// Margins of one panel whose rows have names on the left, the longest of so many letters.
std::string MarginsBesideNames(std::size_t longest_name, int width_px, double height_px);

/// What is drawn in which colour, as a row of coloured words above a panel; texts that do not fit are cut.
struct LegendEntry {
  std::string_view colour;
  std::string text;
  bool marked{true};  // with a dot in its colour
};
/// @param gap_px  above the panel's upper edge.
std::string Legend(const std::vector<LegendEntry>& entries, const PanelEdges& panel, double height_px,
                   double gap_px = 14.0);

/// Smallest and largest of the finite values; the first above the second where there are none.
struct ValueRange {
  double low{std::numeric_limits<double>::infinity()};
  double high{-std::numeric_limits<double>::infinity()};
};
ValueRange FiniteRange(std::span<const double> values);

/// "[low:high]" with a margin; around a level where all are equal.
std::string RangeText(std::span<const double> values, double margin = 0.05);

/// Values of the indices, times `factor`.
std::vector<double> Picked(std::span<const double> values, std::span<const std::size_t> indices,
                           double factor = 1.0);

/// A data block whose lines break where a segment begins.
std::string BrokenBlock(const std::string& name, std::span<const std::size_t> indices,
                        std::span<const std::size_t> segments,
                        std::initializer_list<std::span<const double>> columns);

}  // namespace strainwave::bench
