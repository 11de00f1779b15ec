// SPDX-License-Identifier: Apache-2.0
// Measured over simulated, and what is left of the difference.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "analysis/diagnosis/residual_views.h"
#include "analysis/diagnosis/residuals.h"
#include "bench/diagnosis/diagnosis_pictures.h"
#include "bench/diagnosis/picture_frame.h"
#include "bench/diagnosis/residual_views.h"
#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;
using diagnosis::Regressor;

// What a kind is drawn over: what a person would choose for the abscissa.
struct Abscissa {
  std::string title{"sample"};
  std::vector<double> values;
};

Abscissa AbscissaOf(const diagnosis::Study& study, std::initializer_list<std::string_view> wanted) {
  for (const std::string_view name : wanted) {
    const auto found = std::ranges::find(study.regressors(), name, &Regressor::name);
    if (found == study.regressors().end()) continue;
    Abscissa abscissa{found->title, found->values};
    for (double& value : abscissa.values) value *= found->per_unit;
    return abscissa;
  }
  Abscissa abscissa;
  abscissa.values.resize(study.measured().size());
  std::iota(abscissa.values.begin(), abscissa.values.end(), 0.0);
  return abscissa;
}

Abscissa ResponseAbscissa(const DiagnosisReport& report) {
  const diagnosis::Study& study = *report.input.study;
  if (report.input.kind == StudyKind::kTransmissionError) {
    Abscissa turn = AbscissaOf(study, {"output_angle"});
    // From the first turn on, whichever turns of the shaft these were.
    const double before = 360.0 * std::floor(std::ranges::min(turn.values) / 360.0 + 1e-6);
    for (double& value : turn.values) value -= before;
    return turn;
  }
  if (report.input.kind == StudyKind::kHysteresis)
    return AbscissaOf(study, {"torque"});  // drawn over the twist
  return AbscissaOf(study, {"time"});
}

// The samples around that at which the nominal model is off most, inside one segment.
std::vector<std::size_t> DetailOf(const DiagnosisReport& report, std::size_t length) {
  const std::vector<double> residual = diagnosis::ResidualsOf(*report.input.study, report.result.nominal);
  const std::vector<double>& weights = report.result.weights;
  length = std::min(length, residual.size());
  double sum = 0.0;
  double best = -1.0;
  std::size_t best_end = length;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    sum += weights[i] * residual[i] * residual[i];
    if (i >= length) sum -= weights[i - length] * residual[i - length] * residual[i - length];
    if (i + 1 >= length && sum > best) {
      best = sum;
      best_end = i + 1;
    }
  }
  const std::span<const std::size_t> segments = report.input.study->segments();
  const auto next = std::upper_bound(segments.begin(), segments.end(), best_end - 1 - length / 2);
  const std::size_t first = std::max(best_end - length, *std::prev(next));
  const std::size_t last = std::min(best_end, next == segments.end() ? residual.size() : *next);
  std::vector<std::size_t> indices(last - first);
  std::iota(indices.begin(), indices.end(), first);
  return indices;
}

// As everywhere, a loop is drawn as torque over twist.
bool IsLoop(const DiagnosisReport& report) { return report.input.kind == StudyKind::kHysteresis; }

// A line through so many turns would be a bush.
bool IsZigzag(const std::vector<double>& values) {
  std::size_t turns = 0;
  for (std::size_t i = 2; i < values.size(); ++i) {
    if ((values[i] - values[i - 1]) * (values[i - 1] - values[i - 2]) < 0.0) ++turns;
  }
  return 4 * turns > values.size();
}

// Values far from zero are drawn from a round one on, so that the axis stays readable.
double ShiftOf(const DiagnosisReport& report) {
  const auto [low, high] = std::ranges::minmax(report.input.study->measured());
  const double unit = report.input.study->unit_per_si();
  const double middle = 0.5 * (low + high) * unit;
  return std::abs(middle) > 5.0 * (high - low) * unit ? std::round(middle) : 0.0;
}

// One panel's data and what is drawn of it.
std::string ResponsePanel(const DiagnosisReport& report, const Abscissa& abscissa, const std::string& name,
                          std::span<const std::size_t> indices, bool whole, std::string& data,
                          std::vector<double>& drawn) {
  const diagnosis::Study& study = *report.input.study;
  const double unit = study.unit_per_si();
  const double shift = ShiftOf(report);
  const auto& nominal = report.result.nominal.predicted;
  const auto& extended = report.result.extended.predicted;
  const auto count = static_cast<std::size_t>(nominal.size());
  const auto abscissae = Picked(abscissa.values, indices);
  auto measured = Picked(study.measured(), indices, unit);
  auto before = Picked({nominal.data(), count}, indices, unit);
  auto after = Picked({extended.data(), count}, indices, unit);
  for (auto* values : {&measured, &before, &after}) {
    for (double& value : *values) value -= shift;
    drawn.insert(drawn.end(), values->begin(), values->end());
  }
  data += BrokenBlock(name, indices, study.segments(), {abscissae, measured, before, after});
  const auto over = [&](int column) {
    return IsLoop(report) ? fmt::format("{}:1", column) : fmt::format("1:{}", column);
  };
  const bool points = whole && IsZigzag(before);
  const auto style = [&](std::string_view colour, int shape) {
    return points ? fmt::format("points pointtype {} pointsize 0.5 linecolor rgb '{}'", shape, colour)
                  : fmt::format("lines linewidth 1.6 linecolor rgb '{}'", colour);
  };
  std::string plot = fmt::format(
      "plot ${0} using {4} with points pointtype 7 pointsize {1} linecolor rgb '{2}',\\\n"
      "  ${0} using {5} with {3}",
      name, DotSize(indices.size()), kMeasuredColour, style(kLastColour.plain, 6), over(2), over(3));
  if (IsExtended(report)) {
    plot += fmt::format(",\\\n  ${} using {} with {}", name, over(4), style(kFirstColour.plain, 4));
  }
  return plot + "\n";
}

std::string FrameCommands(double height_px, const std::string& title) {
  return CommonStyle() + TitleLabel(title, height_px) +
         fmt::format("set multiplot\nset lmargin at screen {}\n", kPanelLeft) +
         "set rmargin at screen 0.975\nunset key\nset xzeroaxis linetype 1 linewidth 0.8 linecolor rgb "
         "'#AAAAAA'\n";
}

std::string MissLabel(const diagnosis::Study& study) {
  return fmt::format("set ylabel {}\n", Quoted(fmt::format("measured - simulated ({})", study.unit())));
}

// Only the lowest panel has numbers and words below it.
std::string AxisBelow(bool lowest, const std::string& title) {
  return fmt::format("set format x '{}'\nset xlabel {} offset 0,0.4\n", lowest ? "%g" : "",
                     lowest ? Quoted(title) : "''");
}

// Of values at these samples those that were not left out: a few spikes must not flatten a picture.
std::vector<double> Counted(std::span<const double> values, std::span<const std::size_t> samples,
                            std::span<const double> weights) {
  std::vector<double> counted;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (weights[samples[i]] > 0.0) counted.push_back(values[i]);
  }
  return counted;
}

}  // namespace

std::filesystem::path DrawResponse(const DiagnosisReport& report, const std::filesystem::path& stem) {
  const diagnosis::Study& study = *report.input.study;
  const Abscissa abscissa = ResponseAbscissa(report);
  const std::size_t samples = study.measured().size();
  const auto whole = Thinned(samples, kMostDrawn);
  // A branch of a loop spans much more twist than a model errs by.
  const std::size_t parts = report.input.kind == StudyKind::kHysteresis ? 60 : 12;
  const auto detail = DetailOf(report, std::clamp<std::size_t>(samples / parts, 40, 1500));
  const PanelLayout layout = StackPanels(2, 330.0, 66.0);
  const double shift = ShiftOf(report);
  std::string data;
  std::vector<double> drawn;
  const std::string above = ResponsePanel(report, abscissa, "whole", whole, true, data, drawn);
  std::string script = FrameCommands(layout.height_px, TitleOf(report, "measured and simulated"));
  const std::string response =
      fmt::format("{}{} ({})", ResponseName(report.input.kind),
                  shift == 0.0 ? "" : fmt::format(" less {:.10g}", shift), study.unit());
  const std::string over = AxisTitle(abscissa.title);
  script += fmt::format("set ylabel {}\nset xlabel {} offset 0,0.4\n",
                        Quoted(IsLoop(report) ? over : response), Quoted(IsLoop(report) ? response : over));
  const auto ranges = [&](const std::vector<double>& values, std::span<const std::size_t> indices) {
    const std::string of_values = RangeText(values);
    const std::string of_abscissae = RangeText(Picked(abscissa.values, indices), 0.02);
    return fmt::format("set yrange {}\nset xrange {}\n", IsLoop(report) ? of_abscissae : of_values,
                       IsLoop(report) ? of_values : of_abscissae);
  };
  script += ranges(drawn, whole);
  std::vector<LegendEntry> legend{{kMeasuredColour, "measured"}, {kLastColour.plain, NominalName(report)}};
  if (IsExtended(report)) legend.push_back({kFirstColour.plain, ExtendedName(report)});
  script += Legend(legend, layout.panels[0], layout.height_px);
  script += PanelMargins(layout.panels[0]) + above + "unset label 1000\n";
  drawn.clear();
  const std::string below = ResponsePanel(report, abscissa, "detail", detail, false, data, drawn);
  script += Legend({{{"#666666", "in detail, where the " + NominalName(report) + " is off most", false}}},
                   layout.panels[1], layout.height_px);
  script += ranges(drawn, detail);
  script += PanelMargins(layout.panels[1]) + below + "unset multiplot\n";
  return RenderPicture(data + script, stem,
                       {.width_px = 1200, .height_px = static_cast<int>(layout.height_px)});
}

std::filesystem::path DrawResidual(const DiagnosisReport& report, const std::filesystem::path& stem) {
  const diagnosis::Study& study = *report.input.study;
  const Abscissa abscissa = AbscissaOf(study, {"time"});
  const auto indices = Thinned(study.measured().size(), kMostDrawn);
  const auto abscissae = Picked(abscissa.values, indices);
  const bool extended = IsExtended(report);
  const PanelLayout layout = StackPanels(extended ? 2 : 1, 300.0, 44.0);
  const double unit = study.unit_per_si();
  const double floor = 2.0 * study.NoiseFloor() * unit;
  const auto before = Picked(diagnosis::ResidualsOf(study, report.result.nominal), indices, unit);
  const auto after = Picked(diagnosis::ResidualsOf(study, report.result.extended), indices, unit);
  std::string script =
      FrameCommands(layout.height_px, TitleOf(report, "what the simulation misses")) + MissLabel(study);
  script += fmt::format("set xrange {}\nset yrange {}\n", RangeText(abscissae, 0.01),
                        RangeText(Counted(before, indices, report.result.weights)));
  if (floor > 0.0) {
    script += fmt::format(
        "set object 1 rectangle from graph 0, first {:.6g} to graph 1, first {:.6g} behind fillcolor rgb "
        "'#E8E8E8' fillstyle solid 1 noborder\n",
        -floor, floor);
  }
  const std::string band = floor > 0.0 ? " (grey: 2 standard deviations of the noise)" : "";
  for (std::size_t k = 0; k < layout.panels.size(); ++k) {
    const std::string_view colour = k == 0 ? kLastColour.plain : kFirstColour.plain;
    script += AxisBelow(k + 1 == layout.panels.size(), AxisTitle(abscissa.title));
    script += Legend({{{colour, k == 0 ? NominalName(report) + band : ExtendedName(report)}}},
                     layout.panels[k], layout.height_px);
    script += PanelMargins(layout.panels[k]);
    script += fmt::format(
        "plot $residual using 1:{} with points pointtype 7 pointsize {} linecolor rgb '{}'\nunset label "
        "1000\n",
        k + 2, DotSize(indices.size()), colour);
  }
  return RenderPicture(DataBlock("residual", {abscissae, before, after}) + script + "unset multiplot\n", stem,
                       {.width_px = 1200, .height_px = static_cast<int>(layout.height_px)});
}

std::filesystem::path DrawResidualOver(const DiagnosisReport& report, std::size_t regressor,
                                       const std::filesystem::path& stem) {
  const diagnosis::Study& study = *report.input.study;
  const Regressor& over = study.regressors()[regressor];
  const std::string quantity = diagnosis::SplitTitle(over).quantity;
  const std::vector<double> abscissae = AbscissaeOf(over);
  const auto indices = Thinned(abscissae.size(), kMostDrawn);
  const PanelLayout layout = StackPanels(IsExtended(report) ? 2 : 1, 300.0, 44.0);
  std::string data;
  std::string script =
      FrameCommands(layout.height_px, TitleOf(report, "what the simulation misses, over " + quantity)) +
      MissLabel(study) + fmt::format("set xrange {}\n", RangeText(abscissae, 0.02));
  for (std::size_t k = 0; k < layout.panels.size(); ++k) {
    const bool nominal = k == 0;
    std::vector<double> residual =
        diagnosis::ResidualsOf(study, nominal ? report.result.nominal : report.result.extended);
    for (double& value : residual) value *= study.unit_per_si();
    const BinnedMeans means = BinMeans(abscissae, residual, report.result.weights);
    const auto drawn = Picked(residual, indices);
    data += DataBlock(fmt::format("points{}", k), {Picked(abscissae, indices), drawn});
    data += DataBlock(fmt::format("means{}", k), {means.abscissa, means.mean, means.two_standard_errors});
    if (nominal) {
      script += fmt::format("set yrange {}\n", RangeText(Counted(drawn, indices, report.result.weights)));
    }
    const PictureColour& colour = nominal ? kLastColour : kFirstColour;
    script += AxisBelow(k + 1 == layout.panels.size(),
                        AxisTitle(over.title) + (IsFolded(over) ? ", turns folded into one" : ""));
    script += Legend({{{colour.dark, "mean and 2 standard errors"},
                       {colour.plain, nominal ? NominalName(report) : ExtendedName(report)}}},
                     layout.panels[k], layout.height_px);
    script += PanelMargins(layout.panels[k]);
    script += fmt::format(
        "plot $points{0} using 1:2 with points pointtype 7 pointsize {3} linecolor rgb '{1}',\\\n"
        "  $means{0} using 1:2:3 with yerrorbars pointtype 7 pointsize 0.8 linewidth 1.8 linecolor rgb "
        "'{2}'\n"
        "unset label 1000\n",
        k, colour.pale, colour.dark, DotSize(indices.size()));
  }
  return RenderPicture(data + script + "unset multiplot\n", stem,
                       {.width_px = 1200, .height_px = static_cast<int>(layout.height_px)});
}

}  // namespace strainwave::bench
