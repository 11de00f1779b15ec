// SPDX-License-Identifier: Apache-2.0
#include "bench/plots/hysteresis_picture.h"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "analysis/quantities.h"
#include "analysis/units.h"
#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

void Check(const HysteresisCurve& curve) {
  const std::size_t samples = curve.twist_rad.size();
  if (samples == 0) {
    throw std::invalid_argument(fmt::format("the loop '{}' is empty (expected samples)", curve.label));
  }
  if (curve.torque_Nm.size() != samples ||
      (!curve.fitted_torque_Nm.empty() && curve.fitted_torque_Nm.size() != samples)) {
    throw std::invalid_argument(
        fmt::format("the loop '{}' has {} twists, {} torques and {} fitted torques "
                    "(expected one length)",
                    curve.label, samples, curve.torque_Nm.size(), curve.fitted_torque_Nm.size()));
  }
}

std::vector<double> ToArcmin(std::span<const double> angle_rad) {
  std::vector<double> angle_arcmin(angle_rad.size());
  std::transform(angle_rad.begin(), angle_rad.end(), angle_arcmin.begin(), ArcminFromRad);
  return angle_arcmin;
}

// The spring alone, as line pieces through the middle of the loop: twist at the torques −T₃ … T₃.
struct SpringLine {
  std::array<double, 7> torque_Nm;
  std::array<double, 7> twist_arcmin;
};

SpringLine MakeSpringLine(const HysteresisCurve& curve) {
  const analysis::TestTorques& t = curve.torques;
  const double end_Nm = std::max(t.t2_Nm, t.t3_Nm - curve.friction_torque_Nm);
  const double at_t1_rad = t.t1_Nm / curve.k1_Nm_per_rad.value;
  const double at_t2_rad = at_t1_rad + (t.t2_Nm - t.t1_Nm) / curve.k2_Nm_per_rad.value;
  const double at_end_rad = at_t2_rad + (end_Nm - t.t2_Nm) / curve.k3_Nm_per_rad.value;
  // Twist counts from the first sample, which need not be the middle of the loop.
  const auto [lowest, highest] = std::minmax_element(curve.twist_rad.begin(), curve.twist_rad.end());
  const double middle_rad = 0.5 * (*lowest + *highest);
  SpringLine line{{-end_Nm, -t.t2_Nm, -t.t1_Nm, 0.0, t.t1_Nm, t.t2_Nm, end_Nm}, {}};
  const std::array<double, 7> twist_rad{-at_end_rad, -at_t2_rad, -at_t1_rad, 0.0,
                                        at_t1_rad,   at_t2_rad,  at_end_rad};
  for (std::size_t i = 0; i < twist_rad.size(); ++i) {
    line.twist_arcmin[i] = ArcminFromRad(middle_rad + twist_rad[i]);
  }
  return line;
}

// The data and the plot elements of one cycle. `id` keeps the names of two cycles apart.
struct Layer {
  std::string data;
  std::string loops;
  std::string slopes;
};

std::string SlopeElement(std::string_view id, const std::string& label, int piece,
                         const analysis::Estimate& k_Nm_per_rad, double from_Nm, double to_Nm,
                         double linewidth, std::string_view colour) {
  const analysis::Quantity& quantity = analysis::kStiffnesses[static_cast<std::size_t>(piece - 1)];
  // K1 and K3, which have one colour, differ by their dashes.
  return fmt::format(
      "$spring_{}_{} using 1:2 with lines linewidth {} dashtype {} linecolor rgb '{}' title {}", id, piece,
      linewidth, piece == 3 ? "'-'" : "1", colour,
      Quoted(fmt::format("{}, {} = {}, {:g} to {:g} Nm", label, quantity.title,
                         EstimateText(k_Nm_per_rad, quantity.unit()), from_Nm, to_Nm)));
}

// `rim` widens the lines of a cycle that lies below another, so that it stays visible where they agree.
Layer MakeLayer(std::string_view id, const HysteresisCurve& curve, const PictureColour& colour, double rim) {
  Check(curve);
  const std::vector<double> twist_arcmin = ToArcmin(curve.twist_rad);
  const bool fitted = !curve.fitted_torque_Nm.empty();
  Layer layer;
  layer.data = DataBlock(fmt::format("loop_{}", id),
                         {twist_arcmin, curve.torque_Nm, fitted ? curve.fitted_torque_Nm : curve.torque_Nm});
  layer.loops = fmt::format("$loop_{} using 1:2 with lines linewidth {} linecolor rgb '{}' title {}", id,
                            3.5 + rim, colour.pale, Quoted(curve.label + ", measured"));
  if (fitted) {
    layer.loops += fmt::format(",\\\n  $loop_{} using 1:3 with lines linewidth 1 linecolor rgb '{}' title {}",
                               id, colour.dark, Quoted(curve.label + ", fitted loop"));
  }
  const SpringLine line = MakeSpringLine(curve);
  const std::span<const double> torque_Nm = line.torque_Nm;
  const std::span<const double> spring_arcmin = line.twist_arcmin;
  // K1 is one piece through zero; K2 and K3 have one piece on each side, apart by a line with a gap.
  layer.data +=
      DataBlock(fmt::format("spring_{}_1", id), {spring_arcmin.subspan(2, 3), torque_Nm.subspan(2, 3)});
  constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
  for (const std::size_t piece : {std::size_t{2}, std::size_t{3}}) {
    const std::size_t left = 3 - piece;
    const std::size_t right = 2 + piece;
    const std::array<double, 5> x{spring_arcmin[left], spring_arcmin[left + 1], kGap, spring_arcmin[right],
                                  spring_arcmin[right + 1]};
    const std::array<double, 5> y{torque_Nm[left], torque_Nm[left + 1], kGap, torque_Nm[right],
                                  torque_Nm[right + 1]};
    layer.data += DataBlock(fmt::format("spring_{}_{}", id, piece), {x, y});
  }
  const analysis::TestTorques& t = curve.torques;
  layer.slopes =
      SlopeElement(id, curve.label, 1, curve.k1_Nm_per_rad, 0.0, t.t1_Nm, 2.5 + rim, colour.dark) +
      ",\\\n  " +
      SlopeElement(id, curve.label, 2, curve.k2_Nm_per_rad, t.t1_Nm, t.t2_Nm, 2.5 + rim, colour.plain) +
      ",\\\n  " +
      SlopeElement(id, curve.label, 3, curve.k3_Nm_per_rad, t.t2_Nm, t.t3_Nm, 2.5 + rim, colour.dark);
  return layer;
}

}  // namespace

std::filesystem::path DrawHysteresis(const std::string& title, const HysteresisCurve& first,
                                     const std::optional<HysteresisCurve>& last,
                                     const std::filesystem::path& stem) {
  const Layer lower = MakeLayer("first", first, kFirstColour, last ? 3.5 : 0.0);
  std::string script = lower.data;
  std::string elements = lower.loops + ",\\\n  " + lower.slopes;
  if (last) {
    const Layer upper = MakeLayer("last", *last, kLastColour, 0.0);
    script += upper.data;
    elements += ",\\\n  " + upper.loops + ",\\\n  " + upper.slopes;
  }
  const int rows = first.fitted_torque_Nm.empty() ? 4 : 5;
  script += CommonStyle();
  script += fmt::format("set title {} font ',18'\n", Quoted(title));
  script += "set xlabel 'output twist (arcmin)' offset 0,0.5\nset ylabel 'output torque (Nm)'\n";
  script += "set xzeroaxis linetype 1 linewidth 0.8 linecolor rgb '#AAAAAA'\n";
  script += "set yzeroaxis linetype 1 linewidth 0.8 linecolor rgb '#AAAAAA'\n";
  script +=
      fmt::format("set key below vertical maxrows {} Left reverse samplen 3 spacing 1.2 width 2\n", rows);
  script += "plot " + elements + "\n";
  return RenderPicture(script, stem, {.width_px = 1100, .height_px = 900});
}

}  // namespace strainwave::bench
