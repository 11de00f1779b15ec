// SPDX-License-Identifier: Apache-2.0
#include "analysis/joint_dynamics/excess_friction.h"

#include <cmath>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/joint_dynamics/classification.h"

namespace strainwave::analysis::joint_dynamics::excess_friction_test {
namespace {

using Eigen::Index;

TEST(ExcessFriction, IsTheGreatestOfItsJointsInDeviationsOfOneFurtherFile) {
  const Eigen::MatrixXd healthy{{1.0, 10.0}, {2.0, 10.0}, {3.0, 13.0}};
  const ExcessFriction excess = FitExcessFriction(healthy);
  // Means 2 and 11, deviations 1 and √3, each times √(4/3).
  EXPECT_DOUBLE_EQ(excess.Score(Eigen::RowVectorXd{{4.0, 11.0}}), 2.0 / std::sqrt(4.0 / 3.0));
  EXPECT_DOUBLE_EQ(excess.Score(Eigen::RowVectorXd{{2.0, 15.0}}), 4.0 / 2.0);
  // Student's t of 2 degrees of freedom is passed with 2.5 % above 4.3027.
  EXPECT_NEAR(excess.limit, 4.302653, 1e-6);
}

TEST(ExcessFriction, IsPassedByFiveInAHundredHealthyFiles) {
  constexpr Index kFiles = 8;
  constexpr Index kJoints = 6;
  constexpr int kTrials = 4000;
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal(3.0, 0.2);
  const auto draw = [&](Index rows) {
    Eigen::MatrixXd values(rows, kJoints);
    for (double& value : values.reshaped()) value = normal(engine);
    return values;
  };
  int alarms = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const ExcessFriction excess = FitExcessFriction(draw(kFiles));
    alarms += excess.Score(draw(1).row(0)) > excess.limit ? 1 : 0;
  }
  // Of 200, by 3.5 standard deviations; a little fewer, since the joints' chances are added.
  EXPECT_GT(alarms, 140);
  EXPECT_LT(alarms, 250);
}

TEST(ExcessFriction, NeedsThreeHealthyFiles) {
  try {
    FitExcessFriction(Eigen::MatrixXd::Ones(2, 6));
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "2 healthy files (expected 3 or more)");
  }
}

TEST(ExcessFriction, MeansAreOfTheSamplesOfEachFile) {
  // Columns: two of |τ − f|, two against the motion, two attributions.
  const Eigen::MatrixXd fingerprints{
      {9.0, 9.0, 1.0, 2.0, 9.0, 9.0}, {9.0, 9.0, 5.0, 6.0, 9.0, 9.0}, {9.0, 9.0, 3.0, 4.0, 9.0, 9.0}};
  const Eigen::MatrixXd mean = MeanAgainstMotion(fingerprints, std::vector<int>{0, 1, 0}, 2, 2);
  EXPECT_EQ(mean, (Eigen::MatrixXd{{2.0, 3.0}, {5.0, 6.0}}));
}

// Twelve files of ten samples of two joints, the last four faulty, in one joint or the other.
struct Files {
  FileFacts facts;
  std::vector<int> file;
  Eigen::MatrixXd fingerprints;
};

Files MakeFiles(double excess) {
  constexpr int kHealthy = 8;
  constexpr int kFiles = 12;
  constexpr int kSamples = 10;
  Files files;
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal;
  files.fingerprints.resize(Index{kFiles} * kSamples, 6);
  for (int f = 0; f < kFiles; ++f) {
    files.facts.faulty.push_back(f < kHealthy ? 0 : 1);
    files.facts.unit.push_back(f);
    files.facts.origin.push_back(f % 2);
    for (int i = 0; i < kSamples; ++i) {
      const auto row = static_cast<Index>(files.file.size());
      for (Index column = 0; column < 6; ++column) files.fingerprints(row, column) = normal(engine);
      if (f >= kHealthy) files.fingerprints(row, 2 + f % 2) += excess;
      files.file.push_back(f);
    }
  }
  return files;
}

TEST(ExcessFriction, TellsFaultyFilesOnSplitsThatLeaveFilesOut) {
  const Files files = MakeFiles(10.0);
  const std::vector<FileSplit> splits = SplitsOfFiles(files.facts, 4, 1);
  std::map<std::string, SampleFeatures> features;
  for (const FileSplit& split : splits) features[split.name].of_fold = {files.fingerprints};
  const ScoreTable table = ScoreExcessFriction(splits, features, files.file, files.facts.faulty, 2);
  EXPECT_FALSE(table.contains(std::string(kRandomSplit)));
  for (const std::string_view name : {kFileSplit, kUnitSplit, kOriginSplit}) {
    const SplitScore& score = table.at(std::string(name)).at(kExcessFriction);
    EXPECT_EQ(score.cases, 12U);
    EXPECT_EQ(score.area_under_curve, 1.0) << name;
    EXPECT_EQ(score.confusion(1, 1), 4) << name;
    // Each healthy one is taken for faulty with 5 %: more than three of eight with 0.04 %.
    EXPECT_GE(score.confusion(0, 0), 5) << name;
  }
  // A fault that takes torque away is none of friction.
  const Files pushed = MakeFiles(-10.0);
  for (auto& [name, of_split] : features) of_split.of_fold = {pushed.fingerprints};
  const ScoreTable turned = ScoreExcessFriction(splits, features, pushed.file, pushed.facts.faulty, 2);
  EXPECT_EQ(turned.at(std::string(kUnitSplit)).at(kExcessFriction).confusion(1, 1), 0);
}

TEST(ExcessFriction, LeavesOutSplitsWithTooFewHealthyFiles) {
  Files files = MakeFiles(10.0);
  for (std::size_t f = 2; f < 8; ++f) files.facts.faulty[f] = 1;
  const std::vector<FileSplit> splits = SplitsOfFiles(files.facts, 2, 1);
  std::map<std::string, SampleFeatures> features;
  for (const FileSplit& split : splits) features[split.name].of_fold = {files.fingerprints};
  EXPECT_TRUE(ScoreExcessFriction(splits, features, files.file, files.facts.faulty, 2).empty());
}

}  // namespace
}  // namespace strainwave::analysis::joint_dynamics::excess_friction_test
