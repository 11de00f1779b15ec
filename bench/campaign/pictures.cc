// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/pictures.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>

#include <fmt/core.h>

#include "analysis/quantities.h"
#include "analysis/units.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/cycle_context.h"
#include "bench/campaign/cycle_curves.h"
#include "bench/plots/hysteresis_picture.h"
#include "bench/plots/transmission_error_picture.h"
#include "bench/plots/trend_picture.h"

namespace strainwave::bench {
namespace {

namespace quantities = analysis::quantities;

HysteresisCurve CurveOf(std::string label, const analysis::TorsionalStiffness& stiffness,
                        std::span<const double> twist_rad, std::span<const double> torque_Nm,
                        const analysis::TestTorques& torques, const BenchCorrections& corrections) {
  HysteresisCurve curve;
  curve.label = std::move(label);
  curve.twist_rad = twist_rad;
  curve.torque_Nm = torque_Nm;
  curve.fitted_torque_Nm = stiffness.fitted_torque_Nm;
  curve.torques = torques;
  curve.k1_Nm_per_rad = WithBenchUncertainty(stiffness.k1_Nm_per_rad, quantities::kK1.name, corrections);
  curve.k2_Nm_per_rad = WithBenchUncertainty(stiffness.k2_Nm_per_rad, quantities::kK2.name, corrections);
  curve.k3_Nm_per_rad = WithBenchUncertainty(stiffness.k3_Nm_per_rad, quantities::kK3.name, corrections);
  curve.friction_torque_Nm = stiffness.friction_torque_Nm;
  return curve;
}

std::optional<std::filesystem::path> DrawTrendPicture(const Journal& journal, const std::string& title,
                                                      const std::filesystem::path& stem) {
  struct Series {
    std::vector<double> cycle, value, standard_error;
  };
  constexpr std::array kDrawn{quantities::kK1, quantities::kK2, quantities::kK3, quantities::kEMax};
  std::array<Series, kDrawn.size()> series;
  for (std::size_t k = 0; k < kDrawn.size(); ++k) {
    journal.ForEachResult(kDrawn[k].name, [&](const CycleResult& row) {
      if (row.result.quantity != kDrawn[k].name || !std::isfinite(row.result.value)) return true;
      Series& one = series[k];
      one.cycle.push_back(row.cycle);
      one.value.push_back(row.result.value);
      one.standard_error.push_back(row.result.standard_error);
      return true;
    });
  }
  std::vector<Trend> trends;
  for (std::size_t k = 0; k < kDrawn.size(); ++k) {
    const Series& one = series[k];
    if (one.cycle.size() < 2) continue;
    trends.push_back({std::string(kDrawn[k].title), std::string(kDrawn[k].unit()), one.cycle, one.value,
                      one.standard_error});
  }
  if (trends.empty()) return std::nullopt;
  return DrawTrends(title, trends, stem);
}

std::string NameOfCampaign(const std::filesystem::path& root) {
  return std::filesystem::weakly_canonical(root).filename().string();
}

// What a picture of a record is called: by its campaign and cycle or its file, its group, its lock angle.
struct DrawnRecord {
  std::string stem;
  std::string title;
};

DrawnRecord NamesOf(const daq::Record& record) {
  const std::filesystem::path source = std::filesystem::absolute(record.source.file);
  DrawnRecord names{source.stem().string(), source.filename().string()};
  const std::filesystem::path folder = source.parent_path();
  if (folder.filename() == "cycles" && std::filesystem::exists(folder.parent_path() / "campaign.db")) {
    const std::string campaign = NameOfCampaign(folder.parent_path());
    const int cycle = std::atoi(names.stem.c_str());
    names = {fmt::format("{}_cycle_{}", campaign, cycle), fmt::format("{}, cycle {}", campaign, cycle)};
  }
  // "/hysteresis/hysteresis_2" → "hysteresis_2"
  std::string group;
  for (const std::filesystem::path& part : std::filesystem::path(record.source.group).relative_path()) {
    const std::string name = part.string();
    group = group.empty() || name.starts_with(group) ? name : group + "_" + name;
  }
  names.stem += "_" + (group.empty() ? std::string(record.kind.name()) : group);
  if (!group.empty()) names.title += ", " + group;
  if (const auto angle = record.Metadata("lock_angle_deg")) {
    names.stem += fmt::format("_lock_{}deg", *angle);
    names.title += fmt::format(", lock angle {}°", *angle);
  }
  return names;
}

}  // namespace

std::vector<std::filesystem::path> DrawCampaign(const CampaignFolder& folder, const Journal& journal,
                                                const std::filesystem::path& into) {
  std::vector<int> complete;
  for (const CycleRow& row : journal.Cycles()) {
    if (row.cycle > 0 && row.outcome == "complete") complete.push_back(row.cycle);
  }
  if (complete.empty()) return {};
  const CampaignInputs inputs = ReadFrozenInputs(folder, journal);
  const CycleContext context = ContextOf(journal, inputs.schedule, inputs.bench);
  const std::string title = fmt::format("{}, {}", inputs.schedule.specimen.identity, inputs.schedule.name);
  const CycleCurves first = ReadCycleCurves(folder, journal, complete.front(), context);
  std::optional<CycleCurves> last;
  if (complete.size() > 1) last = ReadCycleCurves(folder, journal, complete.back(), context);

  std::vector<std::filesystem::path> pictures;
  const auto& specimen = inputs.schedule.specimen;
  const analysis::TestTorques torques{specimen.t1_Nm, specimen.t2_Nm, specimen.t3_Nm};
  const auto label = [&](int cycle) { return fmt::format("cycle {}", cycle); };
  const std::string name = NameOfCampaign(folder.root);
  const auto cycles = [&](bool two) {
    return two ? fmt::format("{}_cycles_{}_and_{}", name, complete.front(), complete.back())
               : fmt::format("{}_cycle_{}", name, complete.front());
  };
  if (first.analysis.stiffness) {
    // One loop at its own lock angle; the table's values are means over the angles.
    const std::string angle = first.analysis.loop->Metadata("lock_angle_deg").value_or("");
    const auto curve = [&](const CycleCurves& drawn, int cycle) {
      return CurveOf(label(cycle), *drawn.analysis.stiffness, drawn.twist_rad, drawn.torque_Nm, torques,
                     context.corrections);
    };
    std::optional<HysteresisCurve> second;
    if (last && last->analysis.stiffness) second = curve(*last, complete.back());
    const std::string at = angle.empty() ? "" : fmt::format("_lock_{}deg", angle);
    pictures.push_back(
        DrawHysteresis(angle.empty() ? title : fmt::format("{}, one loop, at lock angle {}°", title, angle),
                       curve(first, complete.front()), second,
                       into / fmt::format("{}_hysteresis{}", cycles(second.has_value()), at)));
  }
  if (first.analysis.transmission_error) {
    std::optional<TransmissionErrorCurve> second;
    if (last && last->analysis.transmission_error) {
      second = TransmissionErrorCurve{label(complete.back()), *last->analysis.transmission_error};
    }
    pictures.push_back(
        DrawTransmissionError(title, {label(complete.front()), *first.analysis.transmission_error}, second,
                              into / fmt::format("{}_transmission_error", cycles(second.has_value()))));
  }
  const auto trends = DrawTrendPicture(
      journal, title,
      into / fmt::format("{}_cycles_{}_to_{}_trends", name, complete.front(), complete.back()));
  if (trends) pictures.push_back(*trends);
  return pictures;
}

std::vector<std::filesystem::path> DrawRecord(const daq::Record& record, analysis::StiffnessMethod method,
                                              const BenchCorrections& corrections,
                                              const std::filesystem::path& into) {
  const DrawnRecord drawn = NamesOf(record);
  if (record.kind == daq::RecordKind::kTransmissionError) {
    analysis::TransmissionError error = TransmissionErrorOf(record, corrections);
    AddUncertainty(corrections, error);
    return {
        DrawTransmissionError(drawn.title, {"measured", std::move(error)}, std::nullopt, into / drawn.stem)};
  }
  if (record.kind != daq::RecordKind::kHysteresis) return {};
  const auto stiffness = StiffnessOf(record, method, corrections);
  const std::vector<double> twist_rad =
      TwistOf(record, corrections.series_compliance.compliance_rad_per_Nm.value);
  return {DrawHysteresis(drawn.title,
                         CurveOf("this record", stiffness, twist_rad, record.Doubles("torque_Nm"),
                                 TestTorquesOf(record), corrections),
                         std::nullopt, into / drawn.stem)};
}

}  // namespace strainwave::bench
