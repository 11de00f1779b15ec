// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "analysis/reliability/degradation_path.h"

namespace strainwave::analysis::reliability {

/// Laws by which a unit comes to its limit, none of them a power of the cycles. On the first three the
/// constants of limit_forecast.cc were chosen; the others are for figures only.
enum class LifeLaw : std::uint8_t {
  kPlantWear,  // stiffness, transmission error or hysteresis of the simulated plant (analysis/model/wear.h)
  kSettling,   // fast at first, then straight
  kGammaProcess,  // independent steps
  kCrackGrowth,   // Paris' law, which runs away
  kWornLayer,     // Archard's wear, faster once a hardened layer is through
  kLogistic,      // begins slowly and saturates
};
inline constexpr LifeLaw kChosenOn[] = {LifeLaw::kPlantWear, LifeLaw::kSettling, LifeLaw::kGammaProcess};
inline constexpr LifeLaw kFiguresOnly[] = {LifeLaw::kCrackGrowth, LifeLaw::kWornLayer, LifeLaw::kLogistic};
const char* NameOf(LifeLaw law);

struct SimulatedLife {
  DegradationPath seen;  // with noise, some of it autocorrelated as by temperature; beyond the limit too
  int met{};             // cycle at which the path without noise is at the limit: 60 to 1500
};

SimulatedLife DrawLife(LifeLaw law, std::mt19937_64& random);

/// The first `share` of the life.
DegradationPath SeenTo(const SimulatedLife& life, double share);
DegradationPath SeenUntil(const SimulatedLife& life, int cycle);

/// Units of one law whose pace is lognormal; those of the gamma process have steps of their own beside.
struct SimulatedPopulation {
  double log_deviation{};            // of the pace, 0.05 to 0.5
  std::vector<double> lives;         // cycles of 1001 such units, in order: the truth
  std::vector<SimulatedLife> units;  // those on the bench
};
SimulatedPopulation DrawPopulation(LifeLaw law, int units, std::mt19937_64& random);

}  // namespace strainwave::analysis::reliability
