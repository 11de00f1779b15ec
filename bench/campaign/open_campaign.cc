// SPDX-License-Identifier: Apache-2.0
// What the files of a campaign say of each other, held against each other before anything is read from them.
#include <fmt/core.h>

#include "bench/campaign/campaign.h"
#include "bench/campaign/salvage_note.h"
#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

void CheckFrozenFiles(const CampaignFolder& folder, const Journal& journal) {
  for (const FrozenFile& frozen : FrozenFiles(folder)) {
    const auto sha256 = journal.Property(frozen.property);
    if (!sha256) continue;
    const bool there = std::filesystem::exists(frozen.file);
    if (!there && sha256->empty()) continue;
    if (!there) Refuse(frozen.file, "is missing", "the copy of what the campaign was started with");
    if (Sha256OfFile(frozen.file) == *sha256) continue;
    Refuse(frozen.file, "is not the file that the campaign was started with",
           sha256->empty() ? "none" : "the file whose SHA-256 is in the journal, " + *sha256);
  }
}

// Every row is on the disk before a checkpoint counts it, so that only a loss leaves a journal behind.
void CheckEnd(const CampaignFolder& folder, const std::optional<Checkpoint>& checkpoint,
              const Journal& journal) {
  if (checkpoint && checkpoint->campaign != 0 && checkpoint->campaign != journal.Identity()) {
    Refuse(folder.Checkpoint(), "is the checkpoint of another campaign",
           "the one that this campaign has written");
  }
  const JournalEnd end = journal.end();
  if (checkpoint &&
      (checkpoint->journal_end.phase > end.phase || checkpoint->journal_end.event > end.event)) {
    Refuse(
        folder.Journal(),
        fmt::format(
            "its last rows are lost: it ends with phase {} and event {}, the checkpoint came after phase {} "
            "and event {}",
            end.phase, end.event, checkpoint->journal_end.phase, checkpoint->journal_end.event),
        "campaign.db with its campaign.db-wal, both as the program has left them");
  }
  // The file of a cycle comes before its row, and the next one long after.
  const int lost = journal.LastCompleteCycle() + 2;
  if (std::filesystem::exists(folder.CycleFile(lost))) {
    Refuse(folder.Journal(),
           fmt::format("its last rows are lost: it has no end of cycle {}, of which there is a file", lost),
           "campaign.db with its campaign.db-wal, both as the program has left them");
  }
}

}  // namespace

Journal OpenCampaign(const CampaignFolder& folder, Database::Mode mode, PagesChecked checked) {
  if (!std::filesystem::exists(folder.Schedule())) {
    Refuse(folder.root, "not a campaign", "a folder with schedule.yaml, bench.yaml and campaign.db");
  }
  // Read before the journal, which a running program meanwhile goes on with.
  const auto checkpoint = ReadCheckpoint(folder.Checkpoint());
  Journal journal = checked == PagesChecked::kAll ? Journal::Open(folder.Journal(), mode)
                                                  : Journal::OpenAsRead(folder.Journal(), mode);
  CheckFrozenFiles(folder, journal);
  CheckEnd(folder, checkpoint, journal);
  return journal;
}

std::vector<std::string> WarningsAbout(const CampaignFolder& folder, const Journal& journal) {
  std::vector<std::string> warnings;
  if (const std::string unchecked = journal.Unchecked(); !unchecked.empty()) {
    warnings.push_back(fmt::format("{}: warning: {}", folder.Journal().string(), unchecked));
  }
  if (const auto salvaged = SalvageNoteOf(journal)) {
    warnings.push_back(fmt::format("{}: warning: {}", folder.root.string(), Words(*salvaged)));
  }
  const auto checkpoint = ReadCheckpoint(folder.Checkpoint());
  if (checkpoint && checkpoint->damaged_states > 0) {
    warnings.push_back(fmt::format("{}: warning: {} of its 3 states is damaged; the newest whole one counts",
                                   folder.Checkpoint().string(), checkpoint->damaged_states));
  }
  return warnings;
}

}  // namespace strainwave::bench
