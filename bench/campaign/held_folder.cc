// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/held_folder.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <system_error>

#include <fmt/core.h>

#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

std::filesystem::path PathOf(const daq::FileDescriptor& held) {
  return fmt::format("/proc/self/fd/{}", held.get());
}

}  // namespace

HeldFolder::HeldFolder(const CampaignFolder& folder) : folder_(folder) {
  for (const auto& path : {folder.root, folder.Cycles(), folder.Unfinished()}) {
    daq::FileDescriptor held(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!held.is_open()) throw std::system_error(errno, std::generic_category(), path.string());
    held_.emplace_back(path, std::move(held));
  }
}

CampaignFolder HeldFolder::wherever() const { return {PathOf(held_.front().second)}; }

void HeldFolder::DemandInPlace() const {
  for (const auto& [path, held] : held_) {
    struct stat own {};
    struct stat there {};
    if (::fstat(held.get(), &own) != 0)
      throw std::system_error(errno, std::generic_category(), path.string());
    const bool exists = ::stat(path.c_str(), &there) == 0;
    if (exists && own.st_dev == there.st_dev && own.st_ino == there.st_ino) continue;
    std::error_code none;
    throw BenchError(
        ExitCode::kMachineFailed,
        fmt::format("{}: error: {} (expected the folder that this run began with, which is now {})",
                    path.string(), exists ? "another folder has come in its place" : "the folder is gone",
                    std::filesystem::read_symlink(PathOf(held), none).string()));
  }
}

}  // namespace strainwave::bench
