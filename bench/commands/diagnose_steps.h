// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/diagnosis/diagnose.h"
#include "bench/commands/terminal.h"
#include "bench/diagnosis/diagnosis_report.h"
#include "bench/diagnosis/extended_model.h"
#include "bench/diagnosis/make_study.h"

/// What `diagnose` does to the records of one unit, or of several in turn.
namespace strainwave::bench {

struct DiagnoseCommand {
  std::vector<std::string> paths;
  std::string model;
  std::string out;
  RecordChoice choice;
  unsigned long long seed{1};
  bool by_specimen{};
  bool details{};
  bool power{};
  std::string map;
  bool json{};
};

/// Shows a step with the share done of what a part of the command does.
using StepProgress = std::function<void(const std::string& step, double share)>;

/// Records with their diagnosis.
struct FinishedDiagnosis {
  StudyInput input;
  std::optional<ExtendedModel> given;  // that it went on from
  analysis::diagnosis::Diagnosis result;
  analysis::diagnosis::SparseFormula formula;
  std::optional<analysis::diagnosis::DetectionPower> power;
  double power_took_s{};
  std::string model_file;

  DiagnosisReport Report() const;
};

/// @param specimen  whose records they are, of several; empty for one diagnosis alone.
/// @param line  cleared before the power of the records is measured, which has a line of its own.
FinishedDiagnosis DiagnoseInput(StudyInput input, const std::string& specimen, const DiagnoseCommand& command,
                                ShareLine& line, const StepProgress& progress);

/// What became of a diagnosis' files.
struct DiagnosisFiles {
  std::string text;             // where they are
  std::string picture_trouble;  // why there are no pictures; empty where there are
};

/// Writes extended_model.yaml, diagnosis.json and the pictures.
/// @param progress  with the share of the pictures.
DiagnosisFiles WriteDiagnosis(const FinishedDiagnosis& finished, const std::filesystem::path& folder,
                              const std::function<void(double)>& progress);

/// Says so where there are no pictures. @return the exit code.
int CodeOfPictures(const std::string& picture_trouble);

/// `diagnose --by-specimen`: each specimen by itself, then what they share.
int RunBySpecimen(const DiagnoseCommand& command);

}  // namespace strainwave::bench
