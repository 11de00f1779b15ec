// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/record_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "analysis/diagnosis/hysteresis/checks.h"
#include "analysis/quantities.h"
#include "analysis/units.h"
#include "bench/campaign/record_results.h"
#include "bench/commands/error_text.h"
#include "bench/errors/bench_error.h"
#include "bench/records/record_data.h"
#include "bench/text.h"

namespace strainwave::bench {
namespace {

using analysis::Quantity;
using analysis::StiffnessMethod;
namespace quantities = analysis::quantities;

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

// JSON null and no error where there is no value.
void AddEstimate(nlohmann::json& report, const std::string& name, const analysis::Estimate& estimate) {
  report[name] = estimate.value;
  report[name + "_se"] = estimate.standard_error;
}

void AddAngle(nlohmann::json& report, const Quantity& quantity, const analysis::Estimate& estimate_rad,
              const RecordContext& context) {
  const analysis::Estimate arcmin{ArcminFromRad(estimate_rad.value),
                                  ArcminFromRad(estimate_rad.standard_error)};
  AddEstimate(report, std::string(quantity.name),
              WithEncoderUncertainty(arcmin, quantity, context.corrections));
}

nlohmann::json TransmissionErrorJson(const daq::Record& record, const RecordContext& context) {
  const analysis::TransmissionError error = TransmissionErrorOf(record, context.corrections);
  nlohmann::json report{{"kind", "transmission_error"}};
  // e_avg and e_max are those of the clockwise sweep (docs/contract.md#transmission-error).
  if (error.cw) {
    AddAngle(report, quantities::kEAvg, error.cw->e_avg_rad, context);
    AddAngle(report, quantities::kEMax, error.cw->e_max_rad, context);
    report["orders"] = Orders(error.cw->orders);
  }
  if (error.ccw) {
    AddAngle(report, quantities::kEAvgCcw, error.ccw->e_avg_rad, context);
    AddAngle(report, quantities::kEMaxCcw, error.ccw->e_max_rad, context);
  }
  if (error.lost_motion_rad) AddAngle(report, quantities::kLostMotion, *error.lost_motion_rad, context);
  report["failed_checks"] = error.failed_checks;
  report["notes"] = error.notes;
  return report;
}

void AddStiffness(nlohmann::json& report, const analysis::TorsionalStiffness& stiffness,
                  const RecordContext& context) {
  const auto add = [&](const Quantity& quantity, const analysis::Estimate& k) {
    AddEstimate(report, std::string(quantity.name),
                WithBenchUncertainty(k, quantity.name, context.corrections));
  };
  add(quantities::kK1, stiffness.k1_Nm_per_rad);
  add(quantities::kK2, stiffness.k2_Nm_per_rad);
  add(quantities::kK3, stiffness.k3_Nm_per_rad);
}

// What diagnose says of such a loop before it looks for causes: units mixed up, all three slopes moved alike.
void AddWarnings(const daq::Record& record, const analysis::TorsionalStiffness& stiffness,
                 const RecordContext& context, nlohmann::json& warnings) {
  const analysis::diagnosis::HysteresisData data = HysteresisDataOf(Corrected(record, context.corrections));
  const auto [low_rad, high_rad] = std::ranges::minmax(data.output_angle_rad);
  const auto [low_Nm, high_Nm] = std::ranges::minmax(data.torque_Nm);
  for (const std::string& odd : analysis::diagnosis::OddThingsAbout(
           data, high_rad - low_rad, std::max(std::abs(low_Nm), std::abs(high_Nm))))
    warnings.push_back(odd);
  const double k[] = {stiffness.k1_Nm_per_rad.value, stiffness.k2_Nm_per_rad.value,
                      stiffness.k3_Nm_per_rad.value};
  if (!std::ranges::all_of(k, [](double slope) { return std::isfinite(slope) && slope > 0.0; })) return;
  const std::string common = analysis::diagnosis::CommonStiffnessChange(k, data.t1_Nm, data.t2_Nm);
  if (!common.empty()) warnings.push_back(common);
}

nlohmann::json HysteresisJson(const daq::Record& record, StiffnessMethod method,
                              const RecordContext& context) {
  const auto stiffness = StiffnessOf(record, method, context.corrections);
  nlohmann::json report{{"kind", "hysteresis"}};
  AddStiffness(report, stiffness, context);
  AddAngle(report, quantities::kHysteresis, stiffness.hysteresis_rad, context);
  AddAngle(report, quantities::kHysteresisLostMotion, stiffness.lost_motion_rad, context);
  if (method == StiffnessMethod::kModel) {
    report[quantities::kFrictionTorque.name] = stiffness.friction_torque_Nm;
    report[quantities::kYieldTwist.name] = ArcminFromRad(stiffness.yield_twist_rad);
    report[quantities::kStiffnessResidual.name] = stiffness.rms_residual_Nm;
  }
  report["failed_checks"] = stiffness.failed_checks;
  report["warnings"] = stiffness.warnings;
  AddWarnings(record, stiffness, context, report["warnings"]);
  nlohmann::json methods;
  for (const StiffnessMethod other : analysis::kStiffnessMethods) {
    nlohmann::json row;
    AddStiffness(row, other == method ? stiffness : StiffnessOf(record, other, context.corrections), context);
    methods[NameOf(other)] = std::move(row);
  }
  report["methods"] = std::move(methods);
  return report;
}

// "27648 ± 160": as many digits as the error has; a dash where there is no value, none behind ± where the
// error is not known.
std::string ValueText(const nlohmann::json& report, const std::string& key) {
  const double value = report[key].get<double>();
  if (!std::isfinite(value)) return fmt::format("{:>12}", "–");
  const std::string se = key + "_se";
  return report.contains(se) ? fmt::format("{:12.5g} ± {}", value, ErrorText(report[se].get<double>()))
                             : fmt::format("{:12.5g}", value);
}

}  // namespace

nlohmann::json RecordJson(const daq::Record& record, StiffnessMethod method, const RecordContext& context) {
  if (record.kind != daq::RecordKind::kTransmissionError && record.kind != daq::RecordKind::kHysteresis) {
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("{}: error: kind '{}' has nothing to recompute (expected transmission_error or "
                    "hysteresis)",
                    record.source.file, record.kind.name()));
  }
  nlohmann::json report = record.kind == daq::RecordKind::kHysteresis
                              ? HysteresisJson(record, method, context)
                              : TransmissionErrorJson(record, context);
  if (!context.campaign.empty()) report["campaign"] = context.campaign;
  for (const std::string& note : context.notes) report["notes"].push_back(note);
  return report;
}

std::string RecordText(const nlohmann::json& report, const std::string& source) {
  std::string text = fmt::format("{}: {}\n", source, report["kind"].get<std::string>());
  for (const auto& [key, value] : report.items()) {
    if (!value.is_number() || key.ends_with("_se")) continue;
    text += Text("  {:28} {}\n", key, ValueText(report, key));
  }
  if (report.contains("methods")) {
    text += fmt::format("  {:20}{:>19}{:>17}{:>17}  {}\n", "methods side by side", quantities::kK1.symbol,
                        quantities::kK2.symbol, quantities::kK3.symbol, quantities::kK1.unit());
    for (const auto& [name, row] : report["methods"].items()) {
      text += fmt::format("    {:20}", name);
      for (const Quantity& quantity : analysis::kStiffnesses) {
        const std::string k(quantity.name);
        const double value = row[k].get<double>();
        text += std::isfinite(value)
                    ? fmt::format(" {:7.0f} ± {:<6}", value, ErrorText(row[k + "_se"].get<double>()))
                    : fmt::format(" {:>7}         ", "–");
      }
      text += "\n";
    }
  }
  if (report.contains("orders")) {
    text += "  order a turn (output, input)   amplitude, arcmin\n";
    for (const auto& row : report["orders"]) {
      text += fmt::format("    {:8.2f} {:8.4f}           {}  {}\n", row["order_per_output_rev"].get<double>(),
                          row["order_per_input_rev"].get<double>(), ValueText(row, "amplitude_arcmin"),
                          row["name"].get<std::string>());
    }
  }
  for (const auto& note : report.value("notes", nlohmann::json::array()))
    text += fmt::format("  note: {}\n", note.get<std::string>());
  for (const auto& check : report["failed_checks"]) {
    text += fmt::format("  check failed: {}\n", check.get<std::string>());
  }
  return text;
}

}  // namespace strainwave::bench
