// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/speed_band.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kLevels = 200;  // of speed: a band ends at one of them, and holds half of them or more

// Speeds that share out the turns evenly; standstill has none.
std::vector<double> LevelsOf(const VibrationRun& run) {
  std::vector<std::pair<double, double>> turned;  // speed, angle at it
  double all = 0.0;
  for (std::size_t i = 1; i < run.size(); ++i) {
    const double angle = run.angle_rad[i] - run.angle_rad[i - 1];
    const double speed = run.speed_rad_per_s[i];
    if (!(angle > 0.0) || !(speed > 0.0)) continue;
    turned.emplace_back(speed, angle);
    all += angle;
  }
  std::ranges::sort(turned);
  std::vector<double> levels;
  double sum = 0.0;
  for (const auto& [speed, angle] : turned) {
    sum += angle;
    const double reached = sum / all * static_cast<double>(kLevels);
    while (static_cast<double>(levels.size()) < reached && levels.size() < kLevels) levels.push_back(speed);
  }
  if (!levels.empty()) levels.back() = turned.back().first;
  return levels;
}

SpeedBand BandOf(const VibrationRun& run, double slowest, double fastest) {
  SpeedBand band{slowest, fastest, 0.0, 0.0};
  double first = -1.0;
  for (std::size_t i = 1; i < run.size(); ++i) {
    if (!band.Holds(run.speed_rad_per_s[i])) continue;
    if (first < 0.0) first = run.angle_rad[i - 1];
    band.turns += (run.angle_rad[i] - run.angle_rad[i - 1]) / kTwoPi;
    band.span = (run.angle_rad[i] - first) / kTwoPi;
  }
  return band;
}

}  // namespace

SpeedBand BandWithin(const VibrationRun& run, double most_work,
                     const std::function<double(const SpeedBand& band)>& work) {
  const std::vector<double> levels = LevelsOf(run);
  for (std::size_t held = levels.size(); 2 * held >= kLevels; held -= kLevels / 20) {
    // Of the bands with so many turns, the one with the least spread of orders.
    std::size_t best = 0;
    const auto spread = [&](std::size_t from) { return 1.0 / levels[from] - 1.0 / levels[from + held - 1]; };
    for (std::size_t from = 0; from + held <= levels.size(); ++from) {
      if (spread(from) <= spread(best)) best = from;
    }
    const SpeedBand band = BandOf(run, levels[best], levels[best + held - 1]);
    if (work(band) <= most_work) return band;
  }
  return {};
}

}  // namespace strainwave::analysis::diagnosis
