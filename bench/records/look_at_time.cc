// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "analysis/samples/stamps.h"
#include "bench/records/looks.h"
#include "bench/records/record_refusal.h"
#include "daq/record_rules.h"

namespace strainwave::bench {
namespace {

namespace samples = analysis::samples;

constexpr double kSameRate = 0.01;
constexpr double kManyRepeated = 0.005;  // share of the stamps
constexpr double kUneven = 0.05;         // of a step, of a vibration: less hardly smears a line
constexpr double kJitter = 0.1;          // of a step, where time is beside the point

bool IsNear(double rate_hz, double said_hz) { return std::abs(rate_hz / said_hz - 1.0) <= kSameRate; }

std::string RateText(double rate_hz) { return fmt::format("{:.5g}", rate_hz); }

void ExpectOneRate(const daq::Record& record, std::span<const double> time_s, std::optional<double> said_hz) {
  if (!said_hz) return;
  // Rounding spoils the median step, a gap the mean.
  const samples::StampRates rates = samples::RatesOf(time_s);
  if (IsNear(rates.by_step_Hz, *said_hz) || IsNear(rates.by_way_Hz, *said_hz)) return;
  throw RecordRefusal(
      record,
      fmt::format("sample_rate_hz is {}, but time_s goes on by {} samples a second (expected one rate)",
                  RateText(*said_hz), RateText(rates.by_way_Hz)));
}

// Samples of a vibration are taken by a clock of their own: what its stamps were rounded to is not when.
void SettleVibration(daq::Record& record, std::vector<double> time_s, double repeated,
                     std::optional<double> said_hz) {
  const double jitter = samples::StampJitter(time_s);
  if (repeated < kManyRepeated && jitter < kUneven) return;
  const std::string found =
      repeated < kManyRepeated
          ? fmt::format("the time stamps are off even ones: half of them by {:.0f} % of their step and more",
                        100.0 * jitter)
          : fmt::format("{:.1f} % of the time stamps repeat the one before", 100.0 * repeated);
  std::vector<double> even_s = time_s;
  if (samples::EvenWithinTicks(even_s)) {
    record.SetColumn("time_s", std::move(even_s));
    return NoteOn(record, found + ": all within a tick of even steps, which take their place");
  }
  if (repeated < kManyRepeated) return;
  if (!said_hz)
    throw RecordRefusal(record, found + " (expected even steps; sample_rate_hz in the metadata settles it)");
  for (std::size_t i = 0; i < time_s.size(); ++i)
    time_s[i] = time_s.front() + static_cast<double>(i) / *said_hz;
  record.SetColumn("time_s", std::move(time_s));
  NoteOn(record, fmt::format("{}: sample_rate_hz, {}, takes their place", found, RateText(*said_hz)));
}

}  // namespace

void LookAtTime(daq::Record& record) {
  if (record.FindColumn("time_s") == nullptr || record.rows() < 3) return;
  std::vector<double> time_s = record.CopyAsDoubles("time_s");
  if (!(time_s.back() > time_s.front())) {
    throw RecordRefusal(
        record, fmt::format("time_s stands still at {:g} (expected time that goes on)", time_s.front()));
  }
  const std::optional<double> said_hz = daq::MetadataNumber(record, "sample_rate_hz");
  ExpectOneRate(record, time_s, said_hz);
  const double repeated =
      static_cast<double>(samples::RepeatedStamps(time_s)) / static_cast<double>(time_s.size() - 1);
  if (record.kind == daq::RecordKind::kVibration)
    return SettleVibration(record, std::move(time_s), repeated, said_hz);
  // The study of an axis lives of its time, and says itself what is odd about it and what it does about it.
  if (record.kind == daq::RecordKind::kMotion) return;
  if (repeated >= kManyRepeated) {
    return NoteOn(record, fmt::format("{:.1f} % of the time stamps repeat the one before", 100.0 * repeated));
  }
  const double jitter = samples::StampJitter(time_s);
  if (jitter < kJitter) return;
  NoteOn(record,
         fmt::format("the time stamps jitter: half of them are off by {:.0f} % and more of their step of "
                     "{:.4g} ms",
                     100.0 * jitter, 1e3 / samples::RatesOf(time_s).by_step_Hz));
}

}  // namespace strainwave::bench
