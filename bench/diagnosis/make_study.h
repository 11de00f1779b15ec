// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/records.h"
#include "analysis/diagnosis/study.h"
#include "bench/diagnosis/plant_mapping.h"
#include "bench/diagnosis/study_kind.h"
#include "bench/records/record_reader.h"
#include "bench/records/record_warnings.h"
#include "daq/record.h"

namespace strainwave::bench {

/// Where a record of a diagnosis is, so that anyone can see later that it is the same one.
struct RecordIdentity {
  std::string file;
  std::string group;   // of an HDF5 file; empty for CSV
  std::string sha256;  // of the whole file
  std::size_t rows{};
};

/// Which records of the files are meant; empty texts take all.
struct RecordChoice {
  std::string kind;
  std::string group;  // part of an HDF5 group's path
  RecordReader reader{};
  bool simulated{};  // causes are to be judged by records simulated without them
};

/// Records of one kind, or a campaign, ready to be diagnosed.
struct StudyInput {
  StudyKind kind{};
  std::vector<RecordIdentity> records;
  std::vector<RecordWarning> warnings;  // what was noticed about the records
  std::vector<std::string> notes;       // what was taken off them, as their campaign does

  std::vector<std::string> WarningTexts() const;
  MappingContext mapping;
  std::optional<analysis::diagnosis::CampaignData> campaign{};  // of a campaign: its results
  std::unique_ptr<analysis::diagnosis::Study> study;
  analysis::diagnosis::SimulateNull simulate{};  // empty unless RecordChoice::simulated
};

inline constexpr std::string_view kDiagnosedKinds = "transmission_error, hysteresis, motion or vibration";

/// The study of records that are all of one kind; nothing is checked but what the study itself checks.
/// @throws std::invalid_argument where they cannot be diagnosed, in words for a technician.
std::unique_ptr<analysis::diagnosis::Study> MakeStudy(std::span<const daq::Record> records);

/// The records of these files that are meant, all of one kind.
/// @throws daq::RecordError for a file that breaks the rules of records; BenchError for mixed kinds, none of
///   the kind chosen, or a folder.
std::vector<daq::Record> ReadChosenRecords(const std::vector<std::string>& paths, const RecordChoice& choice);

/// What is needed to diagnose such records together.
/// @throws BenchError for the same record twice, and whatever `CheckRecord`'s kin or the study refuse.
StudyInput StudyInputOf(std::vector<daq::Record> records, const RecordChoice& choice);

/// Reads record files, or one campaign folder, and checks them.
/// @throws as both, with `FILE: error: WHAT (what was expected)`.
StudyInput ReadStudyInput(const std::vector<std::string>& paths, const RecordChoice& choice);

}  // namespace strainwave::bench
