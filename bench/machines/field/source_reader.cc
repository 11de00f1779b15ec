// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/field/source_reader.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "bench/realtime/realtime.h"

namespace strainwave::bench {

using daq::acquisition::ChannelDescription;
using daq::acquisition::Decimator;
using daq::acquisition::DecimatorSettings;
using daq::acquisition::NextResult;
using daq::acquisition::SampleBlock;
using daq::acquisition::SampleSource;
using daq::acquisition::SourceDescription;
using daq::acquisition::SpscRing;
using daq::acquisition::TurnCounter;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

namespace {

constexpr milliseconds kPatience{20};
constexpr double kVibrationWindow_s = 0.1;
constexpr double kCaptureRoom_s = 4.0;

using Calibrations = std::map<std::string, daq::acquisition::Calibration>;

SourceDescription Started(SampleSource& source, const Calibrations& calibrations) {
  source.Start();
  SourceDescription description = source.description();
  for (ChannelDescription& channel : description.channels) {
    const auto given = calibrations.find(channel.name);
    if (given == calibrations.end()) continue;
    channel.calibration = given->second;
    channel.sensor_serial = given->second.sensor_serial;
  }
  if (description.channels.size() > SourceSnapshot::kMostChannels) {
    throw std::invalid_argument(fmt::format("{} has {} channels (must be at most {})", description.name,
                                            description.channels.size(), SourceSnapshot::kMostChannels));
  }
  return description;
}

SampleBlock RoomFor(const SourceDescription& description) {
  return SampleBlock(description.channels.size() * description.most_samples_a_block);
}

// An angle in whole counts, which has no ends.
bool GoesOver(const SourceDescription& source, const ChannelDescription& channel) {
  return source.type == daq::acquisition::SampleType::kInt32 &&
         (channel.unit == "deg" || channel.unit == "rad") && !channel.limits.saturation_low &&
         !channel.limits.saturation_high;
}

}  // namespace

// The ring between the reader's thread and the capturing one.
struct SourceReader::Capture {
  Capture(const SourceDescription& source, unsigned factor, std::vector<std::size_t> wanted)
      : channels(std::move(wanted)) {
    if (factor > 1) {
      DecimatorSettings settings;
      settings.factor = factor;
      decimator.emplace(source, settings);
    }
    const SourceDescription& out = decimator ? decimator->description() : source;
    const double blocks = kCaptureRoom_s * out.rate_hz / std::max(1U, source.most_samples_a_block / factor);
    lowered = std::make_unique<SampleBlock>(RoomFor(out));
    ring.emplace(static_cast<std::size_t>(blocks) + 2, *lowered);
  }

  std::vector<std::size_t> channels;
  std::optional<Decimator> decimator;
  std::unique_ptr<SampleBlock> lowered;
  std::optional<SpscRing<SampleBlock>> ring;
  bool begun{};
  std::atomic<std::uint64_t> lost{};
};

SourceReader::SourceReader(std::unique_ptr<SampleSource> source, const MonotonicClock& clock,
                           const Calibrations& calibrations)
    : source_(std::move(source)),
      clock_(clock),
      description_(Started(*source_, calibrations)),
      ledger_({.bits = description_.counter_bits}, description_.rate_hz),
      watch_(description_),
      device_clock_({}),
      window_(static_cast<std::size_t>(std::max(1.0, kVibrationWindow_s * description_.rate_hz))),
      around_trip_(description_, AroundTrip(description_)) {
  for (std::size_t i = 0; i < description_.channels.size(); ++i) {
    const ChannelDescription& channel = description_.channels[i];
    if (channel.unit == "m/s^2") accelerometers_.push_back(i);
    if (GoesOver(description_, channel)) turns_.try_emplace(i);
  }
  next_.bad_channels = description_.channels.size() == SourceSnapshot::kMostChannels
                           ? ~0U
                           : (1U << description_.channels.size()) - 1U;
  reasons_.resize(description_.channels.size());
  sums_.resize(accelerometers_.size());
  squares_.resize(accelerometers_.size());
  thread_ = std::thread([this] { Run(); });
}

SourceReader::~SourceReader() {
  ending_ = true;
  thread_.join();
  source_->Stop();
}

std::optional<std::size_t> SourceReader::Find(std::string_view channel) const {
  const auto found = std::ranges::find(description_.channels, channel, &ChannelDescription::name);
  if (found == description_.channels.end()) return std::nullopt;
  return static_cast<std::size_t>(found - description_.channels.begin());
}

void SourceReader::Run() {
  // Where it is refused, the control loop's own warning says so.
  (void)BecomeRealtime(RealtimeRank::kAcquisition);
  SampleBlock block = RoomFor(description_);
  std::string said;
  while (!ending_) {
    std::string trouble;
    try {
      switch (source_->Next(block, kPatience)) {
        case NextResult::kBlock:
          Record(block);
          Take(block);
          break;
        case NextResult::kNothingYet:
          watch_.Tick(std::chrono::steady_clock::now().time_since_epoch());
          trouble = said;
          break;
        case NextResult::kEnded:
          trouble = fmt::format("{} has come to its end", description_.name);
          std::this_thread::sleep_for(kPatience);
          break;
        case NextResult::kFailed:
          trouble = fmt::format("{}: {}", description_.name, source_->trouble());
          break;
      }
    } catch (const std::exception& error) {
      trouble = fmt::format("{}: {}", description_.name, error.what());
      std::this_thread::sleep_for(kPatience);
    }
    const std::uint32_t bad_before = next_.bad_channels;
    for (std::size_t i = 0; i < description_.channels.size(); ++i) {
      const bool good = watch_.fault(i) == daq::acquisition::SensorFault::kNone;
      const std::uint32_t bit = 1U << i;
      next_.bad_channels =
          good && next_.time.count() != 0 ? next_.bad_channels & ~bit : next_.bad_channels | bit;
    }
    FinishAroundTrip();
    if (trouble != said || next_.bad_channels != bad_before) Say(trouble);
    said = std::move(trouble);
    newest_.Set(next_);
    Publish();
  }
}

void SourceReader::Publish() noexcept {
  state_.Set({ledger_.totals(), device_clock_.estimate(), device_clock_.restarts()});
}

// The block as the device has sent it: what is lost or repeated is for the file to say.
void SourceReader::Record(const SampleBlock& block) {
  const std::lock_guard lock(mutex_);
  if (recorder_) (void)recorder_->Push(block);  // a full ring is counted
}

// When the last sample of a block was taken. A delivery is late at times, never early: what the clocks say is
// believed as far as it lies before the arrival, and not a network's whole patience before it.
nanoseconds SourceReader::FollowClock(const SampleBlock& block) noexcept {
  constexpr nanoseconds kLongestDelivery = milliseconds(50);
  const nanoseconds arrival = block.header.arrival;
  const double since_first_ns = 1e9 * (block.header.samples - 1) / description_.rate_hz;
  const nanoseconds device = block.header.device_time + nanoseconds(std::llround(since_first_ns));
  device_clock_.Add(device, arrival);
  if (!device_clock_.estimate()) return arrival;
  return std::clamp(device_clock_.estimate()->ToHost(device), arrival - kLongestDelivery, arrival);
}

void SourceReader::Take(SampleBlock& block) {
  ledger_.Admit(block);
  if (block.header.samples == 0) return;
  watch_.Judge(block);
  MeasureVibration(block);
  const std::size_t last = block.header.samples - 1;
  for (std::size_t i = 0; i < description_.channels.size(); ++i) {
    next_.values[i] = description_.channels[i].calibration.Apply(block.Value(last, i));
  }
  CountTurns(block);
  next_.block_s = static_cast<double>(block.header.samples) / description_.rate_hz;
  next_.time = clock_.FromKernel(block.header.arrival);
  next_.sampled = clock_.FromKernel(FollowClock(block));
  Keep(block);
  around_trip_.Take(block, [this](daq::acquisition::Capture around) { Deliver(std::move(around)); });
}

void SourceReader::CountTurns(const SampleBlock& block) {
  const std::lock_guard lock(mutex_);
  for (auto& [channel, turns] : turns_) {
    const auto sent = static_cast<std::int32_t>(block.Value(block.header.samples - 1, channel));
    next_.values[channel] =
        description_.channels[channel].calibration.Apply(static_cast<double>(turns.Follow(sent)));
  }
}

std::vector<std::int64_t> SourceReader::Turns() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::int64_t> counted;
  for (const auto& [channel, turns] : turns_) counted.push_back(turns.counted());
  return counted;
}

void SourceReader::GoOnFrom(std::span<const std::int64_t> turns) {
  const std::lock_guard lock(mutex_);
  if (turns.size() != turns_.size()) return;
  auto from = turns.begin();
  for (auto& [channel, counter] : turns_) counter = TurnCounter(*from++);
  since_ns_ = clock_.Now().count();
}

SourceSnapshot SourceReader::Newest() const noexcept {
  const SourceSnapshot newest = newest_.Get();
  return newest.time.count() > since_ns_ ? newest : SourceSnapshot{};
}

void SourceReader::MeasureVibration(const SampleBlock& block) noexcept {
  if (accelerometers_.empty()) return;
  for (std::uint32_t sample = 0; sample < block.header.samples; ++sample) {
    for (std::size_t i = 0; i < accelerometers_.size(); ++i) {
      const std::size_t channel = accelerometers_[i];
      const double value = description_.channels[channel].calibration.Apply(block.Value(sample, channel));
      sums_[i] += value;
      squares_[i] += value * value;
    }
    if (++in_window_ < window_) continue;
    double strongest = 0.0;
    const auto count = static_cast<double>(in_window_);
    for (std::size_t i = 0; i < accelerometers_.size(); ++i) {
      const double mean = sums_[i] / count;
      strongest = std::max(strongest, squares_[i] / count - mean * mean);
      sums_[i] = squares_[i] = 0.0;
    }
    next_.vibration_rms_m_per_s2 = std::sqrt(strongest);
    in_window_ = 0;
  }
}

void SourceReader::Keep(const SampleBlock& block) {
  std::shared_ptr<Capture> capture;
  {
    const std::lock_guard lock(mutex_);
    capture = capture_;
  }
  if (!capture) return;
  const SampleBlock* whole = &block;
  if (capture->decimator) {
    capture->decimator->Decimate(block, *capture->lowered);
    whole = capture->lowered.get();
    if (whole->header.samples == 0) return;
  }
  if (capture->begun) capture->lost += whole->header.lost_before;
  capture->begun = true;
  SampleBlock* const slot = capture->ring->BeginWrite();
  if (slot == nullptr) {
    capture->lost += whole->header.samples;
    return;
  }
  slot->CopyFrom(*whole);
  capture->ring->EndWrite();
}

void SourceReader::StartCapture(std::span<const std::size_t> channels, double rate_hz) {
  const double factor = std::round(description_.rate_hz / rate_hz);
  if (!(factor >= 1.0) || std::abs(description_.rate_hz / rate_hz - factor) > 1e-9 * factor) {
    throw std::invalid_argument(
        fmt::format("rate_hz = {} does not divide the {} Hz of {} (must be a whole part)", rate_hz,
                    description_.rate_hz, description_.name));
  }
  auto capture = std::make_shared<Capture>(description_, static_cast<unsigned>(factor),
                                           std::vector<std::size_t>(channels.begin(), channels.end()));
  drained_ = capture;
  const std::lock_guard lock(mutex_);
  capture_ = std::move(capture);
}

void SourceReader::StopCapture() {
  const std::lock_guard lock(mutex_);
  capture_.reset();
}

void SourceReader::Drain(std::span<std::vector<float>* const> channels) {
  if (!drained_) return;
  while (const SampleBlock* const block = drained_->ring->BeginRead()) {
    for (std::uint32_t sample = 0; sample < block->header.samples; ++sample) {
      for (std::size_t i = 0; i < channels.size() && i < drained_->channels.size(); ++i) {
        const std::size_t channel = drained_->channels[i];
        const double value = description_.channels[channel].calibration.Apply(block->Value(sample, channel));
        channels[i]->push_back(static_cast<float>(value));
      }
    }
    drained_->ring->EndRead();
  }
}

std::uint64_t SourceReader::lost_in_capture() const noexcept { return drained_ ? drained_->lost.load() : 0; }

void SourceReader::Say(const std::string& trouble) {
  const std::lock_guard lock(mutex_);
  trouble_ = trouble;
  for (std::size_t i = 0; i < reasons_.size(); ++i) reasons_[i] = watch_.ReasonOf(i);
}

std::string SourceReader::Trouble() const {
  const std::lock_guard lock(mutex_);
  std::string all = trouble_;
  for (const std::string& reason : reasons_) {
    if (!reason.empty()) all += (all.empty() ? "" : "; ") + reason;
  }
  return all;
}

std::string SourceReader::TroubleOf(std::size_t channel) const {
  const std::lock_guard lock(mutex_);
  const std::string& reason = reasons_[channel];
  return fmt::format("{}{}{}", reason, reason.empty() || trouble_.empty() ? "" : "; ", trouble_);
}

}  // namespace strainwave::bench
