// SPDX-License-Identifier: Apache-2.0
#include "bench/integrity/journal_checks.h"

#include <filesystem>

#include <fmt/core.h>
#include <sqlite3.h>

#include "bench/campaign/journal.h"
#include "bench/campaign/page_checksums.h"
#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

void TakeDamage(JournalIntegrity& journal, std::string reason) {
  journal.state = FileState::kDamaged;
  if (journal.reason.empty()) journal.reason = std::move(reason);
}

void CheckPagesOf(const fs::path& file, JournalIntegrity& journal) {
  const auto pages = CheckPages(file, Journal::kApplicationId, Journal::kVersion);
  if (!pages) return;
  journal.pages = pages->pages;
  journal.damaged_pages = pages->damaged;
  if (pages->damaged > 0) {
    TakeDamage(journal, fmt::format("{} of {} pages do not match their checksum, the first of them page {}",
                                    pages->damaged, pages->pages, pages->first_damaged));
  } else if (pages->cut) {
    TakeDamage(journal, fmt::format("it is cut, {} pages are left", pages->pages));
  }
}

void CheckRows(const fs::path& file, JournalIntegrity& integrity) {
  const Journal journal = Journal::OpenAsRead(file);
  Statement check = journal.database().Prepare("PRAGMA integrity_check(1)");
  if (!check.Step() || check.Text(0) != "ok")
    TakeDamage(integrity, fmt::format("SQLite finds: {}", check.Text(0)));
  integrity.has_chain = HasChain(journal.database());
  if (integrity.has_chain) integrity.chain = CheckChain(journal.database());
}

}  // namespace

JournalIntegrity CheckJournal(const CampaignFolder& folder) {
  JournalIntegrity journal;
  const fs::path file = folder.Journal();
  if (!fs::exists(file)) {
    journal.state = FileState::kMissing;
    journal.reason = "it is not there";
    return journal;
  }
  journal.log = CheckLog(file.string() + "-wal");
  CheckPagesOf(file, journal);
  try {
    CheckRows(file, journal);
  } catch (const DatabaseError& error) {
    // Of another program or a newer version, and not only a damaged header.
    if ((error.code() & 0xff) == SQLITE_MISMATCH && journal.state == FileState::kWhole) {
      throw BenchError(ExitCode::kWrongInput, error.what());
    }
    TakeDamage(journal, error.what());
  }
  return journal;
}

}  // namespace strainwave::bench
