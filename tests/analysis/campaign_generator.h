// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "analysis/diagnosis/records.h"

namespace strainwave::analysis::diagnosis {

/// A campaign out of closed formulas: run-in, creeping wear and a late power law, all drawn from a seed, with
/// scatter that K2 and K3 share in part. What is hidden in it is added afterwards.
struct CampaignDrawing {
  static constexpr std::size_t kSeries = 6;
  CampaignData data;
  std::array<double, kSeries> scatter{};
  std::mt19937 engine;

  CampaignDrawing(unsigned seed, std::size_t cycles) : engine(seed) {
    const std::array<const char*, kSeries> names{"k1_Nm_per_rad", "k2_Nm_per_rad", "k3_Nm_per_rad",
                                                 "e_max_arcmin",  "e_avg_arcmin",  "lost_motion_arcmin"};
    const std::array<double, kSeries> start{16000.0, 25000.0, 29000.0, 1.6, 0.5, 0.9};
    const std::array<double, kSeries> direction{-1.0, -1.0, -1.0, 1.0, 1.0, 1.0};
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    const double total_h = 0.5 * static_cast<double>(cycles);
    const double run_in_h = total_h * (0.02 + 0.1 * uniform(engine));
    const double power = 2.0 + 1.5 * uniform(engine);
    std::array<double, kSeries> run_in{}, slope{}, late{};
    for (std::size_t s = 0; s < kSeries; ++s) {
      scatter[s] = start[s] * (s < 3 ? 0.003 : 0.01);
      run_in[s] = 0.03 * uniform(engine);
      slope[s] = 0.05 * uniform(engine);
      late[s] = 0.03 * uniform(engine);
      data.series.push_back({names[s], {}, {}});
    }
    const double hour_offset = 24.0 * uniform(engine);
    const std::string serials = "torque 17, encoder 4";
    for (std::size_t c = 0; c < cycles; ++c) {
      const double load_h = 0.5 * static_cast<double>(c + 1);
      const double wall_h = 1.1 * static_cast<double>(c) + hour_offset;
      const double u = load_h / total_h;
      data.cycle.push_back(static_cast<double>(c + 1));
      data.load_time_s.push_back(3600.0 * load_h);
      data.time_s.push_back(3600.0 * wall_h);
      data.temperature_degC.push_back(45.0 + 1.5 * std::sin(0.2618 * wall_h) + 0.5 * normal(engine));
      data.sensor_serials.push_back(serials);
      const double shared = normal(engine);
      for (std::size_t s = 0; s < kSeries; ++s) {
        const double grown =
            run_in[s] * (1.0 - std::exp(-load_h / run_in_h)) + slope[s] * u + late[s] * std::pow(u, power);
        const double own = normal(engine);
        const double noise = s == 1 || s == 2 ? 0.6 * shared + 0.8 * own : own;
        data.series[s].value.push_back(start[s] * (1.0 + direction[s] * grown) + scatter[s] * noise);
        data.series[s].standard_error.push_back(0.9 * scatter[s]);
      }
    }
  }

  /// Adds size · scatter from this cycle number on.
  void AddStep(std::size_t series, double from_cycle, double size) {
    for (std::size_t c = 0; c < data.cycle.size(); ++c) {
      if (data.cycle[c] >= from_cycle) data.series[series].value[c] += size * scatter[series];
    }
  }

  /// Adds a slope from this cycle number on, which comes to size · scatter at the end.
  void AddSlope(std::size_t series, double from_cycle, double size) {
    const double last = data.cycle.back();
    for (std::size_t c = 0; c < data.cycle.size(); ++c) {
      const double run = std::max(0.0, data.cycle[c] - from_cycle) / (last - from_cycle);
      data.series[series].value[c] += size * run * scatter[series];
    }
  }

  /// Adds size · scatter for each kelvin off 45 °C.
  void AddTemperature(std::size_t series, double size) {
    for (std::size_t c = 0; c < data.cycle.size(); ++c) {
      data.series[series].value[c] += size * scatter[series] * (data.temperature_degC[c] - 45.0);
    }
  }

  void ReplaceSensor(std::size_t from_row) {
    for (std::size_t c = from_row; c < data.cycle.size(); ++c)
      data.sensor_serials[c] = "torque 23, encoder 4";
  }

  /// Stands still for these hours before that row, and falls back from size · scatter over `recovery` cycles.
  void AddPause(std::size_t series, std::size_t row, double hours, double size, double recovery) {
    for (std::size_t c = row; c < data.cycle.size(); ++c) {
      if (series == 0) data.time_s[c] += 3600.0 * hours;
      data.series[series].value[c] +=
          size * scatter[series] * std::exp(-static_cast<double>(c - row) / recovery);
    }
  }
};

}  // namespace strainwave::analysis::diagnosis
