// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "daq/acquisition/sample_source.h"
#include "daq/acquisition/sources/tcp_stream_decoder.h"
#include "daq/file_descriptor.h"

namespace strainwave::daq::acquisition {

struct TcpStreamSettings {
  std::string host{};
  std::uint16_t port{};
  std::uint32_t source{};
  std::chrono::milliseconds hello_within{3000};  // of the start
  std::chrono::milliseconds silent_after{3000};  // no message for so long: the connection is dead
  std::chrono::milliseconds between_connections{1000};
};

/// Samples from a front end that speaks `TCP_STREAM.md`. A connection that breaks is made anew from within
/// `Next`, which says kFailed once and kNothingYet until it stands again; the counters of the blocks tell
/// what was lost meanwhile.
class TcpStreamSource : public SampleSource {
 public:
  explicit TcpStreamSource(TcpStreamSettings settings) : settings_(std::move(settings)) {}

  /// @throws std::system_error if nobody answers or no hello comes; `what()` says which.
  void Start() override;
  void Stop() noexcept override;
  NextResult Next(SampleBlock& block, std::chrono::nanoseconds patience) override;
  const SourceDescription& description() const override { return description_; }
  std::string trouble() const override { return trouble_; }

  const TcpStreamDamage& damage() const { return decoder_.damage(); }
  std::uint64_t connections() const { return connections_; }

 private:
  enum class Read : std::uint8_t { kSome, kNothing, kClosed };
  void Connect(std::chrono::nanoseconds patience);
  Read ReadSome(std::chrono::nanoseconds patience);
  NextResult Lose(std::string why);
  bool Reconnect(std::chrono::nanoseconds patience);

  TcpStreamSettings settings_;
  SourceDescription description_;
  TcpStreamDecoder decoder_;
  FileDescriptor socket_{-1};
  bool has_ended_{};
  std::chrono::nanoseconds last_message_{};
  std::chrono::nanoseconds last_attempt_{};
  std::uint64_t connections_{};
  std::string trouble_;
};

}  // namespace strainwave::daq::acquisition
