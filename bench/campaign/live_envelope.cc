// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/live_envelope.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <type_traits>
#include <utility>

#include <fmt/core.h>

#include "daq/data_file_error.h"

namespace strainwave::bench {
namespace {

constexpr std::int64_t kEnvelopeInterval_ms = 500;
constexpr std::int32_t kEnvelopeVersion = 1;

// In front of the bins; native byte order, since it is read on the machine that writes it.
struct EnvelopeHeader {
  std::int32_t version;
  std::int32_t recent_bins;
  std::int32_t whole_bins;
  std::int32_t unused;
  double recent_start_s;
  double recent_width_s;
  double whole_start_s;
  double whole_width_s;
  std::uint64_t campaign;
  std::int64_t utc_ms;
  std::int64_t since_boot_ms;
  std::uint64_t boot;
};
// Min, max and last of each channel, as float: seven digits, and half the room.
using Bin = std::array<float, 3 * kLiveChannels.size()>;
static_assert(std::is_trivially_copyable_v<EnvelopeHeader> && sizeof(Bin) == 3 * 4 * kLiveChannels.size());
static_assert(sizeof(EnvelopeHeader) + 2 * LiveEnvelopes::kBins * sizeof(Bin) <=
              daq::CheckpointFile::kCapacity_bytes);

Bin Packed(const LiveExtremes& extremes) {
  Bin bin{};
  std::size_t at = 0;
  for (const Extremes& channel : extremes.channels) {
    for (const double value : {channel.min, channel.max, channel.last}) bin[at++] = static_cast<float>(value);
  }
  return bin;
}

LiveExtremes Unpacked(const Bin& bin) {
  LiveExtremes extremes;
  std::size_t at = 0;
  for (Extremes& channel : extremes.channels) {
    channel = {bin[at], bin[at + 1], bin[at + 2]};
    at += 3;
  }
  return extremes;
}

std::byte* PutBins(std::byte* to, const Envelope& envelope) {
  for (const LiveExtremes& extremes : envelope.bins()) {
    const Bin bin = Packed(extremes);
    std::memcpy(to, &bin, sizeof bin);
    to += sizeof bin;
  }
  return to;
}

std::vector<LiveExtremes> BinsAt(const std::byte* from, std::int32_t count) {
  std::vector<LiveExtremes> bins;
  for (std::int32_t i = 0; i < count; ++i) {
    Bin bin{};
    std::memcpy(&bin, from + static_cast<std::size_t>(i) * sizeof bin, sizeof bin);
    bins.push_back(Unpacked(bin));
  }
  return bins;
}

}  // namespace

Envelope::Envelope(std::size_t most_bins, double width_s, WhenFull when_full)
    : Envelope(most_bins, width_s, when_full, 0.0, {}) {}

Envelope::Envelope(std::size_t most_bins, double width_s, WhenFull when_full, double start_s,
                   std::vector<LiveExtremes> bins)
    : most_bins_(most_bins),
      width_s_(width_s),
      when_full_(when_full),
      start_s_(start_s),
      bins_(std::move(bins)) {
  if (most_bins < 2) {
    throw std::invalid_argument(fmt::format("most_bins = {} is too few (expected at least 2)", most_bins));
  }
  if (!(width_s > 0.0) || !std::isfinite(width_s)) {
    throw std::invalid_argument(fmt::format("width_s = {:g} is not a positive number", width_s));
  }
  if (bins_.size() > most_bins || !std::isfinite(start_s)) {
    throw std::invalid_argument(
        fmt::format("{} bins from {:g} s are none of an envelope of {}", bins_.size(), start_s, most_bins));
  }
}

void Envelope::Add(double time_s, const LiveExtremes& values) {
  if (!std::isfinite(time_s)) return;
  // The first bin begins at a whole number of widths, so that bins of one campaign are alike.
  if (bins_.empty()) start_s_ = std::floor(time_s / width_s_) * width_s_;
  MakeRoom(time_s);
  const double place = std::max(0.0, std::floor((time_s - start_s_) / width_s_));
  const auto bin = static_cast<std::size_t>(place);
  if (bin >= bins_.size()) bins_.resize(bin + 1);
  bins_[bin].Merge(values);
}

// Until the time lies in one of the bins that there may be.
void Envelope::MakeRoom(double time_s) {
  const auto most = static_cast<double>(most_bins_);
  switch (when_full_) {
    case WhenFull::kMergePairs:
      while ((time_s - start_s_) / width_s_ >= most) {
        std::vector<LiveExtremes> wider((bins_.size() + 1) / 2);
        for (std::size_t i = 0; i < bins_.size(); ++i) wider[i / 2].Merge(bins_[i]);
        bins_ = std::move(wider);
        width_s_ *= 2.0;
      }
      return;
    case WhenFull::kForgetOldest: {
      const double beyond = std::floor((time_s - start_s_) / width_s_) - (most - 1.0);
      if (beyond <= 0.0) return;
      const double gone = std::min(beyond, static_cast<double>(bins_.size()));
      bins_.erase(bins_.begin(), bins_.begin() + static_cast<std::ptrdiff_t>(gone));
      start_s_ += beyond * width_s_;
      return;
    }
  }
}

LiveEnvelopeFile::LiveEnvelopeFile(const std::filesystem::path& path, std::uint64_t campaign)
    : campaign_(campaign) {
  if (auto kept = ReadLiveEnvelopes(path, campaign)) {
    envelopes_ = std::move(*kept);
    envelopes_.taken = {};  // perhaps of another boot
  } else {
    std::error_code none;
    std::filesystem::remove(path, none);  // damaged, or of another campaign
  }
  try {
    file_.emplace(path);
  } catch (const daq::DataFileError&) {
    // A campaign does not end because nobody can look on.
  }
}

LiveEnvelopeFile::~LiveEnvelopeFile() {
  if (!is_written_) Write();
}

void LiveEnvelopeFile::Add(double time_s, const LiveExtremes& values) {
  if (values.empty()) return;
  envelopes_.recent.Add(time_s, values);
  envelopes_.whole.Add(time_s, values);
  is_written_ = false;
  if (Now().since_boot_ms - envelopes_.taken.since_boot_ms >= kEnvelopeInterval_ms) Write();
}

void LiveEnvelopeFile::Write() noexcept {
  if (!file_) return;
  envelopes_.taken = Now();
  const auto& [recent, whole, taken] = envelopes_;
  const EnvelopeHeader header{kEnvelopeVersion,
                              static_cast<std::int32_t>(recent.bins().size()),
                              static_cast<std::int32_t>(whole.bins().size()),
                              0,
                              recent.start_s(),
                              recent.width_s(),
                              whole.start_s(),
                              whole.width_s(),
                              campaign_,
                              taken.utc_ms,
                              taken.since_boot_ms,
                              taken.boot};
  std::array<std::byte, sizeof(EnvelopeHeader) + 2 * LiveEnvelopes::kBins * sizeof(Bin)> buffer;
  std::memcpy(buffer.data(), &header, sizeof header);
  const std::byte* const end = PutBins(PutBins(buffer.data() + sizeof header, recent), whole);
  try {
    file_->Write({buffer.data(), static_cast<std::size_t>(end - buffer.data())});
    is_written_ = true;
  } catch (const daq::DataFileError&) {
    file_.reset();
  }
}

std::optional<LiveEnvelopes> ReadLiveEnvelopes(const std::filesystem::path& path, std::uint64_t campaign) {
  using WhenFull = Envelope::WhenFull;
  constexpr auto kMost = static_cast<std::int32_t>(LiveEnvelopes::kBins);
  try {
    const auto newest = daq::ReadCheckpoint(path);
    EnvelopeHeader header{};
    if (!newest || newest->payload.size() < sizeof header) return std::nullopt;
    std::memcpy(&header, newest->payload.data(), sizeof header);
    const auto is_count = [](std::int32_t bins) { return bins >= 0 && bins <= kMost; };
    if (header.version != kEnvelopeVersion || header.campaign != campaign || !is_count(header.recent_bins) ||
        !is_count(header.whole_bins)) {
      return std::nullopt;
    }
    const auto bins = static_cast<std::size_t>(header.recent_bins + header.whole_bins);
    if (newest->payload.size() != sizeof header + bins * sizeof(Bin)) return std::nullopt;
    const std::byte* const recent = newest->payload.data() + sizeof header;
    const std::byte* const whole = recent + static_cast<std::size_t>(header.recent_bins) * sizeof(Bin);
    return LiveEnvelopes{Envelope(LiveEnvelopes::kBins, header.recent_width_s, WhenFull::kForgetOldest,
                                  header.recent_start_s, BinsAt(recent, header.recent_bins)),
                         Envelope(LiveEnvelopes::kBins, header.whole_width_s, WhenFull::kMergePairs,
                                  header.whole_start_s, BinsAt(whole, header.whole_bins)),
                         {header.utc_ms, header.since_boot_ms, header.boot}};
  } catch (const daq::DataFileError&) {
    return std::nullopt;
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

}  // namespace strainwave::bench
