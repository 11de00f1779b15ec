// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/record_report.h"

#include <fmt/core.h>

#include "analysis/units.h"
#include "bench/campaign/campaign_error.h"
#include "bench/campaign/record_results.h"

namespace strainwave::bench {
namespace {

using analysis::StiffnessMethod;

constexpr std::size_t kOrdersShown = 12;

nlohmann::json Orders(const std::vector<analysis::OrderLine>& lines) {
  nlohmann::json orders = nlohmann::json::array();
  for (const auto& line : lines) {
    if (orders.size() == kOrdersShown) break;
    nlohmann::json row{{"order_per_output_rev", line.order_per_output_rev},
                       {"order_per_input_rev", line.order_per_input_rev},
                       {"amplitude_arcmin", ArcminFromRad(line.amplitude_rad.value)},
                       {"amplitude_arcmin_se", ArcminFromRad(line.amplitude_rad.standard_error)},
                       {"name", line.name}};
    if (line.aliased) row["appears_at_order_per_output_rev"] = line.alias_order_per_output_rev;
    orders.push_back(std::move(row));
  }
  return orders;
}

void AddEstimate(nlohmann::json& report, const std::string& name, const analysis::Estimate& estimate_rad) {
  report[name] = ArcminFromRad(estimate_rad.value);
  report[name + "_se"] = ArcminFromRad(estimate_rad.standard_error);
}

nlohmann::json TransmissionErrorJson(const daq::Record& record) {
  const analysis::TransmissionError error = TransmissionErrorOf(record, {});
  nlohmann::json report{{"kind", "transmission_error"}};
  // e_avg and e_max are those of the clockwise sweep (contract, section 2).
  if (error.cw) {
    AddEstimate(report, "e_avg_arcmin", error.cw->e_avg_rad);
    AddEstimate(report, "e_max_arcmin", error.cw->e_max_rad);
    report["orders"] = Orders(error.cw->orders);
  }
  if (error.ccw) {
    AddEstimate(report, "e_avg_ccw_arcmin", error.ccw->e_avg_rad);
    AddEstimate(report, "e_max_ccw_arcmin", error.ccw->e_max_rad);
  }
  if (error.lost_motion_rad) AddEstimate(report, "lost_motion_arcmin", *error.lost_motion_rad);
  report["failed_checks"] = error.failed_checks;
  report["notes"] = error.notes;
  return report;
}

void AddStiffness(nlohmann::json& report, const analysis::TorsionalStiffness& stiffness) {
  const auto add = [&](const std::string& name, const analysis::Estimate& k) {
    report[name] = k.value;
    report[name + "_se"] = k.standard_error;
  };
  add("k1_Nm_per_rad", stiffness.k1_Nm_per_rad);
  add("k2_Nm_per_rad", stiffness.k2_Nm_per_rad);
  add("k3_Nm_per_rad", stiffness.k3_Nm_per_rad);
}

nlohmann::json HysteresisJson(const daq::Record& record, StiffnessMethod method) {
  const auto stiffness = StiffnessOf(record, method, {});
  nlohmann::json report{{"kind", "hysteresis"}};
  AddStiffness(report, stiffness);
  AddEstimate(report, "hysteresis_arcmin", stiffness.hysteresis_rad);
  AddEstimate(report, "lost_motion_arcmin", stiffness.lost_motion_rad);
  if (method == StiffnessMethod::kModel) {
    report["friction_torque_Nm"] = stiffness.friction_torque_Nm;
    report["yield_twist_arcmin"] = ArcminFromRad(stiffness.yield_twist_rad);
    report["rms_residual_Nm"] = stiffness.rms_residual_Nm;
  }
  report["failed_checks"] = stiffness.failed_checks;
  nlohmann::json methods;
  for (const auto& [name, other] :
       {std::pair{"model", StiffnessMethod::kModel}, std::pair{"loading", StiffnessMethod::kLoading},
        std::pair{"backbone", StiffnessMethod::kBackbone}}) {
    nlohmann::json row;
    AddStiffness(row, other == method ? stiffness : StiffnessOf(record, other, {}));
    methods[name] = std::move(row);
  }
  report["methods"] = std::move(methods);
  return report;
}

}  // namespace

nlohmann::json RecordJson(const daq::Record& record, StiffnessMethod method) {
  if (record.kind == "transmission_error") return TransmissionErrorJson(record);
  if (record.kind == "hysteresis") return HysteresisJson(record, method);
  throw CampaignError(
      ExitCode::kWrongInput,
      fmt::format("{}: error: kind '{}' has nothing to recompute (expected transmission_error or "
                  "hysteresis)",
                  record.source.file, record.kind));
}

std::string RecordText(const nlohmann::json& report, const std::string& source) {
  std::string text = fmt::format("{}: {}\n", source, report["kind"].get<std::string>());
  for (const auto& [key, value] : report.items()) {
    if (!value.is_number() || key.ends_with("_se")) continue;
    text += fmt::format("  {:28} {:12.5g}", key, value.get<double>());
    const std::string se = key + "_se";
    if (report.contains(se) && report[se].is_number())
      text += fmt::format(" ± {:.2g}", report[se].get<double>());
    text += "\n";
  }
  if (report.contains("methods")) {
    text += "  methods side by side              K1          K2          K3  Nm/rad\n";
    for (const auto& [name, row] : report["methods"].items()) {
      const auto number = [&](const char* key) {
        return row[key].is_number() ? row[key].get<double>() : 0.0;
      };
      text += fmt::format("    {:20} {:11.0f} {:11.0f} {:11.0f}\n", name, number("k1_Nm_per_rad"),
                          number("k2_Nm_per_rad"), number("k3_Nm_per_rad"));
    }
  }
  if (report.contains("orders")) {
    text += "  order a turn (output, input)   amplitude, arcmin\n";
    for (const auto& row : report["orders"]) {
      text += fmt::format("    {:8.2f} {:8.4f}           {:8.4f}  {}\n",
                          row["order_per_output_rev"].get<double>(), row["order_per_input_rev"].get<double>(),
                          row["amplitude_arcmin"].get<double>(), row["name"].get<std::string>());
    }
  }
  if (report.contains("notes")) {
    for (const auto& note : report["notes"]) text += fmt::format("  note: {}\n", note.get<std::string>());
  }
  for (const auto& check : report["failed_checks"]) {
    text += fmt::format("  check failed: {}\n", check.get<std::string>());
  }
  return text;
}

}  // namespace strainwave::bench
