// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/monitor/alarm.h"
#include "bench/prediction/signal_inputs.h"

namespace strainwave::bench {

/// One output of one window, in its unit; of a class, its probability thrice.
struct MonitoredOutput {
  double value{};
  double low{};
  double high{};
};

/// What one window has come to. Outputs are there unless there is a fault; outside the training they are
/// there and must not be relied on.
struct MonitorResult {
  std::int64_t number{};    // of the window, from 1
  std::int64_t begin_ms{};  // since 1970, UTC
  std::int64_t end_ms{};
  std::string origin;
  std::optional<SignalFault> fault;
  double distance{};  // above 1: outside the training
  bool outside_training{};
  std::vector<std::string> left{};       // of training's torques, speeds and temperatures, in words
  std::vector<std::string> not_known{};  // of these, and what contradicts itself; in words
  std::vector<MonitoredOutput> outputs;
  std::vector<AlarmLevel> alarms;  // of each output; after a window that is not good, as they were
  AlarmLevel alarm{};              // the highest of them
};

/// The place of the likeliest class. @param outputs  one or more.
std::size_t LikeliestOf(const std::vector<MonitoredOutput>& outputs);

/// What a reader may make of the newest values. The numbers go to PLCs and never change their meaning.
enum class ValueStatus { kNone = 0, kGood = 1, kBad = 2, kStale = 3, kOutsideTraining = 4 };

/// "none", "good", "bad", "stale", "outside_training".
std::string_view NameOf(ValueStatus status);

/// What stays the same while a monitor runs.
struct MonitorFrame {
  std::vector<std::string> outputs;  // with units: "k2_Nm_per_rad"; of classes, their names
  double coverage{};                 // of the intervals
  std::int64_t stale_after_ms{};     // a value older than that is not good
  bool classes{};                    // outputs are probabilities of classes
};

/// The way to the broker.
struct LinkState {
  bool used{};
  bool connected{};
  std::uint64_t waiting_windows{};
  std::uint64_t waiting_bytes{};
  std::uint64_t dropped_windows{};
};

/// All that publishers show.
struct MonitorState {
  std::optional<MonitorResult> last;
  std::uint64_t good_windows{};
  std::uint64_t bad_windows{};
  std::uint64_t outside_windows{};
  LinkState link;
};

/// Of the newest result at `now_ms`, the time of the stream.
ValueStatus StatusOf(const MonitorState& state, const MonitorFrame& frame, std::int64_t now_ms);

}  // namespace strainwave::bench
