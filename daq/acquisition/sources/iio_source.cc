// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/sources/iio_source.h"

#include <fmt/format.h>
#include <iio.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <system_error>
#include <utility>

#include "daq/acquisition/sources/iio_handles.h"
#include "daq/acquisition/sources/steady_now.h"
#include "daq/record.h"

namespace strainwave::daq::acquisition {
namespace {

constexpr std::uint64_t kMostSampleBits = 32;
constexpr std::chrono::milliseconds kLook{1};  // how often the ring is looked at while it is empty

[[noreturn]] void Throw(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

std::optional<double> NumberFrom(ssize_t (*read)(const iio_channel*, const char*, char*, std::size_t),
                                 const iio_channel* channel, const char* name) {
  std::array<char, 256> text{};
  if (read(channel, name, text.data(), text.size() - 1) <= 0) return std::nullopt;
  return NumberFromText(text.data());
}

// "accel_x" counts as m/s^2 once it is scaled; of other kinds the unit is libiio's own, which it does not
// tell.
std::string UnitOfKind(iio_chan_type kind) {
  switch (kind) {
    case IIO_ACCEL:
      return "m/s^2";
    case IIO_ANGL_VEL:
      return "rad/s";
    case IIO_VOLTAGE:
      return "mV";
    case IIO_CURRENT:
      return "mA";
    default:
      return "";
  }
}

// Of the device, or else of one of its channels.
std::optional<double> RateHz(const iio_device* device, const iio_channel* channel) {
  double rate_hz{};
  if (iio_device_attr_read_double(device, "sampling_frequency", &rate_hz) >= 0) return rate_hz;
  return NumberFrom(iio_channel_attr_read, channel, "sampling_frequency");
}

bool SameChannelNames(const SourceDescription& a, const SourceDescription& b) {
  return a.rate_hz == b.rate_hz &&
         std::ranges::equal(a.channels, b.channels, {}, &ChannelDescription::name, &ChannelDescription::name);
}

}  // namespace

struct IioSource::Device {
  IioContext context{nullptr, iio_context_destroy};
  iio_device* device{};
  std::vector<iio_channel*> channels;
  iio_channel* time_stamp{};
  std::unique_ptr<iio_buffer, decltype(&iio_buffer_destroy)> buffer{nullptr, iio_buffer_destroy};
};

IioSource::IioSource(IioSettings settings) : settings_(std::move(settings)) {}

IioSource::~IioSource() { Stop(); }

bool IioSource::has_time_stamps() const { return device_ && device_->time_stamp != nullptr; }

void IioSource::Start() {
  counter_ = 0;
  last_stamp_ns_ = 0;
  last_arrival_ = {};
  came_back_ = false;
  Open(nullptr);
}

void IioSource::Open(const SourceDescription* before) {
  Stop();
  last_attempt_ = std::chrono::steady_clock::now();
  device_ = std::make_unique<Device>();
  device_->context = OpenIioContext(settings_.uri);
  if (!device_->context) Throw(errno, fmt::format("no IIO context at '{}'", settings_.uri));
  device_->device = iio_context_find_device(device_->context.get(), settings_.device.c_str());
  if (device_->device == nullptr) {
    Throw(ENODEV, fmt::format("the IIO context '{}' has no device '{}'", settings_.uri, settings_.device));
  }
  Describe();
  if (before != nullptr && !SameChannelNames(*before, description_)) {
    Throw(EINVAL, fmt::format("'{}' came back with other channels or another rate", description_.name));
  }
  device_->buffer.reset(iio_device_create_buffer(device_->device, settings_.samples_a_block, false));
  if (!device_->buffer) Throw(errno, fmt::format("cannot make a buffer on '{}'", description_.name));
  const SampleBlock empty(description_.channels.size() * settings_.samples_a_block);
  ring_ = std::make_unique<SpscRing<SampleBlock>>(settings_.ring_blocks, empty);
  spare_ = std::make_unique<SampleBlock>(empty);
  ends_.store(false);
  has_failed_.store(false);
  failure_told_ = false;
  reader_ = std::thread([this] { Refill(); });
}

void IioSource::Describe() {
  description_ = {.name = fmt::format("iio:{}/{}", settings_.uri, settings_.device),
                  .source = settings_.source,
                  .type = SampleType::kInt32,
                  .most_samples_a_block = settings_.samples_a_block};
  std::vector<std::string> missing = settings_.channels;
  for (unsigned i = 0; i < iio_device_get_channels_count(device_->device); ++i) {
    iio_channel* const channel = iio_device_get_channel(device_->device, i);
    iio_channel_disable(channel);
    if (!IsScanned(channel)) continue;
    const std::string id = iio_channel_get_id(channel);
    if (IsIioTimeStamp(channel)) {
      device_->time_stamp = channel;
      iio_channel_enable(channel);
      continue;
    }
    const auto wanted = std::find(missing.begin(), missing.end(), id);
    if (wanted != missing.end())
      missing.erase(wanted);
    else if (!settings_.channels.empty())
      continue;
    const iio_data_format* const format = iio_channel_get_data_format(channel);
    if (format->bits > kMostSampleBits || format->repeat > 1) {
      Throw(EINVAL, fmt::format("channel '{}' of '{}' has {} bits {} times, at most {} once expected", id,
                                description_.name, format->bits, format->repeat, kMostSampleBits));
    }
    iio_channel_enable(channel);
    device_->channels.push_back(channel);
    const double scale = NumberFrom(iio_channel_attr_read, channel, "scale").value_or(1.0);
    const double offset = NumberFrom(iio_channel_attr_read, channel, "offset").value_or(0.0);
    ChannelDescription description{.name = id, .unit = UnitOfKind(iio_channel_get_type(channel))};
    if (scale != 0) description.calibration = {.id = "driver", .sensitivity = 1 / scale, .zero = -offset};
    const double ends = std::ldexp(1.0, static_cast<int>(format->bits) - (format->is_signed ? 1 : 0));
    description.limits.saturation_high = ends - 1;
    description.limits.saturation_low = format->is_signed ? -ends : 0;
    description_.channels.push_back(std::move(description));
  }
  if (!missing.empty())
    Throw(ENODEV, fmt::format("'{}' has no channel '{}' to scan", description_.name, missing.front()));
  if (description_.channels.empty())
    Throw(ENODEV, fmt::format("'{}' has no channel to scan", description_.name));
  description_.rate_hz = RateHz(device_->device, device_->channels.front()).value_or(0);
  if (!(description_.rate_hz > 0))
    Throw(EINVAL, fmt::format("'{}' does not say its sampling_frequency", description_.name));
  // The kernel's own choice is the date, and a date that is set would look like lost samples. A kernel that
  // has no choice, or that does not let us choose, keeps its own.
  iio_device_attr_write(device_->device, "current_timestamp_clock", "monotonic");
}

void IioSource::Stop() noexcept {
  ends_.store(true);
  // Wakes a refill that waits; from then on the buffer gives nothing.
  if (device_ && device_->buffer) iio_buffer_cancel(device_->buffer.get());
  if (reader_.joinable()) reader_.join();
  device_.reset();
}

void IioSource::Fail(std::string why) {
  const std::scoped_lock lock(trouble_mutex_);
  trouble_ = std::move(why);
  has_failed_.store(true, std::memory_order_release);
}

std::string IioSource::trouble() const {
  const std::scoped_lock lock(trouble_mutex_);
  return trouble_;
}

void IioSource::Refill() noexcept {
  while (!ends_.load()) {
    const ssize_t bytes = iio_buffer_refill(device_->buffer.get());
    if (ends_.load()) return;
    if (bytes < 0) {
      // A slow sensor; or one that is unplugged, which a buffer of the kernel does not tell.
      const bool waits = bytes == -ETIMEDOUT || bytes == -EAGAIN;
      if (waits && RateHz(device_->device, device_->channels.front())) continue;
      Fail(fmt::format("{}: {}", description_.name,
                       std::generic_category().message(waits ? ENODEV : static_cast<int>(-bytes))));
      return;
    }
    SampleBlock* const slot = ring_->BeginWrite();
    Convert(slot == nullptr ? *spare_ : *slot);
    if (slot != nullptr) ring_->EndWrite();
  }
}

void IioSource::Convert(SampleBlock& block) {
  iio_buffer* const buffer = device_->buffer.get();
  const std::ptrdiff_t step = iio_buffer_step(buffer);
  const auto* const end = static_cast<const char*>(iio_buffer_end(buffer));
  const auto* const begin = static_cast<const char*>(iio_buffer_start(buffer));
  const auto samples = static_cast<std::uint32_t>(
      std::min<std::ptrdiff_t>(step > 0 ? (end - begin) / step : 0, settings_.samples_a_block));
  block.header = {.source = settings_.source,
                  .channels = static_cast<std::uint32_t>(device_->channels.size()),
                  .samples = samples,
                  .type = SampleType::kInt32,
                  .device_counter = counter_,
                  .arrival = SteadyNow(),
                  .rate_hz = description_.rate_hz};
  const std::span<std::uint32_t> words = block.words();
  for (std::size_t c = 0; c < device_->channels.size(); ++c) {
    const auto* raw = static_cast<const char*>(iio_buffer_first(buffer, device_->channels[c]));
    const bool is_signed = iio_channel_get_data_format(device_->channels[c])->is_signed;
    const std::size_t width = iio_channel_get_data_format(device_->channels[c])->length / 8;
    for (std::uint32_t i = 0; i < samples; ++i, raw += step) {
      // libiio takes byte order, shift and sign into account and fills the width that the channel has in the
      // buffer.
      std::array<std::byte, 8> converted{};
      iio_channel_convert(device_->channels[c], converted.data(), raw);
      std::uint64_t bits{};
      std::memcpy(&bits, converted.data(), converted.size());
      if (is_signed && width < 4) {
        const auto unused = static_cast<unsigned>(64 - 8 * width);
        bits = static_cast<std::uint64_t>(static_cast<std::int64_t>(bits << unused) >> unused);
      }
      words[std::size_t{i} * block.header.channels + c] = static_cast<std::uint32_t>(bits);
    }
  }
  if (samples == 0) return;
  if (device_->time_stamp != nullptr) {
    std::int64_t stamp_ns{};
    iio_channel_convert(device_->time_stamp, &stamp_ns, iio_buffer_first(buffer, device_->time_stamp));
    block.header.device_time = std::chrono::nanoseconds(stamp_ns);
  }
  counter_ += LostBefore(block.header);
  block.header.device_counter = counter_;
  counter_ += samples;
  came_back_ = false;
  last_stamp_ns_ = block.header.device_time.count();
  last_arrival_ = block.header.arrival;
}

std::uint64_t IioSource::LostBefore(const BlockHeader& header) const {
  // First sample to first sample by the stamps, last to last by the arrivals.
  const auto samples_in = [this](std::chrono::nanoseconds time) {
    return std::chrono::duration<double>(time).count() * description_.rate_hz;
  };
  const double stamped = samples_in(header.device_time - std::chrono::nanoseconds(last_stamp_ns_));
  if (last_stamp_ns_ != 0 && stamped > 0) {
    const double lost = std::round(stamped - settings_.samples_a_block);
    return lost > 0.5 * settings_.samples_a_block ? static_cast<std::uint64_t>(lost) : 0;
  }
  if (!came_back_) return 0;
  // Nobody knows how many they were; that there were some must show.
  const double waited = std::round(samples_in(header.arrival - last_arrival_) - header.samples);
  return static_cast<std::uint64_t>(std::max(1.0, waited));
}

void IioSource::Recover(std::chrono::nanoseconds patience) {
  const auto due = last_attempt_ + settings_.between_attempts;
  const auto now = std::chrono::steady_clock::now();
  if (due > now + patience) {
    std::this_thread::sleep_for(patience);
    return;
  }
  std::this_thread::sleep_until(due);
  const SourceDescription before = description_;
  try {
    came_back_ = true;  // before the reader starts
    Open(&before);
  } catch (const std::system_error& error) {
    Stop();
    description_ = before;
    Fail(error.what());
    failure_told_ = true;
  }
}

NextResult IioSource::Next(SampleBlock& block, std::chrono::nanoseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (true) {
    if (const SampleBlock* const slot = ring_->BeginRead()) {
      block.CopyFrom(*slot);
      ring_->EndRead();
      return NextResult::kBlock;
    }
    if (has_failed_.load(std::memory_order_acquire)) {
      if (!std::exchange(failure_told_, true)) return NextResult::kFailed;
      Recover(deadline - std::chrono::steady_clock::now());
      if (has_failed_.load(std::memory_order_acquire)) return NextResult::kNothingYet;
    }
    if (std::chrono::steady_clock::now() >= deadline) return NextResult::kNothingYet;
    std::this_thread::sleep_for(kLook);
  }
}

}  // namespace strainwave::daq::acquisition
