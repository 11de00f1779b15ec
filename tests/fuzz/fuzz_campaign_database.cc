// SPDX-License-Identifier: Apache-2.0
// The journal of a campaign with any bytes changed and each page's checksum right: what it says is read, or
// it is refused in SQLite's words. longest: 512
#include <cstdint>
#include <cstdlib>

#include <sqlite3.h>

#include "bench/campaign/journal.h"
#include "bench/campaign/page_checksums.h"
#include "bench/campaign/sample_totals.h"
#include "tests/fuzz/folder_in_memory.h"
#include "tests/fuzz/patched_file.h"

namespace {

using namespace strainwave::bench;

std::vector<std::byte> AJournal(const FolderInMemory& folder) {
  {
    Journal journal = Journal::Create(folder.path() / "made.db");
    journal.SetProperty("schedule_sha256", "0123");
    journal.BeginCycle(1, 0.0);
    const std::int64_t phase =
        journal.BeginPhase({.cycle = 1, .name = "load", .kind = "load", .outcome = "running"});
    journal.EndPhase(phase, 60.0, "complete", 60.0);
    journal.AddResults(1, 0, {{"k1_Nm_per_rad", 1e4, 10.0, ""}, {"samples_received_a", 5.0, 0.0, ""}});
    journal.AddEvent({.time_s = 1.0,
                      .utc = "2026-03-01T12:00:00Z",
                      .cycle = 1,
                      .severity = "alarm",
                      .code = "trip",
                      .text = "words"});
    journal.SetCalibration({"torque", 1.0, 0.1, "Nm", "file"}, "2026-03-01T12:00:00Z");
    journal.AddOperatorNote({"2026-03-01T12:00:00Z", "A. Meier", "grease"});
    journal.SetChannelTroubles({{"gear temperature", "broken wire", "2026-03-01T12:00:00Z"}});
    journal.AddHole({.cycle = 1, .phase = "load", .time_s = 2.0});
    AlarmInstance alarm;
    journal.StoreAlarm(alarm);
    journal.AddAlarmAction({alarm.number, "2026-03-01T12:00:00Z", "A. Meier", "comment", "seen"});
    journal.EndCycle(1, 100.0, "complete", "0123");
    KeepSampleTotals(journal);
    journal.database().Execute("PRAGMA wal_checkpoint(TRUNCATE)");
  }
  return folder.Read("made.db");
}

void ReadAll(const Journal& journal) {
  (void)journal.Unchecked();
  (void)journal.LatestTime_s();
  (void)journal.Identity();
  (void)journal.Property(kCycles);
  (void)journal.Cycles();
  (void)journal.RecordsSha256(1);
  (void)journal.LastCompleteCycle();
  (void)journal.MeanCycle_s(5, 1);
  (void)journal.Phases(1);
  (void)journal.CreditedLoad_s(0);
  (void)journal.Results(1, 0);
  (void)journal.NewestResults("k1_Nm_per_rad", 5);
  (void)journal.RepeatsOf(1);
  (void)journal.Events(5);
  (void)journal.EventsAfter(0, 5);
  (void)journal.OpenAlarms();
  (void)journal.Alarms(0.0);
  (void)journal.AlarmActions();
  (void)journal.OperatorNotes(5);
  (void)journal.ChannelTroubles();
  (void)journal.Holes();
  (void)journal.FindCalibration("torque");
  (void)journal.CalibrationsLike("t");
  (void)SamplesOf(journal);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FolderInMemory folder;
  static const std::vector<std::byte> journal = AJournal(folder);
  std::vector<std::byte> bytes = Patched(journal, {data, size});
  for (std::size_t at = 0; at + kPage_bytes <= bytes.size(); at += kPage_bytes) {
    SealPage(PageBytes(bytes.data() + at, kPage_bytes), static_cast<std::uint32_t>(at / kPage_bytes + 1));
  }
  for (const char* beside : {"any.db-wal", "any.db-shm"}) std::filesystem::remove(folder.path() / beside);
  const auto file = folder.Write("any.db", bytes);
  try {
    ReadAll(Journal::Open(file, Database::Mode::kReadOnly));
  } catch (const DatabaseError&) {
  }
  return 0;
}
