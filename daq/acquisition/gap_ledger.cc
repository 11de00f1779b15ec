// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/gap_ledger.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace strainwave::daq::acquisition {
namespace {

constexpr unsigned kLeastCounterBits = 8;
constexpr unsigned kMostCounterBits = 64;
constexpr double kFurthestStep = 9e18;  // of what an int64 holds

std::uint64_t MaskOf(unsigned bits) { return ~std::uint64_t{0} >> (kMostCounterBits - bits); }

}  // namespace

GapLedger::GapLedger(CounterRules rules, double rate_hz) : rules_(rules), rate_hz_(rate_hz) {
  if (rules.bits < kLeastCounterBits || rules.bits > kMostCounterBits) {
    throw std::invalid_argument(
        fmt::format("bits = {} is not between {} and {}", rules.bits, kLeastCounterBits, kMostCounterBits));
  }
  if (!(rate_hz > 0) || !std::isfinite(rate_hz)) {
    throw std::invalid_argument(fmt::format("rate_hz = {} is not above zero", rate_hz));
  }
}

GapLedger::Step GapLedger::StepOf(const BlockHeader& header) const noexcept {
  const auto in_samples = [this](std::chrono::nanoseconds time) {
    return std::chrono::duration<double>(time).count() * rate_hz_;
  };
  // The last samples of two blocks lie as far apart as their arrivals do.
  const double missing = in_samples(header.arrival - last_arrival_) - static_cast<double>(header.samples);
  const std::uint64_t forward = (header.device_counter - next_counter_) & MaskOf(rules_.bits);
  auto samples = static_cast<std::int64_t>(forward);
  if (rules_.bits < kMostCounterBits) {
    const double turn = std::ldexp(1.0, static_cast<int>(rules_.bits));
    const double turns = std::max(-1.0, std::round((missing - static_cast<double>(forward)) / turn));
    samples = static_cast<std::int64_t>(std::min(static_cast<double>(forward) + turns * turn, kFurthestStep));
  }
  const auto step = static_cast<double>(samples);
  if (samples == 0) return {Move::kGoesOn, samples, missing};
  if (samples > 0) {
    return {step - missing > in_samples(rules_.credible) ? Move::kJumps : Move::kLoses, samples, missing};
  }
  const double repeated = std::max(-step, static_cast<double>(repeated_in_a_row_));
  return {repeated > in_samples(rules_.longest_repeat) ? Move::kJumps : Move::kRepeats, samples, missing};
}

std::uint64_t GapLedger::EstimateOf(const Step& step) noexcept {
  return static_cast<std::uint64_t>(std::max(0.0, std::round(step.missing)));
}

Gap GapLedger::Book(const BlockHeader& header, std::uint64_t lost, bool jumped) noexcept {
  ++totals_.gaps;
  totals_.lost += lost;
  if (jumped) {
    ++totals_.resets;
    totals_.estimated += lost;
  }
  const Gap gap{next_sample_,  lost,           !jumped,           jumped,
                last_arrival_, header.arrival, last_device_time_, header.device_time};
  next_sample_ += lost;
  return gap;
}

std::optional<Gap> GapLedger::Admit(SampleBlock& block) noexcept {
  BlockHeader& header = block.header;
  std::optional<Gap> gap;
  if (has_begun_ && header.samples > 0) {
    const Step step = StepOf(header);
    switch (step.move) {
      case Move::kGoesOn:
        break;
      case Move::kLoses:
        gap = Book(header, static_cast<std::uint64_t>(step.samples), false);
        break;
      case Move::kRepeats: {
        const auto behind = static_cast<std::uint64_t>(-step.samples);
        const auto again = static_cast<std::uint32_t>(std::min<std::uint64_t>(behind, header.samples));
        totals_.repeated += again;
        repeated_in_a_row_ += again;
        header.flags |= kHadRepeats;
        block.DropFront(again);
        break;
      }
      case Move::kJumps:
        gap = Book(header, EstimateOf(step), true);
        header.flags |= kAfterReset | kLostIsEstimate;
        break;
    }
  }
  header.first_sample = next_sample_;
  header.lost_before = gap ? gap->lost : 0;
  if (gap) header.flags |= kAfterGap;
  if (header.samples == 0) return gap;
  has_begun_ = true;
  repeated_in_a_row_ = 0;
  totals_.received += header.samples;
  next_sample_ += header.samples;
  next_counter_ = header.device_counter + header.samples;
  last_arrival_ = header.arrival;
  last_device_time_ = header.device_time;
  return gap;
}

std::optional<Gap> GapLedger::EndAfter(const BlockHeader& dropped) noexcept {
  BlockHeader end = dropped;
  end.device_counter += dropped.samples;
  end.samples = 0;
  const Step step = StepOf(end);
  if (!has_begun_ || step.move == Move::kRepeats) return std::nullopt;
  const bool jumped = step.move == Move::kJumps;
  const Gap gap = Book(end, jumped ? EstimateOf(step) : static_cast<std::uint64_t>(step.samples), jumped);
  next_counter_ = end.device_counter;
  last_arrival_ = end.arrival;
  return gap;
}

}  // namespace strainwave::daq::acquisition
