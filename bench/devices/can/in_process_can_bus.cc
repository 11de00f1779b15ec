// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/can/in_process_can_bus.h"

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <tuple>

#include <fmt/format.h>
#include <boost/lockfree/spsc_queue.hpp>

#include "bench/devices/can/wire_bits.h"

namespace strainwave::bench {
namespace {

using protocols::CanFrame;

constexpr std::uint32_t kBusOffClass = 0x40;  // of error frames as Linux reports them

// Lower goes first, bit by bit as on the wire: the first 11 bits, remote or extended recessive, the rest.
auto Priority(const CanFrame& frame) {
  const std::uint32_t first = frame.extended ? frame.id >> 18U : frame.id;
  return std::make_tuple(first, frame.extended || frame.remote, frame.extended,
                         frame.extended ? frame.id & 0x3FFFFU : 0U, frame.remote);
}

}  // namespace

class InProcessCanBus::End final : public CanBus {
 public:
  // A queue with room for what was purged and not yet thrown away: after a stop there must be place for its
  // frames at once.
  explicit End(const InProcessCanSettings& settings)
      : most_queued_(settings.transmit_frames),
        transmit_(4 * settings.transmit_frames),
        receive_(settings.receive_frames) {}

  Sent Send(const CanFrame& frame) noexcept override {
    if (bus_off_.load(std::memory_order_acquire)) return Sent::kDown;
    const std::uint64_t gone =
        std::max(taken_.load(std::memory_order_acquire), purged_.load(std::memory_order_relaxed));
    if (queued_ - gone >= most_queued_ || !transmit_.push(frame)) return Sent::kFull;
    ++queued_;
    return Sent::kQueued;
  }

  bool Receive(ReceivedFrame& received) noexcept override { return receive_.pop(received); }

  // Only the bus can take frames out; those up to this one it throws away.
  void PurgeTransmit() noexcept override { purged_.store(queued_, std::memory_order_release); }

  CanState state() const noexcept override {
    if (bus_off_.load(std::memory_order_acquire)) return CanState::kBusOff;
    return alone_.load(std::memory_order_acquire) ? CanState::kErrorPassive : CanState::kErrorActive;
  }

  std::uint64_t lost_frames() const noexcept override { return lost_.load(std::memory_order_relaxed); }

  // The bus's side.
  bool hears() const noexcept { return !bus_off_.load(std::memory_order_relaxed); }
  void SetAlone(bool alone) noexcept { alone_.store(alone, std::memory_order_release); }
  void SetBusOff(bool off) noexcept { bus_off_.store(off, std::memory_order_release); }
  void LoseNext(std::uint64_t frames) noexcept { to_lose_ += frames; }

  // What is queued later waits for the next exchange: an end that sends as fast as frames are taken would
  // otherwise never let one end.
  void NoteQueued() noexcept { offered_ = transmit_.read_available(); }
  // The frame that this end has on offer; null when none.
  const CanFrame* Offered() noexcept {
    while (offered_ != 0) {
      const bool purged = taken_.load(std::memory_order_relaxed) < purged_.load(std::memory_order_acquire);
      if (hears() && !purged) return &transmit_.front();
      Take();
    }
    return nullptr;
  }
  void Take() noexcept {
    transmit_.pop();
    --offered_;
    taken_.fetch_add(1, std::memory_order_release);
  }

  void Deliver(const ReceivedFrame& received) noexcept {
    const bool loses = to_lose_ > 0 && !received.frame.error;
    if (loses) --to_lose_;
    if (loses || !receive_.push(received)) lost_.fetch_add(1, std::memory_order_relaxed);
  }

 private:
  std::size_t most_queued_;
  boost::lockfree::spsc_queue<CanFrame> transmit_;
  boost::lockfree::spsc_queue<ReceivedFrame> receive_;
  // Frames since the start: queued, up to which purged, taken out by the bus.
  std::uint64_t queued_{};
  std::atomic<std::uint64_t> purged_{};
  std::atomic<std::uint64_t> taken_{};
  std::atomic<std::uint64_t> lost_{};
  std::atomic<bool> bus_off_{};
  std::atomic<bool> alone_{};
  std::uint64_t to_lose_{};
  std::size_t offered_{};  // of the frames queued, those for this exchange
};

InProcessCanBus::InProcessCanBus(const InProcessCanSettings& settings) : bitrate_(settings.bitrate) {
  const auto demand = [](const char* name, auto value, auto least) {
    if (value >= least) return;
    throw std::invalid_argument(fmt::format("{} = {} (must be at least {})", name, value, least));
  };
  demand("ends", settings.ends, 2);
  demand("transmit_frames", settings.transmit_frames, std::size_t{1});
  demand("receive_frames", settings.receive_frames, std::size_t{1});
  for (int i = 0; i < settings.ends; ++i) ends_.push_back(std::make_unique<End>(settings));
}

InProcessCanBus::~InProcessCanBus() = default;

CanBus& InProcessCanBus::end(int number) { return *ends_.at(static_cast<std::size_t>(number)); }

bool InProcessCanBus::SomeoneHears(const End& sender) const noexcept {
  return std::any_of(ends_.begin(), ends_.end(),
                     [&](const auto& end) { return end.get() != &sender && end->hears(); });
}

InProcessCanBus::End* InProcessCanBus::Winner() noexcept {
  End* winner = nullptr;
  const CanFrame* best = nullptr;
  for (const auto& end : ends_) {
    const CanFrame* offered = end->Offered();
    if (offered == nullptr) continue;
    const bool heard = SomeoneHears(*end);
    end->SetAlone(!heard);
    if (!heard || (best != nullptr && Priority(*best) <= Priority(*offered))) continue;
    winner = end.get();
    best = offered;
  }
  // Now: its end may purge it at any moment, and would then have another on offer, or none.
  if (winner != nullptr) on_the_wire_ = *best;
  return winner;
}

void InProcessCanBus::Exchange(std::chrono::nanoseconds now) noexcept {
  for (const auto& end : ends_) end->NoteQueued();
  for (;;) {
    if (sender_ != nullptr) {
      if (free_at_ > now) break;
      ++carried_;
      for (const auto& end : ends_) {
        if (end.get() != sender_ && end->hears()) end->Deliver({on_the_wire_, free_at_});
      }
      sender_ = nullptr;
    }
    const std::chrono::nanoseconds start = std::max(free_at_, last_exchange_);
    if (start > now) break;
    sender_ = Winner();
    if (sender_ == nullptr) break;
    sender_->Take();
    const std::chrono::nanoseconds length(
        bitrate_ == 0 ? 0 : WireBits(on_the_wire_) * std::int64_t{1'000'000'000} / std::int64_t{bitrate_});
    free_at_ = start + length;
    busy_ += length;
  }
  last_exchange_ = std::max(last_exchange_, now);
}

void InProcessCanBus::SetBusOff(int number, bool off) noexcept {
  End& end = *ends_[static_cast<std::size_t>(number)];
  end.SetBusOff(off);
  if (!off) return;
  if (sender_ == &end) sender_ = nullptr;
  ReceivedFrame told;
  told.frame.id = kBusOffClass;
  told.frame.error = true;
  told.frame.length = 8;
  told.time = last_exchange_;
  end.Deliver(told);
}

void InProcessCanBus::LoseNext(int number, std::uint64_t frames) noexcept {
  ends_[static_cast<std::size_t>(number)]->LoseNext(frames);
}

}  // namespace strainwave::bench
