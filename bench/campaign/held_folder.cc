// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/held_folder.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <fmt/core.h>

#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

std::filesystem::path PathOf(const daq::FileDescriptor& held) {
  return fmt::format("/proc/self/fd/{}", held.get());
}

/// Whether `path` still leads to what is held.
bool InPlace(const std::filesystem::path& path, const daq::FileDescriptor& held) {
  struct stat own {};
  struct stat there {};
  if (::fstat(held.get(), &own) != 0) throw std::system_error(errno, std::generic_category(), path.string());
  return ::stat(path.c_str(), &there) == 0 && own.st_dev == there.st_dev && own.st_ino == there.st_ino;
}

// Short beside the second between two beats of a bench in real time, so that each of those looks.
constexpr std::chrono::milliseconds kWatchInterval{50};

}  // namespace

HeldFolder::HeldFolder(const CampaignFolder& folder) : folder_(folder) {
  for (const auto& path : {folder.root, folder.Cycles(), folder.Unfinished()}) {
    daq::FileDescriptor held(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!held.is_open()) throw std::system_error(errno, std::generic_category(), path.string());
    held_.emplace_back(path, std::move(held));
  }
}

CampaignFolder HeldFolder::wherever() const { return {PathOf(held_.front().second)}; }

void HeldFolder::WatchInPlace() {
  const auto now = std::chrono::steady_clock::now();
  if (now - watched_at_ < kWatchInterval) return;
  watched_at_ = now;
  DemandInPlace();
}

void HeldFolder::DemandInPlace() const {
  const auto away = [](const auto& entry) { return !InPlace(entry.first, entry.second); };
  const auto found = std::ranges::find_if(held_, away);
  if (found == held_.end()) return;
  // What it lies in may have gone after it was looked at: the outermost is told.
  const auto first = std::ranges::find_if(held_.begin(), found, away);
  const auto& [path, held] = *first;
  std::error_code none;
  throw BenchError(
      ExitCode::kMachineFailed,
      fmt::format(
          "{}: error: {} (expected the folder that this run began with, which is now {})", path.string(),
          std::filesystem::exists(path, none) ? "another folder has come in its place" : "the folder is gone",
          std::filesystem::read_symlink(PathOf(held), none).string()));
}

}  // namespace strainwave::bench
