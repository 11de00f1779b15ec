// SPDX-License-Identifier: Apache-2.0
// Files of a campaign that do not belong together.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>

#include "bench/campaign/campaign.h"
#include "bench/campaign/recompute.h"
#include "bench/errors/bench_error.h"
#include "bench/sha256.h"
#include "daq/cycle_file.h"
#include "tests/checkout.h"

namespace strainwave::bench::open_campaign_test {
namespace {

namespace fs = std::filesystem;

class Opening : public testing::Test {
 protected:
  ~Opening() override { fs::remove_all(root_); }

  std::string Words(const CampaignFolder& folder) const {
    try {
      OpenCampaign(folder, Database::Mode::kReadOnly);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }
  Checkpoint Here() const { return {.campaign = journal_.Identity(), .journal_end = journal_.end()}; }
  static void Leave(const CampaignFolder& folder, const Checkpoint& checkpoint) {
    CheckpointWriter(folder.Checkpoint()).Write(checkpoint, {});
  }
  // A cycle of one record, stored as the runner stores it.
  void Store(int cycle, const std::string& says_cycle, const std::string& says_schedule,
             bool with_digest = true) {
    daq::Record record;
    record.kind = daq::RecordKind::kHistory;
    record.columns.push_back({"time_s", std::vector<double>{0.0, 1.0 * cycle}, {}, {}});
    daq::WriteRecordsAtomically(folder_.CycleFile(cycle), std::vector<daq::NamedRecord>{{"a", record}},
                                {{"cycle", says_cycle}, {"schedule_sha256", says_schedule}});
    journal_.BeginCycle(cycle, cycle);
    journal_.EndCycle(cycle, cycle, "complete", with_digest ? Sha256OfFile(folder_.CycleFile(cycle)) : "");
  }
  std::string WordsOfReading(int cycle) const {
    try {
      ReadCycleRecords(folder_, journal_, cycle);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }
  std::string Schedule() const { return *journal_.Property("schedule_sha256"); }

  fs::path root_ = fs::temp_directory_path() / ("strainwave_open_campaign_" + std::to_string(::getpid()));
  CampaignFolder folder_{root_ / "one"};
  CampaignInputs inputs_ = ReadInputs(SourceFolder() + "/tests/simulation/small.yaml", std::nullopt);
  Journal journal_ = [this] {
    fs::remove_all(root_);
    inputs_.plant_text = "plant: 1\n";
    return CreateCampaign(folder_, inputs_);
  }();
};

TEST_F(Opening, RefusesEveryFrozenFileThatIsNotTheOneOfTheStart) {
  EXPECT_EQ(Words(folder_), "");
  for (const FrozenFile& frozen : FrozenFiles(folder_)) {
    const bool was_there = fs::exists(frozen.file);
    const std::string before = was_there ? ReadText(frozen.file) : "";
    std::ofstream(frozen.file) << before + " ";
    EXPECT_EQ(
        Words(folder_),
        frozen.file.string() + ": error: is not the file that the campaign was started with (expected " +
            (was_there ? "the file whose SHA-256 is in the journal, " + *journal_.Property(frozen.property)
                       : std::string("none")) +
            ")");
    std::ofstream(frozen.file) << before;
    if (!was_there) fs::remove(frozen.file);
  }
  EXPECT_EQ(Words(folder_), "");
  fs::remove(folder_.Plant());
  EXPECT_EQ(Words(folder_),
            folder_.Plant().string() +
                ": error: is missing (expected the copy of what the campaign was started with)");
}

TEST_F(Opening, RefusesTheCheckpointOfAnotherCampaignOfTheSameSchedule) {
  const CampaignFolder other{root_ / "two"};
  ::usleep(2000);  // their identity is when they began, to a millisecond
  const Journal other_journal = CreateCampaign(other, inputs_);
  Leave(other, {.campaign = other_journal.Identity()});
  EXPECT_EQ(Words(other), "");
  fs::copy(other.Checkpoint(), folder_.Checkpoint());
  EXPECT_EQ(Words(folder_),
            folder_.Checkpoint().string() +
                ": error: is the checkpoint of another campaign (expected the one that this campaign "
                "has written)");
}

TEST_F(Opening, RefusesAJournalThatHasLostItsLastRows) {
  journal_.AddEvent({1.0, "utc", 0, "", "info", "code", "text"});
  Leave(folder_, Here());
  EXPECT_EQ(Words(folder_), "");
  Checkpoint ahead = Here();
  ahead.journal_end = {3, 1};
  Leave(folder_, ahead);
  EXPECT_EQ(
      Words(folder_),
      folder_.Journal().string() +
          ": error: its last rows are lost: it ends with phase 0 and event 1, the checkpoint came after "
          "phase 3 "
          "and event 1 (expected campaign.db with its campaign.db-wal, both as the program has left them)");
}

TEST_F(Opening, RefusesAJournalThatDoesNotKnowACycleOfWhichThereIsAFile) {
  std::ofstream(folder_.CycleFile(0)) << "written, and then the program was killed";
  EXPECT_EQ(Words(folder_), "");
  std::ofstream(folder_.CycleFile(1)) << "text";
  EXPECT_EQ(
      Words(folder_),
      folder_.Journal().string() +
          ": error: its last rows are lost: it has no end of cycle 1, of which there is a file (expected "
          "campaign.db with its campaign.db-wal, both as the program has left them)");
}

TEST_F(Opening, SaysThatAStateOfTheCheckpointIsDamaged) {
  for (int states = 0; states < 3; ++states) Leave(folder_, Here());
  {
    std::fstream file(folder_.Checkpoint(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(16384 + 40);
    file << "damage";
  }
  EXPECT_EQ(WarningsAbout(folder_, journal_),
            std::vector<std::string>{folder_.Checkpoint().string() +
                                     ": warning: 1 of its 3 states is damaged; the newest whole one counts"});
}

TEST_F(Opening, TakesNoFileOfACycleForThatOfAnother) {
  Store(1, "1", Schedule());
  Store(2, "2", Schedule());
  EXPECT_EQ(WordsOfReading(1), "");
  const std::string digest = Sha256OfFile(folder_.CycleFile(1));
  fs::copy_file(folder_.CycleFile(2), folder_.CycleFile(1), fs::copy_options::overwrite_existing);
  EXPECT_EQ(WordsOfReading(1), folder_.CycleFile(1).string() +
                                   ": error: holds the records of cycle 2 (expected those of cycle 1)");
  Store(1, "1", Schedule());
  journal_.EndCycle(1, 1.0, "complete", digest);
  EXPECT_EQ(WordsOfReading(1), "") << "the same records are the same file";
  journal_.EndCycle(1, 1.0, "complete", std::string(64, '0'));
  EXPECT_EQ(WordsOfReading(1),
            folder_.CycleFile(1).string() +
                ": error: is not the file that was stored (expected the file whose SHA-256 is in "
                "the journal, " +
                std::string(64, '0') + ")");
  Store(1, "1", "another", false);
  EXPECT_EQ(WordsOfReading(1),
            folder_.CycleFile(1).string() +
                ": error: holds records of another campaign (expected those measured by this "
                "campaign's schedule.yaml)");
}

}  // namespace
}  // namespace strainwave::bench::open_campaign_test
