// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>

#include "bench/devices/wake.h"
#include "daq/acquisition/sample_source.h"
#include "daq/acquisition/spsc_ring.h"
#include "daq/file_descriptor.h"

namespace strainwave::bench {

/// A front end that sends its samples over TCP (daq/acquisition/TCP_STREAM.md) to whoever connects, one at a
/// time. It counts on while nobody listens, as a device does.
class StreamServer {
 public:
  /// Listens on `address`; port 0 is any free one. @throws std::system_error when it cannot.
  StreamServer(daq::acquisition::SourceDescription description, const std::string& address, int port);
  StreamServer(const StreamServer&) = delete;
  StreamServer& operator=(const StreamServer&) = delete;
  ~StreamServer();

  int port() const noexcept { return port_; }
  const daq::acquisition::SourceDescription& description() const noexcept { return description_; }

  /// From one thread, never waits: the next samples, with counter and device time. What the network is too
  /// slow for is lost, and shows by the counter.
  void Push(const daq::acquisition::SampleBlock& block) noexcept;

  /// From any thread: the next `samples` are lost, in whole blocks.
  void Drop(std::uint64_t samples) noexcept { to_drop_ += samples; }
  /// Samples that were dropped so far, on command or for want of room, while somebody was connected.
  std::uint64_t dropped() const noexcept { return dropped_; }
  /// Neither samples nor signs of life until it is taken back.
  void FallSilent(bool silent) noexcept { silent_ = silent; }

 private:
  void Run();
  void Serve(int connection);
  bool SendAll(int connection, std::span<const std::byte> bytes);

  daq::acquisition::SourceDescription description_;
  daq::acquisition::SpscRing<daq::acquisition::SampleBlock> ring_;
  daq::FileDescriptor listener_;
  int port_{};
  Wake wake_;
  std::atomic<bool> ending_{};
  std::atomic<bool> connected_{};
  std::atomic<bool> silent_{};
  std::atomic<std::uint64_t> to_drop_{};
  std::atomic<std::uint64_t> dropped_{};
  std::thread thread_;
};

}  // namespace strainwave::bench
