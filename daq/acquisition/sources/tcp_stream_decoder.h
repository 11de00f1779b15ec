// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daq/acquisition/sample_source.h"

namespace strainwave::daq::acquisition {

/// What came out of the bytes of a TCP stream.
enum class TcpStreamEvent : std::uint8_t { kNeedsMore, kHello, kBlock, kKeepAlive, kEnd };

/// What was wrong so far. Nothing of it ends the stream.
struct TcpStreamDamage {
  std::uint64_t skipped_bytes{};  // that were no message
  std::uint64_t left_out{};       // messages
  std::string last;               // the last trouble in words
};

/// Parses the byte stream of `TCP_STREAM.md`; no sockets, no clocks. Any bytes may come, cut anywhere.
class TcpStreamDecoder {
 public:
  static constexpr std::size_t kHeader_bytes = 20;
  static constexpr std::size_t kMostPayload_bytes = std::size_t{4} << 20;
  static constexpr std::size_t kMostHello_bytes = std::size_t{1} << 20;
  static constexpr std::size_t kMostChannels = 1024;

  TcpStreamDecoder();

  /// Where the next bytes go; never empty once `Next` said kNeedsMore. `Received(n)` says how many came.
  std::span<std::byte> Room();
  void Received(std::size_t bytes) { end_ += bytes; }

  /// The next message. A block is written to `block`, but for its arrival; one without room for it is left
  /// out.
  TcpStreamEvent Next(SampleBlock& block);

  /// What the hello said; nothing before one.
  const std::optional<SourceDescription>& description() const { return description_; }
  const TcpStreamDamage& damage() const { return damage_; }
  /// The device's counter as the last keep-alive told it.
  std::uint64_t keep_alive_counter() const { return keep_alive_counter_; }

  /// Begins a new connection; damage goes on being counted.
  void Reset();

 private:
  std::span<const std::byte> Buffered() const { return std::span(buffer_).subspan(begin_, end_ - begin_); }
  bool FindHeader();
  std::optional<TcpStreamEvent> Take(std::uint8_t type, std::span<const std::byte> payload,
                                     SampleBlock& block);
  std::optional<TcpStreamEvent> TakeHello(std::span<const std::byte> payload);
  std::optional<TcpStreamEvent> TakeBlock(std::span<const std::byte> payload, SampleBlock& block);
  std::optional<TcpStreamEvent> LeaveOut(std::string why);

  std::vector<std::byte> buffer_;
  std::size_t begin_{};
  std::size_t end_{};
  std::optional<SourceDescription> description_;
  std::string refused_hello_;  // why; the reason of all that follows on its connection
  TcpStreamDamage damage_;
  std::uint64_t keep_alive_counter_{};
};

/// The JSON of a hello. @throws std::invalid_argument naming what is wrong.
SourceDescription SourceDescriptionFromJson(std::string_view json);

}  // namespace strainwave::daq::acquisition
