// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/validate_schedule.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include "analysis/units.h"
#include "schedules/reader/comparison.h"

namespace strainwave::schedules {
namespace {

// Ripple and control error come on top of a set point; nearer than this to the limit they trip it.
constexpr double kShareOfLimitWithoutRoom = 0.95;
// A turn of the output in fewer steps shows no more of the error than chance, and fails its own check.
constexpr double kFewestStepsPerTurn = 36.0;
// Below this many samples up to T1 the first slope is a guess.
constexpr double kFewestSamplesUpToT1 = 10.0;
// Angles are written in decimal degrees: a turn is whole when it is so to a thousandth of an arcsecond.
constexpr double kWholeTurn_rad = RadFromArcsec(1e-3);
// A load run's log is in memory until the run has ended, and once more while it is stored: eleven numbers of
// 8 bytes a row, with room for a run that takes a fifth and a minute longer than its load.
constexpr double kLoadRunRowInMemory_bytes = 11.0 * 8.0;
constexpr double kLongestLog_bytes = 256e6;

bool IsMeasurement(const PhaseParameters& parameters) {
  return std::holds_alternative<MeasurementRotation>(parameters) ||
         std::holds_alternative<TransmissionErrorSweep>(parameters) ||
         std::holds_alternative<HysteresisTest>(parameters);
}

template <typename Kind>
bool Has(const std::vector<Phase>& phases) {
  for (const Phase& phase : phases) {
    if (std::holds_alternative<Kind>(phase.parameters)) return true;
  }
  return false;
}

void CheckSpecimen(const Specimen& specimen, const Comparison& compare) {
  const Named t1{"specimen.t1", specimen.t1_Nm};
  const Named t2{"specimen.t2", specimen.t2_Nm};
  const Named t3{"specimen.t3", specimen.t3_Nm};
  compare.MustBeBelow(t1, t2);
  compare.MustBeBelow(t2, t3);
  const bool readable = compare.Readable("specimen.flexspline_teeth") &&
                        compare.Readable("specimen.circular_spline_teeth") &&
                        compare.Readable("specimen.ratio");
  if (!readable) return;
  const int difference = specimen.circular_spline_teeth - specimen.flexspline_teeth;
  if (difference <= 0) {
    compare.Error(
        "specimen.circular_spline_teeth",
        fmt::format("circular_spline_teeth = {} is not above flexspline_teeth = {} (expected two more)",
                    specimen.circular_spline_teeth, specimen.flexspline_teeth));
    return;
  }
  // With the circular spline fixed one input turn moves the output by the difference in teeth.
  const double ratio_of_teeth = static_cast<double>(specimen.flexspline_teeth) / difference;
  if (std::abs(std::abs(specimen.ratio) - ratio_of_teeth) > 1e-6 * ratio_of_teeth) {
    compare.Error("specimen.ratio",
                  fmt::format("ratio = {} does not fit {} and {} teeth (expected {:g} or -{:g})",
                              compare.Written({"specimen.ratio", specimen.ratio}), specimen.flexspline_teeth,
                              specimen.circular_spline_teeth, ratio_of_teeth, ratio_of_teeth));
  }
}

void CheckLimits(const Schedule& schedule, const Comparison& compare) {
  const Specimen& specimen = schedule.specimen;
  const Named limit{"limits.output_torque", schedule.limits.output_torque_Nm};
  for (const Named& failure : {Named{"specimen.ratcheting_torque", specimen.ratcheting_torque_Nm},
                               Named{"specimen.buckling_torque", specimen.buckling_torque_Nm}}) {
    compare.MustBeBelow(limit, failure);
    const bool small_margin = limit.value < failure.value && 2.0 * limit.value > failure.value;
    if (small_margin && compare.Readable(limit.path) && compare.Readable(failure.path)) {
      compare.Warning(limit.path,
                      fmt::format("output_torque = {} leaves a margin of {:.2f} to {} = {} (2 is usual)",
                                  compare.Written(limit), failure.value / limit.value, KeyOf(failure.path),
                                  compare.Written(failure)));
    }
  }
  const Named twist{"limits.twist", schedule.limits.twist_rad};
  const double half_tooth_rad = 0.5 * kTwoPi / specimen.flexspline_teeth;
  if (twist.value >= half_tooth_rad && compare.Readable(twist.path) &&
      compare.Readable("specimen.flexspline_teeth")) {
    compare.Error(
        twist.path,
        fmt::format("twist = {} is not below half a tooth, {:.4g} arcmin with "
                    "flexspline_teeth = {} (expected less, since teeth have jumped by then)",
                    compare.Written(twist), ArcminFromRad(half_tooth_rad), specimen.flexspline_teeth));
  }
}

constexpr double kWarmRoom_degC = 25.0;  // of a laboratory on a warm day

void CheckThermalRules(const Schedule& schedule, const Comparison& compare) {
  const Named trip{"suspend.trip_temperature", schedule.suspend.trip_temperature_degC};
  const Named resume{"suspend.resume_temperature", schedule.suspend.resume_temperature_degC};
  compare.MustBeBelow(resume, trip);
  if (resume.value < kWarmRoom_degC) {
    compare.Warning(resume.path,
                    fmt::format("resume_temperature = {} may be below the room's own temperature, so that a "
                                "suspended gear never comes down to it (expected at least {:g} degC, or a "
                                "climate chamber)",
                                compare.Written(resume), kWarmRoom_degC));
  }
  compare.MustBeBelow(trip, {"limits.gear_temperature", schedule.limits.gear_temperature_degC});
  compare.MustBeBelow({"measurements.declared_temperature", schedule.measurements.declared_temperature_degC},
                      trip);
  compare.MustBeBelow({"suspend.dwell", schedule.suspend.dwell_s},
                      {"suspend.give_up", schedule.suspend.give_up_s});
}

void CheckResumeRules(const ResumeRules& rules, const Comparison& compare) {
  if (rules.unattended == 0 || !rules.operator_acknowledges || !compare.Readable("resume.unattended")) return;
  compare.Error("resume.unattended",
                fmt::format("unattended = {} lets shafts move without a person (expected with it "
                            "operator_acknowledges: false, and people who are kept away from the bench)",
                            rules.unattended));
}

// The rules for one phase; `path` is where it stands: "phases[2]".
class PhaseCheck {
 public:
  PhaseCheck(const Schedule& schedule, std::string path, bool in_preparation, const Comparison& compare)
      : schedule_(schedule), path_(std::move(path)), in_preparation_(in_preparation), compare_(compare) {}

  void operator()(const LoadRun& run) const {
    CheckTorque("output_torque", run.output_torque_Nm);
    CheckSpeed(run.input_speed_rad_per_s);
    CheckTolerances(run.tolerances);
    CheckLog(run);
  }

  void operator()(const MeasurementRotation& rotation) const {
    CheckTorque("output_torque", rotation.output_torque_Nm);
    CheckSpeed(rotation.input_speed_rad_per_s);
    CheckTolerances(rotation.tolerances);
    CheckWholeTurns(rotation.turns);
  }

  void operator()(const TransmissionErrorSweep& sweep) const {
    CheckSpeed(sweep.input_speed_rad_per_s);
    if (!compare_.Readable(At("step")) || !compare_.Readable(At("steps"))) return;
    const double swept_rad = sweep.step_rad * sweep.steps;
    const double turns = std::round(swept_rad / kTwoPi);
    if (turns < 1.0 || std::abs(swept_rad - turns * kTwoPi) > kWholeTurn_rad) {
      compare_.Error(
          At("step"),
          fmt::format("steps = {} of step = {} make {:.6g} deg (expected whole turns of the output, a "
                      "multiple of 360 deg)",
                      sweep.steps, compare_.Written({At("step"), sweep.step_rad}), DegFromRad(swept_rad)));
      return;
    }
    const double steps_per_turn = kTwoPi / sweep.step_rad;
    if (steps_per_turn < kFewestStepsPerTurn - 0.5) {
      compare_.Error(
          At("step"),
          fmt::format("step = {} makes {:.4g} steps a turn of the output (expected at least "
                      "{:g}, or no sweep passes its checks)",
                      compare_.Written({At("step"), sweep.step_rad}), steps_per_turn, kFewestStepsPerTurn));
    }
  }

  void operator()(const HysteresisTest& test) const {
    CheckTorque("peak_torque", test.peak_torque_Nm);
    compare_.MustReach({At("peak_torque"), test.peak_torque_Nm}, {"specimen.t3", schedule_.specimen.t3_Nm});
    const double samples = schedule_.specimen.t1_Nm / test.torque_rate_Nm_per_s * test.log_rate_hz;
    const bool readable = compare_.Readable("specimen.t1") && compare_.Readable(At("torque_rate")) &&
                          compare_.Readable(At("log_rate"));
    if (readable && samples < kFewestSamplesUpToT1) {
      compare_.Error(
          At("torque_rate"),
          fmt::format("torque_rate = {} leaves {:.1f} samples up to t1 = {} at log_rate = {} (expected {:g} "
                      "or more)",
                      compare_.Written({At("torque_rate"), test.torque_rate_Nm_per_s}), samples,
                      compare_.Written({"specimen.t1", schedule_.specimen.t1_Nm}),
                      compare_.Written({At("log_rate"), test.log_rate_hz}), kFewestSamplesUpToT1));
    }
  }

  void operator()(const Soak& soak) const {
    compare_.MustBeBelow({At("below_temperature"), soak.below_temperature_degC},
                         {"limits.gear_temperature", schedule_.limits.gear_temperature_degC});
  }

  void operator()(const BlankTest& test) const {
    CheckTorque("peak_torque", test.peak_torque_Nm);
    if (!in_preparation_) {
      compare_.Error(
          At("kind"),
          "kind = blank_test is in the cycle (expected in preparation: a person mounts the blank)");
    }
  }

  void operator()(const SensorCheck& check) const {
    if (check.kind == SensorCheck::Kind::kShunt) CheckTorque("expected", std::abs(check.expected_Nm));
    if (check.kind != SensorCheck::Kind::kReference) {
      // A torque that is off by more makes another stiffness of the gear.
      compare_.MustBeBelow({At("allowed"), check.allowed}, {"specimen.t1", schedule_.specimen.t1_Nm});
    }
    // Before a zero is read, the load servo dithers the gear by t2.
    if (check.kind == SensorCheck::Kind::kZero) {
      compare_.MustBeBelow({"specimen.t2", schedule_.specimen.t2_Nm},
                           {"limits.output_torque", schedule_.limits.output_torque_Nm});
    }
  }

 private:
  std::string At(std::string_view key) const { return fmt::format("{}.{}", path_, key); }

  void CheckTorque(std::string_view key, double torque_Nm) const {
    const Named torque{At(key), torque_Nm};
    const Named limit{"limits.output_torque", schedule_.limits.output_torque_Nm};
    compare_.MustNotExceed(torque, limit);
    const bool no_room = torque_Nm <= limit.value && torque_Nm > kShareOfLimitWithoutRoom * limit.value;
    if (no_room && compare_.Readable(torque.path) && compare_.Readable(limit.path)) {
      compare_.Warning(torque.path,
                       fmt::format("{} = {} is so near to the limit of {} that ripple may trip it (5 % "
                                   "of room is usual)",
                                   key, compare_.Written(torque), compare_.Written(limit)));
    }
  }

  void CheckSpeed(double input_speed_rad_per_s) const {
    compare_.MustNotExceed({At("input_speed"), input_speed_rad_per_s},
                           {"limits.input_speed", schedule_.limits.input_speed_rad_per_s});
  }

  // What is taken for the load that was asked for damages the gear by its cube: half as much again is three
  // times.
  void CheckTolerances(const SetPointTolerances& tolerances) const {
    constexpr double kMostShare = 0.5;
    constexpr double kLongestDwell_s = 10.0;  // of the wrong load, before anybody is told
    for (const auto& [key, value, most, words] :
         {std::tuple{"torque_tolerance", tolerances.torque_share, kMostShare, "50 %"},
          {"speed_tolerance", tolerances.speed_share, kMostShare, "50 %"},
          {"tolerance_dwell", tolerances.dwell_s, kLongestDwell_s, "10 s"}}) {
      if (!compare_.Readable(At(key)) || value <= most) continue;
      compare_.Error(At(key),
                     fmt::format("{} = {} would credit a load that is not there (expected at most {})", key,
                                 compare_.Written({At(key), value}), words));
    }
  }

  void CheckLog(const LoadRun& run) const {
    if (!compare_.Readable(At("duration")) || !compare_.Readable(At("log_rate"))) return;
    const double longest_s = 1.2 * run.duration_s + 61.0;
    const double log_bytes = longest_s * run.log_rate_hz * kLoadRunRowInMemory_bytes;
    if (log_bytes <= kLongestLog_bytes) return;
    compare_.Error(
        At("log_rate"),
        fmt::format(
            "log_rate = {} over duration = {} is a log of {:.0f} MB in memory (expected at most {:.0f} MB: "
            "at most {:.3g} Hz, or a shorter duration and more cycles)",
            compare_.Written({At("log_rate"), run.log_rate_hz}),
            compare_.Written({At("duration"), run.duration_s}), log_bytes * 1e-6, kLongestLog_bytes * 1e-6,
            kLongestLog_bytes / (longest_s * kLoadRunRowInMemory_bytes)));
  }

  void CheckWholeTurns(double turns) const {
    if (!compare_.Readable(At("turns")) || turns == std::floor(turns)) return;
    compare_.Error(At("turns"),
                   fmt::format("turns = {} is not whole (expected whole turns of the output, which "
                               "keep its orders apart)",
                               compare_.Written({At("turns"), turns})));
  }

  const Schedule& schedule_;
  std::string path_;
  bool in_preparation_;
  const Comparison& compare_;
};

// Returns false when a phase's kind could not be read, so that nothing can be said of what is absent.
bool CheckPhases(const Schedule& schedule, const std::vector<Phase>& phases, std::string_view list,
                 std::map<std::string, int>& lines, const Comparison& compare) {
  bool all_known = compare.Readable(list);
  for (std::size_t i = 0; i < phases.size(); ++i) {
    const Phase& phase = phases[i];
    const std::string path = fmt::format("{}[{}]", list, i);
    if (!compare.Readable(path + ".kind")) {
      all_known = false;
      continue;
    }
    if (compare.Readable(path + ".name")) {
      const auto [first, is_new] = lines.emplace(phase.name, phase.line);
      if (!is_new) {
        compare.Error(path + ".name",
                      fmt::format("two phases are named '{}' (expected a name of its own; the first "
                                  "is on line {})",
                                  phase.name, first->second));
      }
    }
    std::visit(PhaseCheck(schedule, path, list == "preparation", compare), phase.parameters);
  }
  return all_known;
}

void CheckCampaign(const Schedule& schedule, const Comparison& compare) {
  if (schedule.stop.k2_below_share_of_first) {
    const Named share{"stop.k2_below_share_of_first", *schedule.stop.k2_below_share_of_first};
    if (compare.Readable(share.path) && share.value >= 1.0) {
      compare.Error(share.path,
                    fmt::format("k2_below_share_of_first = {} would stop at once (expected below 100 %)",
                                compare.Written(share)));
    }
    if (!Has<HysteresisTest>(schedule.phases)) {
      compare.Error(share.path, "k2_below_share_of_first is never measured (expected a hysteresis phase)");
    }
  }
  if (schedule.stop.vibration_rms_above_m_per_s2 && !Has<MeasurementRotation>(schedule.phases)) {
    compare.Error("stop.vibration_rms_above",
                  "vibration_rms_above is never measured (expected a measurement_rotation phase)");
  }
  if (schedule.stop.e_max_above_rad && !Has<TransmissionErrorSweep>(schedule.phases)) {
    compare.Error("stop.e_max_above", "e_max_above is never measured (expected a transmission_error phase)");
  }
  bool any_measurement = false;
  for (const Phase& phase : schedule.phases)
    any_measurement = any_measurement || IsMeasurement(phase.parameters);
  if (!any_measurement) {
    compare.Warning("phases",
                    "no phase measures anything (measurement_rotation, transmission_error or hysteresis)");
  }
  if (!Has<LoadRun>(schedule.phases)) compare.Warning("phases", "no phase loads the gear (load_run)");
}

}  // namespace

FindingList ValidateSchedule(const Schedule& schedule) {
  FindingList findings;
  const Comparison compare(schedule.origins, findings);
  CheckSpecimen(schedule.specimen, compare);
  CheckLimits(schedule, compare);
  CheckThermalRules(schedule, compare);
  CheckResumeRules(schedule.resume, compare);
  std::map<std::string, int> lines;
  const bool preparation_known = CheckPhases(schedule, schedule.preparation, "preparation", lines, compare);
  const bool phases_known = CheckPhases(schedule, schedule.phases, "phases", lines, compare);
  if (preparation_known && phases_known) CheckCampaign(schedule, compare);
  return findings;
}

}  // namespace strainwave::schedules
