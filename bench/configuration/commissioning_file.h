// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace strainwave::bench {

/// How long this very drive takes to stop when the program is gone, as measured (docs/requirements.md R14).
struct MeasuredStop {
  std::string servo;        // "driving_servo", "load_servo"
  std::string identity;     // of the drive, its serial number in it; empty: it did not tell
  double left_enabled_s{};  // from the last that was sent to it, by its own word
  double stood_s{};         // its shaft; zero where it did not turn
  std::string measured;     // "2026-03-01T12:00:00Z"
};

/// Where the measurements of a bench are kept: BENCH.commissioned.yaml beside BENCH.yaml. Those of an
/// example, which is to stay as it came with the program, in `campaigns/` of the same checkout.
std::filesystem::path CommissioningFileOf(const std::filesystem::path& bench_file);

/// What such a file holds.
std::string CommissioningText(const std::vector<MeasuredStop>& stops);
/// @throws BenchFileError with every error of the text, if there is one.
std::vector<MeasuredStop> ParseCommissioningFile(const std::string& text, std::string_view file_name);
/// Nothing where there is no such file.
std::vector<MeasuredStop> ReadCommissioningFile(const std::filesystem::path& path);

/// Whether a bench may run with what was measured.
struct StopTimeFinding {
  bool refuses{};     // what was measured speaks against it; else nothing is known
  std::string words;  // empty: all is well
};

/// @param stop      of this servo; null: never measured.
/// @param identity  of the drive that is there now; empty: it does not tell.
StopTimeFinding JudgeStopTime(const std::string& servo, const MeasuredStop* stop, const std::string& identity,
                              double longest_s);

}  // namespace strainwave::bench
