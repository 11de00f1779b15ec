// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/source_states.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "bench/utc.h"

namespace strainwave::bench {
namespace {

constexpr std::array kAllChannels{"input_angle",      "output_angle",        "output_torque",
                                  "gear_temperature", "ambient_temperature", "vibration"};

std::string LossWords(const SourceCounts& counts) {
  const daq::acquisition::GapTotals& samples = counts.samples;
  std::vector<std::string> words;
  if (samples.lost > 0) {
    words.push_back(fmt::format("{} of {} samples lost in {} gaps{}, the last at {}", samples.lost,
                                samples.lost + samples.received, samples.gaps,
                                samples.estimated > 0 ? ", some told from the time alone" : "",
                                UtcText(counts.last_loss_utc_ms)));
  }
  if (samples.repeated > 0) words.push_back(fmt::format("{} came late or twice", samples.repeated));
  if (samples.resets > 0) words.push_back(fmt::format("its counter began anew {} times", samples.resets));
  return fmt::format("{}", fmt::join(words, "; "));
}

void PutFirst(const std::string& words, SourceState& state) {
  state.words = state.words.empty() ? words : words + "; " + state.words;
}

// Of a stream: what is worst.
void JudgeCounts(const SourceCounts& counts, std::int64_t now_utc_ms, SourceState& state) {
  state.counts = counts;
  state.words = LossWords(counts);
  if (!counts.trouble.empty()) {
    state.condition = SourceCondition::kTrouble;
    PutFirst(counts.trouble, state);
  } else if (now_utc_ms - counts.last_sample_utc_ms > kSilentAfter_ms) {
    state.condition = SourceCondition::kSilent;
    PutFirst(counts.last_sample_utc_ms == 0 ? std::string("nothing has come of it yet")
                                            : "nothing has come since " + UtcText(counts.last_sample_utc_ms),
             state);
  } else if (counts.last_loss_utc_ms > 0 && now_utc_ms - counts.last_loss_utc_ms <= kLosingFor_ms) {
    state.condition = SourceCondition::kLosing;
  }
}

}  // namespace

std::string_view NameOf(SourceCondition condition) {
  switch (condition) {
    case SourceCondition::kNotRunning:
      return "not running";
    case SourceCondition::kGood:
      return "good";
    case SourceCondition::kLosing:
      return "losing samples";
    case SourceCondition::kSilent:
      return "silent";
    case SourceCondition::kTrouble:
      return "trouble";
  }
  return "";
}

std::vector<SourceState> SourceStates(const BenchDescription& bench, const std::vector<ChannelTrouble>& bad,
                                      const std::optional<LiveSources>& live, bool is_running,
                                      const Moment& now) {
  const double age_s = live ? PauseBetween(live->taken, now).length_s.value_or(0.0) : 0.0;
  std::vector<SourceState> states;
  for (const ChannelLink& link : bench.channels) {
    auto state = std::ranges::find(states, link.device, &SourceState::source);
    if (state == states.end()) {
      states.push_back({link.device, SourceCondition::kGood});
      state = std::prev(states.end());
    }
    state->channels.push_back(link.channel);
  }
  if (bench.simulated) {
    states.push_back({"simulated bench", SourceCondition::kGood});
    states.back().channels.assign(kAllChannels.begin(), kAllChannels.end());
  }
  for (SourceState& state : states) {
    if (live) {
      const auto counts = std::ranges::find(live->sources, state.source, &SourceCounts::name);
      // By the clock of the file, of which its times are: a page that looks late is no loss of the source.
      if (counts != live->sources.end()) JudgeCounts(*counts, live->taken.utc_ms, state);
      if (state.counts && is_running && age_s > kOldestCounts_s) {
        state.condition = SourceCondition::kSilent;
        PutFirst(
            "the program that runs the campaign has said nothing of it since " + UtcText(live->taken.utc_ms),
            state);
      }
    }
    if (!is_running) {
      state.condition = SourceCondition::kNotRunning;
      continue;
    }
    for (const ChannelTrouble& trouble : bad) {
      if (std::ranges::find(state.channels, trouble.channel) == state.channels.end()) continue;
      state.condition = SourceCondition::kTrouble;
      PutFirst(
          fmt::format("{} gives no value since {}: {}", trouble.channel, trouble.since_utc, trouble.reason),
          state);
    }
  }
  return states;
}

}  // namespace strainwave::bench
