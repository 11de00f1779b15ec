// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/pictures.h"

#include <map>
#include <optional>

#include <fmt/core.h>

#include "analysis/units.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/cycle_context.h"
#include "bench/campaign/recompute.h"
#include "bench/plots/hysteresis_picture.h"
#include "bench/plots/transmission_error_picture.h"
#include "bench/plots/trend_picture.h"

namespace strainwave::bench {
namespace {

// Keeps what the curves' spans look at.
struct DrawnCycle {
  std::vector<NamedRecord> records;
  CycleAnalysis analysis;
  std::vector<double> twist_rad;
  std::vector<double> torque_Nm;
};

// The gear's own twist: what the bench adds in series is taken off, as it is for the fit.
std::vector<double> TwistOf(const daq::Record& record, double compliance_rad_per_Nm) {
  std::vector<double> twist_rad;
  const auto angle_deg = record.Doubles("output_angle_deg");
  const auto torque_Nm = record.Doubles("torque_Nm");
  for (std::size_t i = 0; i < angle_deg.size(); ++i) {
    twist_rad.push_back(RadFromDeg(angle_deg[i] - angle_deg.front()) - compliance_rad_per_Nm * torque_Nm[i]);
  }
  return twist_rad;
}

HysteresisCurve CurveOf(std::string label, const analysis::TorsionalStiffness& stiffness,
                        std::span<const double> twist_rad, std::span<const double> torque_Nm,
                        const analysis::TestTorques& torques) {
  HysteresisCurve curve;
  curve.label = std::move(label);
  curve.twist_rad = twist_rad;
  curve.torque_Nm = torque_Nm;
  curve.fitted_torque_Nm = stiffness.fitted_torque_Nm;
  curve.torques = torques;
  curve.k1_Nm_per_rad = stiffness.k1_Nm_per_rad;
  curve.k2_Nm_per_rad = stiffness.k2_Nm_per_rad;
  curve.k3_Nm_per_rad = stiffness.k3_Nm_per_rad;
  curve.friction_torque_Nm = stiffness.friction_torque_Nm;
  return curve;
}

DrawnCycle Load(const CampaignFolder& folder, const Journal& journal, int cycle,
                const CycleContext& context) {
  DrawnCycle drawn;
  drawn.records = ReadCycleRecords(folder, journal, cycle);
  drawn.analysis = AnalyzeCycle(drawn.records, context);
  if (drawn.analysis.loop != nullptr) {
    drawn.twist_rad =
        TwistOf(*drawn.analysis.loop, context.corrections.series_compliance.compliance_rad_per_Nm.value);
    const auto torque = drawn.analysis.loop->Doubles("torque_Nm");
    drawn.torque_Nm.assign(torque.begin(), torque.end());
  }
  return drawn;
}

bool DrawTrendPicture(const Journal& journal, const std::string& title, const std::filesystem::path& stem) {
  struct Series {
    std::vector<double> cycle, value, standard_error;
  };
  const std::vector<std::tuple<const char*, const char*, const char*>> wanted{
      {"k1_Nm_per_rad", "K₁", "Nm/rad"},
      {"k2_Nm_per_rad", "K₂", "Nm/rad"},
      {"k3_Nm_per_rad", "K₃", "Nm/rad"},
      {"e_max_arcmin", "e_max", "arcmin"}};
  std::map<std::string, Series> series;
  for (const auto& [quantity, label, unit] : wanted) {
    journal.ForEachResult(quantity, [&, name = std::string_view(quantity)](const CycleResult& row) {
      if (row.result.quantity != name) return true;
      Series& one = series[row.result.quantity];
      one.cycle.push_back(row.cycle);
      one.value.push_back(row.result.value);
      one.standard_error.push_back(row.result.standard_error);
      return true;
    });
  }
  std::vector<Trend> trends;
  for (const auto& [quantity, label, unit] : wanted) {
    const auto found = series.find(quantity);
    if (found == series.end() || found->second.cycle.size() < 2) continue;
    trends.push_back({label, unit, found->second.cycle, found->second.value, found->second.standard_error});
  }
  if (trends.empty()) return false;
  DrawTrends(title, trends, stem);
  return true;
}

}  // namespace

std::vector<std::filesystem::path> DrawCampaign(const CampaignFolder& folder, const Journal& journal,
                                                const std::filesystem::path& into) {
  std::vector<int> complete;
  for (const CycleRow& row : journal.Cycles()) {
    if (row.cycle > 0 && row.outcome == "complete") complete.push_back(row.cycle);
  }
  if (complete.empty()) return {};
  const CampaignInputs inputs = ReadFrozenInputs(folder);
  const CycleContext context = ContextOf(journal, inputs.schedule, inputs.bench);
  const std::string title = fmt::format("{}, {}", inputs.schedule.specimen.identity, inputs.schedule.name);
  const DrawnCycle first = Load(folder, journal, complete.front(), context);
  std::optional<DrawnCycle> last;
  if (complete.size() > 1) last = Load(folder, journal, complete.back(), context);

  std::vector<std::filesystem::path> pictures;
  const auto& specimen = inputs.schedule.specimen;
  const analysis::TestTorques torques{specimen.t1_Nm, specimen.t2_Nm, specimen.t3_Nm};
  const auto label = [&](int cycle) { return fmt::format("cycle {}", cycle); };
  if (first.analysis.stiffness) {
    const auto curve = [&](const DrawnCycle& drawn, int cycle) {
      // One loop at its own lock angle; the table's values are means over the angles.
      const std::string angle = drawn.analysis.loop->Metadata("lock_angle_deg").value_or("");
      return CurveOf(angle.empty() ? label(cycle) : fmt::format("{} at lock angle {}°", label(cycle), angle),
                     *drawn.analysis.stiffness, drawn.twist_rad, drawn.torque_Nm, torques);
    };
    std::optional<HysteresisCurve> second;
    if (last && last->analysis.stiffness) second = curve(*last, complete.back());
    pictures.push_back(into / "hysteresis");
    DrawHysteresis(title, curve(first, complete.front()), second, pictures.back());
  }
  if (first.analysis.transmission_error) {
    std::optional<TransmissionErrorCurve> second;
    if (last && last->analysis.transmission_error) {
      second = TransmissionErrorCurve{label(complete.back()), *last->analysis.transmission_error};
    }
    pictures.push_back(into / "transmission_error");
    DrawTransmissionError(title, {label(complete.front()), *first.analysis.transmission_error}, second,
                          pictures.back());
  }
  if (DrawTrendPicture(journal, title, into / "trends")) pictures.push_back(into / "trends");
  return pictures;
}

std::vector<std::filesystem::path> DrawRecord(const daq::Record& record, analysis::StiffnessMethod method,
                                              const std::filesystem::path& into) {
  const std::filesystem::path source = record.source.file;
  const std::filesystem::path stem = into / fmt::format("{}_{}", source.stem().string(), record.kind);
  if (record.kind == "transmission_error") {
    DrawTransmissionError(source.filename().string(), {record.kind, TransmissionErrorOf(record, {})},
                          std::nullopt, stem);
    return {stem};
  }
  if (record.kind != "hysteresis") return {};
  const auto stiffness = StiffnessOf(record, method, {});
  const std::vector<double> twist_rad = TwistOf(record, 0.0);
  DrawHysteresis(
      source.filename().string(),
      CurveOf("measured", stiffness, twist_rad, record.Doubles("torque_Nm"), TestTorquesOf(record)),
      std::nullopt, stem);
  return {stem};
}

}  // namespace strainwave::bench
