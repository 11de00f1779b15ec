// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/window_sequence.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace strainwave::bench {
namespace {

constexpr double kEven = 0.01;
constexpr std::size_t kParts = 8;
// A length that is whole but for its rounding counts as whole.
constexpr double kRounding = 1e-6;

}  // namespace

std::optional<double> SamplesPerUnit(std::span<const double> positions) {
  if (positions.size() < 2) return std::nullopt;
  const std::size_t parts = std::min(kParts, positions.size() - 1);
  const std::size_t part = (positions.size() - 1) / parts;
  const double all = positions[parts * part] - positions.front();
  for (std::size_t k = 0; k < parts; ++k) {
    const double share = positions[(k + 1) * part] - positions[k * part];
    if (!(std::abs(share * static_cast<double>(parts) / all - 1.0) <= kEven)) return std::nullopt;
  }
  return static_cast<double>(parts * part) / std::abs(all);
}

std::optional<Window> WindowSequence::Add(double position) {
  std::optional<Window> ended;
  if (positions_.empty()) {
    origin_ = position;
  } else {
    const double half_step = 0.5 * (position - positions_.back());
    if (position - origin_ > (ended_ + 1.0) * length_ - half_step) ended = Close(positions_.size());
  }
  positions_.push_back(position);
  return ended;
}

std::optional<Window> WindowSequence::Finish() {
  const std::optional<std::size_t> whole = WholeSamples();
  if (!whole || *whole == 0 || positions_.size() < *whole) return std::nullopt;
  return Close(positions_.size());
}

std::optional<std::size_t> WindowSequence::WholeSamples() const {
  const std::optional<double> samples_per_unit = SamplesPerUnit(positions_);
  if (!samples_per_unit) return std::nullopt;
  return static_cast<std::size_t>(*samples_per_unit * length_ + kRounding);
}

Window WindowSequence::Close(std::size_t count) {
  const Window window{begin_, std::min(count, WholeSamples().value_or(count))};
  begin_ += count;
  ended_ += 1.0;
  positions_.clear();
  return window;
}

std::vector<Window> WindowsOf(std::size_t rows, std::optional<double> samples_per_turn,
                              const WindowLength& length) {
  if (length.turns == 0 && length.samples == 0) return {{0, rows}};
  if (length.turns > 0 && !samples_per_turn) {
    throw std::invalid_argument("samples_per_turn is not known (expected it for windows of whole turns)");
  }
  const double samples =
      length.turns > 0 ? *samples_per_turn * length.turns : static_cast<double>(length.samples);
  if (!(samples + kRounding >= 1.0 && samples <= static_cast<double>(rows) + 1.0)) return {};
  WindowSequence sequence(samples);
  std::vector<Window> windows;
  for (std::size_t i = 0; i < rows; ++i) {
    if (const auto ended = sequence.Add(static_cast<double>(i))) windows.push_back(*ended);
  }
  if (const auto last = sequence.Finish()) windows.push_back(*last);
  return windows;
}

}  // namespace strainwave::bench
