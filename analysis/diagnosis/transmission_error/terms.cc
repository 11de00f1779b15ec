// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/transmission_error/terms.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "analysis/diagnosis/scans.h"
#include "analysis/diagnosis/transmission_error/folded_orders.h"
#include "analysis/harmonic_regression.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kLeastWarming_K = 0.1;  // a drift of less than that is one of time

constexpr char kSmallerStep[] =
    "# a smaller step tells the orders apart that these steps fold onto one another\n"
    "- {kind: transmission_error, step: 0.25 deg, steps: 1440, directions: both, input_speed: 300 rpm}\n";

using Samples = TransmissionErrorSamples;

// The column less its mean in each record: per-record offsets are in the nominal model.
std::vector<double> Centred(const Samples& samples, std::vector<double> column) {
  std::vector<double> sum(samples.records, 0.0);
  std::vector<double> count(samples.records, 0.0);
  for (std::size_t i = 0; i < column.size(); ++i) {
    sum[samples.record[i]] += column[i];
    count[samples.record[i]] += 1.0;
  }
  for (std::size_t i = 0; i < column.size(); ++i)
    column[i] -= sum[samples.record[i]] / count[samples.record[i]];
  return column;
}

void AddHarmonicCause(const Samples& samples, SeparableModel& model, CauseRule rule, bool input,
                      double order) {
  rule.parameters = {{"amplitude_arcmin", "arcmin", 0.0, kLargest_arcmin, true}};
  rule.degrees_of_freedom = 2;
  const double per_output = input ? order * std::abs(samples.ratio) : order;
  const std::string why =
      WhyNotSeen(samples, per_output, {{2.0 * std::abs(samples.ratio), "the second harmonic"}});
  if (!why.empty()) {
    model.warnings.push_back(fmt::format("no verdict on {}: {}", rule.name, why));
    return;
  }
  if (samples.samples_per_turn > 0.0) {
    const double folded = FoldedOrder(per_output, samples.samples_per_turn);
    if (std::abs(folded - per_output) > 1e-6) {
      rule.aliases.push_back(fmt::format("line at {:.2f} per output turn", folded));
      rule.to_settle = kSmallerStep;
    }
  }
  model.causes.push_back(HarmonicTerm(input ? samples.input_rad : samples.output_rad, order,
                                      "amplitude_arcmin", "arcmin", kArcminPerRad));
  model.rules.push_back(std::move(rule));
}

void AddHarmonics(const Samples& samples, SeparableModel& model) {
  AddHarmonicCause(
      samples, model,
      {.name = "wave_generator_first_harmonic",
       .what_to_do = "measure the runout of wave generator and input coupling, centre the input encoder, and "
                     "sweep again",
       .sentence = "an error once per turn of the input: the wave generator or the input coupling runs "
                   "out, or the input encoder is mounted off centre",
       .where = Where::kUndecided,
       .effect = "E4",
       .to_settle = "# remount the input coupling turned by 90 degrees: the phase moves with the part "
                    "that errs\n- {kind: transmission_error, step: 1 deg, steps: 360, directions: both, "
                    "input_speed: 300 rpm}\n"},
      true, 1.0);
  AddHarmonicCause(
      samples, model,
      {.name = "wave_generator_fourth_harmonic",
       .what_to_do =
           "exchange the wave generator, if there is a second one, and sweep again: the error goes with it",
       .sentence = "an error four times per turn of the wave generator: its shape departs from an "
                   "ellipse",
       .where = Where::kUnit,
       .effect = "E1"},
      true, 4.0);
  AddHarmonicCause(
      samples, model,
      {.name = "output_eccentricity",
       .what_to_do = "turn the output encoder by half a turn on its flange and sweep again: an error of the "
                     "encoder turns with it",
       .sentence = "an error once per turn of the output: flange or flexspline run out, or the output "
                   "encoder is mounted off centre; one record cannot tell which",
       .where = Where::kUndecided,
       .effect = "E3",
       .to_settle = "# remount the output encoder turned by 90 degrees: the phase moves with the "
                    "encoder, or stays with the gear\n- {kind: transmission_error, step: 1 deg, steps: 360, "
                    "directions: both, input_speed: 300 rpm}\n"},
      false, 1.0);
  AddHarmonicCause(
      samples, model,
      {.name = "circular_spline_ovality",
       .what_to_do = "loosen the circular spline, tighten its screws crosswise, and sweep again",
       .sentence = "an error twice per turn of the output: the circular spline is oval (clamped "
                   "unevenly), or the output encoder is tilted",
       .where = Where::kUndecided,
       .effect = "E3",
       .to_settle = "# remount the output encoder turned by 90 degrees: an oval spline keeps its "
                    "phase\n- {kind: transmission_error, step: 1 deg, steps: 360, directions: both, "
                    "input_speed: 300 rpm}\n"},
      false, 2.0);
  const double engagement = 2.0 * std::abs(samples.ratio) + 2.0;
  const bool folds = samples.samples_per_turn > 0.0 && samples.samples_per_turn < 2.0 * engagement;
  // Two per output turn beside the second harmonic: half a turn does not part them.
  if (SpanOf(samples.output_rad) > 0.9 * kTwoPi && !folds) {
    AddHarmonicCause(
        samples, model,
        {.name = "tooth_engagement",
         .what_to_do = "compare with the sweep of this unit when it was new: every gear has some of it",
         .sentence = "an error at the order at which teeth of flexspline and circular spline meet; it "
                     "beats with the second harmonic",
         .where = Where::kUnit,
         .effect = "E2"},
        false, engagement);
  }
}

void AddBacklash(const Samples& samples, SeparableModel& model) {
  if (!(SpanOf(samples.direction) > 1.0)) {
    model.warnings.push_back("backlash cannot be judged: the record has one direction only");
    return;
  }
  std::vector<double> half(samples.direction);
  for (double& value : half) value *= 0.5;
  model.causes.push_back(ColumnTerm(std::move(half), {"backlash_arcmin", "arcmin", kArcminPerRad}));
  CauseRule rule{.name = "backlash",
                 .what_to_do =
                     "look for play in keys and couplings, and sweep again at half the speed: a skew in time "
                     "halves, lost motion stays",
                 .sentence = "a constant difference between the two directions: lost motion",
                 .where = Where::kUnit,
                 .effect = "E4",
                 .parameters = {{"backlash_arcmin", "arcmin", -kLargest_arcmin, kLargest_arcmin, true}}};
  if (samples.has_time) {
    rule.where = Where::kUndecided;
    rule.sentence += "; at one speed, a skew in time between the two encoders looks the same";
    rule.to_settle =
        "# the same sweep at half the speed: a skew in time halves, lost motion stays\n"
        "- {kind: transmission_error, step: 1 deg, steps: 360, directions: both, input_speed: 150 "
        "rpm}\n";
  }
  model.rules.push_back(std::move(rule));
}

// Turns of the output that the sweeps go through, there and back.
double TurnsTravelled(const Samples& samples) {
  double way_rad = 0.0;
  for (std::size_t i = 1; i < samples.output_rad.size(); ++i) {
    if (samples.record[i] == samples.record[i - 1])
      way_rad += std::abs(samples.output_rad[i] - samples.output_rad[i - 1]);
  }
  return way_rad / kTwoPi;
}

// A room that warms and cools again, about once in the record; where the sweep goes by each angle once that
// is an eccentricity.
void AddSwingOfDrift(const Samples& samples, SeparableModel& model, CauseRule rule) {
  constexpr double kShortest = 0.7;  // period, of the record
  constexpr double kLongest = 4.0;
  const double span_s = SpanOf(samples.time_s);
  if (!(span_s > 0.0) || !TimeIsApartFromAngle(samples)) return;
  const double first_s = *std::min_element(samples.time_s.begin(), samples.time_s.end());
  SeparableTerm term;
  term.columns = 2;
  term.nonlinear_parameters = {{.low = kShortest * span_s, .high = kLongest * span_s, .step = 0.2 * span_s}};
  term.fill = [time = samples.time_s, first_s](std::span<const double> nonlinear_parameters,
                                               Eigen::Ref<Eigen::MatrixXd> design) {
    for (std::size_t i = 0; i < time.size(); ++i) {
      const double phase = kTwoPi * (time[i] - first_s) / nonlinear_parameters[0];
      design(static_cast<Eigen::Index>(i), 0) = std::cos(phase);
      design(static_cast<Eigen::Index>(i), 1) = std::sin(phase);
    }
  };
  term.starts = [span_s](const WeightedResidual&) {
    return std::vector<std::vector<double>>{{0.9 * span_s}, {1.5 * span_s}, {2.5 * span_s}};
  };
  DescribeAsHarmonic(term, "drift_swing_arcmin", "arcmin", kArcminPerRad,
                     {samples.has_time ? NonlinearParameterDescription{"period_s", "s", 1.0}
                                       : NonlinearParameterDescription{"period_samples", "samples", 1.0}});
  rule.parameters = {{"drift_swing_arcmin", "arcmin", 0.0, 1e6, true}};
  rule.degrees_of_freedom = 3;
  model.causes.push_back(std::move(term));
  model.rules.push_back(std::move(rule));
}

void AddDrift(const Samples& samples, SeparableModel& model) {
  CauseRule rule{.name = "thermal_drift",
                 .what_to_do = "let the bench warm up until its temperature stands, and sweep again",
                 .sentence = "the error moves with temperature or time, whatever the angle",
                 .where = Where::kUndecided,
                 .effect = "E10",
                 .to_settle =
                     "# hold still after the sweep: a thermal drift goes on, an error of angle does not\n"
                     "- {kind: soak, below_temperature: 25 degC, at_most: 1 h}\n- {kind: transmission_error, "
                     "step: 1 deg, steps: 360, "
                     "directions: both, input_speed: 300 rpm}\n"};
  if (SpanOf(samples.temperature_degC) > kLeastWarming_K) {
    rule.parameters = {{"drift_arcmin_per_K", "arcmin/K", -50.0, 50.0, true}};
    model.causes.push_back(ColumnTerm(Centred(samples, samples.temperature_degC),
                                      {"drift_arcmin_per_K", "arcmin/K", kArcminPerRad}));
    model.rules.push_back(rule);
  }
  const double span_s = SpanOf(samples.time_s);
  if (!(span_s > 0.0)) return;
  const double first_s = *std::min_element(samples.time_s.begin(), samples.time_s.end());
  // Per hour; without a time column per sample.
  const double unit = samples.has_time ? 3600.0 : 1.0;
  const std::string name = samples.has_time ? "drift_arcmin_per_h" : "drift_arcmin_per_sample";
  rule.parameters = {{name, samples.has_time ? "arcmin/h" : "arcmin", -1e9, 1e9, true}};
  SeparableTerm term;
  term.nonlinear_parameters = {{0.02 * span_s, 50.0 * span_s, 0.3 * span_s}};
  term.fill = [time = samples.time_s, first_s, span_s](std::span<const double> nonlinear_parameters,
                                                       Eigen::Ref<Eigen::MatrixXd> design) {
    // Saturates with the time constant; scaled so that the coefficient is the mean rate over the
    // record.
    const double scale = span_s / -std::expm1(-span_s / nonlinear_parameters[0]);
    for (std::size_t i = 0; i < time.size(); ++i) {
      design(static_cast<Eigen::Index>(i), 0) =
          -scale * std::expm1(-(time[i] - first_s) / nonlinear_parameters[0]);
    }
  };
  term.starts = [span_s](const WeightedResidual&) {
    return std::vector<std::vector<double>>{{20.0 * span_s}, {0.3 * span_s}};
  };
  DescribeEach(term, {{name, rule.parameters[0].unit, kArcminPerRad * unit},
                      {samples.has_time ? "time_constant_s" : "time_constant_samples",
                       samples.has_time ? "s" : "samples", 1.0}});
  rule.degrees_of_freedom = 2;
  model.causes.push_back(std::move(term));
  model.rules.push_back(rule);
  AddSwingOfDrift(samples, model, rule);
  if (TimeIsApartFromAngle(samples)) AddCurveOfDrift(samples, std::move(rule), model);
}

void AddWindup(const Samples& samples, SeparableModel& model) {
  if (samples.torque_Nm.empty()) return;
  if (!(SpanOf(samples.torque_Nm) > 0.2)) {
    model.warnings.push_back("wind-up under load cannot be judged: the torque hardly changes in this record");
    return;
  }
  model.causes.push_back(
      ColumnTerm(Centred(samples, samples.torque_Nm), {"windup_arcmin_per_Nm", "arcmin/Nm", kArcminPerRad}));
  model.rules.push_back(
      {.name = "load_windup",
       .what_to_do = "run the extended model under load, or put the output encoder on the gear's own flange",
       .sentence = "the error follows the torque: the gear, or what is in series with it, winds up",
       .where = Where::kUndecided,
       .effect = "E5",
       .parameters = {{"windup_arcmin_per_Nm", "arcmin/Nm", -20.0, 20.0, true}},
       .to_settle = "# a lock test gives the stiffness by itself; with a blank test of the bench "
                    "it parts gear and couplings\n- {kind: hysteresis, peak_torque: 34 Nm, "
                    "torque_rate: 3 Nm/s, hold: 0.5 s, loops: 1}\n"});
}

}  // namespace

bool TimeIsApartFromAngle(const Samples& samples) {
  constexpr double kFewestTurns = 1.5;
  return TurnsTravelled(samples) >= kFewestTurns;
}

SeparableTerm HarmonicTerm(const std::vector<double>& angle_rad, double order, std::string amplitude_name,
                           std::string unit, double unit_per_si) {
  auto design = std::make_shared<Eigen::MatrixXd>(static_cast<Eigen::Index>(angle_rad.size()), 2);
  for (std::size_t i = 0; i < angle_rad.size(); ++i) {
    (*design)(static_cast<Eigen::Index>(i), 0) = std::cos(order * angle_rad[i]);
    (*design)(static_cast<Eigen::Index>(i), 1) = std::sin(order * angle_rad[i]);
  }
  SeparableTerm term;
  term.columns = 2;
  term.fill = [design](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> out) { out = *design; };
  DescribeAsHarmonic(term, std::move(amplitude_name), std::move(unit), unit_per_si);
  return term;
}

SeparableTerm ColumnTerm(std::vector<double> column, NonlinearParameterDescription description) {
  SeparableTerm term;
  term.fill = [column = std::move(column)](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> out) {
    out.col(0) = Eigen::Map<const Eigen::VectorXd>(column.data(), static_cast<Eigen::Index>(column.size()));
  };
  DescribeEach(term, {std::move(description)});
  return term;
}

void AddTransmissionErrorCauses(const Samples& samples, SeparableModel& model) {
  AddHarmonics(samples, model);
  AddBacklash(samples, model);
  AddDrift(samples, model);
  AddLocalDamages(samples, model);
  AddWindup(samples, model);
  AddTransmissionErrorNuisanceTerms(samples, model);
}

}  // namespace strainwave::analysis::diagnosis
