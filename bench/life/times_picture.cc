// SPDX-License-Identifier: Apache-2.0
#include "bench/life/times_picture.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

namespace reliability = analysis::reliability;
using reliability::Lifetime;

struct Points {
  std::vector<double> time;
  std::vector<double> height;  // ln(−ln(1 − F))
};

double Height(double share_failed) { return std::log(-std::log1p(-share_failed)); }

// An interval is drawn at its middle.
Points Ranked(std::vector<Lifetime> lives) {
  std::ranges::sort(lives, {}, &Lifetime::middle);
  double units = 0.0;
  for (const Lifetime& life : lives) units += life.count;
  Points points;
  double left = units;
  double rank = 0.0;
  for (const Lifetime& life : lives) {
    if (life.is_failure()) {
      // Johnson: each failure adds what the suspended before it have left to those that remain.
      for (double i = 0.0; i < life.count; ++i) rank += (units + 1.0 - rank) / (1.0 + left - i);
      points.time.push_back(life.middle());
      points.height.push_back(Height((rank - 0.3) / (units + 0.4)));
    }
    left -= life.count;
  }
  return points;
}

}  // namespace

std::optional<std::filesystem::path> DrawTimes(const TimesReport& report, const std::filesystem::path& stem) {
  if (!report.weibull) return std::nullopt;
  const Points points = Ranked(report.lifetimes);
  std::vector<double> height, time, low, high;
  LifeSettings settings = report.settings;
  settings.at.clear();
  settings.shares.clear();
  for (double share : {0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.95, 0.99})
    settings.shares.push_back(share);
  for (const Quantile& quantile : WeibullReportOf(report.lifetimes, settings).quantiles) {
    const reliability::Interval shown = ShownOf(quantile.life, settings.bounds);
    height.push_back(Height(quantile.share_failed));
    time.push_back(quantile.life.value);
    low.push_back(shown.low);
    high.push_back(shown.high);
  }
  std::string script = DataBlock("points", {points.time, points.height}) +
                       DataBlock("law", {height, time, low, high}) + CommonStyle();
  script += "set rmargin 5\nset logscale x\nset xlabel " + Quoted("time in " + report.unit) +
            "\nset ylabel 'failed in %'\nset ytics (";
  std::string tics;
  for (const double percent : {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 63.2, 90.0, 99.0})
    tics += fmt::format("{}'{:g}' {:.5f}", tics.empty() ? "" : ", ", percent, Height(percent / 100.0));
  script += tics + ")\nset key top left\nset title " +
            Quoted(fmt::format("Weibull: shape {:.3g}, scale {:.4g} {}, {:g} of {:g} failed",
                               report.weibull->fit.shape, report.weibull->fit.scale, report.unit,
                               report.counts.failures, report.counts.units)) +
            "\n";
  script += fmt::format(
      "plot $law using 3:1 with lines lw 1.5 dt 2 lc rgb '{0}' title '{1:g} % bounds', '' using 4:1 with "
      "lines lw 1.5 dt 2 lc "
      "rgb '{0}' notitle, '' using 2:1 with lines lw 2 lc rgb '{2}' title 'maximum likelihood', $points "
      "using 1:2 with "
      "points pt 7 ps 1.2 lc rgb '{3}' title 'failures at median ranks'\n",
      kFirstColour.pale, 100.0 * settings.level, kFirstColour.plain, kLastColour.plain);
  return RenderPicture(script, stem, {1000, 700});
}

}  // namespace strainwave::bench
