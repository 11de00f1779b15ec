// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "bench/campaign/progress.h"

namespace strainwave::bench {

/// "1 h 05 min", "3 min 20 s", "12 s": for people.
std::string DurationText(double time_s);

/// Progress on standard error: a bar with the time left on a terminal, a line a minute in a log.
class TerminalProgress final : public ProgressSink {
 public:
  TerminalProgress();
  ~TerminalProgress() override;

  void Update(const ProgressState& state) override;
  void Message(std::string_view severity, std::string_view text) override;
  void CycleStored(int cycle, const std::vector<Result>& results) override;

 private:
  void ClearLine();
  void Draw(double share, double eta_s);

  bool is_terminal_;
  double first_share_{-1.0};  // what earlier runs have done says nothing of this one's pace
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_draw_{};
  ProgressState state_;
  std::string phase_;
  bool line_open_{};
};

}  // namespace strainwave::bench
