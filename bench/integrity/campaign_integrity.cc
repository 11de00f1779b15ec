// SPDX-License-Identifier: Apache-2.0
#include "bench/integrity/campaign_integrity.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>

#include <fmt/core.h>
#include <sqlite3.h>

#include "bench/campaign/journal.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/errors/bench_error.h"
#include "bench/integrity/file_checks.h"
#include "bench/integrity/journal_checks.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

// What the journal says of files, as far as it can be read.
struct Expected {
  std::map<std::string, std::string> files;  // SHA-256 by path; empty: not known
  int complete{};
  std::optional<SalvageNote> salvaged;
};

std::string PathIn(const CampaignFolder& folder, const fs::path& file) {
  return file.lexically_relative(folder.root).generic_string();
}

Expected ExpectedFiles(const CampaignFolder& folder, const Journal& journal) {
  Expected expected;
  for (const auto& [path, digest] : journal.Files()) expected.files[path] = digest.sha256;
  for (const FrozenFile& frozen : FrozenFiles(folder)) {
    const auto sha256 = journal.Property(frozen.property);
    if (sha256 && !sha256->empty()) expected.files[PathIn(folder, frozen.file)] = *sha256;
  }
  for (const CycleRow& row : journal.Cycles()) {
    if (row.outcome != "complete") continue;
    ++expected.complete;
    const std::string file = PathIn(folder, folder.CycleFile(row.cycle));
    const std::string sha256 = journal.RecordsSha256(row.cycle);
    // Without a digest: a preparation without records, or a journal of an earlier version.
    if (sha256.empty() && (row.cycle == 0 || fs::exists(folder.root / file))) continue;
    expected.files[file] = sha256;
  }
  // Of a campaign that was salvaged, what was lost then is known.
  if (expected.salvaged = SalvageNoteOf(journal); expected.salvaged) {
    for (const std::string& lost : expected.salvaged->files_lost) expected.files.erase(lost);
  }
  return expected;
}

// Of a journal that is damaged what can still be read.
Expected ReadExpected(const CampaignFolder& folder, const JournalIntegrity& journal) {
  if (journal.state == FileState::kMissing) return {};
  try {
    return ExpectedFiles(folder, Journal::OpenAsRead(folder.Journal()));
  } catch (const DatabaseError&) {
    if (journal.state == FileState::kWhole) throw;
    return {};
  }
}

// The journal's own files are read with it; others are of a program that runs.
bool IsOfItsOwn(const std::string& path) { return path == "lock" || path.starts_with("campaign.db"); }

std::vector<FileIntegrity> FilesOf(const CampaignFolder& folder, const Expected& expected) {
  std::map<std::string, FileIntegrity> files;
  for (const auto& [path, sha256] : expected.files) files[path].state = FileState::kMissing;
  for (const auto& entry : fs::recursive_directory_iterator(folder.root)) {
    // Beside a running campaign a file that is being written gets its name, and is gone under the one it had.
    std::error_code gone;
    if (!entry.is_regular_file(gone) || gone) continue;
    const std::uintmax_t bytes = entry.file_size(gone);
    if (gone) continue;
    const std::string path = PathIn(folder, entry.path());
    if (IsOfItsOwn(path)) continue;
    files[path].state = FileState::kUnregistered;
    files[path].bytes = bytes;
  }
  std::vector<FileIntegrity> list;
  for (auto& [path, file] : files) {
    file.path = path;
    file.cycle = CycleNamed(path);
    list.push_back(std::move(file));
  }
  return list;
}

}  // namespace

std::string_view Name(FileState state) {
  switch (state) {
    case FileState::kWhole:
      return "whole";
    case FileState::kDamaged:
      return "damaged";
    case FileState::kMissing:
      return "missing";
    case FileState::kUnregistered:
      return "unregistered";
  }
  return "";
}

std::string_view Name(Verdict verdict) {
  switch (verdict) {
    case Verdict::kWhole:
      return "whole";
    case Verdict::kDamaged:
      return "damaged";
    case Verdict::kNothing:
      return "nothing can be read";
  }
  return "";
}

std::size_t CampaignIntegrity::Count(FileState state) const {
  return static_cast<std::size_t>(std::ranges::count(files, state, &FileIntegrity::state));
}

Verdict CampaignIntegrity::verdict() const {
  if (journal.state == FileState::kWhole && journal.log.damage.empty() && journal.chain.IsWhole() &&
      Count(FileState::kDamaged) == 0 && Count(FileState::kMissing) == 0) {
    return Verdict::kWhole;
  }
  const bool has_rows = journal.state == FileState::kWhole || cycles > 0;
  const bool has_files = Count(FileState::kWhole) + Count(FileState::kUnregistered) > 0;
  return has_rows || has_files ? Verdict::kDamaged : Verdict::kNothing;
}

CampaignIntegrity VerifyCampaign(const CampaignFolder& folder, const BytesRead& progress) {
  if (!fs::exists(folder.Journal()) && !fs::exists(folder.Schedule()) && !fs::is_directory(folder.Cycles())) {
    Refuse(folder.root, "not a campaign", "a folder with schedule.yaml, bench.yaml and campaign.db");
  }
  CampaignIntegrity integrity;
  integrity.process = CampaignLock::Holder(folder);
  integrity.journal = CheckJournal(folder);
  const Expected expected = ReadExpected(folder, integrity.journal);
  integrity.cycles = expected.complete;
  integrity.salvaged = expected.salvaged;
  integrity.files = FilesOf(folder, expected);
  std::uint64_t all = 0;
  for (const FileIntegrity& file : integrity.files) all += file.bytes;
  std::mutex mutex;
  OnAllProcessors(integrity.files.size(), [&](std::size_t i) {
    FileIntegrity& file = integrity.files[i];
    if (file.state == FileState::kMissing) {
      file.reason = "it is not there";
      return;
    }
    const auto registered = expected.files.find(file.path);
    // What a program is writing at this moment is not judged.
    if (integrity.process > 0 && registered == expected.files.end()) return;
    CheckFile(folder, registered == expected.files.end() ? "" : registered->second, file);
    const std::lock_guard lock(mutex);
    integrity.bytes += file.bytes;
    if (progress) progress(integrity.bytes, all);
  });
  std::error_code none;
  const auto journal_bytes = fs::file_size(folder.Journal(), none);
  if (!none) integrity.bytes += journal_bytes;
  return integrity;
}

}  // namespace strainwave::bench
