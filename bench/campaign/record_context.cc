// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/record_context.h"

#include <charconv>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/units.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/cycle_context.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

bool IsBlank(const daq::Record& record) { return record.source.group.find("/blank_") != std::string::npos; }

// As AnalyzeCycle takes them off: only a lock test has torque enough to twist the couplings.
std::vector<std::string> TakenOf(const daq::Record& record, const BenchCorrections& corrections) {
  std::vector<std::string> taken;
  if (record.kind == daq::RecordKind::kHysteresis && KnowsCompliance(corrections)) {
    const analysis::Estimate& compliance = corrections.series_compliance.compliance_rad_per_Nm;
    const analysis::Estimate arcmin{ArcminFromRad(compliance.value),
                                    ArcminFromRad(compliance.standard_error)};
    taken.push_back(
        fmt::format("the bench's compliance of {} (blank test)", EstimateText(arcmin, "arcmin/Nm")));
  }
  if (record.kind == daq::RecordKind::kTransmissionError && !corrections.encoder.harmonics.empty())
    taken.push_back("the output encoder's error, once and twice a turn (blank test)");
  const auto skew_us = daq::NumberFromText(record.Metadata("encoder_skew_us").value_or(""));
  if (skew_us && record.Metadata("encoder_skew_taken_out") == "true")
    taken.push_back(fmt::format("{:.3g} us between the two encoders (when it was measured)", *skew_us));
  return taken;
}

}  // namespace

std::optional<CampaignBeside> FindCampaignBeside(const std::filesystem::path& file) {
  const std::filesystem::path whole = std::filesystem::absolute(file).lexically_normal();
  const CampaignFolder folder{whole.parent_path().parent_path()};
  const std::string stem = whole.stem().string();
  int cycle = 0;
  const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), cycle);
  const bool is_cycle =
      error == std::errc() && end == stem.data() + stem.size() && whole == folder.CycleFile(cycle);
  if (!is_cycle || !std::filesystem::exists(folder.Journal())) return std::nullopt;
  const Journal journal = OpenCampaign(folder, Database::Mode::kReadOnly);
  const CampaignInputs inputs = ReadFrozenInputs(folder, journal);
  const std::string sha256 = journal.RecordsSha256(cycle);
  return CampaignBeside{folder.root.string(), sha256.empty() || Sha256OfFile(file) == sha256,
                        ContextOf(journal, inputs.schedule, inputs.bench).corrections,
                        inputs.schedule.specimen};
}

RecordContext ContextOfRecord(const daq::Record& record, const std::optional<CampaignBeside>& campaign) {
  RecordContext context;
  const bool is_loop = record.kind == daq::RecordKind::kHysteresis;
  if (!campaign) {
    // What only a bench of this program writes.
    if (is_loop && record.Metadata("lock_angle_deg")) {
      context.warnings.push_back(
          "the campaign that this loop was measured in is not beside it: K holds the bench's compliance, "
          "which its blank test knows");
    }
    return context;
  }
  context.campaign = campaign->folder;
  if (!campaign->has_stored_it) {
    context.warnings.push_back(
        fmt::format("this is not the file that the campaign in {} has stored: nothing that it knows is taken",
                    campaign->folder));
    return context;
  }
  if (IsBlank(record)) {
    context.warnings.push_back("a blank test: what it measures is the bench, not a gear");
    return context;
  }
  const schedules::Specimen& specimen = campaign->specimen;
  for (const auto& [key, of_campaign] :
       {std::pair{"ratio", specimen.ratio}, std::pair{"t1_Nm", specimen.t1_Nm},
        std::pair{"t2_Nm", specimen.t2_Nm}, std::pair{"t3_Nm", specimen.t3_Nm}}) {
    const auto said = daq::NumberFromText(record.Metadata(key).value_or(""));
    if (said && *said != of_campaign)
      context.warnings.push_back(fmt::format("{} is {:g} in the record and {:g} in the campaign's schedule",
                                             key, *said, of_campaign));
  }
  context.corrections = campaign->corrections;
  if (is_loop && !KnowsCompliance(context.corrections))
    context.warnings.push_back(fmt::format("K {} (the campaign in {})", kNoBlankFlag, campaign->folder));
  const std::vector<std::string> taken = TakenOf(record, context.corrections);
  if (!taken.empty()) {
    context.notes.push_back(
        fmt::format("taken off, as the campaign in {} does: {}", campaign->folder, fmt::join(taken, "; ")));
  }
  return context;
}

daq::Record Corrected(daq::Record record, const BenchCorrections& corrections) {
  const bool is_loop = record.kind == daq::RecordKind::kHysteresis;
  if (!is_loop && record.kind != daq::RecordKind::kTransmissionError) return record;
  std::vector<double> angle_deg = record.CopyAsDoubles("output_angle_deg");
  if (is_loop) {
    const double compliance = DegFromRad(corrections.series_compliance.compliance_rad_per_Nm.value);
    const std::vector<double> torque_Nm = record.CopyAsDoubles("torque_Nm");
    for (std::size_t i = 0; i < angle_deg.size(); ++i) angle_deg[i] -= compliance * torque_Nm[i];
  } else {
    const std::vector<double> read_deg = angle_deg;
    for (std::size_t i = 0; i < angle_deg.size(); ++i)
      angle_deg[i] -= DegFromRad(corrections.encoder.At(read_deg[i]) - corrections.encoder.At(read_deg[0]));
  }
  record.SetColumn("output_angle_deg", std::move(angle_deg));
  return record;
}

}  // namespace strainwave::bench
