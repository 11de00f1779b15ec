// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/modbus/modbus_watchdog_proof.h"

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/devices/modbus/modbus_poller.h"

namespace strainwave::bench {
namespace {

namespace mb = protocols::modbus;
using protocols::PowerState;
using std::chrono::nanoseconds;
using Values = std::vector<std::pair<std::size_t, double>>;

double Milliseconds(nanoseconds time) { return std::chrono::duration<double, std::milli>(time).count(); }

// What ends the proof before its time.
struct Refused {
  std::string words;
};

class Proof {
 public:
  Proof(ModbusLink& link, const mb::RegisterMap& map, const ModbusServoProfile& profile, BenchClock& clock)
      : link_(link),
        map_(map),
        profile_(profile),
        at_(FindServoRegisters(map, profile)),
        clock_(clock),
        poller_(map, clock) {}

  WatchdogProof Run() {
    Stop();
    ResetFault();  // one that was there before: who starts a bench has seen it
    SetTime();
    Enable();
    const WatchdogProof found = Watch();
    Stop();
    ResetFault();  // the one that the watchdog has ended in
    return found;
  }

  // Whatever has happened before.
  ModbusReply TryStop() {
    const Values off{{at_.control, profile_.control.off}};
    const Values rest{
        {at_.speed_set_point, 0.0}, {at_.torque_set_point, 0.0}, {at_.brake, profile_.brake_engaged}};
    const ModbusReply reply = link_.Write(PlanWrites(map_, off));
    const ModbusReply braked = link_.Write(PlanWrites(map_, rest));
    return reply.good() ? braked : reply;
  }

 private:
  void Check(const ModbusReply& reply) {
    if (!reply.good())
      throw Refused{fmt::format("the drive cannot be asked: {}", Words(reply, link_.settings()))};
  }
  void Write(const Values& values) { Check(link_.Write(PlanWrites(map_, values))); }
  void Stop() { Check(TryStop()); }

  double Read(std::size_t index) {
    Check(poller_.ReadNow(link_, std::span(&index, 1)));
    return poller_.Value(index).value;
  }

  std::optional<PowerState> State() {
    const double status = Read(at_.status);
    if (!(status >= 0.0)) return std::nullopt;
    const auto bits = static_cast<std::uint32_t>(status);
    for (const ModbusServoProfile::Status& row : profile_.status) {
      if ((bits & row.mask) == row.value) return row.state;
    }
    return std::nullopt;
  }
  bool IsEnabled() { return State() == PowerState::kOperationEnabled; }
  bool IsInFault() {
    const std::optional<PowerState> state = State();
    return state == PowerState::kFault || state == PowerState::kFaultReactionActive;
  }
  std::string Fault() {
    return FaultWords(at_.fault_code ? Read(*at_.fault_code) : std::numeric_limits<double>::quiet_NaN());
  }

  // Written again and again, which feeds the watchdog, while the drive does what takes it a while.
  void WriteWhile(double control_word, const std::function<bool()>& goes_on) {
    constexpr nanoseconds kLongest = std::chrono::seconds(2);
    const nanoseconds begin = clock_.Now();
    while (goes_on() && clock_.Now() - begin < kLongest) {
      Write({{at_.control, control_word}});
      clock_.SleepUntil(clock_.Now() + profile_.period);
    }
  }

  // By one edge from off; a drive that is still stopping may come to its fault then.
  void ResetFault() {
    WriteWhile(profile_.control.off, [this] { return State() == PowerState::kQuickStopActive; });
    if (!IsInFault()) return;
    WriteWhile(profile_.control.reset_fault, [this] { return IsInFault(); });
    Stop();
    if (!IsInFault()) return;
    throw Refused{fmt::format(
        "the drive is {}, and a reset does not clear it (expected a drive without a fault: mend its cause)",
        Fault())};
  }

  void SetTime() {
    const double wanted_s = std::chrono::duration<double>(profile_.watchdog_time).count();
    Write({{at_.watchdog_time, wanted_s}});
    const double read_s = Read(at_.watchdog_time);
    const double step_s = std::abs(map_.registers[at_.watchdog_time].scale);
    if (!(std::abs(read_s - wanted_s) <= step_s)) {
      throw Refused{
          fmt::format("the watchdog time was written as {:g} s and reads back as {:g} s (expected the same)",
                      wanted_s, read_s)};
    }
  }

  void Enable() {
    constexpr nanoseconds kLongest = std::chrono::seconds(5);
    const nanoseconds begin = clock_.Now();
    std::uint16_t count = 0;
    do {
      Values values{
          {at_.mode, profile_.torque_mode}, {at_.torque_set_point, 0.0}, {at_.brake, profile_.brake_engaged}};
      if (at_.watchdog) values.emplace_back(*at_.watchdog, ++count & 0x7F);
      Write(values);
      const nanoseconds written = clock_.Now();
      Write({{at_.control, profile_.control.enable}});
      if (IsEnabled()) return;
      if (IsInFault()) {
        // Where this machine was held up for so long it is the watchdog's.
        if (clock_.Now() - written < profile_.watchdog_time) {
          throw Refused{
              fmt::format("the drive is {}, when it is enabled at zero torque with its brake on", Fault())};
        }
        ResetFault();
      }
      clock_.SleepUntil(clock_.Now() + profile_.period);
    } while (clock_.Now() - begin < kLongest);
    throw Refused{
        "the drive could not be enabled at zero torque with its brake on, so that its watchdog was not seen"};
  }

  // Reading alone from here on, then nothing at all.
  WatchdogProof Watch() {
    const nanoseconds written = clock_.Now();
    const nanoseconds longest = 2 * profile_.watchdog_time + 4 * profile_.period;
    while (clock_.Now() - written < longest) {
      if (!IsEnabled()) {
        const nanoseconds time = clock_.Now() - written;
        return {true, time,
                fmt::format("the drive stopped {:.0f} ms after the last write while it was still read",
                            Milliseconds(time))};
      }
      clock_.SleepUntil(clock_.Now() + profile_.period / 4);
    }
    clock_.SleepUntil(clock_.Now() + longest);
    const char* const found =
        IsEnabled() ? "nor {:.0f} ms after the last request of any kind: it has no watchdog"
                    : "but did within {:.0f} ms of complete silence: reading alone keeps its watchdog quiet";
    return {false,
            {},
            fmt::format("the drive did not stop within {:.0f} ms after the last write while it was read, {} "
                        "(expected a watchdog that only writing keeps quiet)",
                        Milliseconds(longest), fmt::format(fmt::runtime(found), Milliseconds(longest)))};
  }

  ModbusLink& link_;
  const mb::RegisterMap& map_;
  const ModbusServoProfile& profile_;
  const ModbusServoRegisters at_;
  BenchClock& clock_;
  ModbusPoller poller_;
};

}  // namespace

WatchdogProof ProveWatchdog(ModbusLink& link, const mb::RegisterMap& map, const ModbusServoProfile& profile,
                            BenchClock& clock) {
  Proof proof(link, map, profile, clock);
  WatchdogProof result;
  try {
    result = proof.Run();
  } catch (const Refused& refused) {
    result.words = refused.words;
  }
  const ModbusReply stopped = proof.TryStop();
  if (!stopped.good()) {
    result = {
        false, result.time_to_stop,
        fmt::format("{}; then it could not be stopped: {}", result.words, Words(stopped, link.settings()))};
  }
  return result;
}

}  // namespace strainwave::bench
