// SPDX-License-Identifier: Apache-2.0
#include "bench/central/record_store.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "bench/errors/output_path.h"
#include "bench/sha256.h"
#include "daq/synced_folder.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

bool IsDigest(const std::string& text) {
  const auto is_hexadecimal = [](char digit) {
    return (digit >= '0' && digit <= '9') || (digit >= 'a' && digit <= 'f');
  };
  return text.size() == 64 && std::ranges::all_of(text, is_hexadecimal);
}

void SyncFile(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && ::fsync(descriptor) == 0;
  const int failure = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (!synced) throw std::system_error(failure, std::generic_category(), file.string());
}

// Aside, looked at, synced, renamed; gone again where it does not get that far.
bool CopyWhole(const fs::path& from, const fs::path& to, const std::string& sha256) {
  const fs::path partial =
      to.parent_path() / fmt::format(".{}.{}.partial", to.filename().string(), ::getpid());
  try {
    fs::copy_file(from, partial, fs::copy_options::overwrite_existing);
    if (Sha256OfFile(partial) != sha256) {
      fs::remove(partial);
      return false;
    }
    SyncFile(partial);
    fs::rename(partial, to);
    daq::SyncFolderOf(to);
  } catch (...) {
    std::error_code gone;
    fs::remove(partial, gone);
    throw;
  }
  return true;
}

}  // namespace

RecordStore::RecordStore(fs::path folder) : folder_(std::move(folder)) {
  DemandOutputFolder(folder_);
  daq::MakeFolders(folder_);
}

fs::path RecordStore::PathOf(const std::string& sha256) const {
  return folder_ / sha256.substr(0, 2) / sha256;
}

bool RecordStore::Keep(const fs::path& file, const std::string& sha256) const {
  if (!IsDigest(sha256)) return false;
  const fs::path kept = PathOf(sha256);
  std::error_code missing;
  if (fs::file_size(kept, missing) == fs::file_size(file) && !missing) return true;
  daq::MakeFolders(kept.parent_path());
  return CopyWhole(file, kept, sha256);
}

bool RecordStore::Fetch(const std::string& sha256, const fs::path& file) const {
  if (!IsDigest(sha256) || !fs::exists(PathOf(sha256))) return false;
  return CopyWhole(PathOf(sha256), file, sha256);
}

}  // namespace strainwave::bench
