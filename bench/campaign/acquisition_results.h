// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/campaign/journal.h"
#include "bench/controller/phase_program.h"
#include "bench/roles/sample_sources.h"

namespace strainwave::bench {

/// How results of a source's samples begin, before the name of the source.
inline constexpr const char* kSamplesReceived = "samples_received_";
inline constexpr const char* kSamplesLost = "samples_lost_";

/// A record of what came of a source since `before`: samples received and lost, gaps, and its clock.
NamedRecord SourceRecord(const SourceTotals& before, const SourceTotals& now);

/// The same of a raw stream that was kept.
NamedRecord RecordingRecord(const RecordedSource& recorded);

/// Sums over all phases of a cycle: "samples_received_SOURCE", "samples_lost_SOURCE", with a flag where some
/// losses were told from the time alone; "clock_drift_ppm_SOURCE" where it is known;
/// "samples_lost_in_files_SOURCE" of the streams that were kept.
std::vector<Result> SourceResults(std::span<const NamedRecord> records);

/// Vibration over whole load runs, all their pieces together, about the mean:
/// "PHASE_vibration_rms_CHANNEL_m_per_s2", "…_peak_…", and "PHASE_vibration_crest_CHANNEL", "…_kurtosis_…",
/// which have no unit.
std::vector<Result> VibrationStatisticsResults(std::span<const NamedRecord> records);

}  // namespace strainwave::bench
