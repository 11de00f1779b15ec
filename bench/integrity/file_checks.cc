// SPDX-License-Identifier: Apache-2.0
#include "bench/integrity/file_checks.h"

#include <array>
#include <charconv>
#include <exception>
#include <filesystem>
#include <mutex>

#include <fmt/core.h>

#include "bench/sha256.h"
#include "daq/checkpoint_file.h"
#include "daq/data_file_error.h"
#include "daq/growing_file.h"
#include "daq/record_checks.h"
#include "daq/record_error.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

// One process for a damaged file at a time: another one, forked meanwhile, would hold its pipe open.
std::mutex& OwnProcess() {
  static std::mutex mutex;
  return mutex;
}

void TakeDamage(FileIntegrity& file, std::string reason) {
  file.state = FileState::kDamaged;
  file.reason = std::move(reason);
}

// Which records of it are left.
void LookAtRecords(const fs::path& path, FileIntegrity& file) {
  const std::lock_guard lock(OwnProcess());
  try {
    file.records = daq::CheckRecords(path);
  } catch (const daq::RecordError& error) {
    file.reason += fmt::format("; {}", error.findings().front().what);
  }
}

void CheckStates(const fs::path& path, FileIntegrity& file) {
  const auto latest = daq::ReadCheckpoint(path);
  file.state = FileState::kWhole;
  if (latest && latest->damaged_slots > 0) {
    TakeDamage(file, fmt::format("{} of its {} states is damaged; the newest whole one counts",
                                 latest->damaged_slots, daq::CheckpointFile::kSlots));
  }
}

void CheckGrowing(const fs::path& path, FileIntegrity& file) {
  const auto grown = daq::ReadGrowingFile(path);
  if (grown.lost_bytes > 0) {
    TakeDamage(file, fmt::format("its last block is cut, {} bytes of it are there", grown.lost_bytes));
  }
}

bool HoldsStates(std::string_view path) {
  constexpr std::array<std::string_view, 4> kFiles{"checkpoint", "envelope", "readings", "sources"};
  return std::ranges::find(kFiles, path) != kFiles.end();
}

// By the checksums within the file.
void CheckByItself(const fs::path& path, FileIntegrity& file) {
  if (HoldsStates(file.path)) return CheckStates(path, file);
  if (path.extension() == ".rows") return CheckGrowing(path, file);
  if (path.extension() != ".h5") return;
  LookAtRecords(path, file);
  for (const daq::RecordCheck& record : file.records) {
    if (!record.damage.empty()) return TakeDamage(file, "a record of it does not match its checksum");
  }
  if (!file.reason.empty()) return TakeDamage(file, file.reason.substr(2));
  file.records.clear();
}

void CheckByDigest(const fs::path& path, const std::string& sha256, FileIntegrity& file) {
  if (sha256 == Sha256OfFile(path)) {
    file.state = FileState::kWhole;
    return;
  }
  TakeDamage(file, "it is not the file that was registered (SHA-256)");
  if (path.extension() == ".h5") LookAtRecords(path, file);
}

}  // namespace

std::optional<int> CycleNamed(std::string_view path) {
  const std::size_t folder = path.rfind('/');
  if (folder == path.npos) return std::nullopt;
  const std::string_view name = path.substr(folder + 1);
  constexpr std::size_t kDigits = 6;
  int cycle = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), cycle);
  const bool is_number = error == std::errc{} && end >= name.data() + kDigits;
  return is_number ? std::optional(cycle) : std::nullopt;
}

void CheckFile(const CampaignFolder& folder, const std::string& sha256, FileIntegrity& file) {
  const fs::path path = folder.root / file.path;
  try {
    sha256.empty() ? CheckByItself(path, file) : CheckByDigest(path, sha256, file);
  } catch (const std::exception& error) {
    TakeDamage(file, error.what());
  }
}

}  // namespace strainwave::bench
