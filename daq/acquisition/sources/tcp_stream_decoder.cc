// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/sources/tcp_stream_decoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "daq/crc32.h"

namespace strainwave::daq::acquisition {
namespace {

constexpr std::array kMagic{std::byte{'S'}, std::byte{'W'}, std::byte{'S'}, std::byte{'1'}};
constexpr std::uint8_t kVersion = 1;
constexpr std::size_t kHeaderCrcAt = 12;
constexpr std::size_t kPayloadCrcAt = 16;
constexpr std::size_t kBlockHead_bytes = 24;
constexpr std::size_t kKeepAlive_bytes = 16;
constexpr std::uint32_t kLostInDevice = 1;

enum class MessageType : std::uint8_t { kHello = 1, kBlock = 2, kKeepAlive = 3, kEnd = 4 };

template <typename Number>
Number LittleEndian(std::span<const std::byte> bytes, std::size_t at) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    number |= std::to_integer<std::uint64_t>(bytes[at + i]) << (8 * i);
  }
  return static_cast<Number>(number);
}

// Up to a magic, or to what may become one with the next bytes.
std::size_t BytesBeforeMagic(std::span<const std::byte> bytes) {
  auto at = bytes.begin();
  while ((at = std::find(at, bytes.end(), kMagic[0])) != bytes.end()) {
    const auto there = std::min(bytes.end() - at, static_cast<std::ptrdiff_t>(kMagic.size()));
    if (std::equal(at, at + there, kMagic.begin())) break;
    ++at;
  }
  return static_cast<std::size_t>(at - bytes.begin());
}

}  // namespace

TcpStreamDecoder::TcpStreamDecoder() : buffer_(kHeader_bytes + kMostPayload_bytes) {}

void TcpStreamDecoder::Reset() {
  begin_ = end_ = 0;
  description_.reset();
  refused_hello_.clear();
}

std::span<std::byte> TcpStreamDecoder::Room() {
  // Bytes move to the front only when the room behind them gets short.
  if (begin_ > 0 && buffer_.size() - end_ < buffer_.size() / 4) {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
              buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= begin_;
    begin_ = 0;
  }
  return std::span(buffer_).subspan(end_);
}

// Skips to a header that its CRC confirms. False if there is none yet.
bool TcpStreamDecoder::FindHeader() {
  while (true) {
    if (const std::size_t skipped = BytesBeforeMagic(Buffered()); skipped > 0) {
      begin_ += skipped;
      damage_.skipped_bytes += skipped;
      damage_.last = "bytes that are no message";
    }
    const std::span<const std::byte> header = Buffered();
    if (header.size() < kHeader_bytes) return false;
    if (LittleEndian<std::uint32_t>(header, kHeaderCrcAt) == Crc32(header.first(kHeaderCrcAt))) return true;
    begin_ += 1;
    damage_.skipped_bytes += 1;
    damage_.last = "a header with a wrong CRC";
  }
}

TcpStreamEvent TcpStreamDecoder::Next(SampleBlock& block) {
  while (FindHeader()) {
    const std::span<const std::byte> bytes = Buffered();
    const auto type = std::to_integer<std::uint8_t>(bytes[4]);
    const auto version = std::to_integer<std::uint8_t>(bytes[5]);
    const auto length = LittleEndian<std::uint32_t>(bytes, 8);
    if (length > kMostPayload_bytes) {
      LeaveOut(fmt::format("a message of {} bytes, more than {}", length, kMostPayload_bytes));
      begin_ += kHeader_bytes;
      continue;
    }
    if (bytes.size() < kHeader_bytes + length) return TcpStreamEvent::kNeedsMore;
    begin_ += kHeader_bytes + length;
    const std::span<const std::byte> payload = bytes.subspan(kHeader_bytes, length);
    if (LittleEndian<std::uint32_t>(bytes, kPayloadCrcAt) != Crc32(payload)) {
      LeaveOut(fmt::format("a message of {} bytes with a wrong CRC", length));
    } else if (version != kVersion) {
      LeaveOut(fmt::format("a message of version {}, {} expected", version, kVersion));
    } else if (const std::optional<TcpStreamEvent> event = Take(type, payload, block)) {
      return *event;
    }
  }
  return TcpStreamEvent::kNeedsMore;
}

std::optional<TcpStreamEvent> TcpStreamDecoder::LeaveOut(std::string why) {
  ++damage_.left_out;
  damage_.last = std::move(why);
  return std::nullopt;
}

std::optional<TcpStreamEvent> TcpStreamDecoder::Take(std::uint8_t type, std::span<const std::byte> payload,
                                                     SampleBlock& block) {
  switch (static_cast<MessageType>(type)) {
    case MessageType::kHello:
      return TakeHello(payload);
    case MessageType::kBlock:
      return TakeBlock(payload, block);
    case MessageType::kKeepAlive:
      if (payload.size() != kKeepAlive_bytes) {
        return LeaveOut(
            fmt::format("a keep-alive of {} bytes, {} expected", payload.size(), kKeepAlive_bytes));
      }
      keep_alive_counter_ = LittleEndian<std::uint64_t>(payload, 0);
      return TcpStreamEvent::kKeepAlive;
    case MessageType::kEnd:
      return TcpStreamEvent::kEnd;
  }
  return LeaveOut(fmt::format("a message of type {}, which is unknown", type));
}

std::optional<TcpStreamEvent> TcpStreamDecoder::TakeHello(std::span<const std::byte> payload) {
  if (description_) return LeaveOut("a second hello");
  if (payload.size() > kMostHello_bytes) {
    return LeaveOut(fmt::format("a hello of {} bytes, more than {}", payload.size(), kMostHello_bytes));
  }
  try {
    description_ = SourceDescriptionFromJson({reinterpret_cast<const char*>(payload.data()), payload.size()});
  } catch (const std::invalid_argument& error) {
    refused_hello_ = fmt::format("hello: {}", error.what());
    return LeaveOut(refused_hello_);
  }
  return TcpStreamEvent::kHello;
}

std::optional<TcpStreamEvent> TcpStreamDecoder::TakeBlock(std::span<const std::byte> payload,
                                                          SampleBlock& block) {
  if (!description_) return LeaveOut(refused_hello_.empty() ? "a block before the hello" : refused_hello_);
  if (payload.size() < kBlockHead_bytes) return LeaveOut(fmt::format("a block of {} bytes", payload.size()));
  const auto samples = LittleEndian<std::uint32_t>(payload, 16);
  if (samples == 0 || samples > description_->most_samples_a_block) {
    return LeaveOut(
        fmt::format("a block of {} samples, 1 to {} expected", samples, description_->most_samples_a_block));
  }
  const std::size_t values = std::size_t{samples} * description_->channels.size();
  if (payload.size() != kBlockHead_bytes + 4 * values) {
    return LeaveOut(fmt::format("a block of {} samples in {} bytes, {} expected", samples, payload.size(),
                                kBlockHead_bytes + 4 * values));
  }
  if (values > block.capacity())
    return LeaveOut(fmt::format("a block of {} values without room for it", values));
  block.header = {.source = description_->source,
                  .channels = static_cast<std::uint32_t>(description_->channels.size()),
                  .samples = samples,
                  .type = description_->type,
                  .device_counter = LittleEndian<std::uint64_t>(payload, 0),
                  .device_time = std::chrono::nanoseconds(LittleEndian<std::int64_t>(payload, 8)),
                  .rate_hz = description_->rate_hz};
  if ((LittleEndian<std::uint32_t>(payload, 20) & kLostInDevice) != 0) block.header.flags |= kDeviceOverrun;
  const std::span<std::uint32_t> words = block.words();
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = LittleEndian<std::uint32_t>(payload, kBlockHead_bytes + 4 * i);
  }
  return TcpStreamEvent::kBlock;
}

}  // namespace strainwave::daq::acquisition
