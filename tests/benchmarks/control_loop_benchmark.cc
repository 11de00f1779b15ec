// SPDX-License-Identifier: Apache-2.0
// A control loop with two drives on a CAN bus, within the program or on an interface: how even its periods
// are, how long a stop takes from the limit that asks for it to the frame that carries it out, and which
// frames got lost. usage: control_loop_benchmark [SECONDS [PERIOD_MS [INTERFACE]]]
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include <fmt/core.h>

#include "bench/devices/can/socket_can_bus.h"
#include "bench/devices/canopen/drive_bus_thread.h"
#include "bench/devices/monotonic_clock.h"
#include "bench/machines/device_side/drive_on_bus.h"
#include "bench/realtime/realtime.h"
#include "bench/realtime/timing_histogram.h"
#include "tests/bench/canopen/in_process_drives.h"

namespace strainwave::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr double kBetweenStops_s = 2.0;  // in half a second a drive is seldom enabled again

// An end of the bus that counts what passes, and notes when the first quick stop went out.
class NotingBus final : public CanBus {
 public:
  NotingBus(CanBus& bus, const BenchClock& clock) : bus_(bus), clock_(clock) {}

  Sent Send(const protocols::CanFrame& frame) noexcept override {
    const Sent sent = bus_.Send(frame);
    if (sent != Sent::kQueued) return sent;
    ++sent_by_id[frame.id & 0x7FF];
    const bool stop = frame.id == 0x201 && frame.data[0] == 0x02 && frame.data[1] == 0;
    std::int64_t none = 0;
    if (stop) stop_sent_ns.compare_exchange_strong(none, clock_.Now().count());
    return sent;
  }
  bool Receive(ReceivedFrame& received) noexcept override {
    if (!bus_.Receive(received)) return false;
    if (!received.frame.error) ++received_by_id[received.frame.id & 0x7FF];
    return true;
  }
  void PurgeTransmit() noexcept override { bus_.PurgeTransmit(); }
  CanState state() const noexcept override { return bus_.state(); }
  std::uint64_t lost_frames() const noexcept override { return bus_.lost_frames(); }

  std::atomic<std::int64_t> stop_sent_ns{};
  std::array<std::uint64_t, 2048> sent_by_id{};
  std::array<std::uint64_t, 2048> received_by_id{};

 private:
  CanBus& bus_;
  const BenchClock& clock_;
};

// The three ends of a bus: the bench's, and those of drives 1 and 2.
class ThreeEnds {
 public:
  ThreeEnds(const std::string& interface, const MonotonicClock& clock) {
    for (int node = 0; node < 3; ++node) {
      if (interface.empty()) {
        ends_[At(node)] = std::make_unique<NotingBus>(in_process_.end(node), clock);
        continue;
      }
      SocketCanSettings settings;
      settings.interface = interface;
      settings.filters = node == 0 ? std::vector<CanFilter>{{1, 0x7F}, {2, 0x7F}} : FiltersOfNode(node);
      settings.transmit_frames = 64;
      settings.clock_zero = -clock.FromKernel({});
      sockets_[At(node)] = std::make_unique<SocketCanBus>(settings);
      ends_[At(node)] = std::make_unique<NotingBus>(*sockets_[At(node)], clock);
    }
  }
  NotingBus& end(int node) { return *ends_[At(node)]; }
  void Exchange(nanoseconds now) {
    if (!sockets_[0]) in_process_.Exchange(now);
  }

 private:
  static std::size_t At(int node) { return static_cast<std::size_t>(node); }

  // Frames take no time: with the standard PDOs two drives need more than 1 ms of a bus at 1 Mbit/s.
  InProcessCanBus in_process_{{.ends = 3, .bitrate = 0, .transmit_frames = 64}};
  std::array<std::unique_ptr<SocketCanBus>, 3> sockets_;
  std::array<std::unique_ptr<NotingBus>, 3> ends_;
};

void PlayDrives(ThreeEnds& ends, const BenchClock& clock, nanoseconds period, const std::atomic<bool>& over) {
  (void)BecomeRealtime(RealtimeRank::kDeviceSide);
  FreeMotor motors[2];
  const auto eds = InProcessDrives::ReadEds();
  protocols::canopen::device::DriveNode nodes[] = {{eds, 1, motors[0]}, {eds, 2, motors[1]}};
  DriveOnBus drives[] = {{ends.end(1), nodes[0]}, {ends.end(2), nodes[1]}};
  MonotonicClock pace;
  nanoseconds next = pace.Now();
  while (!over) {
    ends.Exchange(clock.Now());
    for (FreeMotor& motor : motors) motor.Step(std::chrono::duration<double>(period).count());
    for (DriveOnBus& drive : drives) drive.Cycle(clock.Now());
    ends.Exchange(clock.Now());
    next = std::max(next + period, pace.Now() - period);
    pace.SleepUntil(next);
  }
}

struct LoopTiming {
  TimingHistogram periods, lateness, stops;
  std::uint64_t missed_more_than_one{};
  std::string refused;
};

void Control(DriveBus& bus, NotingBus& end, MonotonicClock& clock, nanoseconds period, double seconds,
             LoopTiming& timing) {
  timing.refused = BecomeRealtime(RealtimeRank::kControl);
  CanopenServo& driving = bus.servo(0);
  CanopenServo& load = bus.servo(1);
  const auto between_stops =
      static_cast<int>(kBetweenStops_s / std::chrono::duration<double>(period).count());
  const nanoseconds start = clock.Now();
  nanoseconds next = start;
  nanoseconds last = start;
  for (int number = 0; next - start < std::chrono::duration<double>(seconds); ++number) {
    next += period;
    clock.SleepUntil(next);
    const nanoseconds now = clock.Now();
    timing.periods.Add(now - last);
    timing.lateness.Add(now - next);
    if (now - next > period) ++timing.missed_more_than_one;
    last = now;
    next = std::max(next, now - period);
    const int at = number % between_stops;
    load.Actual();
    if (at == 0) {
      driving.Enable(DriveMode::kSpeed);
    } else if (at == between_stops - 1 &&
               driving.Actual().power == protocols::PowerState::kOperationEnabled) {
      // A limit is broken in this period's readings.
      end.stop_sent_ns = 0;
      driving.QuickStop();
      const nanoseconds give_up = now + milliseconds(100);
      while (end.stop_sent_ns == 0 && clock.Now() < give_up) {
      }
      timing.stops.Add(nanoseconds(end.stop_sent_ns) - now);
      next = std::max(next, clock.Now());
      last = clock.Now();
    } else if (driving.Actual().power == protocols::PowerState::kOperationEnabled) {
      if (driving.Actual().brake_engaged) driving.SetBrake(false);
      driving.CommandSpeed(100.0);
    }
  }
}

// Sent by one end and not received by the other, after all have read what there was: frames that bear the
// node's number, and SYNC.
std::uint64_t Missing(const NotingBus& from, const NotingBus& to, unsigned node, bool with_sync) {
  std::uint64_t missing = 0;
  for (std::size_t id = 0; id < from.sent_by_id.size(); ++id) {
    const bool is_meant = (id & 0x7F) == node || (with_sync && id == 0x80);
    if (is_meant) missing += from.sent_by_id[id] - std::min(from.sent_by_id[id], to.received_by_id[id]);
  }
  return missing;
}

void ReportFrames(ThreeEnds& ends) {
  ReceivedFrame rest;
  for (int node = 2; node >= 0; --node) {
    while (ends.end(node).Receive(rest)) continue;
  }
  for (const unsigned node : {1U, 2U}) {
    NotingBus& drive = ends.end(static_cast<int>(node));
    std::uint64_t set_points = 0;
    std::uint64_t answers = 0;
    for (const unsigned pdo : {0x200U, 0x300U, 0x400U, 0x500U}) {
      set_points += ends.end(0).sent_by_id[pdo + node];
      answers += drive.sent_by_id[pdo - 0x80U + node];
    }
    fmt::print(
        "drive {}: SYNC sent {}, PDOs to it {}, from it {}; on the way to it {} lost or purged by a stop, "
        "from it {} lost\n",
        node, ends.end(0).sent_by_id[0x80], set_points, answers, Missing(ends.end(0), drive, node, true),
        Missing(drive, ends.end(0), node, false));
  }
  fmt::print("overrun sockets: {} frames lost\n",
             ends.end(0).lost_frames() + ends.end(1).lost_frames() + ends.end(2).lost_frames());
}

int Run(double seconds, nanoseconds period, const std::string& interface) {
  MonotonicClock clock;
  ThreeEnds ends(interface, clock);
  auto profile = ReadDriveProfile(InProcessDrives::Profiles() / "strainwave_drive.yaml");
  profile.timing.sync_period = period;
  profile.timing.stale_after_syncs = 100;
  profile.timing.most_sync_deviation = std::max<nanoseconds>(milliseconds(100), 20 * period);
  if (!interface.empty()) {
    // An emulated processor is held up for longer than a real one.
    profile.supervision.drive_timeout_ms = profile.supervision.master_timeout_ms = 1000;
    profile.supervision.rpdo_event_timer_ms = 1000;
  }
  DriveBus bus(ends.end(0), clock, {{"driving servo", profile, 1}, {"load servo", profile, 2}});
  std::atomic<bool> over{};
  std::thread devices([&] { PlayDrives(ends, clock, period, over); });
  LoopTiming timing;
  DriveBusThread thread(bus, clock);
  std::this_thread::sleep_for(milliseconds(100));
  // Drives that have just been switched on say so, and then have lost what was set up before.
  std::string troubles = thread.Commission(std::chrono::seconds(20));
  if (!troubles.empty()) troubles = thread.Commission(std::chrono::seconds(20));
  std::thread control([&] { Control(bus, ends.end(0), clock, period, seconds, timing); });
  control.join();
  thread.End();
  // The drives read what is still on its way; what they go on saying would fill a socket that nobody reads.
  ReceivedFrame rest;
  for (int i = 0; i < 500; ++i) {
    std::this_thread::sleep_for(milliseconds(1));
    while (ends.end(0).Receive(rest)) continue;
  }
  over = true;
  devices.join();
  const DriveBusCounts counts = bus.counts();
  fmt::print("{}{}", troubles, troubles.empty() ? "" : "\n");
  if (!timing.refused.empty()) fmt::print("{}\n", timing.refused);
  fmt::print("control loop, periods:      {}\n", timing.periods.Text());
  fmt::print("control loop, late by:      {}\n", timing.lateness.Text());
  fmt::print("bus thread, periods:        {}\n", thread.timing().periods.Text());
  fmt::print("limit to quick-stop frame:  {}\n", timing.stops.Text());
  fmt::print("periods late by more than one: {}; frames sent {}, received {}, lost {}\n",
             timing.missed_more_than_one, counts.sent, counts.received, counts.lost);
  ReportFrames(ends);
  return troubles.empty() ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace strainwave::bench

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 600.0;
  const double period_ms = argc > 2 ? std::atof(argv[2]) : 1.0;
  return strainwave::bench::Run(seconds, std::chrono::nanoseconds(static_cast<std::int64_t>(1e6 * period_ms)),
                                argc > 3 ? argv[3] : "");
}
