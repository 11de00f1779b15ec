// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "bench/diagnosis/picture_frame.h"
#include "bench/diagnosis/power_report.h"
#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {

namespace diagnosis = analysis::diagnosis;

std::filesystem::path DrawDetectionPower(const DiagnosisReport& report, const std::filesystem::path& stem) {
  constexpr std::size_t kMostShown = 40;
  constexpr std::size_t kLongestWords = 60;
  constexpr int kWidth_px = 1200;
  std::vector<const diagnosis::CausePower*> order;
  for (const diagnosis::CausePower& power : report.power->causes) order.push_back(&power);
  const auto sigma_of = [](const diagnosis::CausePower* power) {
    return power->size && power->sigma ? power->sigma->value : INFINITY;
  };
  std::ranges::stable_sort(order, {}, sigma_of);
  const std::size_t shown = std::min(order.size(), kMostShown);
  const double height = 130.0 + 34.0 * static_cast<double>(std::max<std::size_t>(shown, 1));
  double largest = 10.0;
  double smallest = 3.0;
  for (const diagnosis::CausePower* power : order) {
    if (!std::isfinite(sigma_of(power))) continue;
    const double high = std::isfinite(power->sigma->high) ? power->sigma->high : 2.0 * power->sigma->value;
    largest = std::max(largest, high);
    smallest = std::min(smallest, power->sigma->low);
  }
  const double left = 0.8 * smallest;
  std::vector<double> bars[4];   // left, right, lower and upper edge
  std::vector<double> marks[4];  // value, y, low, high
  std::string names;
  std::string labels;
  std::size_t longest_name = 0;
  for (std::size_t k = 0; k < shown; ++k) {
    const diagnosis::CausePower& power = *order[k];
    const double y = -static_cast<double>(k);
    const std::string name = CandidateName(*report.input.study, power.cause);
    longest_name = std::max(longest_name, name.size());
    names += fmt::format("{}{} {:g}", k == 0 ? "" : ", ", Quoted(name), y);
    const bool reached = std::isfinite(sigma_of(&power));
    double x = left;
    std::string words = "never so often";
    if (!power.objection.empty()) words += ": " + power.objection.substr(0, kLongestWords);
    if (reached) {
      const double high = std::isfinite(power.sigma->high) ? power.sigma->high : 2.0 * power.sigma->value;
      bars[0].push_back(left);
      bars[1].push_back(power.sigma->value);
      bars[2].push_back(y - 0.36);
      bars[3].push_back(y + 0.36);
      marks[0].push_back(power.sigma->value);
      marks[1].push_back(y);
      marks[2].push_back(power.sigma->low);
      marks[3].push_back(high);
      x = high;
      words = fmt::format("{} ({:.2g} to {:.2g})",
                          SpokenParameter({power.amount, power.unit, power.size->value, 0.0}),
                          power.size->low, power.size->high);
    }
    labels +=
        fmt::format("set label {} at first {:.5g},{:.5g} left offset 0.8,0 font ',13' textcolor rgb '{}'\n",
                    Quoted(words), x, y, reached ? kFirstColour.dark : "#666666");
  }
  std::string script = CommonStyle();
  script += TitleLabel(TitleOf(report, "how large an effect is found nine times of ten"), height);
  script += MarginsBesideNames(longest_name, kWidth_px, height);
  // Room on the right for the words.
  script += fmt::format("set logscale x\nset xrange [{:.5g}:{:.5g}]\nset yrange [{:.5g}:0.6]\n", left,
                        largest * std::pow(largest / left, 1.2), -static_cast<double>(shown) + 0.4);
  script += "set xtics (1, 2, 3, 5, 10, 20, 50, 100, 200, 500)\n";
  script += fmt::format("set ytics ({}) scale 0\nunset key\nunset grid\n", names);
  script += "set xlabel 'size in standard errors of a matched filter (with its 95 % interval)'\n";
  script += labels;
  if (bars[0].empty()) {
    script += "plot NaN\n";
  } else {
    script += DataBlock("bars", {bars[0], bars[1], bars[2], bars[3]});
    script += DataBlock("marks", {marks[0], marks[1], marks[2], marks[3]});
    script += fmt::format(
        "set style fill solid 1 noborder\n"
        "plot $bars using (0.5*($1+$2)):(0.5*($3+$4)):1:2:3:4 with boxxyerror linecolor rgb '{}', "
        "$marks using 1:2:3:4 with xerrorbars pointtype 7 linewidth 2 linecolor rgb '{}'\n",
        kFirstColour.pale, kFirstColour.dark);
  }
  return RenderPicture(script, stem, {.width_px = kWidth_px, .height_px = static_cast<int>(height)});
}

}  // namespace strainwave::bench
