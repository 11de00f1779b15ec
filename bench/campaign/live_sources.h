// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/campaign/pause.h"
#include "bench/roles/sample_sources.h"
#include "daq/checkpoint_file.h"

namespace strainwave::bench {

/// What came of one source of samples since the run began.
struct SourceCounts {
  std::string name;
  daq::acquisition::GapTotals samples;
  std::uint64_t clock_restarts{};
  std::string trouble;                // in words, while it lasts
  std::int64_t last_sample_utc_ms{};  // when samples were last seen to come; 0: never
  std::int64_t last_loss_utc_ms{};    // when some were last seen to be lost; 0: never

  bool operator==(const SourceCounts&) const = default;
};

/// The same as one look after another finds it; time is an argument.
class SourceWatch {
 public:
  void Look(std::span<const SourceTotals> sources, std::int64_t utc_ms);
  const std::vector<SourceCounts>& sources() const { return sources_; }

 private:
  std::vector<SourceCounts> sources_;
};

struct LiveSources {
  std::int64_t since_utc_ms{};  // the counts begin then
  Moment taken{};
  std::vector<SourceCounts> sources;
};

/// Shows them to other processes, and to later ones what they were at the end. A write is one system call in
/// place, at most once a second of the world's. A bench without sources makes no file.
class LiveSourcesFile {
 public:
  explicit LiveSourcesFile(std::filesystem::path path) : path_(std::move(path)) {}
  LiveSourcesFile(const LiveSourcesFile&) = delete;
  LiveSourcesFile& operator=(const LiveSourcesFile&) = delete;

  void Show(std::span<const SourceTotals> sources, const Moment& now);

 private:
  const std::filesystem::path path_;
  std::optional<daq::CheckpointFile> file_;
  bool failed_{};  // it cannot be made or written, and nobody sees anything
  Moment begun_{};
  Moment written_{};
  SourceWatch watch_;
};

/// Nothing where there is no such file, or none that can be read.
std::optional<LiveSources> ReadLiveSources(const std::filesystem::path& path);

}  // namespace strainwave::bench
