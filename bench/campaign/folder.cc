// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <ctime>
#include <fstream>
#include <memory>
#include <sstream>
#include <system_error>

#include <fmt/core.h>

#include "bench/configuration/commissioning_file.h"
#include "bench/errors/bench_error.h"
#include "daq/file_descriptor.h"
#include "daq/synced_folder.h"

namespace strainwave::bench {
namespace {

[[noreturn]] void ThrowErrno(const std::filesystem::path& file) {
  throw std::system_error(errno, std::generic_category(), file.string());
}

}  // namespace

std::filesystem::path CampaignFolder::CycleFile(int cycle) const {
  return Cycles() / fmt::format("{:06d}.h5", cycle);
}

std::filesystem::path CampaignFolder::UnfinishedFile(int cycle, int step, int repeat, int attempt) const {
  return Unfinished() / fmt::format("{:06d}-{:03d}-{:02d}-{:03d}.h5", cycle, step, repeat, attempt);
}

std::filesystem::path CampaignFolder::Commissioned() const { return CommissioningFileOf(Bench()); }

std::vector<FrozenFile> FrozenFiles(const CampaignFolder& folder) {
  return {{folder.Schedule(), "schedule_sha256"},
          {folder.Bench(), "bench_sha256"},
          {folder.Plant(), "plant_sha256"},
          {folder.Commissioned(), "commissioned_sha256"}};
}

CampaignLock::CampaignLock(const CampaignFolder& folder)
    : folder_(folder), made_folder_(daq::MakeFolders(folder.root)) {
  Open();
  struct stat file {};
  // Another process may have taken its lock away meanwhile.
  while (::fstat(descriptor_, &file) == 0 && file.st_nlink == 0) {
    ::close(descriptor_);
    Open();
  }
  const std::string text = fmt::format("{}\n", ::getpid());
  if (::ftruncate(descriptor_, 0) != 0 ||
      ::pwrite(descriptor_, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size())) {
    const int failure = errno;
    ::close(descriptor_);
    throw std::system_error(failure, std::generic_category(), folder.Lock().string());
  }
}

void CampaignLock::Open() {
  descriptor_ = ::open(folder_.Lock().c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) ThrowErrno(folder_.Lock());
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    ::close(descriptor_);
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("{}: error: the campaign is running in process {} (expected a folder that no "
                    "other process runs)",
                    folder_.root.string(), Holder(folder_)));
  }
}

CampaignLock::~CampaignLock() {
  std::error_code gone;
  // By its path the folder may be somebody else's by now.
  if (daq::LeadsTo(folder_.Lock(), descriptor_) && !std::filesystem::exists(folder_.Journal(), gone)) {
    std::filesystem::remove(folder_.Lock(), gone);
    if (made_folder_) std::filesystem::remove(folder_.root, gone);  // while it is empty
  }
  ::close(descriptor_);
}

int CampaignLock::Holder(const CampaignFolder& folder) {
  const int descriptor = ::open(folder.Lock().c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return 0;
  const bool held = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0;
  ::close(descriptor);
  if (!held) return 0;
  int process = 0;
  std::ifstream(folder.Lock()) >> process;
  return process;
}

std::string ReadText(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) ThrowErrno(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return std::move(text).str();
}

}  // namespace strainwave::bench
