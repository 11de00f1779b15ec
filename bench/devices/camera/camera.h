// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <variant>
#include <vector>

#include "bench/devices/wake.h"
#include "bench/roles/bench_clock.h"

namespace strainwave::bench {

struct CameraSettings {
  /// Number of a camera of this machine, or a video file or numbered pictures ("frame_%03d.png").
  std::variant<int, std::string> source;
  std::chrono::nanoseconds patience{std::chrono::seconds(2)};  // a later picture is told to be late
};

/// What became of one request.
struct Snapshot {
  std::filesystem::path file;
  std::chrono::nanoseconds asked{}, taken{};
  bool late{};
  std::string trouble;  // why there is no picture; empty: it is there
};

/// Pictures on request, each written whole or not at all, as JPEG or PNG by the name of its file. Everything
/// that may take long is done by a thread of its own; of requests only one waits, and a further one is
/// refused.
class Camera {
 public:
  static constexpr std::size_t kLongestPath = 400;

  /// Opens nothing yet. @param clock  outlives the camera.
  Camera(CameraSettings settings, const BenchClock& clock);
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;
  /// Waits for a picture that is being taken, as long as its driver takes.
  ~Camera();

  /// From one thread, which never waits; nothing is allocated. False, and the request is counted as refused,
  /// while another one waits, or for a path that is too long.
  bool Ask(std::string_view file) noexcept;
  std::uint64_t refused() const noexcept { return refused_; }

  /// What became of requests since the last call. Not for the control thread.
  std::vector<Snapshot> TakeSnapshots();

 private:
  void Run();

  const CameraSettings settings_;
  const BenchClock& clock_;
  Wake wake_;
  std::array<char, kLongestPath> path_{};  // of the request that waits
  std::size_t path_length_{};
  std::chrono::nanoseconds asked_{};
  std::atomic<bool> waiting_{false};
  std::atomic<std::uint64_t> refused_{0};
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::vector<Snapshot> done_;
  std::thread thread_;
};

}  // namespace strainwave::bench
