// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>

#include "bench/campaign/disk_room.h"
#include "bench/campaign/progress.h"
#include "bench/commands/output.h"

namespace strainwave::bench {

/// "1 h 05 min", "3 min 20 s", "12 s": for people.
std::string DurationText(double time_s);

/// "sweep.csv, 512.0 MB": what a command is busy with.
std::string FileText(const std::filesystem::path& file);

/// The line of a terminal that is written anew in place (`ShowLine`), taken away at the end.
class TerminalLine {
 public:
  TerminalLine() = default;
  ~TerminalLine() { Clear(); }
  TerminalLine(const TerminalLine&) = delete;
  TerminalLine& operator=(const TerminalLine&) = delete;

  void Show(std::string_view text) { ShowLine(text); }
  void Clear() { ShowLine({}); }
};

/// Long work as one line of a terminal: the share done, the step, and the time left. In a log a line each
/// half minute.
class ShareLine {
 public:
  void Show(const std::string& step, double share);
  void Clear() { line_.Clear(); }

 private:
  TerminalLine line_;
  std::chrono::steady_clock::time_point start_{std::chrono::steady_clock::now()};
  std::chrono::steady_clock::time_point last_logged_{start_};
};

/// Progress on standard error: a bar with the time left on a terminal, a line a minute in a log.
class TerminalProgress final : public ProgressSink {
 public:
  TerminalProgress();
  void Update(const ProgressState& state) override;
  void Message(std::string_view severity, std::string_view text) override;
  void CycleStored(int cycle, const std::vector<Result>& results) override;

 private:
  void Draw(const ProgressState& state, double eta_s);

  TerminalLine line_;
  double first_share_{-1.0};  // what earlier runs have done says nothing of this one's pace
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_draw_{};
};

}  // namespace strainwave::bench
