// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/roles/bench_devices.h"
#include "bench/safety/stop_reason.h"
#include "daq/cycle_file.h"

namespace strainwave::bench {

using daq::NamedRecord;

enum class StepResult { kRunning, kDone, kLogFull, kFailedCheck };

/// One phase as motion: told the readings once a control period, it commands the drives. The runner watches
/// limits and requests around it, and makes the bench safe on every way out; a program never needs to.
class PhaseProgram {
 public:
  PhaseProgram() = default;
  PhaseProgram(const PhaseProgram&) = delete;
  PhaseProgram& operator=(const PhaseProgram&) = delete;
  virtual ~PhaseProgram() = default;

  /// Set-up: enables the drives that the phase needs. Memory for the log is set aside by now.
  virtual void SetUp(const Readings& readings, BenchDevices& devices) = 0;

  /// The body, once a control period; `elapsed_s` since set-up. Allocates nothing.
  virtual StepResult Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept = 0;

  /// Between control periods, where memory may be allocated: fast channels are taken over here.
  virtual void Collect(BenchDevices&) {}

  /// Asks the phase to come to rest by itself and be done before its time, with what it has so far. False
  /// where it cannot be cut: a measurement is taken whole or not at all.
  virtual bool WindDown() noexcept { return false; }

  /// Control period that the phase's own sampling asks for; the bench's where that is shorter.
  virtual double control_period_s() const { return 1e9; }
  /// Longest time that the phase may take before it counts as stuck.
  virtual double timeout_s() const = 0;
  /// Share done, for the progress line.
  virtual double share_done() const noexcept = 0;
  /// Load time that counts as served so far, seconds.
  virtual double credited_load_s() const noexcept { return 0.0; }
  virtual bool input_locked() const noexcept { return false; }
  /// Output angle at which the input was locked; meaningless before.
  virtual double locked_output_angle_rad() const noexcept { return 0.0; }
  /// What a failed check saw, when Step says so.
  virtual StopReason failed_check() const noexcept { return {}; }

  /// What was measured; once, at the end. An interrupted phase's records are whole rows, cut short.
  virtual std::vector<NamedRecord> TakeRecords() = 0;
  /// The same while a long phase runs, to be kept in case the program dies; nothing where a phase that is cut
  /// begins anew. May be called from another thread than the one that steps.
  virtual std::vector<NamedRecord> RecordsSoFar() const { return {}; }
};

/// Input angle at which every measurement begins: the whole turn of the input encoder at which the output
/// stands nearest to a zero of its own encoder. Both encoders are absolute, so it is the same teeth and the
/// same angle of the wave generator in every cycle; going by the output encoder alone, transmission error and
/// wind-up where it stands now would move the start by a degree of the input.
double HomeInput_rad(const Readings& readings, double ratio) noexcept;

/// The driving servo's own position beside the input encoder's angle, while the shaft is held. A drive counts
/// from where it came up, the encoder from its own zero: who means an angle of the encoder adds this to it.
double DriveAhead_rad(const Readings& readings, const ServoDrive& driving) noexcept;

/// Releases the brake as soon as the drive holds the shaft; true once it is released.
bool BroughtUp(ServoDrive& drive) noexcept;

}  // namespace strainwave::bench
