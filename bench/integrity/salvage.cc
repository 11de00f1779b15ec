// SPDX-License-Identifier: Apache-2.0
#include "bench/integrity/salvage.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <system_error>

#include <fmt/core.h>

#include "bench/campaign/checkpoint.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/integrity/salvage_rows.h"
#include "bench/sha256.h"
#include "bench/utc.h"
#include "daq/cycle_file.h"
#include "daq/file_descriptor.h"
#include "daq/record_checks.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

// Of a program that runs or goes on; what is salvaged is not gone on with.
bool IsForGoingOn(const std::string& path) { return path == "checkpoint" || path == "readings"; }

bool IsText(const std::string& path) { return path.ends_with(".yaml"); }

bool LiesWithin(const fs::path& inner, const fs::path& outer) {
  const fs::path relative = inner.lexically_relative(outer);
  return !relative.empty() && *relative.begin() != "..";
}

void CopyFile(const fs::path& from, const fs::path& to) {
  fs::create_directories(to.parent_path());
  fs::copy_file(from, to);
}

// What a cycle's file says of itself; its own attributes may be damaged.
daq::Attributes AttributesOf(const FileIntegrity& file) {
  daq::Attributes attributes{{"salvaged", "1"}};
  if (file.cycle && file.path.starts_with("cycles/"))
    attributes.emplace_back("cycle", std::to_string(*file.cycle));
  return attributes;
}

// Whole records of a damaged file, as a file of their own.
bool CopyRecords(const FileIntegrity& file, const fs::path& from, const fs::path& to, SalvageNote& note) {
  for (const daq::RecordCheck& record : file.records) {
    if (!record.damage.empty()) note.records_lost.push_back(file.path + " " + record.group);
  }
  std::vector<std::string> whole;
  for (const daq::RecordCheck& record : file.records) {
    if (record.damage.empty()) whole.push_back(record.group);
  }
  if (whole.empty()) return false;
  note.records_recovered += static_cast<std::int64_t>(whole.size());
  fs::create_directories(to.parent_path());
  daq::CopyRecords(from, whole, to, AttributesOf(file));
  return true;
}

// Paths that were written anew with what is left.
std::set<std::string> CopyFiles(const CampaignFolder& from, const CampaignIntegrity& integrity,
                                const fs::path& out, SalvageNote& note) {
  std::set<std::string> rewritten;
  for (const FileIntegrity& file : integrity.files) {
    if (IsForGoingOn(file.path)) continue;
    const fs::path source = from.root / file.path;
    const fs::path target = out / file.path;
    if (file.state == FileState::kWhole || file.state == FileState::kUnregistered) {
      CopyFile(source, target);
      ++note.files_recovered;
    } else if (file.state == FileState::kDamaged && CopyRecords(file, source, target, note)) {
      rewritten.insert(file.path);
    } else {
      note.files_lost.push_back(file.path);
      if (file.state == FileState::kDamaged && IsText(file.path))
        CopyFile(source, target.string() + ".damaged");
    }
  }
  return rewritten;
}

// How many rows there were, as far as chain and checkpoint tell.
std::map<std::string, std::int64_t> LeastRows(const CampaignFolder& from, const Database& journal) {
  std::map<std::string, std::int64_t> least;
  if (const auto checkpoint = ReadCheckpoint(from.Checkpoint())) {
    least["phases"] = checkpoint->journal_end.phase;
    least["events"] = checkpoint->journal_end.event;
  }
  constexpr std::array<std::pair<const char*, const char*>, 5> kKinds{{{"event", "events"},
                                                                       {"hole", "holes"},
                                                                       {"note", "operator_notes"},
                                                                       {"alarm action", "alarm_actions"},
                                                                       {"file", "files"}}};
  try {
    for (const auto& [kind, table] : kKinds) {
      Statement last = journal.Prepare("SELECT MAX(CAST(key AS INTEGER)) FROM chain WHERE kind = ?");
      last.Bind(std::string_view(kind));
      if (last.Step()) least[table] = std::max(least[table], last.Integer(0));
    }
  } catch (const DatabaseError&) {
    // No chain, or a damaged one: the rows tell what they tell.
  }
  return least;
}

// Complete cycles of which a row is lost.
std::vector<int> IncompleteCycles(const Database& damaged, const Journal& journal) {
  std::vector<int> cycles;
  try {
    constexpr std::string_view kCycle = "cycle ";
    for (const BrokenLink& link : CheckChain(damaged, journal.database(), SIZE_MAX).broken) {
      int cycle = 0;
      const char* const end = link.what.data() + link.what.size();
      if (link.what.starts_with(kCycle) &&
          std::from_chars(link.what.data() + kCycle.size(), end, cycle).ptr == end) {
        cycles.push_back(cycle);
      }
    }
  } catch (const DatabaseError&) {
    for (const CycleRow& row : journal.Cycles()) {
      if (row.outcome == "complete" && journal.Results(row.cycle, 0).empty() && row.cycle > 0)
        cycles.push_back(row.cycle);
    }
  }
  return cycles;
}

void CopyJournal(const CampaignFolder& from, const CampaignIntegrity& integrity, Journal& journal,
                 SalvageNote& note) {
  if (integrity.journal.state == FileState::kMissing) return;
  const Database damaged(from.Journal(), Database::Mode::kReadOnly);
  CopyRows(damaged, journal.database(), LeastRows(from, damaged), note);
  note.cycles_incomplete = IncompleteCycles(damaged, journal);
  note.chain_head = integrity.journal.chain.head;
}

void TakeNewDigests(const fs::path& out, const std::set<std::string>& rewritten, const Journal& journal) {
  const CampaignFolder folder{out};
  for (const CycleRow& row : journal.Cycles()) {
    const std::string file = folder.CycleFile(row.cycle).lexically_relative(out).generic_string();
    if (!rewritten.contains(file)) continue;
    journal.database()
        .Prepare("UPDATE cycles SET records_sha256 = ? WHERE cycle = ?")
        .Bind(std::string_view(Sha256OfFile(folder.CycleFile(row.cycle))))
        .Bind(row.cycle)
        .Run();
  }
}

}  // namespace

void DemandPlaceToSalvage(const CampaignFolder& from, const fs::path& out) {
  const fs::path campaign = fs::weakly_canonical(from.root);
  const fs::path place = fs::weakly_canonical(out);
  constexpr const char* kExpected = "a new or empty folder outside of the campaign";
  if (place == campaign) Refuse(out, "is the campaign itself", kExpected);
  if (LiesWithin(place, campaign)) Refuse(out, "lies within the campaign", kExpected);
  if (LiesWithin(campaign, place)) Refuse(out, "holds the campaign", kExpected);
  if (!fs::exists(place)) return DemandOutputFolder(out);
  if (!fs::is_directory(place)) Refuse(out, "is not a folder", kExpected);
  if (!fs::is_empty(place)) Refuse(out, "is not empty", kExpected);
}

SalvageNote Salvage(const CampaignFolder& from, const CampaignIntegrity& integrity, const fs::path& out) {
  DemandPlaceToSalvage(from, out);
  SalvageNote note;
  note.from = fs::weakly_canonical(from.root).string();
  note.utc = UtcNow();
  const CampaignFolder folder{out};
  for (const auto& made : {out, folder.Cycles(), folder.Unfinished()}) fs::create_directories(made);
  const std::set<std::string> rewritten = CopyFiles(from, integrity, out, note);
  const fs::path aside = out / "campaign.db.new";
  {
    Journal journal = Journal::Create(aside);
    Transaction transaction(journal.database());
    CopyJournal(from, integrity, journal, note);
    TakeNewDigests(out, rewritten, journal);
    KeepSalvageNote(journal, note);
    AddAllLinks(journal.database());
    transaction.Commit();
    journal.database().Execute("PRAGMA wal_checkpoint(TRUNCATE)");
  }
  // The journal appears last: a folder without it is no campaign yet.
  fs::rename(aside, folder.Journal());
  const daq::FileDescriptor disk(::open(out.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!disk.is_open() || ::syncfs(disk.get()) != 0) {
    throw std::system_error(errno, std::generic_category(), out.string());
  }
  return note;
}

}  // namespace strainwave::bench
