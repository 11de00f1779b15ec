// SPDX-License-Identifier: Apache-2.0
#include "bench/records/sweep_checks.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "analysis/diagnosis/scans.h"
#include "analysis/noise_level.h"
#include "analysis/units.h"
#include "bench/records/looks.h"
#include "bench/records/record_refusal.h"
#include "daq/record_rules.h"

namespace strainwave::bench {
namespace {

using daq::Direction;

// Twice what the worst gear has, so that a short sweep is not taken for a wrong ratio.
constexpr double kLargestError_deg = 10.0 / 60.0;
// Teeth that differ by one change a ratio of 160 by 0.6 %.
constexpr double kRatioTolerance = 0.004;

[[noreturn]] void Refuse(const daq::Record& record, const std::string& what, const std::string& expected) {
  throw RecordRefusal(record, fmt::format("{} (expected {})", what, expected));
}

// Samples of one direction, in the order of the record.
struct Sweep {
  std::vector<double> input_deg;
  std::vector<double> output_deg;
};

Sweep SweepOf(const daq::Record& record, Direction direction) {
  const auto directions = record.Directions("direction");
  const auto input_deg = record.Doubles("input_angle_deg");
  const auto output_deg = record.Doubles("output_angle_deg");
  Sweep sweep;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    if (directions[i] != direction) continue;
    sweep.input_deg.push_back(input_deg[i]);
    sweep.output_deg.push_back(output_deg[i]);
  }
  return sweep;
}

double MeanOf(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// Input angle over output angle by least squares, each direction about its own mean.
double SlopeOf(std::span<const Sweep> sweeps) {
  double product = 0.0;
  double square = 0.0;
  for (const Sweep& sweep : sweeps) {
    if (sweep.output_deg.empty()) continue;
    const double input_mean = MeanOf(sweep.input_deg);
    const double output_mean = MeanOf(sweep.output_deg);
    for (std::size_t i = 0; i < sweep.output_deg.size(); ++i) {
      const double output = sweep.output_deg[i] - output_mean;
      product += output * (sweep.input_deg[i] - input_mean);
      square += output * output;
    }
  }
  return product / square;
}

std::string RatioText(double ratio) {
  const double whole = std::round(ratio);
  return std::abs(ratio - whole) <= 1e-3 * std::abs(ratio) ? fmt::format("{:.0f}", whole)
                                                           : fmt::format("{:.4g}", ratio);
}

struct UnitMixUp {
  double factor;  // seen ratio over the one of the file
  const char* column;
  const char* unit;
};
const UnitMixUp kMixUps[] = {
    {60.0, "input_angle_deg", "arcmin"},         {1.0 / 60.0, "output_angle_deg", "arcmin"},
    {3600.0, "input_angle_deg", "arcsec"},       {1.0 / 3600.0, "output_angle_deg", "arcsec"},
    {RadFromDeg(1.0), "input_angle_deg", "rad"}, {DegFromRad(1.0), "output_angle_deg", "rad"},
    {1.0 / 360.0, "input_angle_deg", "turns"},   {360.0, "output_angle_deg", "turns"}};

void CheckRatio(const daq::Record& record, std::span<const Sweep> sweeps, double span_deg) {
  const double said = *daq::MetadataNumber(record, "ratio");
  const double seen = SlopeOf(sweeps);
  const double tolerance = std::max(kRatioTolerance, kLargestError_deg / span_deg);
  if (std::abs(seen / said - 1.0) <= tolerance) return;
  for (const UnitMixUp& mix_up : kMixUps) {
    if (std::abs(seen / said / mix_up.factor - 1.0) > kRatioTolerance) continue;
    Refuse(record,
           fmt::format("{} looks like {}: the input turns {:.5g} for 1 of the output, the ratio says {:g}",
                       mix_up.column, mix_up.unit, seen, said),
           "angles in degrees");
  }
  Refuse(record, fmt::format("ratio looks like {}, file says {:g}", RatioText(seen), said),
         "ratio = input angle / output angle, signed");
}

// Both columns in another unit: the ratio is right, but whole turns stand at another number.
void CheckTurns(const daq::Record& record, double span_deg) {
  constexpr double kTurn_arcmin = 360.0 * 60.0;
  const auto is_whole = [span_deg](double turn) {
    const double turns = span_deg / turn;
    const double nearest = std::round(turns);
    // A stepped sweep ends a step before the turn is full.
    return nearest >= 1.0 && nearest <= 4.0 && turns > nearest - 0.01 && turns < nearest + 0.002;
  };
  const bool radians = is_whole(kTwoPi);
  if (!radians && !is_whole(kTurn_arcmin)) return;
  const double turns = std::round(span_deg / (radians ? kTwoPi : kTurn_arcmin));
  Refuse(record,
         fmt::format("output_angle_deg spans {:.5g}, which is {} in {}", span_deg,
                     turns == 1.0 ? std::string("a whole turn") : fmt::format("{:.0f} whole turns", turns),
                     radians ? "rad" : "arcmin"),
         "angles in degrees");
}

// Which way a sweep turns: +1, −1, or 0 where it does not move; and the rows that go against it.
struct Travel {
  int sign{};
  std::size_t against{};
};

constexpr std::ptrdiff_t kFewestMoving = 8;  // steps: fewer, and the noise is a guess

Travel TravelOf(std::span<const double> angle_deg) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < angle_deg.size(); ++i) steps.push_back(angle_deg[i] - angle_deg[i - 1]);
  if (steps.empty()) return {};
  std::vector<double> sizes;
  for (const double step : steps) sizes.push_back(std::abs(step));
  std::ranges::sort(sizes);
  // Noise between readings at one standstill is no travel, however long it lasts.
  const double noise = 6.0 * analysis::EstimateNoise(angle_deg).standard_deviation;
  const auto moving = std::ranges::upper_bound(sizes, noise);
  if (sizes.end() - moving >= kFewestMoving) sizes.erase(sizes.begin(), moving);
  const double counts = 0.2 * sizes[sizes.size() * 9 / 10];
  std::size_t forward = 0;
  std::size_t backward = 0;
  for (const double step : steps) {
    if (step > counts) ++forward;
    if (step < -counts) ++backward;
  }
  if (forward == backward) return {0, forward};
  return {forward > backward ? 1 : -1, std::min(forward, backward)};
}

void CheckDirections(daq::Record& record, std::span<const Sweep> sweeps) {
  const char* const names[] = {"cw", "ccw"};
  int signs[] = {0, 0};
  for (std::size_t k = 0; k < sweeps.size(); ++k) {
    const std::size_t rows = sweeps[k].output_deg.size();
    const Travel travel = TravelOf(sweeps[k].output_deg);
    signs[k] = travel.sign;
    // A repeated sweep jumps back once for each turn; half-degree overshoots may happen.
    const std::size_t allowed = std::max<std::size_t>(3, rows / 50);
    if (travel.against <= allowed) continue;
    Refuse(record,
           fmt::format("direction contradicts the angles: {} of {} rows marked {} turn the other way",
                       travel.against, rows, names[k]),
           "cw where the output turns one way, ccw where it turns back");
  }
  if (signs[0] != 0 && signs[0] == signs[1]) {
    NoteOn(record,
           fmt::format("direction contradicts the angles: rows marked cw and rows marked ccw both turn the "
                       "output {}",
                       signs[0] > 0 ? "forwards" : "backwards"));
  } else if (signs[0] < 0 || signs[1] > 0) {
    NoteOn(record,
           fmt::format("direction contradicts the angles: {} turns the output {}; differences between the "
                       "directions have the other sign then",
                       signs[0] < 0 ? "cw" : "ccw", signs[0] < 0 ? "backwards" : "forwards"));
  }
}

}  // namespace

void CheckSweep(daq::Record& record) {
  const double output_span_deg = analysis::diagnosis::SpanOf(record.Doubles("output_angle_deg"));
  for (const char* column : {"input_angle_deg", "output_angle_deg"}) {
    const auto angle_deg = record.Doubles(column);
    if (analysis::diagnosis::SpanOf(angle_deg) > 0.0) continue;
    Refuse(record, fmt::format("{} is constant at {:g}", column, angle_deg.front()), "a sweep of the output");
  }
  const Sweep sweeps[] = {SweepOf(record, Direction::kClockwise),
                          SweepOf(record, Direction::kCounterClockwise)};
  CheckRatio(record, sweeps, output_span_deg);
  CheckTurns(record, output_span_deg);
  CheckDirections(record, sweeps);
}

}  // namespace strainwave::bench
