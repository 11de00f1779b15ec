// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/diagnosis/vibration/combs.h"
#include "analysis/diagnosis/vibration/parameters.h"
#include "analysis/model/vibration_orders.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Lines have phases and orders, for which BIC charges as if all samples spoke of each: in four channels they
// had to be twice as strong as what no chance makes. Under noise their likelihood ratio is χ² but for the
// search locations that are counted: the p-value alone says whether a nuisance term is there.
constexpr double kAnyBic = -1e9;
constexpr int kAllNumbers = 1000;
constexpr double kLargest = 1e6;            // an accelerometer's range is far below
constexpr double kResonanceMisfit = 0.005;  // of squares; a structure rings in more than one way

constexpr char kOtherSpeed[] =
    "# the same load at another speed: a line of the shaft moves with the speed, a resonance stays where it "
    "is\n"
    "- {kind: measurement_rotation, turns: 1, direction: cw, output_torque: 40 Nm, input_speed: 1500 rpm, "
    "vibration_rate: 25.6 kHz}\n";

struct Table {
  const VibrationSamples& samples;
  VibrationRules& rules;
  ParameterRule amplitude;
  double cells;  // resolution cells of a spectrum

  void Add(VibrationCause kind, CauseRule rule) {
    rules.kinds.push_back(kind);
    rules.rules.push_back(std::move(rule));
  }
};

void AddGearMesh(Table& table) {
  const VibrationSamples& samples = table.samples;
  const double order = model::FlexsplineMeshOrder(samples.ratio);
  CauseRule rule{
      .name = "gear_mesh",
      .what_to_do =
          "compare with a record of this unit when it was new; where it is louder now, check alignment and "
          "grease",
      .sentence = fmt::format("lines at the orders at which teeth meet, {:g} and {:g} per input turn, with "
                              "sidebands: every gear has them, a new one, too; louder than this one's were "
                              "when it was new they speak of worn or misaligned teeth, or lack of grease",
                              order, model::CircularSplineMeshOrder(samples.ratio)),
      .where = Where::kUnit,
      .effect = "E2",
      .parameters = {table.amplitude},
      .degrees_of_freedom = 2,
      .known_by_size = true,
      .location_parameters =
          kAllNumbers,        // of each line a phase and a share of the amplitude, as sharp as it is large
      .trials_factor = 4.0};  // either line or both; which further ones, the fit says
  const double folded = FoldedVibrationOrder(samples, order);
  if (std::abs(folded - order) > 1e-9) {
    rule.aliases.push_back(fmt::format("line at {:.2f} per input turn", folded));
    rule.to_settle =
        "# a higher sampling rate shows the teeth where they are\n- {kind: measurement_rotation, turns: 1, "
        "direction: cw, output_torque: 40 Nm, input_speed: 2400 rpm, vibration_rate: 51.2 kHz}\n";
  }
  table.Add(VibrationCause::kGearMesh, std::move(rule));
}

void AddToothEngagement(Table& table) {
  table.Add(VibrationCause::kToothEngagement,
            {.name = "gear_mesh",
             .what_to_do = "compare with a record of this unit when it was new; where it is louder now, "
                           "check alignment and grease",
             .sentence =
                 fmt::format("a smooth line at {:.4g} per input turn, where a tooth of one spline meets the "
                             "next of the other: every gear has some of it; louder than this one's was when "
                             "it was new it speaks of worn or misaligned teeth, or lack of grease",
                             model::CrackOrder(table.samples.ratio)),
             .where = Where::kUnit,
             .effect = "E2",
             .parameters = {table.amplitude},
             .degrees_of_freedom = 2,
             // A crack, which has the same order, is looked for first.
             .trials_factor = 400.0,
             .to_settle = "# at light load a crack opens less, teeth meet all the same\n"
                          "- {kind: measurement_rotation, turns: 4, direction: cw, output_torque: 5 Nm, "
                          "input_speed: 2400 rpm, vibration_rate: 25.6 kHz}\n"});
}

void AddBearing(Table& table) {
  const double highest = std::min(kHighestBearingOrder, 0.45 * table.samples.highest_order());
  if (!(highest > kLowestBearingOrder)) return;
  table.Add(
      VibrationCause::kBearingDefect,
      {.name = "bearing_defect",
       .what_to_do = "record again uncoupled to learn whose bearing it is, and plan to replace that one",
       .sentence =
           "impulses at an order that is no whole number, with harmonics or a resonance that rings: a "
           "race or a ball is damaged, in the wave generator's bearing or in one of the input shaft's",
       .where = Where::kUndecided,
       .effect = "E24",
       .parameters = {{"defect_order", "1/turn", kLowestBearingOrder, kHighestBearingOrder, false},
                      table.amplitude},
       .degrees_of_freedom = 5,
       .known_by_size = true,
       .location_parameters = 4,  // order, resonance, its decay, where the impulses stand
       // Orders, at each some tens of resonances that may ring, with each change of the impulses, in any of
       // the channels; how many of them a train might have had, the fit says. Of 235 clean records 7 had
       // p < 0.2, where 6 should.
       .trials_factor = 1300.0 * table.cells,
       .misfit_share = kResonanceMisfit,
       .to_settle = "# the motor alone, uncoupled: a defect that is still heard is in the motor's bearings\n"
                    "- {kind: measurement_rotation, turns: 1, direction: cw, output_torque: 40 Nm, "
                    "input_speed: 1500 rpm, vibration_rate: 25.6 kHz}\n"});
}

void AddCrack(Table& table) {
  const VibrationSamples& samples = table.samples;
  const double order = model::CrackOrder(samples.ratio);
  table.Add(
      VibrationCause::kFlexsplineCrack,
      {.name = "flexspline_crack",
       .what_to_do = "stop the test and inspect the flexspline",
       .sentence = fmt::format(
           "impulses at {:.4g} per input turn, or a line of the shaft that changes once per output "
           "turn: a place of the flexspline meets the two lobes of the wave generator, as a crack "
           "does",
           order),
       .where = Where::kUnit,
       .effect = "E23",
       // Nearer to 2 it is what looseness and misalignment make of the shaft.
       .parameters = {{"crack_order", "1/turn", order - 0.3 * (order - 2.0), order + 0.3 * (order - 2.0),
                       false},
                      table.amplitude},
       .degrees_of_freedom = 2,
       .known_by_size = true,
       // Widths and phases of a pulse, changes, resonances and lines, in any of the channels. A seventeenth
       // of 136 clean records had p < 0.05 with a tenth of these, where a two-hundred-and-fortieth should.
       .trials_factor = 100.0,
       .to_settle = "# a whole turn of the output or more: the impulses come back once per output turn\n"
                    "- {kind: measurement_rotation, turns: 4, direction: cw, output_torque: 40 Nm, "
                    "input_speed: 2400 rpm, vibration_rate: 25.6 kHz}\n"});
}

void AddResonances(Table& table) {
  const double highest = table.samples.highest_Hz();
  const std::vector<ParameterRule> parameters{
      {"frequency_Hz", "Hz", kLowestTorsional_Hz, kHighestTorsional_Hz, false},
      {"damping_ratio", "1", kLeastTorsionalDamping, 0.25, false},
      table.amplitude};
  const double share = std::min(1.0, kHighestTorsional_Hz / highest);
  table.Add(
      VibrationCause::kTorsionalResonance,
      {.name = "torsional_resonance",
       .what_to_do =
           "choose speeds whose orders stay away from the frequency named, and look for loose couplings",
       .sentence =
           "a lightly damped resonance at a fixed frequency, whatever the speed: the gear's stiffness "
           "between its two inertias; the model foretells it from one sample to the next",
       .where = Where::kUndecided,
       .effect = "E15",
       .parameters = parameters,
       .degrees_of_freedom = 3,
       .known_by_size = true,
       .location_parameters = 1,  // its frequency
       .trials_factor = std::max(50.0, 1.5 * share * table.cells),
       .local = true,  // an impact rings for a small part of a turn
       .to_settle = kOtherSpeed});
  if (highest > 1.1 * kHighestTorsional_Hz) {
    table.Add(VibrationCause::kHighResonance,
              {.name = "resonance of the structure",
               .parameters = {{"damping_ratio", "1", kLeastStructureDamping, 0.25, false}, table.amplitude},
               .degrees_of_freedom = 3,
               .location_parameters = 1,
               .trials_factor = std::max(50.0, 1.5 * (1.0 - share) * table.cells),
               .local = true,
               .named = false});
  }
}

void AddImbalance(Table& table, VibrationSamples& samples) {
  double spread = 0.0;
  for (const VibrationRun& run : samples.runs) spread = std::max(spread, run.speed_spread);
  if (spread <= kLeastSpeedSpread) {
    samples.warnings.push_back(
        "imbalance cannot be judged: at one speed it is part of the shaft's own line at 1 per turn (a run at "
        "another "
        "speed, or through the speeds, would tell)");
    return;
  }
  ParameterRule amplitude = table.amplitude;
  amplitude.name = "amplitude_at_1000_rpm" + amplitude.name.substr(std::string("amplitude").size());
  table.Add(
      VibrationCause::kImbalance,
      {.name = "imbalance",
       .what_to_do = "balance motor shaft, coupling and wave generator, and record again",
       .sentence =
           "the shaft's line at 1 per turn grows with the square of the speed: a mass off centre on the "
           "motor shaft, the coupling or the wave generator",
       .where = Where::kUndecided,
       .effect = "E19",
       .parameters = {std::move(amplitude)},
       .degrees_of_freedom = 2,
       .known_by_size = true,
       // In any of the channels. Of 48 clean records 13 had p < 0.63 without these, where 4 should.
       .trials_factor = 4.0,
       .to_settle =
           "# the motor alone, uncoupled, through the same speeds: an imbalance that stays is the bench's\n"
           "- {kind: measurement_rotation, turns: 1, direction: cw, output_torque: 40 Nm, input_speed: 2400 "
           "rpm, vibration_rate: 25.6 kHz}\n"});
}

void AddNuisanceTerms(Table& table) {
  const VibrationSamples& samples = table.samples;
  const std::vector<ParameterRule> amplitude{table.amplitude};
  bool steady = samples.angle_known();
  for (const VibrationRun& run : samples.runs) {
    // A tone is smeared over orders by less than a cell: line and tone are one.
    steady = steady && run.speed_spread * run.turns * 2.0 < 1.0;
  }
  if (samples.angle_known()) {
    for (const char* name : {"line over shaft angle", "second line over shaft angle"}) {
      table.Add(VibrationCause::kLineOverAngle, {.name = name,
                                                 .parameters = amplitude,
                                                 .degrees_of_freedom = 3,
                                                 .location_parameters = 1,
                                                 .trials_factor = table.cells,
                                                 .least_bic = kAnyBic,
                                                 .named = false});
    }
  }
  if (!steady) {
    for (const char* name : {"line over time", "second line over time"}) {
      table.Add(VibrationCause::kLineOverTime, {.name = name,
                                                .parameters = amplitude,
                                                .degrees_of_freedom = 3,
                                                .location_parameters = 1,
                                                .trials_factor = table.cells,
                                                .least_bic = kAnyBic,
                                                .named = false});
    }
  }
  table.Add(VibrationCause::kBurst, {.name = "burst of a tone",
                                     .parameters = amplitude,
                                     .degrees_of_freedom = 5,
                                     .trials_factor = 4.0 * table.cells,
                                     .local = true,
                                     .named = false});
  table.Add(VibrationCause::kSlowChange,
            {.name = "slow change of the mean", .degrees_of_freedom = 3, .named = false});
}

}  // namespace

VibrationRules RulesFor(VibrationSamples& samples) {
  VibrationRules rules;
  double longest = 0.0;
  for (const VibrationRun& run : samples.runs) longest = std::max(longest, run.span_s());
  const std::string unit = UnitOfChannel(samples.runs.front().channels.front().name);
  Table table{samples,
              rules,
              {AmplitudeName(samples), unit, 0.0, kLargest, true},
              2.0 * longest * samples.highest_Hz()};
  if (samples.angle_known()) {
    AddGearMesh(table);
    AddToothEngagement(table);
    AddBearing(table);
    AddCrack(table);
    AddImbalance(table, samples);
  }
  AddResonances(table);
  AddNuisanceTerms(table);
  return rules;
}

}  // namespace strainwave::analysis::diagnosis
