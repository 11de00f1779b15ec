// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "daq/acquisition/sample_block.h"

namespace strainwave::daq::acquisition {

/// Samples that never came.
struct Gap {
  std::uint64_t first_lost{};                   // running number, as in `BlockHeader::first_sample`
  std::uint64_t lost{};                         // samples a channel
  bool is_exact{true};                          // from the counter; else from the time that went by
  bool is_reset{false};                         // the counter jumped or started anew; `lost` may then be 0
  std::chrono::nanoseconds last_arrival{};      // of the block before
  std::chrono::nanoseconds arrival{};           // of the block after
  std::chrono::nanoseconds last_device_time{};  // of the first sample of the block before
  std::chrono::nanoseconds device_time{};       // of the first sample after

  bool operator==(const Gap&) const = default;
};

/// Totals since the ledger was made.
struct GapTotals {
  std::uint64_t received{};   // samples that were passed on
  std::uint64_t lost{};       // sum over all gaps
  std::uint64_t estimated{};  // of these, by gaps that are not exact
  std::uint64_t repeated{};   // samples that came again, or after they had been reported as lost; left out
  std::uint64_t gaps{};
  std::uint64_t resets{};

  bool operator==(const GapTotals&) const = default;
};

/// How a device counts.
struct CounterRules {
  unsigned bits{64};  // the counter wraps after 2^bits samples; 8 to 64
  /// A step forward that is longer than the time that went by, by more than this, is a counter that jumped.
  std::chrono::nanoseconds credible{std::chrono::seconds(5)};
  /// A step back that is longer than this is a counter that started anew, a shorter one is samples that come
  /// again.
  std::chrono::nanoseconds longest_repeat{std::chrono::seconds(1)};
};

/// Accounts for every sample of one source by its counter, and tells those behind it in band what is missing.
///
/// A counter says how far it went only up to whole turns; how many turns there were is told from the arrival
/// times. So a narrow counter wants its blocks within half a turn of their time: 16 bits at 51.2 kHz hold
/// 0.64 s. A 16-bit counter can therefore not tell a reset from a loss; wider ones can.
class GapLedger {
 public:
  /// @throws std::invalid_argument for a width that no counter has or a rate that is not above zero.
  GapLedger(CounterRules rules, double rate_hz);

  /// Fills in `first_sample`, `lost_before` and the flags of a block, in the order of arrival, and takes off
  /// what had come before; a block that is all repeats is left with no samples.
  /// @returns the gap before the block, if there is one.
  std::optional<Gap> Admit(SampleBlock& block) noexcept;

  /// Books what is missing up to the end of a block that came but was not kept, with none kept after it.
  std::optional<Gap> EndAfter(const BlockHeader& dropped) noexcept;

  const GapTotals& totals() const { return totals_; }

 private:
  enum class Move : std::uint8_t { kGoesOn, kLoses, kRepeats, kJumps };
  struct Step {
    Move move{};
    std::int64_t samples{};  // between the sample that was expected and the one that came
    double missing{};        // the same by the time that went by
  };
  Step StepOf(const BlockHeader& header) const noexcept;
  static std::uint64_t EstimateOf(const Step& step) noexcept;
  Gap Book(const BlockHeader& header, std::uint64_t lost, bool jumped) noexcept;

  CounterRules rules_;
  double rate_hz_;
  bool has_begun_{};
  std::uint64_t next_sample_{};   // running number that is expected
  std::uint64_t next_counter_{};  // the device's
  std::uint64_t repeated_in_a_row_{};
  std::chrono::nanoseconds last_arrival_{};
  std::chrono::nanoseconds last_device_time_{};
  GapTotals totals_;
};

}  // namespace strainwave::daq::acquisition
