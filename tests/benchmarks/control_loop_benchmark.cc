// SPDX-License-Identifier: Apache-2.0
// A control loop at 1 kHz with two drives on a CAN bus within the program: how even its periods are, and how
// long a stop takes from the limit that asks for it to the frame that carries it out. usage:
// control_loop_benchmark [SECONDS]
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include <fmt/core.h>

#include "bench/controller/realtime.h"
#include "bench/controller/timing_histogram.h"
#include "bench/devices/canopen/drive_bus_thread.h"
#include "bench/devices/monotonic_clock.h"
#include "tests/bench/canopen/in_process_drives.h"

namespace strainwave::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr milliseconds kPeriod{1};
constexpr int kPeriodsBetweenStops = 2000;

// The bench's end of the bus, which notes when the first quick stop went out.
class NotingBus final : public CanBus {
 public:
  NotingBus(CanBus& bus, const BenchClock& clock) : bus_(bus), clock_(clock) {}

  Sent Send(const protocols::CanFrame& frame) noexcept override {
    const Sent sent = bus_.Send(frame);
    const bool stop = frame.id == 0x201 && frame.data[0] == 0x02 && frame.data[1] == 0;
    std::int64_t none = 0;
    if (stop && sent == Sent::kQueued) stop_sent_ns.compare_exchange_strong(none, clock_.Now().count());
    return sent;
  }
  bool Receive(ReceivedFrame& received) noexcept override { return bus_.Receive(received); }
  void PurgeTransmit() noexcept override { bus_.PurgeTransmit(); }
  CanState state() const noexcept override { return bus_.state(); }
  std::uint64_t lost_frames() const noexcept override { return bus_.lost_frames(); }

  std::atomic<std::int64_t> stop_sent_ns{};

 private:
  CanBus& bus_;
  const BenchClock& clock_;
};

int Run(double seconds) {
  MonotonicClock clock;
  // Frames take no time: with the standard PDOs two drives need more than 1 ms of a bus at 1 Mbit/s.
  InProcessCanBus buses({.ends = 3, .bitrate = 0, .transmit_frames = 64});
  auto profile = ReadDriveProfile(InProcessDrives::Profiles() / "strainwave_drive.yaml");
  profile.timing.sync_period = kPeriod;
  profile.timing.stale_after_syncs = 100;
  profile.timing.most_sync_deviation = milliseconds(100);
  NotingBus end(buses.end(0), clock);
  DriveBus bus(end, clock, {{"driving servo", profile, 1}, {"load servo", profile, 2}});

  std::atomic<bool> over{};
  std::thread devices([&] {
    (void)BecomeRealtime(RealtimeRank::kDeviceSide);
    FreeMotor motors[2];
    const auto eds = InProcessDrives::ReadEds();
    protocols::canopen::device::DriveNode first(eds, 1, motors[0]);
    protocols::canopen::device::DriveNode second(eds, 2, motors[1]);
    MonotonicClock pace;
    nanoseconds next = pace.Now();
    while (!over) {
      buses.Exchange(clock.Now());
      int number = 1;
      for (auto* node : {&first, &second}) {
        ReceivedFrame received;
        CanBus& mine = buses.end(number);
        while (mine.Receive(received)) node->OnFrame(received.frame, clock.Now());
        motors[number - 1].Step(1e-3);
        node->Poll(clock.Now());
        protocols::CanFrame frame;
        while (node->Next(frame)) mine.Send(frame);
        ++number;
      }
      buses.Exchange(clock.Now());
      next = std::max(next + kPeriod, pace.Now() - kPeriod);
      pace.SleepUntil(next);
    }
  });

  int result = EXIT_FAILURE;
  {
    DriveBusThread thread(bus, clock);
    std::this_thread::sleep_for(milliseconds(100));
    const std::string troubles = thread.Commission(std::chrono::seconds(20));
    TimingHistogram periods, lateness, stops;
    std::uint64_t missed_more_than_one = 0;
    std::string refused;
    std::thread control([&] {
      refused = BecomeRealtime(RealtimeRank::kControl);
      CanopenServo& driving = bus.servo(0);
      CanopenServo& load = bus.servo(1);
      const nanoseconds start = clock.Now();
      nanoseconds next = start;
      nanoseconds last = start;
      for (int period = 0; next - start < std::chrono::duration<double>(seconds); ++period) {
        next += kPeriod;
        clock.SleepUntil(next);
        const nanoseconds now = clock.Now();
        periods.Add(now - last);
        lateness.Add(now - next);
        if (now - next > kPeriod) ++missed_more_than_one;
        last = now;
        next = std::max(next, now - kPeriod);
        const int at = period % kPeriodsBetweenStops;
        load.Actual();
        if (at == 0) {
          driving.Enable(DriveMode::kSpeed);
        } else if (at == kPeriodsBetweenStops - 1) {
          // A limit is broken in this period's readings.
          end.stop_sent_ns = 0;
          driving.QuickStop();
          const nanoseconds give_up = now + milliseconds(100);
          while (end.stop_sent_ns == 0 && clock.Now() < give_up) {
          }
          stops.Add(nanoseconds(end.stop_sent_ns) - now);
          next = std::max(next, clock.Now());
          last = clock.Now();
        } else if (driving.Actual().power == protocols::PowerState::kOperationEnabled) {
          if (driving.Actual().brake_engaged) driving.SetBrake(false);
          driving.CommandSpeed(100.0);
        }
      }
    });
    control.join();
    const DriveBusCounts counts = bus.counts();
    thread.End();
    fmt::print("{}{}", troubles, troubles.empty() ? "" : "\n");
    if (!refused.empty()) fmt::print("{}\n", refused);
    fmt::print("control loop, periods:      {}\n", periods.Text());
    fmt::print("control loop, late by:      {}\n", lateness.Text());
    fmt::print("bus thread, periods:        {}\n", thread.timing().periods.Text());
    fmt::print("limit to quick-stop frame:  {}\n", stops.Text());
    fmt::print("periods late by more than one: {}; frames sent {}, received {}, lost {}\n",
               missed_more_than_one, counts.sent, counts.received, counts.lost);
    result = troubles.empty() ? EXIT_SUCCESS : EXIT_FAILURE;
  }
  over = true;
  devices.join();
  return result;
}

}  // namespace
}  // namespace strainwave::bench

int main(int argc, char** argv) { return strainwave::bench::Run(argc > 1 ? std::atof(argv[1]) : 600.0); }
