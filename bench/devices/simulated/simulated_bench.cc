// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/simulated/simulated_bench.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "analysis/units.h"
#include "bench/devices/simulated/gear_plant.h"
#include "bench/devices/simulated/simulated_drive.h"
#include "bench/devices/simulated/simulated_sensors.h"
#include "bench/devices/simulated/vibration_synthesis.h"

namespace strainwave::bench {

namespace model = analysis::model;
using std::chrono::nanoseconds;

namespace {

// Streams of noise, so that none of them shifts another.
enum : std::uint64_t { kSpecimenStream = 1, kSlowStream = 2, kVibrationStream = 3, kSeatingStream = 4 };

constexpr double kVibrationRoom_s = 4.0;

// What still counts as a bench that was left standing: the rest of a finished ramp.
constexpr double kStandingSpeed_rad_per_s = 20.0;
constexpr double kStandingLoad_Nm = 2.0;
constexpr double kRunDownStep_s = 1e-3;
constexpr int kRunDownSteps = 3000;

model::PlantParameters Specimen(const model::PlantModel& description,
                                const SimulatedBenchSettings& settings) {
  model::PlantParameters nominal = model::CompilePlantModel(description);
  if (settings.ambient_degC) nominal.ambient.mean_degC = *settings.ambient_degC;
  return model::DrawSpecimen(nominal, NoiseKey(settings.seed, kSpecimenStream));
}

void Check(const SimulatedBenchSettings& settings) {
  std::ostringstream text;
  if (!(settings.pace > 0.0)) {
    text << "pace = " << settings.pace << " must be above zero";
  } else if (!std::isfinite(settings.time_skew_s)) {
    text << "time_skew_s = " << settings.time_skew_s << " must be finite";
  } else if (settings.ambient_degC && !std::isfinite(*settings.ambient_degC)) {
    text << "ambient_degC = " << *settings.ambient_degC << " must be finite";
  } else {
    return;
  }
  throw std::invalid_argument(text.str());
}

}  // namespace

class SimulatedBench::Implementation final : public Sampler, public BenchClock {
 public:
  Implementation(const model::PlantModel& description, const SimulatedBenchSettings& settings)
      : settings_(settings),
        plant_(Specimen(description, settings)),
        sensors_(plant_.specimen(), settings.time_skew_s),
        vibration_(plant_.specimen().vibration, description.ratio, settings.seed,
                   plant_.specimen().vibration_causes) {
    BeginPhase(0);
    Report();
  }

  // Sampler
  Readings Read() noexcept override;
  void StartVibration(double sample_rate_hz) override {
    if (!(sample_rate_hz > 0.0 && std::isfinite(sample_rate_hz))) {
      std::ostringstream text;
      text << "sample_rate_hz = " << sample_rate_hz << " must be above zero";
      throw std::invalid_argument(text.str());
    }
    vibration_.Start(sample_rate_hz, NoiseKey(NoiseKey(settings_.seed, kVibrationStream), phase_key_),
                     plant_.state().time_s, kVibrationRoom_s);
  }
  void StopVibration() override { vibration_.Stop(); }
  void DrainVibration(VibrationBlock& block) override { vibration_.Drain(block); }
  void ConnectShunt(bool on) noexcept override {
    if (on != sensors_.shunted()) fresh_ = false;
    sensors_.ConnectShunt(on);
  }

  // BenchClock
  nanoseconds Now() const noexcept override { return now_; }
  void SleepUntil(nanoseconds time) noexcept override;
  std::uint64_t Overruns() const noexcept override { return overruns_; }

  void BeginPhase(std::uint64_t key) {
    phase_key_ = key;
    NoiseSource seat(NoiseKey(NoiseKey(settings_.seed, kSeatingStream), key));
    const model::SeatingScatter& scatter = plant_.specimen().seating;
    const double stiffness = std::exp(scatter.stiffness * seat());
    plant_.SetSeating({stiffness, std::exp(scatter.kinematic * seat())});
    sensors_.SeedNoise(NoiseKey(NoiseKey(settings_.seed, kSlowStream), key));
    // What follows the slow states from time to time follows them now, so that a phase that starts from a
    // restored memory sees the same gear as one that the bench came to by running.
    plant_.SetState(plant_.state());
    sensors_.FollowVibration(plant_);
    fresh_ = false;
  }
  void Restore(const BenchMemory& memory);
  void MountBlank(bool mounted) {
    plant_.MountBlank(mounted);
    fresh_ = false;
    Report();
  }
  void Inject(const Injection& injection) {
    injection_ = injection;
    injected_at_ = now_;
    driving_.SetFaults(injection.driving);
    load_.SetFaults(injection.load);
    if (injection.driving_fault) driving_.Fault();
    if (injection.load_fault) load_.Fault();
    if (injection.gear_temperature_degC) plant_.SetGearTemperature(*injection.gear_temperature_degC);
    fresh_ = false;
  }

  SimulatedDrive& driving() { return driving_; }
  SimulatedDrive& load() { return load_; }
  const GearPlant& plant() const { return plant_; }

 private:
  PlantCommands Commands() const noexcept;
  void Report() noexcept;
  void KeepPace() noexcept;

  SimulatedBenchSettings settings_;
  GearPlant plant_;
  SimulatedSensors sensors_;
  VibrationSynthesis vibration_;
  SimulatedDrive driving_{true};
  SimulatedDrive load_{false};
  nanoseconds now_{};
  std::uint64_t overruns_{};
  std::uint64_t phase_key_{};
  Injection injection_;
  std::chrono::nanoseconds injected_at_{};
  Readings last_;
  bool fresh_{};  // `last_` is of this moment
  std::optional<std::chrono::steady_clock::time_point> wall_start_;
};

PlantCommands SimulatedBench::Implementation::Commands() const noexcept {
  PlantCommands commands;
  if (driving_.enabled()) {
    switch (driving_.mode()) {
      case DriveMode::kSpeed:
        commands.input = PlantCommands::Input::kSpeed;
        break;
      case DriveMode::kPosition:
        commands.input = PlantCommands::Input::kPosition;
        break;
      case DriveMode::kTorque:
        commands.input = PlantCommands::Input::kTorque;
        break;
    }
    commands.input_set_point = driving_.set_point();
  }
  commands.input_brake = driving_.brake_engaged();
  commands.load_enabled = load_.enabled();
  if (load_.enabled() && load_.mode() == DriveMode::kSpeed) {
    commands.load_speed_rad_per_s = load_.set_point();
  } else {
    commands.load_torque_Nm = load_.set_point();
  }
  commands.load_brake = load_.brake_engaged();
  return commands;
}

void SimulatedBench::Implementation::Report() noexcept {
  const PlantState& state = plant_.state();
  driving_.Report(now_, state.input_rad, state.input_speed_rad_per_s, state.motor_torque_Nm);
  load_.Report(now_, state.output_rad, state.output_speed_rad_per_s, state.load_torque_Nm);
}

void SimulatedBench::Implementation::SleepUntil(nanoseconds time) noexcept {
  if (time <= now_) {
    overruns_ += time < now_ ? 1 : 0;
    return;
  }
  const double step_s = 1e-9 * static_cast<double>((time - now_).count());
  driving_.StepPowerState();
  load_.StepPowerState();
  const double from_rad = plant_.state().input_rad;
  const double slow_before_s = plant_.state().slow_elapsed_s;
  plant_.Step(Commands(), step_s);
  now_ = time;
  const PlantState& state = plant_.state();
  // The plant's slow states have just moved on.
  if (state.slow_elapsed_s < slow_before_s) sensors_.FollowVibration(plant_);
  if (vibration_.running()) {
    vibration_.Advance(
        step_s, from_rad, state.input_rad,
        model::SourcesAt(plant_.specimen().vibration,
                         {state.input_speed_rad_per_s, state.gear_torque_Nm, state.thermal.gear_degC},
                         state.wear));
  }
  fresh_ = false;
  Report();
  if (std::isfinite(settings_.pace)) KeepPace();
}

void SimulatedBench::Implementation::KeepPace() noexcept {
  const auto ahead = std::chrono::duration<double>(now_) / settings_.pace;
  if (!wall_start_) {
    wall_start_ = std::chrono::steady_clock::now() -
                  std::chrono::duration_cast<std::chrono::steady_clock::duration>(ahead);
  }
  std::this_thread::sleep_until(*wall_start_ +
                                std::chrono::duration_cast<std::chrono::steady_clock::duration>(ahead));
}

Readings SimulatedBench::Implementation::Read() noexcept {
  if (fresh_ || injection_.sampler_silent) return last_;
  Readings readings = sensors_.Measure(plant_, now_);
  if (!settings_.has_accelerometers) readings.vibration_rms_m_per_s2 = 0.0;
  const unsigned held = injection_.frozen_channels | injection_.dead_channels;
  const unsigned drifting = injection_.drifting_channels;
  if ((held | drifting) != 0) {
    const double drift = injection_.drift_per_s * 1e-9 * static_cast<double>((now_ - injected_at_).count());
    const std::array<double Readings::*, 8> channels{
        &Readings::input_angle_rad,          &Readings::output_angle_rad,
        &Readings::input_speed_rad_per_s,    &Readings::output_torque_Nm,
        &Readings::motor_torque_Nm,          &Readings::gear_temperature_degC,
        &Readings::ambient_temperature_degC, &Readings::vibration_rms_m_per_s2};
    for (std::size_t channel = 0; channel < channels.size(); ++channel) {
      if ((drifting >> channel & 1u) != 0) readings.*channels[channel] += drift;
      if ((held >> channel & 1u) != 0) readings.*channels[channel] = last_.*channels[channel];
    }
  }
  readings.bad_channels = injection_.dead_channels;
  readings.quick_stop_pressed = injection_.quick_stop_pressed;
  last_ = readings;
  fresh_ = true;
  return readings;
}

void SimulatedBench::Implementation::Restore(const BenchMemory& memory) {
  plant_.SetState(memory.plant);
  vibration_.Stop();
  driving_.PowerCut();
  load_.PowerCut();
  // Caught in motion or under load, the bench runs down with the power off before it is found again.
  const PlantState& state = plant_.state();
  if (std::abs(state.input_speed_rad_per_s) > kStandingSpeed_rad_per_s ||
      std::abs(state.load_torque_Nm) > kStandingLoad_Nm) {
    const PlantCommands power_off = Commands();
    for (int step = 0; step < kRunDownSteps && !(state.input_brake_closed && state.load_brake_closed);
         ++step) {
      plant_.Step(power_off, kRunDownStep_s);
    }
    PlantState at_rest = state;
    at_rest.output_speed_rad_per_s = 0.0;
    plant_.SetState(at_rest);
  }
  sensors_.FollowVibration(plant_);
  fresh_ = false;
  Report();
}

SimulatedBench::SimulatedBench(const model::PlantModel& description, const SimulatedBenchSettings& settings) {
  Check(settings);
  implementation_ = std::make_unique<Implementation>(description, settings);
}

SimulatedBench::~SimulatedBench() = default;

ServoDrive& SimulatedBench::driving_servo() { return implementation_->driving(); }
ServoDrive& SimulatedBench::load_servo() { return implementation_->load(); }
Sampler& SimulatedBench::sampler() { return *implementation_; }
BenchClock& SimulatedBench::clock() { return *implementation_; }
void SimulatedBench::BeginPhase(std::uint64_t key) { implementation_->BeginPhase(key); }
BenchMemory SimulatedBench::Memory() const { return {implementation_->plant().state()}; }
void SimulatedBench::RestoreAfterPowerCut(const BenchMemory& memory) { implementation_->Restore(memory); }
void SimulatedBench::MountBlank(bool mounted) { implementation_->MountBlank(mounted); }
void SimulatedBench::Inject(const Injection& injection) { implementation_->Inject(injection); }

BenchTruth SimulatedBench::TruthNow(double step_rad, int steps, std::optional<double> start_input_rad) const {
  const GearPlant& plant = implementation_->plant();
  const PlantState& state = plant.state();
  const model::TwistLaw& law = plant.law();
  const double ratio = plant.ratio();
  BenchTruth truth;
  truth.k1_Nm_per_rad = law.spring.k1_Nm_per_rad;
  truth.k2_Nm_per_rad = law.spring.k2_Nm_per_rad;
  truth.k3_Nm_per_rad = law.spring.k3_Nm_per_rad;
  truth.series_compliance_rad_per_Nm = law.series_compliance_rad_per_Nm;
  truth.friction_torque_Nm = law.hysteresis.limit_Nm;
  for (const model::ElastoPlasticElement& further : law.deviations.further_friction) {
    truth.friction_torque_Nm += further.limit_Nm;
  }
  truth.hysteresis_rad = model::HysteresisWidth_rad(law.spring, {truth.friction_torque_Nm, 1.0});

  const double home_output_rad = kTwoPi * std::round(state.output_rad / kTwoPi);
  const double start_rad =
      start_input_rad.value_or(state.input_rad + ratio * (home_output_rad - state.output_rad));
  const double at_start = model::KinematicErrorAt(plant.kinematic(), start_rad);
  double sum = 0.0;
  double lowest = 0.0;
  double highest = 0.0;
  for (int step = 1; step <= steps; ++step) {
    const double error =
        model::KinematicErrorAt(plant.kinematic(), start_rad + ratio * step_rad * step) - at_start;
    // The last standstill is the first one again, a turn later.
    if (step < steps) sum += error;
    lowest = std::min(lowest, error);
    highest = std::max(highest, error);
  }
  truth.e_avg_rad = steps > 0 ? sum / steps : 0.0;
  truth.e_max_rad = highest - lowest;
  truth.wear = state.wear;
  truth.input_revolutions = state.input_revolutions;
  truth.gear_temperature_degC = state.thermal.gear_degC;
  truth.time_s = state.time_s;
  return truth;
}

}  // namespace strainwave::bench
