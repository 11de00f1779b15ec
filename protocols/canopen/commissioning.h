// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocols/can_frame.h"
#include "protocols/canopen/commissioning_steps.h"
#include "protocols/canopen/sdo_client.h"

namespace strainwave::protocols::canopen {

/// Takes the steps of a drive's boot one after another over SDO, and stops at the first that fails. Nothing
/// allocates but `FailureWords`.
class Commissioning {
 public:
  enum class State : std::uint8_t { kIdle, kRunning, kDone, kFailed };

  /// @throws std::invalid_argument as SdoClient does.
  Commissioning(std::vector<CommissioningStep> steps, std::uint8_t node_id,
                std::chrono::nanoseconds sdo_timeout);

  void Start(std::chrono::nanoseconds now) noexcept;
  void Abandon() noexcept;

  void OnFrame(const CanFrame& frame, std::chrono::nanoseconds now) noexcept;
  /// The next frame to send, until there is none.
  std::optional<CanFrame> Poll(std::chrono::nanoseconds now) noexcept;

  State state() const noexcept { return state_; }
  /// Steps taken, of `steps().size()`.
  std::size_t steps_done() const noexcept { return step_; }
  const std::vector<CommissioningStep>& steps() const noexcept { return steps_; }

  /// Why it stopped, for a technician; empty unless failed.
  std::string FailureWords() const;

 private:
  void BeginStep(std::chrono::nanoseconds now) noexcept;
  void NextStep(std::chrono::nanoseconds now) noexcept;
  void OnTransferDone(std::chrono::nanoseconds now) noexcept;
  void Write(std::uint32_t value, std::chrono::nanoseconds now) noexcept;

  std::vector<CommissioningStep> steps_;
  std::uint8_t node_id_;
  SdoClient client_;
  State state_{State::kIdle};
  std::size_t step_{};
  bool is_writing_{};
  std::uint32_t read_{};
};

}  // namespace strainwave::protocols::canopen
