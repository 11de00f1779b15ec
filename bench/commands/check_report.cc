// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/check_report.h"

#include "bench/text.h"

#include <nlohmann/json.hpp>

#include "bench/commands/error_text.h"

namespace strainwave::bench {

std::string CheckText(std::span<const CheckHistory> histories) {
  std::string text;
  for (const CheckHistory& history : histories) {
    text += Text("  {:28} {:12.5g} ± {}, allowed {:.5g} ± {:.5g}", history.quantity, history.last.value,
                 ErrorText(history.last.standard_error), history.limits.expected, history.limits.allowed);
    if (history.trend) {
      text += Text("; {:+.3g} ± {} a day over {} checks", history.trend->slope_per_day,
                   ErrorText(history.trend->slope_standard_error), history.checks);
      text += history.trend->days_left
                  ? Text(", meets the limit in {:.3g} days of bench time", *history.trend->days_left)
                  : ", not towards a limit that can be told";
    }
    if (!history.last.flag.empty()) text += "  " + history.last.flag;
    text += "\n";
  }
  return text;
}

nlohmann::json CheckJson(std::span<const CheckHistory> histories) {
  nlohmann::json rows = nlohmann::json::array();
  for (const CheckHistory& history : histories) {
    nlohmann::json row{{"quantity", history.quantity},
                       {"value", history.last.value},
                       {"standard_error", history.last.standard_error},
                       {"expected", history.limits.expected},
                       {"allowed", history.limits.allowed},
                       {"checks", history.checks},
                       {"flag", history.last.flag}};
    if (history.trend) {
      row["slope_per_day"] = history.trend->slope_per_day;
      row["slope_per_day_se"] = history.trend->slope_standard_error;
      if (history.trend->days_left) row["days_to_limit"] = *history.trend->days_left;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace strainwave::bench
