// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "analysis/samples/wraps.h"
#include "analysis/units.h"
#include "bench/records/looks.h"
#include "bench/records/record_refusal.h"
#include "daq/record_rules.h"

namespace strainwave::bench {
namespace {

namespace samples = analysis::samples;
using samples::Wraps;

constexpr double kTurn_deg = 360.0;
constexpr double kMostOfModulus = 0.4;   // a step; half of it could be one the other way
constexpr double kMostOfInput = 0.1;     // the same where the ratio contradicts it: any step could be another
constexpr double kOffRatio = 0.1;        // of the modulus: what the ratio may predict wrongly of a step
constexpr double kClearlyWrapped = 1.5;  // turns that the ratio predicts of an input that keeps to one

void NoteWraps(daq::Record& record, const std::string& column, const Wraps& wraps, const char* unit) {
  NoteAt(
      record, wraps.rows.front(),
      fmt::format("{} starts anew every {:.6g} {}, {} in the record, first at row {}: taken as going on",
                  column, wraps.modulus, unit,
                  wraps.rows.size() == 1 ? std::string("once") : fmt::format("{} times", wraps.rows.size()),
                  wraps.rows.front() + 1));
}

[[noreturn]] void RefuseWraps(const daq::Record& record, const std::string& column, const Wraps& wraps,
                              const char* unit, double share, double most) {
  throw RowRefusal(
      record, wraps.rows.front(),
      fmt::format(
          "{} starts anew every {:.6g} {} at row {}, and goes by {:.3g} {} from row to row: which way cannot "
          "be told (expected steps of less than {:.3g} {}, or an angle that goes on)",
          column, wraps.modulus, unit, wraps.rows.front() + 1, share * wraps.modulus, unit,
          most * wraps.modulus, unit));
}

// One angle with nothing beside it that knows where it goes.
void UnwrapAlone(daq::Record& record, const std::string& column, double turn, const char* unit) {
  if (record.FindColumn(column) == nullptr) return;
  std::vector<double> angle = record.CopyAsDoubles(column);
  const std::optional<Wraps> wraps = samples::FindWraps(angle, turn);
  if (!wraps) return;
  const double share = samples::UsualStep(angle, *wraps);
  if (share > kMostOfModulus) RefuseWraps(record, column, *wraps, unit, share, kMostOfModulus);
  samples::Unwrap(angle, wraps->modulus);
  record.SetColumn(column, std::move(angle));
  NoteWraps(record, column, *wraps, unit);
}

double SpanOf(std::span<const double> values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

// A sweep that is driven again starts where the one before did: both shafts go back together.
std::vector<bool> Returns(std::span<const double> other_deg, double furthest_deg) {
  std::vector<bool> returns(other_deg.size(), false);
  for (std::size_t i = 1; i < other_deg.size(); ++i)
    returns[i] = std::abs(other_deg[i] - other_deg[i - 1]) > furthest_deg;
  return returns;
}

// @returns the modulus, 0 where it does not start anew
double UnwrapOutput(daq::Record& record, double ratio) {
  std::vector<double> output_deg = record.CopyAsDoubles("output_angle_deg");
  const std::vector<bool> returns = Returns(record.Doubles("input_angle_deg"),
                                            std::max(kTurn_deg * 1.01, 0.5 * std::abs(ratio) * kTurn_deg));
  const std::optional<Wraps> wraps = samples::FindWraps(output_deg, kTurn_deg, returns);
  if (!wraps) return 0.0;
  const double share = samples::UsualStep(output_deg, *wraps);
  if (share > kMostOfModulus) RefuseWraps(record, "output_angle_deg", *wraps, "deg", share, kMostOfModulus);
  samples::Unwrap(output_deg, wraps->modulus, returns);
  record.SetColumn("output_angle_deg", std::move(output_deg));
  NoteWraps(record, "output_angle_deg", *wraps, "deg");
  return wraps->modulus;
}

// The input turns far from row to row: its own steps say how many turns only where they are small, the output
// and the ratio also where they are not.
// @returns the modulus, 0 where it does not start anew
double UnwrapInput(daq::Record& record, double ratio) {
  const std::span<const double> output_deg = record.Doubles("output_angle_deg");
  std::vector<double> input_deg = record.CopyAsDoubles("input_angle_deg");
  std::optional<Wraps> wraps = samples::FindWraps(input_deg, kTurn_deg, Returns(output_deg, 0.5 * kTurn_deg));
  const bool found = wraps.has_value();
  if (!found) {
    const bool keeps_to_one_turn = SpanOf(input_deg) <= kTurn_deg;
    if (!keeps_to_one_turn || std::abs(ratio) * SpanOf(output_deg) < kClearlyWrapped * kTurn_deg) return 0.0;
    wraps = Wraps{kTurn_deg, {1}};
  }
  std::vector<double> expected_deg(output_deg.size(), 0.0);
  for (std::size_t i = 1; i < output_deg.size(); ++i)
    expected_deg[i] = ratio * (output_deg[i] - output_deg[i - 1]);
  std::vector<double> along_deg = input_deg;
  if (samples::UnwrapAlong(along_deg, wraps->modulus, expected_deg) <= kOffRatio) {
    input_deg = std::move(along_deg);
  } else if (found) {
    const double share = samples::UsualStep(input_deg, *wraps);
    if (share > kMostOfInput) RefuseWraps(record, "input_angle_deg", *wraps, "deg", share, kMostOfInput);
    samples::Unwrap(input_deg, wraps->modulus);
  } else {
    return 0.0;
  }
  record.SetColumn("input_angle_deg", std::move(input_deg));
  if (found) {
    NoteWraps(record, "input_angle_deg", *wraps, "deg");
  } else {
    NoteOn(record,
           fmt::format("input_angle_deg keeps to one turn where the output's way is {:.4g} of its turns: it "
                       "starts anew each turn; taken as going on",
                       std::abs(ratio) * SpanOf(output_deg) / kTurn_deg));
  }
  return wraps->modulus;
}

// Absolute angles that start anew have lost the turns before the record: of all numbers of turns the gear is
// nearest to that which leaves the least error.
void TakeLostTurns(daq::Record& record, double ratio, double output_modulus_deg, double input_modulus_deg) {
  std::vector<double> input_deg = record.CopyAsDoubles("input_angle_deg");
  std::vector<double> output_deg = record.CopyAsDoubles("output_angle_deg");
  const auto mean_error_deg = [&] {
    double mean_deg = 0.0;
    for (std::size_t i = 0; i < input_deg.size(); ++i)
      mean_deg += (input_deg[i] / ratio - output_deg[i]) / static_cast<double>(input_deg.size());
    return mean_deg;
  };
  const auto shift = [](std::vector<double>& values, double by_deg) {
    for (double& value : values) value += by_deg;
  };
  if (output_modulus_deg > 0.0)
    shift(output_deg, output_modulus_deg * std::round(mean_error_deg() / output_modulus_deg));
  if (input_modulus_deg > 0.0)
    shift(input_deg, -input_modulus_deg * std::round(ratio * mean_error_deg() / input_modulus_deg));
  record.SetColumn("input_angle_deg", std::move(input_deg));
  record.SetColumn("output_angle_deg", std::move(output_deg));
}

}  // namespace

void LookAtAngles(daq::Record& record) {
  if (record.kind == daq::RecordKind::kMotion) UnwrapAlone(record, "position_rad", kTwoPi, "rad");
  if (record.kind == daq::RecordKind::kHysteresis) UnwrapAlone(record, "output_angle_deg", kTurn_deg, "deg");
  if (record.kind != daq::RecordKind::kTransmissionError) return;
  const double ratio = *daq::MetadataNumber(record, "ratio");
  const double output_modulus_deg = UnwrapOutput(record, ratio);
  const double input_modulus_deg = UnwrapInput(record, ratio);
  if (record.Metadata("absolute") == "true" && (output_modulus_deg > 0.0 || input_modulus_deg > 0.0))
    TakeLostTurns(record, ratio, output_modulus_deg, input_modulus_deg);
}

}  // namespace strainwave::bench
