// SPDX-License-Identifier: Apache-2.0
// Folders written anew from the server: whole or not at all, by one program at a time, each campaign once.
#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "tests/bench/central/lab.h"

namespace strainwave::bench::fetch_test {
namespace {

class Fetching : public testing::Test {
 protected:
  void SetUp() override {
    if (!HasPostgres()) GTEST_SKIP() << kNoPostgres;
    lab_ = std::make_unique<Lab>();
    campaign_ = std::make_unique<WrittenCampaign>(lab_->scratch / "campaign");
    campaign_->AddCycles(3);
  }
  std::vector<FoundCampaign> Found(const std::string& query = "") const {
    Server admin(lab_->postgres.Conninfo("admin"));
    return FindCampaigns(admin, ParseCampaignQuery(query));
  }
  FetchedCampaign Fetch(const std::filesystem::path& into, const RecordStore* store = nullptr) const {
    Server admin(lab_->postgres.Conninfo("admin"));
    return FetchCampaign(admin, Found().at(0), into, store);
  }
  std::unique_ptr<Lab> lab_;
  std::unique_ptr<WrittenCampaign> campaign_;
};

TEST_F(Fetching, OneProgramAtATimeWorksAtAPlace) {
  lab_->Forward(lab_->Order(campaign_->folder()));
  const std::filesystem::path into = lab_->scratch / "fetched";
  const std::filesystem::path left = into / ("." + Found().at(0).Name() + ".partial");
  // What a killed one has left is in nobody's way.
  std::filesystem::create_directories(left);
  std::ofstream(left / "half a file") << "x";
  Server admin(lab_->postgres.Conninfo("admin"));
  const auto found = Found();
  admin.Execute("BEGIN; LOCK TABLE strainwave.result_rows IN ACCESS EXCLUSIVE MODE");
  FetchedCampaign first;
  std::thread fetching([&] {
    Server server(lab_->postgres.Conninfo("admin"));
    first = FetchCampaign(server, found.at(0), into, nullptr);
  });
  Until([&] { return lab_->Value("SELECT count(*) FROM pg_locks WHERE NOT granted") == "1"; });
  Server second(lab_->postgres.Conninfo("admin"));
  EXPECT_EQ(RefusalOf([&] { FetchCampaign(second, found.at(0), into, nullptr); }),
            "2: another program fetches it at this moment (expected that to be done, or another folder)");
  admin.Execute("COMMIT");
  fetching.join();
  EXPECT_EQ(RowsOf({first.folder}), RowsOf(campaign_->folder()));
  EXPECT_FALSE(std::filesystem::exists(first.folder / "half a file"));
  EXPECT_EQ(RefusalOf([&] { Fetch(into); }),
            "2: is there already (expected another folder, or none of that name)");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(into), {}), 1);
}

TEST_F(Fetching, CountsRecordsThatAreMissing) {
  auto order = lab_->Order(campaign_->folder());
  order.settings.store = lab_->scratch / "store";
  lab_->Forward(order);
  const std::string digest = Sha256("records of cycle 1");
  std::filesystem::remove(order.settings.store / digest.substr(0, 2) / digest);
  // Of these no store has heard.
  campaign_->AddCycles(20);
  order.settings.store.clear();
  lab_->Forward(order);
  const RecordStore store(lab_->scratch / "store");
  const FetchedCampaign fetched = Fetch(lab_->scratch / "fetched", &store);
  EXPECT_EQ(fetched.records, 2);
  EXPECT_EQ(fetched.missing, 21);
  ASSERT_EQ(fetched.warnings.size(), 11U);
  EXPECT_EQ(fetched.warnings.front(), "cycles/000001.h5: the store has it not, or damaged");
  EXPECT_EQ(fetched.warnings.back(), "11 more files: the store has them not, or damaged");
  EXPECT_EQ(Fetch(lab_->scratch / "without").missing, 0);
}

TEST_F(Fetching, WritesIntoNoCampaignAndNoFile) {
  lab_->Forward(lab_->Order(campaign_->folder()));
  const auto before = RowsOf(campaign_->folder());
  for (const std::filesystem::path& into :
       {campaign_->folder().root, campaign_->folder().Cycles() / "deep"}) {
    EXPECT_EQ(
        RefusalOf([&] { Fetch(into); }),
        "2: is a campaign's folder, or lies in one (expected a folder for campaigns, one below it for each)");
  }
  EXPECT_EQ(RowsOf(campaign_->folder()), before);
  EXPECT_FALSE(std::filesystem::exists(campaign_->folder().root / Found().at(0).Name()));
  std::ofstream(lab_->scratch / "file") << "x";
  EXPECT_EQ(RefusalOf([&] { Fetch(lab_->scratch / "file"); }),
            "2: is no folder (expected a folder, there or to be made)");
  // One of several that is there already: not even the others are begun.
  std::filesystem::create_directories(lab_->scratch / "fetched" / Found().at(0).Name());
  EXPECT_EQ(RefusalOf([&] { DemandFetchPlace(lab_->scratch / "fetched", Found()); }),
            "2: is there already (expected another folder, or none of that name)");
}

TEST_F(Fetching, ACopyThatAnotherBenchForwardsDoesNotCount) {
  lab_->AddBench("hall-4");
  std::filesystem::copy(campaign_->folder().root, lab_->scratch / "copy",
                        std::filesystem::copy_options::recursive);
  lab_->Forward(lab_->Order({lab_->scratch / "copy"}, "hall-4"));
  lab_->Forward(lab_->Order(campaign_->folder()));
  // As many cycles: that which came first counts.
  auto found = Found();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].same_as, found[1].Name());
  EXPECT_EQ(found[1].same_as, "");
  campaign_->AddCycles(1);
  lab_->Forward(lab_->Order(campaign_->folder()));
  found = Found();
  EXPECT_EQ(found[0].same_as, "");
  EXPECT_EQ(found[1].same_as, found[0].Name());
  // Alone it is as good as the other.
  EXPECT_EQ(Found("bench=hall-4").at(0).same_as, "");
}

}  // namespace
}  // namespace strainwave::bench::fetch_test
