// SPDX-License-Identifier: Apache-2.0
#include "tests/power_cuts/disk.h"

#include <gtest/gtest.h>

#include <set>

namespace strainwave::power_cuts::disk_test {
namespace {

constexpr int kSeeds = 200;

// What a file of the name holds after the power went, or "none", for each of many seeds.
template <typename Doing>
std::set<std::string> LeftOf(const std::string& name, Doing doing) {
  std::set<std::string> left;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Disk disk;
    disk.Seed(static_cast<std::uint64_t>(seed));
    doing(disk);
    disk.Cut();
    const auto file = disk.Find(Disk::kRoot, name);
    left.insert(file ? disk.Read(*file, 0, 1 << 20) : "none");
  }
  return left;
}

Number SyncedFile(Disk& disk, const std::string& name, const std::string& text) {
  const Number file = disk.Make(Disk::kRoot, name, false);
  disk.Write(file, 0, text);
  disk.Sync(file);
  disk.Sync(Disk::kRoot);
  return file;
}

TEST(PowerCutDisk, KeepsWhatWasSynced) {
  EXPECT_EQ(LeftOf("a", [](Disk& disk) { SyncedFile(disk, "a", "kept"); }), std::set<std::string>{"kept"});
}

TEST(PowerCutDisk, NeedsASyncOfTheFolderForAName) {
  const auto left = LeftOf("a", [](Disk& disk) {
    const Number file = disk.Make(Disk::kRoot, "a", false);
    disk.Write(file, 0, "kept");
    disk.Sync(file);
  });
  EXPECT_EQ(left, (std::set<std::string>{"kept", "none"}));
}

TEST(PowerCutDisk, NeedsASyncOfTheFileForItsBytes) {
  const auto left = LeftOf("a", [](Disk& disk) {
    disk.Write(disk.Make(Disk::kRoot, "a", false), 0, "new");
    disk.Sync(Disk::kRoot);
  });
  EXPECT_EQ(left, (std::set<std::string>{"", "new", std::string(3, '\0'), std::string(3, '\xA5')}));
}

TEST(PowerCutDisk, RenamesAsAWholeOrNotAtAll) {
  const auto rename = [](Disk& disk) {
    SyncedFile(disk, "a", "old");
    SyncedFile(disk, "b", "new");
    disk.Rename(Disk::kRoot, "b", Disk::kRoot, "a");
  };
  EXPECT_EQ(LeftOf("a", rename), (std::set<std::string>{"old", "new"}));
  EXPECT_EQ(LeftOf("b", rename), (std::set<std::string>{"new", "none"}));
}

TEST(PowerCutDisk, TearsAndReordersWritesAtSectors) {
  const std::string before(2 * Disk::kSector_bytes, '-');
  const auto left = LeftOf("a", [&](Disk& disk) {
    const Number file = SyncedFile(disk, "a", before);
    disk.Write(file, 0, std::string(2 * Disk::kSector_bytes, '1'));
    disk.Write(file, Disk::kSector_bytes, "2");
  });
  const std::string first(Disk::kSector_bytes, '1');
  const std::string untouched(Disk::kSector_bytes, '-');
  std::string later = untouched;
  later.front() = '2';
  EXPECT_TRUE(left.contains(first + untouched)) << "torn";
  EXPECT_TRUE(left.contains(untouched + first)) << "reordered within a write";
  EXPECT_TRUE(left.contains(untouched + later)) << "the later write alone";
  EXPECT_TRUE(left.contains(before)) << "dropped";
}

TEST(PowerCutDisk, WritesNothingAgainAfterAFailedSync) {
  const auto left = LeftOf("a", [](Disk& disk) {
    const Number file = SyncedFile(disk, "a", "old");
    disk.Write(file, 0, "new");
    disk.FailSync(file);
    EXPECT_EQ(disk.Read(file, 0, 3), "new");
    disk.Sync(file);
  });
  EXPECT_EQ(left, (std::set<std::string>{"old", "new"}));
}

TEST(PowerCutDisk, WritesWhatWasDroppedAlongWithItsPage) {
  const auto left = LeftOf("a", [](Disk& disk) {
    const Number file = SyncedFile(disk, "a", "old");
    disk.Write(file, 0, "new");
    disk.FailSync(file);
    disk.Write(file, 3, "er");
    disk.Sync(file);
  });
  EXPECT_EQ(left, std::set<std::string>{"newer"});
}

}  // namespace
}  // namespace strainwave::power_cuts::disk_test
