// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/diagnosis/diagnose.h"
#include "bench/diagnosis/make_study.h"
#include "bench/diagnosis/study_kind.h"
#include "schedules/reader/findings.h"

namespace strainwave::bench {

/// One cause, or nuisance term, of a model, with the parameters that were fitted.
struct ModelEffect {
  std::string name;
  std::string where;  // bench, unit or undecided
  std::vector<analysis::diagnosis::ParameterValue> parameters;
};

/// A model that a diagnosis has extended, as it stands in `extended_model.yaml`. The file is a plant file of
/// the simulated bench with one more section, so that `run` and `simulate` take the very same file.
struct ExtendedModel {
  StudyKind kind{};
  std::string date;  // UTC
  std::vector<RecordIdentity> records;
  std::string unit;      // of the response
  double noise_floor{};  // in that unit
  std::vector<analysis::diagnosis::ParameterValue> nominal;
  std::vector<ModelEffect> causes;
  std::vector<ModelEffect> nuisance_terms;  // functions without a physical meaning
  PlantMapping plant;
};

/// A model file that cannot be used.
class ModelFileError : public schedules::FileError {
 public:
  using FileError::FileError;
};

/// "bench", "unit" or "undecided".
std::string WhereText(analysis::diagnosis::Where where);

/// The model that a diagnosis ends in: nominal parameters refitted beside everything in it.
ExtendedModel ExtendedModelOf(const StudyInput& input, const analysis::diagnosis::Diagnosis& diagnosis,
                              const std::string& date);

std::string ExtendedModelText(const ExtendedModel& model);

/// @throws ModelFileError with every error of the file, if there is one. The plant's terms, which only the
///   simulated bench runs, are not read, nor the identities of the records.
ExtendedModel ReadExtendedModel(const std::filesystem::path& path);

/// Causes by name and parameters, as a study takes them; with the nuisance terms where they are wanted.
std::vector<analysis::diagnosis::Study::NamedCause> NamedCausesOf(const ExtendedModel& model,
                                                                  bool with_nuisance_terms);

/// Indices of the model's causes among those of a study.
/// @throws BenchError naming `file` and a cause that these records cannot have.
std::vector<std::size_t> GivenCauses(const ExtendedModel& model, const analysis::diagnosis::Study& study,
                                     const std::string& file);

}  // namespace strainwave::bench
