// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/picture_frame.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/plots/script.h"

namespace strainwave::bench {

bool IsExtended(const DiagnosisReport& report) {
  return !report.result.causes.empty() || !report.result.nuisance_terms.empty();
}

std::string NominalName(const DiagnosisReport& report) {
  return report.model.empty() ? "nominal model" : "model as given";
}

std::string ExtendedName(const DiagnosisReport& report) {
  std::vector<std::string> names;
  for (const auto* findings : {&report.result.causes, &report.result.nuisance_terms}) {
    for (const auto& finding : *findings) {
      names.push_back(report.input.study->causes()[finding.index].name);
    }
  }
  return fmt::format("with {}", fmt::join(names, ", "));
}

std::string ResponseName(StudyKind kind) {
  if (kind == StudyKind::kTransmissionError) return "transmission error";
  if (kind == StudyKind::kHysteresis) return "twist";
  if (kind == StudyKind::kMotion) return "drive";
  if (kind == StudyKind::kVibration) return "acceleration";
  return "result";
}

std::string TitleOf(const DiagnosisReport& report, const std::string& what) {
  const std::vector<RecordIdentity>& records = report.input.records;
  if (records.empty()) return what;
  const std::filesystem::path file = records.front().file;
  std::string name = (file.has_filename() ? file : file.parent_path()).filename().string();
  if (!records.front().group.empty()) name += " " + records.front().group;
  if (records.size() > 1) name += fmt::format(" and {} more", records.size() - 1);
  return fmt::format("{}: {}", name, what);
}

std::string AxisTitle(const std::string& title) {
  const std::size_t slash = title.find(" / ");
  if (slash == std::string::npos) return title;
  std::string unit = title.substr(slash + 3);
  if (!unit.starts_with('(')) unit = "(" + unit + ")";
  return title.substr(0, slash) + " " + unit;
}

double DotSize(std::size_t count) { return count <= 200 ? 0.9 : count <= 1000 ? 0.6 : 0.4; }

PanelLayout StackPanels(std::size_t count, double panel_px, double gap_px) {
  constexpr double kTitle = 56.0;
  constexpr double kAxis = 72.0;
  PanelLayout layout;
  layout.height_px = kTitle + static_cast<double>(count) * (gap_px + panel_px) + kAxis;
  double y = kTitle;
  for (std::size_t k = 0; k < count; ++k) {
    y += gap_px;
    layout.panels.push_back({1.0 - y / layout.height_px, 1.0 - (y + panel_px) / layout.height_px});
    y += panel_px;
  }
  return layout;
}

std::string PanelMargins(const PanelEdges& panel) {
  return fmt::format("set tmargin at screen {:.5f}\nset bmargin at screen {:.5f}\n", panel.top, panel.bottom);
}

std::string TitleLabel(const std::string& title, double height_px) {
  return fmt::format("set label 1000 {} at screen 0.53,{:.5f} center font ',18'\n", Quoted(title),
                     1.0 - 30.0 / height_px);
}

std::string MarginsBesideNames(std::size_t longest_name, int width_px, double height_px) {
  constexpr double kLetter_px = 9.0;  // of the names' font, on average
  return fmt::format(
      "set lmargin at screen {:.5f}\nset rmargin at screen 0.975\nset tmargin at screen {:.5f}\nset bmargin "
      "at screen {:.5f}\n",
      (30.0 + kLetter_px * static_cast<double>(longest_name)) / width_px, 1.0 - 56.0 / height_px,
      72.0 / height_px);
}

std::string Legend(const std::vector<LegendEntry>& entries, const PanelEdges& panel, double height_px,
                   double gap_px) {
  constexpr double kWidth_px = 1200.0;
  constexpr double kRight_px = 1170.0;
  constexpr double kCharacter_px = 8.0;  // about, of the font that is used
  constexpr double kSpace_px = 40.0;
  std::string commands;
  double x_px = kPanelLeft * kWidth_px + 3.0;
  int tag = 900;
  for (const LegendEntry& entry : entries) {
    const auto room = static_cast<std::size_t>(std::max(0.0, (kRight_px - x_px) / kCharacter_px - 2.0));
    std::string text = entry.text;
    if (text.size() > room) text = text.substr(0, room > 3 ? room - 3 : 0) + "...";
    commands += fmt::format("set label {} {} at screen {:.5f},{:.5f} left font ',14' textcolor rgb '{}'\n",
                            ++tag, Quoted((entry.marked ? "\u25CF " : "") + text), x_px / kWidth_px,
                            panel.top + gap_px / height_px, entry.colour);
    x_px += kCharacter_px * static_cast<double>(text.size() + 2) + kSpace_px;
  }
  // Panels that had more entries before.
  while (tag < 904) commands += fmt::format("unset label {}\n", ++tag);
  return commands;
}

ValueRange FiniteRange(std::span<const double> values) {
  ValueRange range;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
  }
  return range;
}

std::string RangeText(std::span<const double> values, double margin) {
  const auto [low, high] = FiniteRange(values);
  if (!(low <= high)) return "[0:1]";
  const double level = std::max(std::abs(low), std::abs(high));
  const double room = std::max({margin * (high - low), 1e-6 * level, 1e-12});
  return fmt::format("[{:.8g}:{:.8g}]", low - room, high + room);
}

std::vector<double> Picked(std::span<const double> values, std::span<const std::size_t> indices,
                           double factor) {
  std::vector<double> picked;
  for (const std::size_t i : indices) picked.push_back(factor * values[i]);
  return picked;
}

std::string BrokenBlock(const std::string& name, std::span<const std::size_t> indices,
                        std::span<const std::size_t> segments,
                        std::initializer_list<std::span<const double>> columns) {
  std::vector<std::vector<double>> broken(columns.size());
  const auto segment_of = [&](std::size_t sample) {
    return std::upper_bound(segments.begin(), segments.end(), sample) - segments.begin();
  };
  for (std::size_t row = 0; row < indices.size(); ++row) {
    const bool breaks = row > 0 && segment_of(indices[row]) != segment_of(indices[row - 1]);
    std::size_t column = 0;
    for (const std::span<const double> values : columns) {
      if (breaks) broken[column].push_back(std::numeric_limits<double>::quiet_NaN());
      broken[column].push_back(values[row]);
      ++column;
    }
  }
  switch (broken.size()) {
    case 2:
      return DataBlock(name, {broken[0], broken[1]});
    case 3:
      return DataBlock(name, {broken[0], broken[1], broken[2]});
    default:
      return DataBlock(name, {broken.at(0), broken.at(1), broken.at(2), broken.at(3)});
  }
}

}  // namespace strainwave::bench
