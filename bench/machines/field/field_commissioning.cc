// SPDX-License-Identifier: Apache-2.0
// Whether the drives would notice that this program is gone, and how long they then take to stop.
#include <algorithm>
#include <cmath>
#include <mutex>

#include <fmt/format.h>

#include "bench/controller/measure_stop_time.h"
#include "bench/devices/canopen/scan_nodes.h"
#include "bench/errors/bench_error.h"
#include "bench/machines/field/field_machine.h"
#include "bench/seconds.h"
#include "bench/utc.h"

namespace strainwave::bench {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

namespace {

constexpr std::pair<const char*, const char*> kServos[] = {{"driving servo", "driving_servo"},
                                                           {"load servo", "load_servo"}};
constexpr milliseconds kToBoot{50};
constexpr milliseconds kToAnswer{300};
constexpr double kStandstill_rad_per_s = 0.5;  // of a motor whose file does not say
constexpr double kSpeedUp_s = 1.0;
constexpr std::size_t kMostEdsNotes = 10;  // of a file that are shown: what else is odd is no news

// The quick stop after the silence: a drive that is on its way cannot be set up.
void WaitForStop(const std::vector<CanopenServo*>& servos, BenchClock& clock) {
  using protocols::canopen::DriveStage;
  constexpr milliseconds kLook{10};
  constexpr int kMostLooks = 500;
  const auto on_its_way = [](CanopenServo* servo) {
    const DriveStage stage = servo->report().stage;
    return stage == DriveStage::kSilent || stage == DriveStage::kStopping;
  };
  for (int looks = 0; looks < kMostLooks && std::ranges::any_of(servos, on_its_way); ++looks) {
    clock.SleepUntil(clock.Now() + kLook);
  }
}

}  // namespace

// Before anything else is sent on the bus. Drives that have just been switched on do not answer at once; one
// that never does is found out when it is set up.
void FieldMachine::IdentifyDrives(OneBus& bus) {
  constexpr int kMostScans = 3;
  std::vector<std::uint8_t> nodes;
  for (const CanopenServoSettings& drive : bus.drives) nodes.push_back(drive.node_id);
  for (int scans = 0; scans < kMostScans; ++scans) {
    clock_.SleepUntil(clock_.Now() + kToBoot);
    protocols::canopen::NodeScan scan(kToAnswer, nodes);
    std::string note;
    std::size_t told = 0;
    for (const auto& node : ScanNodes(*bus.bus, clock_, scan, note)) {
      const auto drive = std::ranges::find(bus.drives, node.node_id, &CanopenServoSettings::node_id);
      if (drive == bus.drives.end() || !node.device_type) continue;
      identities_[drive->name] = IdentityText(node);
      ++told;
    }
    if (told == nodes.size()) return;
  }
}

void FieldMachine::SetOpen(bool open) noexcept {
  const std::lock_guard lock(open_mutex_);
  is_open_ = open;
}

// docs/requirements.md R15.
bool FieldMachine::IsSupervised() const noexcept {
  const std::lock_guard lock(open_mutex_);
  return is_open_ &&
         std::ranges::all_of(
             buses_,
             [](const auto& entry) { return !entry.second.served || entry.second.served->IsSupervised(); }) &&
         std::ranges::all_of(modbus_servos_, [](const auto& entry) { return entry.second->is_supervised(); });
}

const MeasuredStop* FieldMachine::StopOf(const std::string& servo) const {
  const auto found = std::ranges::find(stops_, servo, &MeasuredStop::servo);
  return found == stops_.end() ? nullptr : &*found;
}

std::vector<BenchMachine::Finding> FieldMachine::Findings() const {
  std::vector<Finding> findings;
  for (const auto& [name, key] : kServos) {
    const auto identity = identities_.find(name);
    const StopTimeFinding finding = JudgeStopTime(
        key, StopOf(key), identity == identities_.end() ? "" : identity->second, bench_.longest_stop_s);
    if (!finding.words.empty()) findings.push_back({finding.refuses, finding.words});
  }
  for (const auto& [profile, notes] : eds_notes_) {
    const std::size_t shown = std::min(notes.size(), kMostEdsNotes);
    for (std::size_t i = 0; i < shown; ++i) findings.push_back({false, notes[i]});
    if (notes.size() > shown) {
      findings.push_back({false, fmt::format("{}: and {} more notes about its EDS file", profile.string(),
                                             notes.size() - shown)});
    }
  }
  return findings;
}

std::vector<MeasuredStop> FieldMachine::MeasureStopTime(double input_speed_rad_per_s,
                                                        const schedules::Limits& limits,
                                                        const std::atomic<StopRequest>& request) {
  StopTimeParameters parameters;
  parameters.input_speed_rad_per_s = input_speed_rad_per_s;
  parameters.input_acceleration_rad_per_s2 = std::abs(input_speed_rad_per_s) / kSpeedUp_s;
  parameters.period_s = bench_.control_period_s;
  parameters.stale_after_s = bench_.stale_after_s;
  parameters.limits = limits;
  parameters.standstill_rad_per_s = {kStandstill_rad_per_s,
                                     kStandstill_rad_per_s / bench_.load_reducer_ratio};
  std::vector<CanopenServo*> servos;
  for (auto& [name, bus] : buses_) {
    for (std::size_t i = 0; bus.served && i < bus.served->size(); ++i)
      servos.push_back(&bus.served->servo(i));
  }
  StopTimes times;
  if (!servos.empty()) {
    times = MeasureStopTimes(
        Devices(), parameters,
        [&] {
          for (CanopenServo* servo : servos) servo->GoSilent();
        },
        request);
    if (times.ended_before) {
      throw BenchError(
          IsRequest(times.ended_before.cause) ? ExitCode::kInterrupted : ExitCode::kMachineFailed,
          fmt::format("not measured: {}", Describe(times.ended_before)));
    }
    WaitForStop(servos, clock_);
    std::string troubles;
    for (auto& [name, bus] : buses_) {
      if (bus.thread) troubles += bus.thread->Commission(kCommissioning);
    }
    if (!troubles.empty()) {
      throw BenchError(ExitCode::kMachineFailed, fmt::format("not set up again: {}", troubles));
    }
  }
  std::vector<MeasuredStop> stops;
  for (std::size_t i = 0; i < std::size(kServos); ++i) {
    const auto& [name, key] = kServos[i];
    MeasuredStop stop{key, identities_[name], 0.0, 0.0, UtcNow()};
    const auto proof = proofs_.find(name);
    const StopTime& time = times.drives[i];
    if (proof != proofs_.end()) {
      stop.left_enabled_s = Seconds(proof->second.time_to_stop);
    } else if (time.left_enabled_after && time.stood_after) {
      stop.left_enabled_s = Seconds(*time.left_enabled_after);
      stop.stood_s = Seconds(*time.stood_after);
    } else {
      throw BenchError(
          ExitCode::kMachineFailed,
          fmt::format(
              "the {} {} within {:.0f} s after this program fell silent: it would run on without it (check "
              "its heartbeat consumer, abort connection option code and ramps)",
              name, time.left_enabled_after ? "did not stand" : "stayed enabled", Seconds(parameters.most)));
    }
    stops.push_back(std::move(stop));
  }
  stops_ = stops;
  return stops;
}

}  // namespace strainwave::bench
