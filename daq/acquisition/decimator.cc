// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/decimator.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace strainwave::daq::acquisition {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLeastAttenuationDb = 21;
constexpr double kMostAttenuationDb = 140;
constexpr double kMarginDb = 2;  // by which Kaiser's fitted formulas may fall short

double KaiserBeta(double attenuation_db) {
  if (attenuation_db > 50) return 0.1102 * (attenuation_db - 8.7);
  return 0.5842 * std::pow(attenuation_db - 21, 0.4) + 0.07886 * (attenuation_db - 21);
}

}  // namespace

std::vector<double> DecimationTaps(const DecimatorSettings& settings) {
  if (settings.factor == 0) throw std::invalid_argument("factor = 0 is not above zero");
  if (!(settings.pass_band > 0 && settings.pass_band < 1)) {
    throw std::invalid_argument(fmt::format("pass_band = {} is not between 0 and 1", settings.pass_band));
  }
  if (!(settings.attenuation_db >= kLeastAttenuationDb && settings.attenuation_db <= kMostAttenuationDb)) {
    throw std::invalid_argument(fmt::format("attenuation_db = {} is not between {} and {}",
                                            settings.attenuation_db, kLeastAttenuationDb,
                                            kMostAttenuationDb));
  }
  if (settings.factor == 1) return {1.0};
  const double attenuation_db = settings.attenuation_db + kMarginDb;
  const double transition = 2 * kPi * (1 - settings.pass_band) / settings.factor;
  const double order = (attenuation_db - 7.95) / (2.285 * transition);
  const auto half = static_cast<std::ptrdiff_t>(std::ceil(order / 2));
  const double beta = KaiserBeta(attenuation_db);
  std::vector<double> taps;
  double sum = 0;
  for (std::ptrdiff_t k = -half; k <= half; ++k) {
    const double x = static_cast<double>(k) / settings.factor;
    const double sinc = k == 0 ? 1.0 : std::sin(kPi * x) / (kPi * x);
    const double place = static_cast<double>(k) / static_cast<double>(half);
    const double window = std::cyl_bessel_i(0.0, beta * std::sqrt(std::max(0.0, 1 - place * place)));
    taps.push_back(sinc * window);
    sum += taps.back();
  }
  for (double& tap : taps) tap /= sum;
  return taps;
}

Decimator::Decimator(const SourceDescription& source, const DecimatorSettings& settings)
    : source_(source), description_(source), factor_(settings.factor), taps_(DecimationTaps(settings)) {
  description_.name += fmt::format("/{}", factor_);
  description_.type = SampleType::kFloat32;
  description_.rate_hz /= factor_;
  description_.counter_bits = 64;
  description_.most_samples_a_block = source.most_samples_a_block / factor_ + 1;
  frames_.resize((taps_.size() + source.most_samples_a_block) * source.channels.size());
  sums_.resize(source.channels.size());
}

void Decimator::Filter(std::uint64_t centre, SampleBlock& out) {
  const std::size_t channels = sums_.size();
  const std::uint64_t first_kept = next_input_ - kept_;
  const double* frame =
      frames_.data() + static_cast<std::size_t>(centre - taps_.size() / 2 - first_kept) * channels;
  std::fill(sums_.begin(), sums_.end(), 0.0);
  for (const double tap : taps_) {
    for (std::size_t c = 0; c < channels; ++c) sums_[c] += tap * frame[c];
    frame += channels;
  }
  const std::size_t at = std::size_t{out.header.samples} * channels;
  ++out.header.samples;
  const std::span<std::uint32_t> words = out.words();
  for (std::size_t c = 0; c < channels; ++c) {
    words[at + c] = std::bit_cast<std::uint32_t>(static_cast<float>(sums_[c]));
  }
}

void Decimator::Decimate(const SampleBlock& block, SampleBlock& out) {
  const BlockHeader& header = block.header;
  const std::size_t channels = sums_.size();
  if (header.channels != channels) {
    throw std::invalid_argument(
        fmt::format("a block of {} channels, {} expected", header.channels, channels));
  }
  if (header.samples > source_.most_samples_a_block)
    throw std::length_error("the block is longer than the source said");
  out.header = header;
  out.header.type = SampleType::kFloat32;
  out.header.samples = 0;
  out.header.rate_hz = description_.rate_hz;
  out.header.flags &= ~static_cast<std::uint32_t>(kAfterGap);
  out.header.lost_before = 0;
  if (header.samples == 0) return;

  const std::uint64_t reach = taps_.size() / 2;
  if (!has_begun_ || header.first_sample != next_input_) {
    kept_ = 0;
    next_input_ = header.first_sample;
    // The first output whose taps all lie behind the gap; at the very start nothing is lost by it.
    const std::uint64_t first_whole = (header.first_sample + reach + factor_ - 1) / factor_;
    if (has_begun_) skipped_ += first_whole - next_output_;
    next_output_ = first_whole;
    has_begun_ = true;
  }
  // Only what an output to come can still reach is kept.
  const std::size_t spare = std::min(kept_, taps_.size() - 1);
  std::copy(frames_.begin() + static_cast<std::ptrdiff_t>((kept_ - spare) * channels),
            frames_.begin() + static_cast<std::ptrdiff_t>(kept_ * channels), frames_.begin());
  double* frame = frames_.data() + spare * channels;
  for (const std::uint32_t word : block.words()) *frame++ = SampleBlock::ValueOf(word, header.type);
  kept_ = spare + header.samples;
  next_input_ += header.samples;

  while (next_output_ * factor_ + reach < next_input_) {
    const std::uint64_t centre = next_output_ * factor_;
    if (out.header.samples == 0) {
      out.header.first_sample = out.header.device_counter = next_output_;
      const double later_samples = static_cast<double>(centre) - static_cast<double>(header.first_sample);
      out.header.device_time =
          header.device_time + std::chrono::nanoseconds(std::llround(later_samples * 1e9 / source_.rate_hz));
    }
    Filter(centre, out);
    ++next_output_;
  }
  if (out.header.samples == 0 || skipped_ == 0) return;
  out.header.lost_before = std::exchange(skipped_, 0);
  out.header.flags |= kAfterGap;
}

}  // namespace strainwave::daq::acquisition
