// SPDX-License-Identifier: Apache-2.0
#include "analysis/joint_dynamics/file_splits.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "analysis/joint_dynamics/classification.h"

namespace strainwave::analysis::joint_dynamics::file_splits_test {
namespace {

// Units 0 to 5 healthy, 4 to 9 faulty: two of them are both. Even units come from origin 0.
FileFacts Facts() {
  FileFacts facts;
  for (int unit = 0; unit < 6; ++unit) facts.unit.push_back(unit);
  for (int unit = 4; unit < 10; ++unit) facts.unit.push_back(unit);
  facts.faulty = {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1};
  for (const int unit : facts.unit) facts.origin.push_back(unit % 2);
  return facts;
}

TEST(FileSplits, KeepWhatBelongsTogetherOnOneSide) {
  const FileFacts facts = Facts();
  const std::vector<FileSplit> splits = SplitsOfFiles(facts, 4, 1);
  ASSERT_EQ(splits.size(), 4U);
  EXPECT_TRUE(splits[0].by_samples);
  const std::vector<std::vector<int>> groups{{}, {}, facts.unit, facts.origin};
  for (std::size_t s = 1; s < 4; ++s) {
    EXPECT_EQ(splits[s].impossible, "") << splits[s].name;
    std::set<int> folds(splits[s].fold.begin(), splits[s].fold.end());
    EXPECT_EQ(static_cast<int>(folds.size()), splits[s].folds);
    for (std::size_t i = 0; i < facts.files() && s > 1; ++i) {
      for (std::size_t j = 0; j < facts.files(); ++j) {
        if (groups[s][i] == groups[s][j]) {
          EXPECT_EQ(splits[s].fold[i], splits[s].fold[j]);
        }
      }
    }
  }
  EXPECT_EQ(splits[3].folds, 2);
  EXPECT_EQ(splits[1].fold, SplitsOfFiles(facts, 4, 1)[1].fold);
}

TEST(FileSplits, SayWhyThereIsNone) {
  FileFacts facts = Facts();
  facts.origin = facts.faulty;  // all healthy ones from one place
  EXPECT_EQ(SplitsOfFiles(facts, 4, 1)[3].impossible,
            "with fold 1 of 2 left out, no faulty file is left to train on");
  facts.origin.assign(facts.files(), 0);
  EXPECT_EQ(SplitsOfFiles(facts, 4, 1)[3].impossible, "there is only one to leave out");
}

TEST(FileSplits, ShuffledLabelsAreAsMany) {
  const std::vector<int> faulty = Facts().faulty;
  const std::vector<int> shuffled = ShuffledLabels(faulty, 2);
  EXPECT_NE(shuffled, faulty);
  EXPECT_EQ(std::accumulate(shuffled.begin(), shuffled.end(), 0), 6);
}

// Samples that tell nothing but which file they are of.
TEST(Classification, OfIdentityAloneSucceedsAtRandomAndFailsHonestly) {
  FileFacts facts;
  std::vector<int> file;
  constexpr int kFiles = 24;
  constexpr int kSamples = 20;
  Eigen::MatrixXd features(kFiles * kSamples, 3);
  std::mt19937_64 engine(9);
  std::normal_distribution<double> normal;
  for (int f = 0; f < kFiles; ++f) {
    facts.faulty.push_back(f % 2);
    facts.unit.push_back(f);
    facts.origin.push_back(0);
    const Eigen::RowVector3d own{normal(engine), normal(engine), normal(engine)};
    for (int s = 0; s < kSamples; ++s) {
      features.row(f * kSamples + s) =
          own + 0.02 * Eigen::RowVector3d{normal(engine), normal(engine), normal(engine)};
      file.push_back(f);
    }
  }
  const ScoreTable table = ScoreSplits(SplitsOfFiles(facts, 4, 1), {{"", {{features}}}}, file, facts.faulty,
                                       {prediction::BinaryKind::kForest}, {});
  EXPECT_FALSE(table.contains("origin_left_out"));
  const SplitScore& random = table.at("random").at("forest");
  EXPECT_GT(random.accuracy, 0.97);
  EXPECT_EQ(random.cases, file.size());
  const SplitScore& honest = table.at("file_left_out").at("forest");
  EXPECT_LT(honest.accuracy, 0.75);
  EXPECT_EQ(honest.cases, static_cast<std::size_t>(kFiles));
  EXPECT_EQ(honest.confusion.sum(), kFiles);
  EXPECT_LT(honest.low, honest.accuracy);
  EXPECT_GT(honest.high, honest.accuracy);
}

}  // namespace
}  // namespace strainwave::analysis::joint_dynamics::file_splits_test
