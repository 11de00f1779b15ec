// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "bench/roles/bench_clock.h"
#include "bench/roles/can_bus.h"
#include "protocols/candump.h"

namespace strainwave::bench {

struct CandumpLogSettings {
  std::filesystem::path folder;  // made where it is not there
  std::string interface;         // as the log names it: "can0"
  std::uint64_t most_file_bytes{16'000'000};
  std::size_t most_files{4};  // of this interface in the folder, older runs included; the oldest go
};

/// The files of a log as `candump -l` writes them, the next one begun when one is full. May be called from
/// several threads.
class CandumpFiles {
 public:
  explicit CandumpFiles(CandumpLogSettings settings);

  /// False when it could not be written; from then on nothing is.
  bool Write(const protocols::LoggedFrame& logged);
  void Flush();
  /// Sees to it that the file under way and the one before it stay, as STEM.INTERFACE.log and
  /// STEM.INTERFACE.before.log; what is written to the file under way from now on is in there, too.
  void Keep(const std::filesystem::path& stem);
  /// Why nothing is written any more, in words; empty while it is.
  std::string trouble() const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  bool Begin(std::chrono::microseconds time);
  bool Fail(const std::string& what);
  void RemoveOldest();

  CandumpLogSettings settings_;
  mutable std::mutex mutex_;
  std::unique_ptr<std::FILE, Close> file_;
  std::deque<std::filesystem::path> names_;  // of this run, the newest last
  std::uint64_t bytes_{};
  int number_{};
  std::string trouble_;
};

/// Writes down what goes over a CAN bus, from a listener of its own on a thread of its own: whoever drives is
/// not held up by it. Frames wait in the listener's queue (in-process: bounded; SocketCAN: the kernel's);
/// what did not fit there is counted.
class CandumpLog {
 public:
  /// @param listener  used by the log alone; both outlive it.
  /// @throws std::system_error if the folder cannot be made.
  CandumpLog(CanBus& listener, const BenchClock& clock, const CandumpLogSettings& settings);
  CandumpLog(const CandumpLog&) = delete;
  CandumpLog& operator=(const CandumpLog&) = delete;
  /// What has come in until then is written.
  ~CandumpLog();

  void Keep(const std::filesystem::path& stem) { files_.Keep(stem); }
  std::uint64_t frames() const noexcept { return frames_; }
  /// Frames of the bus that are missing in the log.
  std::uint64_t lost() const noexcept { return lost_; }
  std::string trouble() const { return files_.trouble(); }
  const std::string& interface() const noexcept { return interface_; }

 private:
  void Run();
  void Drain();

  CanBus& listener_;
  std::string interface_;
  std::chrono::nanoseconds utc_of_zero_;  // of the bench's clock, as the log began; it is never set after
  CandumpFiles files_;
  std::uint64_t lost_before_{};
  std::uint64_t unwritten_{};
  std::atomic<std::uint64_t> frames_{};
  std::atomic<std::uint64_t> lost_{};
  std::atomic<bool> ending_{};
  std::thread thread_;
};

}  // namespace strainwave::bench
