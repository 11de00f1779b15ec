// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bench/campaign/folder.h"
#include "bench/integrity/campaign_integrity.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Ranges of the output torque by size: class i holds those from i widths up to the next. All classes there
/// are have the same width.
struct LoadSpectrum {
  struct Class {
    double cycles{};
    double mean_sum_Nm{};  // of the middles of the ranges, each as often as it was counted
    double reversals{};    // between + and − rated torque that would do as much (cube law)
  };
  double width_Nm{};
  std::vector<Class> classes;
  double largest_Nm{};  // range

  double cycles() const;
  double reversals() const;
};

/// Output torque of a campaign, counted as rainflow over all of its complete cycles.
struct LoadHistory {
  LoadSpectrum ran;
  LoadSpectrum planned;             // of the same cycles
  int cycles_read{};                // the preparation among them
  std::vector<int> cycles_missing;  // whose file is not whole, or has no record of torque
};

/// Counts the torque of every cycle file that is whole. Of a load run the smallest and the largest torque in
/// each row, which hold all readings of the control loop; of the measurements what was recorded. Phases begin
/// and end without torque. The blank test is left out: the gear is not in it.
/// @param cycles  complete ones, in order; 0 is the preparation.
/// @throws daq::RecordError for a file that is whole and yet cannot be read.
LoadHistory ReadLoadHistory(const CampaignFolder& folder, const CampaignIntegrity& integrity,
                            const schedules::Schedule& schedule, const std::vector<int>& cycles);

/// Share of the bearing's L10 that load runs have used up (cube law, Miner), as planned and as measured.
struct LoadRunShare {
  std::string phase;
  double planned{};
  double measured{};
  int runs{};           // of complete cycles, by the plan
  int runs_measured{};  // that have their equivalent time
};

/// @param equivalent_s  sum and number of the results "PHASE_equivalent_s" (bench/campaign/load_results.h) of
///   the complete cycles, by phase.
/// @param complete  cycles, without the preparation.
std::vector<LoadRunShare> LoadRunShares(const schedules::Schedule& schedule, int complete,
                                        const std::map<std::string, std::pair<double, int>>& equivalent_s);

}  // namespace strainwave::bench
