// SPDX-License-Identifier: Apache-2.0
#include "bench/report/schedule_words.h"

#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/report/number_text.h"

namespace strainwave::bench {
namespace {

using schedules::BlankTest, schedules::HysteresisTest, schedules::LoadRun, schedules::MeasurementRotation,
    schedules::SensorCheck, schedules::Soak, schedules::TransmissionErrorSweep;

std::string Turns(double turns) { return fmt::format("{:g} turn{}", turns, turns == 1.0 ? "" : "s"); }
std::string Rpm(double speed_rad_per_s) { return fmt::format("{:.5g} rpm", RpmFromRadPerS(speed_rad_per_s)); }

struct InWords {
  std::string operator()(const LoadRun& run) const {
    return fmt::format(
        "runs for {} at {:g} Nm of the output and {} of the input, {} of the output clockwise, then as many "
        "back",
        DurationWords(run.duration_s), run.output_torque_Nm, Rpm(run.input_speed_rad_per_s),
        Turns(run.turns));
  }
  std::string operator()(const MeasurementRotation& rotation) const {
    return fmt::format("turns the output {}, {}, at {:g} Nm and {} of the input, vibration at {:g} Hz",
                       Turns(rotation.turns), rotation.clockwise ? "clockwise" : "counter-clockwise",
                       rotation.output_torque_Nm, Rpm(rotation.input_speed_rad_per_s),
                       rotation.vibration_rate_hz);
  }
  std::string operator()(const TransmissionErrorSweep& sweep) const {
    return fmt::format("reads both angles at standstill in {} steps of {:.4g}°, {}", sweep.steps,
                       DegFromRad(sweep.step_rad),
                       sweep.clockwise && sweep.counter_clockwise ? "clockwise, then counter-clockwise"
                       : sweep.clockwise                          ? "clockwise"
                                                                  : "counter-clockwise");
  }
  std::string operator()(const HysteresisTest& test) const {
    std::string angles;
    for (const double angle_rad : test.lock_angles_rad)
      angles += fmt::format("{}{:.4g}°", angles.empty() ? "" : ", ", DegFromRad(angle_rad));
    return fmt::format(
        "ramps the torque to ±{:g} Nm at {:g} Nm/s with the input locked at {}, loops at each: {:g}",
        test.peak_torque_Nm, test.torque_rate_Nm_per_s, angles, test.loops);
  }
  std::string operator()(const Soak& soak) const {
    if (soak.below_temperature_degC > 0.0)
      return fmt::format("stands until the gear is below {:g} °C, at most {}", soak.below_temperature_degC,
                         DurationWords(soak.at_most_s));
    return fmt::format("stands for {}", DurationWords(soak.at_most_s));
  }
  std::string operator()(const BlankTest& test) const {
    return fmt::format("measures the bench itself with a rigid blank: ±{:g} Nm, a turn of {} steps",
                       test.peak_torque_Nm, test.steps);
  }
  std::string operator()(const SensorCheck& check) const {
    const std::string then = check.stops ? "beyond it the run ends" : "beyond it results are marked";
    switch (check.kind) {
      case SensorCheck::Kind::kZero:
        return fmt::format("reads the torque transducer without torque, allowed ±{:g} Nm; {}", check.allowed,
                           then);
      case SensorCheck::Kind::kShunt:
        return fmt::format("reads what the shunt resistor adds, {:g} ± {:g} Nm; {}", check.expected_Nm,
                           check.allowed, then);
      case SensorCheck::Kind::kReference:
        return fmt::format(
            "holds both encoders against each other, allowed ±{:.3g} arcmin since the first cycle; {}",
            ArcminFromRad(check.allowed), then);
    }
    return {};
  }
};

}  // namespace

std::string PhaseWords(const schedules::Phase& phase) { return std::visit(InWords{}, phase.parameters); }

}  // namespace strainwave::bench
