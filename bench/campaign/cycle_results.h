// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/campaign/journal.h"
#include "bench/campaign/record_results.h"
#include "bench/controller/phase_program.h"
#include "daq/acquisition/calibration.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// What the results of a cycle depend on besides its raw records.
struct CycleContext {
  double ratio{};
  analysis::StiffnessMethod method{analysis::StiffnessMethod::kModel};
  BenchCorrections corrections;
  /// Declared thermal state of the measurements (docs/requirements.md R41).
  double declared_temperature_degC{};
  double temperature_tolerance_K{};
  /// Calibrations made after the records were: they are scaled anew before anything is computed.
  std::vector<daq::acquisition::Calibration> recalibrations;
};

/// How the flag of a result begins that is sound but was not measured in the declared thermal state.
inline constexpr std::string_view kThermalFlag = "measured";

/// What the flag of a stiffness ends with that no blank test has corrected.
inline constexpr std::string_view kNoBlankFlag = "holds the bench's compliance: no blank test";

/// True for a result without a flag, or with one that only says in which state it was measured.
bool IsSound(const Result& result);

/// Results of one cycle and what pictures need of them.
struct CycleAnalysis {
  std::vector<Result> results;
  std::vector<std::string> failed_checks;
  std::optional<analysis::TransmissionError> transmission_error;
  /// The loop at the first lock angle and its fit; empty without a hysteresis test.
  std::optional<analysis::TorsionalStiffness> stiffness;
  const daq::Record* loop{};  // points into the records given
};

/// Records whose name has no prefix come from a phase of its own; "PHASE/RECORD" is the name in the file and
/// "PHASE/retry_N/RECORD" that of a measurement taken again, of which only the last one counts.
/// Transmission error, stiffness (mean over the lock angles, by the context's method, and beside it by the
/// two others), efficiency, vibration and temperature: a pure function of its arguments, so that the same
/// records give the same bits while the campaign runs and ever after.
CycleAnalysis AnalyzeCycle(std::span<const NamedRecord> records, const CycleContext& context);

/// What the sensor checks among the records have found.
std::vector<Result> SensorCheckResults(std::span<const NamedRecord> records);

/// The value of one quantity, or nothing.
std::optional<Result> FindResult(std::span<const Result> results, std::string_view quantity);

}  // namespace strainwave::bench
