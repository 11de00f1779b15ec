// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "daq/file_descriptor.h"

namespace strainwave::daq {

struct ProcessLimits {
  std::size_t memory_bytes{};        // beyond what this process has
  std::chrono::seconds processor{};  // time of the processor
  std::chrono::seconds silence{};    // longest wait for its next byte: a disk that hangs
};

/// Work that may crash, hang or take all memory, in a process of its own: a fork of this one, which may do
/// what it likes but write files, start programs that outlive this one, or print. Its bytes come back through
/// a pipe. No other thread may be within a library that the work uses.
class LimitedProcess {
 public:
  /// `work` is given the end of the pipe to write to; what it throws is a failure without words.
  /// @throws std::system_error if the machine has no process or pipe left.
  LimitedProcess(const ProcessLimits& limits, const std::function<void(int pipe)>& work);
  LimitedProcess(const LimitedProcess&) = delete;
  LimitedProcess& operator=(const LimitedProcess&) = delete;
  /// Ends it at once if it still runs.
  ~LimitedProcess();

  /// Waits for the next bytes, some or as many as fit; 0 when there are no more.
  std::size_t Read(std::span<std::byte> bytes);

  /// Waits for its end. Empty where it ended well; else what it did in words: "crashed (Segmentation fault)",
  /// "took more than 10 s", "needed more than 512 MiB of memory", "failed".
  std::string End();

 private:
  void Kill() noexcept;

  ProcessLimits limits_;
  FileDescriptor pipe_{-1};
  pid_t child_{-1};
  bool was_silent_{};
};

/// All of `bytes`; for the work. @throws std::system_error.
void WriteToPipe(int pipe, std::span<const std::byte> bytes);

}  // namespace strainwave::daq
