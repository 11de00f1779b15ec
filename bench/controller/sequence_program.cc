// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/sequence_program.h"

#include <algorithm>

namespace strainwave::bench {

SequenceProgram::SequenceProgram(std::vector<std::unique_ptr<PhaseProgram>> programs, std::string prefix)
    : programs_(std::move(programs)), prefix_(std::move(prefix)) {}

void SequenceProgram::SetUp(const Readings& readings, BenchDevices& devices) {
  programs_[current_]->SetUp(readings, devices);
}

StepResult SequenceProgram::Step(const Readings& readings, double elapsed_s, BenchDevices& devices) noexcept {
  const StepResult result = programs_[current_]->Step(readings, elapsed_s - start_s_, devices);
  if (result != StepResult::kDone || current_ + 1 == programs_.size()) return result;
  devices.driving.QuickStop();
  devices.load.QuickStop();
  ++current_;
  start_s_ = elapsed_s;
  set_up_pending_ = true;
  return StepResult::kRunning;
}

void SequenceProgram::Collect(BenchDevices& devices) {
  if (set_up_pending_) {
    programs_[current_]->SetUp(devices.sampler.Read(), devices);
    set_up_pending_ = false;
    return;
  }
  programs_[current_]->Collect(devices);
}

double SequenceProgram::control_period_s() const {
  double shortest = programs_.front()->control_period_s();
  for (const auto& program : programs_) shortest = std::min(shortest, program->control_period_s());
  return shortest;
}

double SequenceProgram::timeout_s() const {
  double sum = 0.0;
  for (const auto& program : programs_) sum += program->timeout_s();
  return sum;
}

double SequenceProgram::share_done() const noexcept {
  return (static_cast<double>(current_) + programs_[current_]->share_done()) /
         static_cast<double>(programs_.size());
}

std::vector<NamedRecord> SequenceProgram::TakeRecords() {
  std::vector<NamedRecord> all;
  for (const auto& program : programs_) {
    for (NamedRecord& named : program->TakeRecords()) {
      named.group = prefix_ + named.group;
      all.push_back(std::move(named));
    }
  }
  return all;
}

}  // namespace strainwave::bench
