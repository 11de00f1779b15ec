// SPDX-License-Identifier: Apache-2.0
#include "bench/central/forward_loop.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <thread>

#include <fmt/core.h>

#include "bench/central/server_source.h"

namespace strainwave::bench {
namespace {

constexpr double kLongestWait = 60.0;
constexpr std::chrono::milliseconds kSlice{20};

class ForwardRounds {
 public:
  ForwardRounds(const ForwardOrder& order, const std::function<bool()>& is_to_end,
                const std::function<void(const std::string&)>& tell)
      : order_(order), is_to_end_(is_to_end), tell_(tell), source_(order.conninfo, is_to_end, order.server) {
    for (const std::string& folder : order.folders) campaigns_.push_back({{{folder}, order.settings}});
  }

  bool Run() {
    while (true) {
      try {
        Round();
        if (!order_.follow) return !trouble_;
        WaitFor(order_.round_s);
      } catch (const ServerError& error) {
        const bool is_stopped = error.kind() == ServerError::Kind::kStopped;
        if (error.kind() == ServerError::Kind::kRefused) throw;
        if (!is_stopped && !is_to_end_()) Away(error);
      }
      if (!is_to_end_()) continue;
      if (order_.follow) return true;
      throw BenchError(ExitCode::kInterrupted,
                       "stopped on request; what is not forwarded stays in the campaign's folder");
    }
  }

 private:
  struct Followed {
    CampaignForward forward;
    bool is_new{true};
    bool is_clock_told{};
    std::string trouble{};  // why it could not be read last time
  };

  void Round() {
    trouble_ = false;
    for (Followed& campaign : campaigns_) {
      try {
        Tell(campaign, campaign.forward.Look(source_));
        campaign.is_new = false;
        campaign.trouble.clear();
      } catch (const ServerError&) {
        throw;
      } catch (const std::exception& error) {
        // The others go on.
        if (!order_.follow && campaigns_.size() == 1) throw;
        trouble_ = true;
        if (campaign.trouble != error.what()) tell_(error.what());
        campaign.trouble = error.what();
      }
    }
    if (attempt_ > 0) tell_("the server is there again");
    attempt_ = 0;
    source_.Close();
  }

  void Tell(Followed& campaign, const Forwarded& done) {
    for (const std::string& trouble : done.troubles) tell_(fmt::format("warning: {}", trouble));
    trouble_ = trouble_ || !done.troubles.empty();
    const bool is_wrong = std::abs(done.clock_off_s) > kClockWrong_s;
    if (is_wrong && !campaign.is_clock_told) {
      tell_(fmt::format(
          "warning: the clock of this machine is {:.1f} days {} that of the server (expected: less than "
          "one); its stamps are marked as wrong there",
          std::abs(done.clock_off_s) / 86'400.0, done.clock_off_s > 0.0 ? "ahead of" : "behind"));
    }
    campaign.is_clock_told = is_wrong;
    if (!campaign.is_new && done.cycles == 0 && done.records == 0) return;
    tell_(fmt::format("{}: bench {}: {} cycles and {} rows brought{}",
                      campaign.forward.folder().root.string(), done.bench, done.cycles, done.rows,
                      done.records > 0 ? fmt::format(", {} files kept", done.records) : ""));
  }

  void Away(const ServerError& error) {
    source_.Close();
    const auto now = std::chrono::steady_clock::now();
    if (++attempt_ == 1) away_since_ = now;
    const double wait_s =
        order_.first_wait_s * WaitsBeforeAttempt(attempt_, std::uniform_real_distribution(0.0, 1.0)(random_));
    const double away_s = std::chrono::duration<double>(now - away_since_).count();
    if (!order_.follow && away_s + wait_s > order_.patience_s) throw error;
    // Once each time that it goes away, not at each attempt.
    if (attempt_ == 1) {
      tell_(fmt::format("{}; what is not forwarded stays in the campaign's folder, and it is tried again",
                        error.what()));
    }
    WaitFor(wait_s);
  }

  void WaitFor(double time_s) const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(time_s);
    while (std::chrono::steady_clock::now() < end && !is_to_end_()) std::this_thread::sleep_for(kSlice);
  }

  const ForwardOrder& order_;
  const std::function<bool()>& is_to_end_;
  const std::function<void(const std::string&)>& tell_;
  std::vector<Followed> campaigns_;
  ServerSource source_;
  std::mt19937 random_{std::random_device()()};
  int attempt_{};
  std::chrono::steady_clock::time_point away_since_;
  bool trouble_{};
};

}  // namespace

double WaitsBeforeAttempt(int attempt, double chance) {
  const double longest = std::min(kLongestWait, std::ldexp(1.0, std::min(attempt, 16) - 1));
  return longest * (1.0 - 0.5 * chance);
}

bool RunForward(const ForwardOrder& order, const std::function<bool()>& is_to_end,
                const std::function<void(const std::string&)>& tell) {
  return ForwardRounds(order, is_to_end, tell).Run();
}

}  // namespace strainwave::bench
