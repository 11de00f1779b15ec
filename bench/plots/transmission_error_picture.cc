// SPDX-License-Identifier: Apache-2.0
#include "bench/plots/transmission_error_picture.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/one_turn.h"
#include "analysis/quantities.h"
#include "analysis/units.h"
#include "bench/plots/gnuplot.h"
#include "bench/plots/order_spectrum.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

using analysis::OrderLine;
using analysis::SweepError;

std::string SweepData(std::string_view name, const SweepError& sweep) {
  const analysis::TurnCurve turn = analysis::OneTurn(sweep);
  return DataBlock(name, {turn.angle_deg, turn.error_arcmin});
}

// One direction of the first and, where there is one, of the last measurement.
struct Panel {
  std::string_view direction;
  std::string data;
  std::string elements;
};

void AddSweep(const std::string& label, std::string_view id, const std::optional<SweepError>& sweep,
              std::string_view colour, double linewidth, Panel& panel) {
  if (!sweep) {
    return;
  }
  const std::string name = fmt::format("turn_{}_{}", id, panel.direction);
  const analysis::Estimate e_max_arcmin{ArcminFromRad(sweep->e_max_rad.value),
                                        ArcminFromRad(sweep->e_max_rad.standard_error)};
  const std::string title =
      fmt::format("{}, {}: {} = {}", label, panel.direction, analysis::quantities::kEMax.title,
                  EstimateText(e_max_arcmin, analysis::quantities::kEMax.unit()));
  panel.data += SweepData(name, *sweep);
  panel.elements += panel.elements.empty() ? "" : ",\\\n  ";
  panel.elements += fmt::format("${} using 1:2 with lines linewidth {} linecolor rgb '{}' title {}", name,
                                linewidth, colour, Quoted(title));
}

std::vector<Panel> MakePanels(const TransmissionErrorCurve& first, const TransmissionErrorCurve* last) {
  std::vector<Panel> panels;
  for (const std::string_view direction : {"cw", "ccw"}) {
    const auto sweep = [&](const TransmissionErrorCurve& curve) -> const std::optional<SweepError>& {
      return direction == "cw" ? curve.error.cw : curve.error.ccw;
    };
    Panel panel{direction, "", ""};
    // The first lies broad and pale below the last, so that both stay visible where they agree.
    AddSweep(first.label, "first", sweep(first), last ? kFirstColour.pale : kFirstColour.plain,
             last ? 2.5 : 1.2, panel);
    if (last) {
      AddSweep(last->label, "last", sweep(*last), kLastColour.plain, 1.0, panel);
    }
    if (!panel.elements.empty()) {
      panels.push_back(std::move(panel));
    }
  }
  return panels;
}

// The range of all sweeps, so that the panels share one scale.
std::pair<double, double> ErrorRangeArcmin(const TransmissionErrorCurve& first,
                                           const TransmissionErrorCurve* last) {
  double lowest_rad = 0.0;
  double highest_rad = 0.0;
  for (const TransmissionErrorCurve* curve : {&first, last}) {
    if (curve == nullptr) {
      continue;
    }
    for (const std::optional<SweepError>* sweep : {&curve->error.cw, &curve->error.ccw}) {
      for (const double error_rad : *sweep ? (*sweep)->error_rad : std::vector<double>{}) {
        lowest_rad = std::min(lowest_rad, error_rad);
        highest_rad = std::max(highest_rad, error_rad);
      }
    }
  }
  const double margin_rad = std::max(0.05 * (highest_rad - lowest_rad), 1e-9);
  return {ArcminFromRad(lowest_rad - margin_rad), ArcminFromRad(highest_rad + margin_rad)};
}

void Check(const TransmissionErrorCurve& curve) {
  if (!curve.error.cw && !curve.error.ccw) {
    throw std::invalid_argument(
        fmt::format("the curve '{}' has no sweep (expected cw, ccw or both)", curve.label));
  }
}

std::span<const OrderLine> Orders(const TransmissionErrorCurve& curve) {
  return curve.error.cw ? curve.error.cw->orders : curve.error.ccw->orders;
}

}  // namespace

std::filesystem::path DrawTransmissionError(const std::string& title, const TransmissionErrorCurve& first,
                                            const std::optional<TransmissionErrorCurve>& last,
                                            const std::filesystem::path& stem) {
  const TransmissionErrorCurve* const second = last ? &*last : nullptr;
  Check(first);
  if (second) {
    Check(*second);
  }
  const std::vector<Panel> panels = MakePanels(first, second);
  const auto [lowest_arcmin, highest_arcmin] = ErrorRangeArcmin(first, second);

  // Laid out in pixels from the top: title, then panels each under its key, then the spectrum.
  constexpr double kTop = 60.0, kKey = 45.0, kPanel = 235.0, kAxis = 75.0, kSpectrum = 310.0;
  const double height =
      kTop + static_cast<double>(panels.size()) * (kKey + kPanel) + kAxis + kSpectrum + kAxis;
  std::string data;
  std::string plots;
  double y = kTop;
  for (const Panel& panel : panels) {
    const bool lowest = &panel == &panels.back();
    data += panel.data;
    y += kKey;
    plots += fmt::format("set tmargin at screen {:.5f}\nset bmargin at screen {:.5f}\n", 1.0 - y / height,
                         1.0 - (y + kPanel) / height);
    plots += lowest ? "set format x '%g'\nset xlabel 'output angle (deg)' offset 0,0.4\n"
                    : "set format x ''\nset xlabel ''\n";
    plots += fmt::format("set ylabel {}\n", Quoted(fmt::format("{} error (arcmin)", panel.direction)));
    plots += "plot " + panel.elements + "\n";
    y += kPanel;
  }
  y += kAxis;
  const SpectrumFrame frame{.left = 0.085,
                            .right = 0.545,
                            .bottom = 1.0 - (y + kSpectrum) / height,
                            .top = 1.0 - y / height,
                            .list_left = 0.555};
  const SpectrumScript spectrum =
      MakeSpectrumScript(Orders(first), second ? Orders(*second) : std::span<const OrderLine>{}, frame);

  std::string script = data + spectrum.data + CommonStyle();
  script += fmt::format("set label {} at screen 0.525,{:.5f} center font ',18'\n", Quoted(title),
                        1.0 - 32.0 / height);
  script += "set multiplot\nset lmargin at screen 0.085\nset rmargin at screen 0.975\n";
  script += "set xrange [0:360]\nset xtics 0,45,360\n";
  script += fmt::format("set yrange [{:.6g}:{:.6g}]\n", lowest_arcmin, highest_arcmin);
  script += "set xzeroaxis linetype 1 linewidth 0.8 linecolor rgb '#AAAAAA'\n";
  script += "set key at graph 0,1.03 left bottom vertical maxrows 1 Left reverse samplen 2.5\n";
  script += plots + "unset label\nset format x '%g'\n" + spectrum.commands + "unset multiplot\n";
  return RenderPicture(script, stem, {.width_px = 1200, .height_px = static_cast<int>(height)});
}

}  // namespace strainwave::bench
