// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/make_study.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/campaign/campaign.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/campaign/record_context.h"
#include "bench/diagnosis/campaign_data.h"
#include "bench/errors/bench_error.h"
#include "bench/records/look_at_samples.h"
#include "bench/records/record_data.h"
#include "bench/records/record_refusal.h"
#include "daq/record_rules.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;
using daq::Record;

template <typename Data>
std::vector<Data> AllOf(std::span<const Record> records, Data (*data_of)(const Record&)) {
  std::vector<Data> all;
  for (const Record& record : records) all.push_back(data_of(record));
  return all;
}

void RefuseSimulation(const RecordChoice& choice, StudyKind kind, const std::string& file) {
  if (!choice.simulated || kind == StudyKind::kMotion) return;
  throw BenchError(ExitCode::kWrongInput,
                   fmt::format("{}: error: a record of kind {} is not judged by simulation (expected one of "
                               "kind motion, or no --judge-by-simulation)",
                               file, NameOf(kind)));
}

MappingContext MappingOf(const Record& record) {
  MappingContext mapping;
  mapping.ratio = daq::MetadataNumber(record, "ratio").value_or(mapping.ratio);
  mapping.t1_Nm = daq::MetadataNumber(record, "t1_Nm").value_or(mapping.t1_Nm);
  mapping.t2_Nm = daq::MetadataNumber(record, "t2_Nm").value_or(mapping.t2_Nm);
  if (record.FindColumn("time_s") != nullptr) {
    const std::vector<double> time_s = record.CopyAsDoubles("time_s");
    mapping.duration_s = time_s.back() - time_s.front();
  }
  if (record.FindColumn("temperature_degC") != nullptr) {
    const std::vector<double> temperature_degC = record.CopyAsDoubles("temperature_degC");
    const double sum = std::accumulate(temperature_degC.begin(), temperature_degC.end(), 0.0);
    mapping.temperature_degC = sum / static_cast<double>(temperature_degC.size());
  }
  if (record.kind == daq::RecordKind::kVibration) {
    const auto data = VibrationDataOf(record);
    if (!data.input_speed_rad_per_s.empty())
      mapping.input_speed_rad_per_s = data.input_speed_rad_per_s.front();
  }
  return mapping;
}

// The study of all, or the words of what is wrong at the record that it is wrong with.
std::unique_ptr<diagnosis::Study> MakeStudyOrSay(std::span<const Record> records) {
  try {
    return MakeStudy(records);
  } catch (const std::invalid_argument& error) {
    for (const Record& record : records) {
      if (records.size() == 1) break;
      try {
        MakeStudy({&record, 1});
      } catch (const std::invalid_argument& alone) {
        throw RecordRefusal(record, alone.what());
      }
    }
    throw RecordRefusal(records.front(), error.what());
  }
}

StudyInput ReadCampaign(const std::string& path) {
  const CampaignFolder folder{path};
  const Journal journal = OpenCampaign(folder, Database::Mode::kReadOnly);
  const CampaignInputs inputs = ReadFrozenInputs(folder, journal);
  StudyInput input;
  const diagnosis::CampaignData& data = input.campaign.emplace(CampaignDataOf(folder, journal));
  input.kind = StudyKind::kCampaign;
  input.records.push_back({path, "", Sha256OfFile(folder.Journal()), data.cycle.size()});
  const auto& specimen = inputs.schedule.specimen;
  input.mapping.ratio = specimen.ratio;
  input.mapping.t1_Nm = specimen.t1_Nm;
  input.mapping.t2_Nm = specimen.t2_Nm;
  try {
    input.study = diagnosis::MakeCampaignStudy(data);
  } catch (const std::invalid_argument& error) {
    throw BenchError(ExitCode::kWrongInput, fmt::format("{}: error: {}", path, error.what()));
  }
  return input;
}

// Its noise would count twice, and make chance look like evidence.
void RefuseTheSameTwice(const Record& record, std::span<const RecordIdentity> before,
                        const std::string& sha256) {
  for (const RecordIdentity& other : before) {
    if (other.sha256 == sha256 && other.group == record.source.group) {
      throw RecordRefusal(
          record,
          fmt::format("holds the same record as {} before it (expected each record once)", other.file));
    }
  }
}

void AddStudyWarnings(StudyInput& input) {
  for (const std::string& warning : input.study->warnings()) {
    // Of several records it says itself which one it means.
    input.warnings.push_back({input.records.size() == 1 ? input.records.front().file : "", 0, warning});
  }
}

}  // namespace

std::vector<std::string> StudyInput::WarningTexts() const {
  return bench::WarningTexts(warnings, records.size() > 1 ? NamedFiles::kYes : NamedFiles::kNo);
}

std::unique_ptr<diagnosis::Study> MakeStudy(std::span<const Record> records) {
  const std::optional<StudyKind> kind = StudyKindOf(records.front().kind);
  if (kind == StudyKind::kTransmissionError)
    return diagnosis::MakeTransmissionErrorStudy(AllOf(records, TransmissionErrorDataOf));
  if (kind == StudyKind::kHysteresis) return diagnosis::MakeHysteresisStudy(AllOf(records, HysteresisDataOf));
  if (kind == StudyKind::kMotion) return diagnosis::MakeMotionStudy(AllOf(records, MotionDataOf));
  return diagnosis::MakeVibrationStudy(AllOf(records, VibrationDataOf), OnAllProcessors);
}

std::vector<Record> ReadChosenRecords(const std::vector<std::string>& paths, const RecordChoice& choice) {
  std::vector<Record> records;
  std::set<std::string> kinds;
  for (const std::string& path : paths) {
    if (std::filesystem::is_directory(path)) {
      throw BenchError(ExitCode::kWrongInput,
                       fmt::format("{}: error: a campaign stands beside other paths (expected one "
                                   "campaign folder alone, or record files)",
                                   path));
    }
    for (Record& record : choice.reader.Read(path)) {
      if (!choice.group.empty() && record.source.group.find(choice.group) == std::string::npos) continue;
      const bool diagnosed = StudyKindOf(record.kind).has_value();
      if (choice.kind.empty() ? !diagnosed && record.source.first_data_line == 0
                              : record.kind.name() != choice.kind)
        continue;
      if (!diagnosed) {
        throw RecordRefusal(record, fmt::format("a record of kind {} cannot be diagnosed (expected {})",
                                                record.kind.name(), kDiagnosedKinds));
      }
      LookAtSamples(record);
      kinds.emplace(record.kind.name());
      records.push_back(std::move(record));
    }
  }
  if (records.empty()) {
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("{}: error: no record to diagnose{}{} (expected {})", paths.front(),
                    choice.kind.empty() ? "" : " of kind " + choice.kind,
                    choice.group.empty() ? "" : " in a group with '" + choice.group + "' in its name",
                    kDiagnosedKinds));
  }
  if (kinds.size() > 1) {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("{}: error: the records are of {} kinds: {} (expected one kind; --kind "
                                 "chooses it)",
                                 paths.front(), kinds.size(), fmt::join(kinds, ", ")));
  }
  return records;
}

StudyInput StudyInputOf(std::vector<Record> records, const RecordChoice& choice) {
  StudyInput input;
  input.kind = *StudyKindOf(records.front().kind);
  RefuseSimulation(choice, input.kind, records.front().source.file);
  input.mapping = MappingOf(records.front());
  std::optional<CampaignBeside> beside;
  for (Record& record : records) {
    const bool same_file = !input.records.empty() && input.records.back().file == record.source.file;
    std::string sha256 = same_file ? input.records.back().sha256 : Sha256(ReadText(record.source.file));
    RefuseTheSameTwice(record, input.records, sha256);
    input.records.push_back({record.source.file, record.source.group, std::move(sha256), record.rows()});
    if (!same_file) beside = FindCampaignBeside(record.source.file);
    const RecordContext context = ContextOfRecord(record, beside);
    for (const std::string& warning : context.warnings) record.notes.push_back({0, warning});
    for (const std::string& note : context.notes)
      if (std::ranges::find(input.notes, note) == input.notes.end()) input.notes.push_back(note);
    if (record.kind == daq::RecordKind::kVibration && !record.Metadata("ratio"))
      record.notes.push_back({0, "metadata ratio is missing: the default of 80 is taken"});
    record = Corrected(std::move(record), context.corrections);
    for (RecordWarning& warning : WarningsOf(record)) input.warnings.push_back(std::move(warning));
  }
  input.study = MakeStudyOrSay(records);
  if (choice.simulated)
    input.simulate = diagnosis::SimulateMotion(AllOf<diagnosis::MotionData>(records, MotionDataOf));
  AddStudyWarnings(input);
  return input;
}

StudyInput ReadStudyInput(const std::vector<std::string>& paths, const RecordChoice& choice) {
  if (paths.size() != 1 || !std::filesystem::is_directory(paths.front()))
    return StudyInputOf(ReadChosenRecords(paths, choice), choice);
  StudyInput input = ReadCampaign(paths.front());
  RefuseSimulation(choice, input.kind, paths.front());
  AddStudyWarnings(input);
  return input;
}

}  // namespace strainwave::bench
