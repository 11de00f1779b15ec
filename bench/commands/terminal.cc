// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/terminal.h"
#include "bench/commands/output.h"

#include <cmath>

#include <fmt/core.h>

namespace strainwave::bench {
namespace {

using std::chrono::duration;
using std::chrono::steady_clock;

constexpr duration<double> kTerminalInterval{0.1};
constexpr duration<double> kLogInterval{30.0};
constexpr int kBarWidth = 30;

}  // namespace

std::string DurationText(double time_s) {
  const auto seconds = static_cast<long long>(std::llround(time_s));
  if (seconds >= 48 * 3600) return fmt::format("{} d {} h", seconds / 86400, seconds % 86400 / 3600);
  if (seconds >= 3600) return fmt::format("{} h {:02d} min", seconds / 3600, seconds % 3600 / 60);
  if (seconds >= 60) return fmt::format("{} min {:02d} s", seconds / 60, seconds % 60);
  return fmt::format("{} s", seconds);
}

std::string FileText(const std::filesystem::path& file) {
  std::error_code unknown;
  const auto size = std::filesystem::file_size(file, unknown);
  const std::string name = file.filename().string();
  return unknown ? name : fmt::format("{}, {}", name, BytesText(static_cast<double>(size)));
}

void ShareLine::Show(const std::string& step, double share) {
  const auto now = steady_clock::now();
  const double elapsed_s = duration<double>(now - start_).count();
  const std::string left = share > 0.02 ? DurationText(elapsed_s * (1.0 - share) / share) + " left" : "";
  const std::string text = fmt::format("{:5.1f} %  {}  {}", 100.0 * share, step, left);
  line_.Show(text);
  if (StderrIsTerminal() || now - last_logged_ < kLogInterval) return;
  last_logged_ = now;
  ToStderr("{}\n", text);
}

TerminalProgress::TerminalProgress() : start_(steady_clock::now()) {}

void TerminalProgress::Update(const ProgressState& state) {
  if (first_share_ < 0.0) first_share_ = state.share;
  const auto now = steady_clock::now();
  if (now - last_draw_ < (StderrIsTerminal() ? kTerminalInterval : kLogInterval)) return;
  last_draw_ = now;
  const double done = state.share - first_share_;
  const double elapsed_s = duration<double>(now - start_).count();
  Draw(state, done > 0.0 ? elapsed_s * (1.0 - state.share) / done : -1.0);
}

void TerminalProgress::Draw(const ProgressState& state, double eta_s) {
  const std::string eta = eta_s < 0.0 ? "?" : DurationText(eta_s);
  const std::string where = state.cycle == 0
                                ? fmt::format("preparation, {}", state.phase)
                                : fmt::format("cycle {} of {}, {}", state.cycle, state.cycles, state.phase);
  std::string bad;
  for (const ChannelTrouble& channel : state.bad_channels) {
    bad += fmt::format("{}{}", bad.empty() ? "  BAD " : ", ", channel.channel);
    if (!StderrIsTerminal()) bad += fmt::format(" ({})", channel.reason);
  }
  if (!StderrIsTerminal()) {
    ToStderr("{:5.1f} %  {}  {} left{}\n", 100.0 * state.share, where, eta, bad);
    return;
  }
  const int full = static_cast<int>(std::lround(state.share * kBarWidth));
  line_.Show(fmt::format("[{}{}] {:5.1f} %  {}  {} left{}", std::string(static_cast<std::size_t>(full), '#'),
                         std::string(static_cast<std::size_t>(kBarWidth - full), '.'), 100.0 * state.share,
                         where, eta, bad));
}

void TerminalProgress::Message(std::string_view severity, std::string_view text) {
  if (severity == "info") {
    ToStderr("{}\n", text);
  } else {
    ToStderr("{}: {}\n", severity, text);
  }
}

void TerminalProgress::CycleStored(int, const std::vector<Result>&) {}

}  // namespace strainwave::bench
