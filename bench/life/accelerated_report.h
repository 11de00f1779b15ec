// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/reliability/acceleration.h"
#include "bench/life/times_report.h"

namespace strainwave::bench {

/// Where exponents of torque and speed come from: the catalogue's cube law, L = L_n (T_r/T)³ (N_r/N), as a
/// prior (3 ± 1 and 1 ± 0.5) or as it is; or from the times alone.
enum class Exponents { kPrior, kCatalogue, kFitted };

struct UseLoad {
  std::optional<double> torque_Nm;
  std::optional<double> speed_rpm;
  Exponents exponents{Exponents::kPrior};
};

struct AcceleratedReport {
  UseLoad use;
  std::string unit;
  LifeSettings settings;
  std::vector<std::string> stresses;  // "torque", "speed"
  analysis::reliability::AcceleratedFit fit;
  std::vector<std::string> warnings;
};

/// @throws BenchError (exit code 2) where the table has no such column, or cannot give what is asked.
AcceleratedReport AcceleratedReportOf(const TimesTable& table, const LifeSettings& settings,
                                      const UseLoad& use);

std::string TextOf(const AcceleratedReport& report);
nlohmann::ordered_json JsonOf(const AcceleratedReport& report);

}  // namespace strainwave::bench
