// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "analysis/angle_weights.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/noise_level.h"
#include "analysis/samples/arrivals.h"
#include "analysis/samples/holds.h"
#include "bench/records/looks.h"
#include "bench/records/record_data.h"
#include "bench/records/record_refusal.h"
#include "daq/record_rules.h"

namespace strainwave::bench {
namespace {

namespace samples = analysis::samples;
using samples::Frozen;
using samples::Held;

constexpr double kGoesOn = 0.5;         // share of its usual change, of another channel meanwhile
constexpr double kTogether = 0.9;       // share of repeated rows
constexpr double kMostLeftOut = 0.4;    // of the rows, before nothing is computed
constexpr double kRest = 0.5;           // of a sweep's usual step
constexpr double kRestingShare = 0.05;  // of its rows, and at least
constexpr std::size_t kFewestResting = 20;
constexpr std::size_t kFewestFrozen = 4;  // rows
constexpr double kStepsOfARest = 3.0;     // of an encoder, from one row to the next as a rest begins or ends
constexpr double kGoesOnBeside = 0.5;     // of its usual steps, a shaft beside one that stands
constexpr double kCoarsestEncoder_deg = 360.0 / 1024.0;
// Of the output, what a shaft goes on beside one that stands where no gear has so much play.
constexpr double kNoPlay_deg = 1.0;
// What straight lines take the place of in a vibration: rows in one piece, and share of all rows.
constexpr std::size_t kMostFilled = 10;
constexpr double kMostFilledShare = 0.1;

struct HeldColumn {
  std::string name;
  Held held;
};

// The channels that a kind lives of.
std::vector<std::string> Measured(const daq::Record& record) {
  if (record.kind == daq::RecordKind::kVibration) return VibrationChannelsOf(record);
  std::vector<std::string> names;
  for (const char* name : {"input_angle_deg", "output_angle_deg", "torque_Nm", "position_rad", "position_m",
                           "force_N", "current_A", "velocity_rad_per_s", "velocity_m_per_s"}) {
    const bool beside_the_point =
        record.kind == daq::RecordKind::kTransmissionError && std::string_view(name) == "torque_Nm";
    if (record.FindColumn(name) != nullptr && !beside_the_point) names.emplace_back(name);
  }
  return names;
}

double RepeatedTogether(const Held& held, std::span<const double> other) {
  std::size_t together = 0;
  for (std::size_t i = 1; i < other.size(); ++i)
    together += !held.fresh[i] && other[i] == other[i - 1] ? 1 : 0;
  return static_cast<double>(together) / static_cast<double>(held.repeated);
}

// What rests while its values stand rests itself: a load in steps, a shaft that is moved and read in turn. A
// logger repeats one channel while the others go on, or all of them at once.
bool IsOfTheLogger(const daq::Record& record, const std::string& name, const Held& held) {
  bool alone = true;
  for (const std::string& other : Measured(record)) {
    if (other == name) continue;
    alone = false;
    const std::vector<double> values = record.CopyAsDoubles(other);
    const bool goes_on = samples::GoesOnMeanwhile(held, values) > kGoesOn;
    // Angles that are read in turn stand together without harm: a sweep has no time.
    const bool together =
        record.kind != daq::RecordKind::kTransmissionError && RepeatedTogether(held, values) > kTogether;
    if (goes_on || together) return true;
  }
  return alone;
}

std::vector<HeldColumn> FindHeldColumns(const daq::Record& record) {
  std::vector<HeldColumn> columns;
  for (const std::string& name : Measured(record)) {
    const bool sweep = record.kind == daq::RecordKind::kTransmissionError;
    std::optional<Held> held = sweep ? samples::FindHeld(record.Doubles(name), kCoarsestEncoder_deg)
                                     : samples::FindHeld(record.CopyAsDoubles(name));
    if (held && IsOfTheLogger(record, name, *held)) columns.push_back({name, std::move(*held)});
  }
  return columns;
}

std::string HeldText(const HeldColumn& column, std::size_t rows) {
  return fmt::format("{} repeats its value until the next one comes, in {} of {} rows, up to {} rows long",
                     column.name, column.held.repeated, rows, column.held.longest);
}

void LeaveOutColumn(daq::Record& record, const std::string& name) {
  std::erase_if(record.columns, [&](const daq::Column& column) { return column.name == name; });
  if (Measured(record).empty()) {
    throw RecordRefusal(record,
                        fmt::format("{}, and there is no other channel (expected samples of a sensor)",
                                    record.notes.back().text));
  }
}

// All channels, in rows with a new value of the one that comes most seldom; its values at the times when they
// came, the others' there.
void TakeNewRows(daq::Record& record, std::vector<HeldColumn> columns) {
  const std::size_t rows = record.rows();
  const auto fresh = [](const HeldColumn& column) { return std::ranges::count(column.held.fresh, true); };
  std::ranges::sort(columns, {}, fresh);
  const std::vector<bool> kept = columns.front().held.fresh;
  const bool timed = record.FindColumn("time_s") != nullptr;
  const std::vector<double> time_s = timed ? record.CopyAsDoubles("time_s") : std::vector<double>{};
  const std::vector<double> arrival_s = timed ? samples::ArrivalTimes(time_s, kept) : std::vector<double>{};
  for (const std::string& name : Measured(record)) {
    const auto own = std::ranges::find(columns, name, &HeldColumn::name);
    if (name == columns.front().name || !timed) continue;
    const std::vector<bool> all(rows, true);
    record.SetColumn(name,
                     samples::AtArrivals(time_s, record.CopyAsDoubles(name),
                                         own == columns.end() ? all : own->held.fresh, arrival_s, kept));
  }
  if (timed) record.SetColumn("time_s", arrival_s);
  for (const HeldColumn& column : columns) NoteOn(record, HeldText(column, rows) + "; only new values count");
  KeepRows(record, kept);
}

// Straight lines between new values.
void FillIn(daq::Record& record, const std::string& name, const std::vector<bool>& fresh) {
  std::vector<double> values = record.CopyAsDoubles(name);
  std::vector<std::size_t> stale;
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    if (!fresh[i]) stale.push_back(i);
  }
  analysis::InterpolateOver(values, stale);
  record.SetColumn(name, std::move(values));
}

// In how many rows a new value came, each time; nothing where they did not come evenly.
std::optional<std::size_t> EvenHold(const std::vector<bool>& fresh) {
  std::size_t last = 0;
  std::size_t rows = 0;
  for (std::size_t i = 1; i < fresh.size(); ++i) {
    if (!fresh[i]) continue;
    if (rows != 0 && i - last != rows) return std::nullopt;
    if (last != 0) rows = i - last;
    last = i;
  }
  return rows > 1 ? std::optional(rows) : std::nullopt;
}

// A vibration lives of even samples: what is short is filled in, all channels that come at one lower rate are
// taken at it, any other channel is left out.
void LookAtHeldVibration(daq::Record& record, const std::vector<HeldColumn>& columns) {
  const std::size_t rows = record.rows();
  const std::vector<bool> first = columns.front().held.fresh;
  const std::optional<std::size_t> every = EvenHold(first);
  const bool all_alike =
      every && columns.size() == Measured(record).size() &&
      std::ranges::all_of(columns, [&](const HeldColumn& one) { return one.held.fresh == first; });
  if (all_alike) {
    for (const HeldColumn& column : columns)
      NoteOn(record, HeldText(column, rows) + "; only new values count");
    if (const auto rate_hz = daq::MetadataNumber(record, "sample_rate_hz"))
      record.SetMetadata("sample_rate_hz", *rate_hz / static_cast<double>(*every));
    return KeepRows(record, first);
  }
  for (const HeldColumn& column : columns) {
    const bool filled =
        column.held.longest <= kMostFilled &&
        static_cast<double>(column.held.repeated) <= kMostFilledShare * static_cast<double>(rows);
    NoteOn(record, HeldText(column, rows) + (filled ? "; they are filled in" : "; it is left out"));
    filled ? FillIn(record, column.name, column.held.fresh) : LeaveOutColumn(record, column.name);
  }
}

void LookAtHeld(daq::Record& record) {
  std::vector<HeldColumn> columns = FindHeldColumns(record);
  if (columns.empty()) return;
  record.kind == daq::RecordKind::kVibration ? LookAtHeldVibration(record, columns)
                                             : TakeNewRows(record, std::move(columns));
}

std::string PlaceOf(const daq::Record& record, const Frozen& frozen) {
  const std::size_t last = frozen.first + frozen.count - 1;
  const std::string rows = fmt::format("rows {} to {}", frozen.first + 1, last + 1);
  if (record.FindColumn("time_s") == nullptr) return rows;
  const std::vector<double> time_s = record.CopyAsDoubles("time_s");
  return fmt::format("{}, {:.2f} to {:.2f} s", rows, time_s[frozen.first], time_s[last]);
}

// Whether a position goes on from where it stood: an axis that rests, or creeps, stays within one step of its
// encoder, also where the noise that it shows in motion (of the samples' times, of its scale) would never let
// it.
bool GoesOnFromThere(std::span<const double> position, const Frozen& frozen, double step) {
  const std::size_t next = frozen.first + frozen.count;
  const double value = position[frozen.first];
  const double most = kStepsOfARest * step;
  return (frozen.first == 0 || std::abs(position[frozen.first - 1] - value) <= most) &&
         (next == position.size() || std::abs(position[next] - value) <= most);
}

// Smallest change of a signal; 0 of one that never changes.
double SmallestChange(std::span<const double> values) {
  double smallest = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double change = std::abs(values[i] - values[i - 1]);
    if (change > 0.0 && (smallest == 0.0 || change < smallest)) smallest = change;
  }
  return smallest;
}

// Against its own noise; of the two angles of a sweep also against the other shaft, which went on.
std::vector<Frozen> FrozenOf(const daq::Record& record, const std::string& name) {
  std::vector<Frozen> segments;
  if (record.kind != daq::RecordKind::kTransmissionError) {
    segments = samples::FindFrozen(record.CopyAsDoubles(name));
    std::erase_if(segments, [](const Frozen& frozen) { return frozen.count < kFewestFrozen; });
    if (record.kind == daq::RecordKind::kMotion && name.starts_with("position_")) {
      const std::vector<double> position = record.CopyAsDoubles(name);
      std::erase_if(segments, [&, step = SmallestChange(position)](const Frozen& frozen) {
        return GoesOnFromThere(position, frozen, step);
      });
    }
    return segments;
  }
  const char* const beside = name == "input_angle_deg" ? "output_angle_deg" : "input_angle_deg";
  const std::span<const double> other = record.Doubles(beside);
  const double step = analysis::UsualStep(other);
  const double no_play = kNoPlay_deg * analysis::diagnosis::SpanOf(other) /
                         analysis::diagnosis::SpanOf(record.Doubles("output_angle_deg"));
  for (const Frozen& frozen : samples::StandingSegments(record.Doubles(name), kFewestFrozen)) {
    const double way = std::abs(other[frozen.first + frozen.count - 1] - other[frozen.first]);
    if (way >= std::min(kGoesOnBeside * step * static_cast<double>(frozen.count - 1), no_play))
      segments.push_back(frozen);
  }
  return segments;
}

void LookAtFrozen(daq::Record& record) {
  const bool vibration = record.kind == daq::RecordKind::kVibration;
  std::vector<bool> kept(record.rows(), true);
  for (const std::string& name : Measured(record)) {
    std::vector<Frozen> segments = FrozenOf(record, name);
    std::vector<bool> own(record.rows(), true);
    std::size_t longest = 0;
    for (const Frozen& frozen : segments) {
      longest = std::max(longest, frozen.count);
      std::fill_n(own.begin() + static_cast<std::ptrdiff_t>(frozen.first), frozen.count, false);
      std::fill_n(kept.begin() + static_cast<std::ptrdiff_t>(frozen.first), frozen.count, false);
    }
    const bool filled = vibration && longest <= kMostFilled;
    for (const Frozen& frozen : segments) {
      NoteAt(record, frozen.first,
             fmt::format("{} samples of {} repeat one value, {}: a sensor or logger that stood still; {}",
                         frozen.count, name, PlaceOf(record, frozen),
                         filled      ? "they are filled in"
                         : vibration ? "the channel is left out"
                                     : "they are left out"));
    }
    if (!vibration || segments.empty()) continue;
    filled ? FillIn(record, name, own) : LeaveOutColumn(record, name);
  }
  if (vibration) return;
  const auto lost = static_cast<std::size_t>(std::ranges::count(kept, false));
  if (static_cast<double>(lost) > kMostLeftOut * static_cast<double>(kept.size())) {
    throw RecordRefusal(
        record, fmt::format("a sensor or logger stood still in {} of {} rows (expected at most {:.0f} %)",
                            lost, kept.size(), 100.0 * kMostLeftOut));
  }
  if (lost > 0) KeepRows(record, kept);
}

// Told, not changed: means are over the angle.
void LookAtRests(daq::Record& record) {
  const std::span<const double> angle_deg = record.Doubles("output_angle_deg");
  const double clear_deg = kRest * analysis::UsualStep(angle_deg);
  std::size_t first = 0;
  for (std::size_t i = 1; i <= angle_deg.size(); ++i) {
    if (i < angle_deg.size() && std::abs(angle_deg[i] - angle_deg[first]) < clear_deg) continue;
    const std::size_t rows = i - first;
    if (rows >= kFewestResting &&
        static_cast<double>(rows) >= kRestingShare * static_cast<double>(angle_deg.size())) {
      NoteAt(record, first,
             fmt::format("the output stands still in rows {} to {}: they count by the angle, not by "
                         "their number",
                         first + 1, i));
    }
    first = i;
  }
}

}  // namespace

void LookAtStandstill(daq::Record& record) {
  if (record.kind == daq::RecordKind::kTransmissionError) LookAtRests(record);
  LookAtHeld(record);
  LookAtFrozen(record);
}

}  // namespace strainwave::bench
