// SPDX-License-Identifier: Apache-2.0
#include "bench/page/picture.h"

#include <chrono>
#include <fstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::page_picture_test {
namespace {

namespace fs = std::filesystem;

class Pictures : public testing::Test {
 protected:
  Pictures() {
    fs::create_directories(folder_.Cycles());
    fs::create_directories(folder_.Faults());
  }
  static void Write(const fs::path& file, int at_s, const std::string& bytes = "picture") {
    std::ofstream(file) << bytes;
    fs::last_write_time(file, fs::file_time_type::clock::from_sys(
                                  std::chrono::sys_seconds(std::chrono::seconds(1'772'366'400 + at_s))));
  }

  daq::ScratchFolder scratch_;
  CampaignFolder folder_{scratch_.path()};
  PictureWatch watch_;
};

TEST(PictureNames, SayTheirCycle) {
  EXPECT_EQ(CycleOfPicture("000005.jpg"), 5);
  EXPECT_EQ(CycleOfPicture("1000005.jpg"), 1000005);
  EXPECT_EQ(CycleOfPicture("000005-120s.jpg"), 5);
  for (const char* name :
       {"5.jpg", "000005.h5", "000005.jpg.part", "000005x.jpg", "-00005.jpg", "x.jpg", ""}) {
    EXPECT_EQ(CycleOfPicture(name), std::nullopt) << name;
  }
}

TEST_F(Pictures, TheNewestIsShownWhereverItWasTaken) {
  EXPECT_EQ(watch_.Look(folder_, 2), std::nullopt);
  Write(folder_.Cycles() / "000001.jpg", 10);
  // Those of cycles long ago are looked for once, at the start.
  PictureWatch later;
  EXPECT_EQ(later.Look(folder_, 40)->cycle, 1);
  Write(folder_.Cycles() / "000002.jpg", 20);
  EXPECT_EQ(watch_.Look(folder_, 2)->file, folder_.Cycles() / "000002.jpg");
  Write(folder_.Cycles() / "000003.jpg", 30);
  EXPECT_EQ(watch_.Look(folder_, 2)->cycle, 3);
  Write(folder_.Faults() / "000004-120s.jpg", 40);
  Write(folder_.Faults() / "000004-120s.h5", 50);
  EXPECT_EQ(watch_.Look(folder_, 3)->cycle, 4);
  EXPECT_EQ(watch_.Look(folder_, 3)->taken_utc_ms, 1'772'366'440'000);
}

TEST_F(Pictures, OneThatIsOldSaysSo) {
  EXPECT_EQ(WhyStale(std::nullopt, 5), "the camera has given no picture yet");
  const BenchPicture picture{folder_.Cycles() / "000004.jpg", 4, 1'772'366'400'000};
  EXPECT_EQ(WhyStale(picture, 4), "");
  EXPECT_EQ(WhyStale(picture, 3), "");
  EXPECT_EQ(WhyStale(picture, 5), "of cycle 4; the camera has given none in the cycle complete since");
  EXPECT_EQ(WhyStale(picture, 7), "of cycle 4; the camera has given none in the 3 cycles complete since");
  const auto json = PictureJson(picture, 5, 1'772'366'402'500);
  EXPECT_EQ(json["name"], "000004.jpg");
  EXPECT_EQ(json["taken_utc"], "2026-03-01T12:00:00.000Z");
  EXPECT_EQ(json["age_s"], 2.5);
  EXPECT_NE(json["stale"], "");
  EXPECT_TRUE(PictureJson(std::nullopt, 5, 0)["name"].is_null());
}

TEST_F(Pictures, AreReadWholeOrNotAtAll) {
  const fs::path file = folder_.Cycles() / "000001.jpg";
  Write(file, 0, std::string("\xff\xd8\0picture", 10));
  EXPECT_EQ(ReadPicture(file), std::string("\xff\xd8\0picture", 10));
  Write(file, 0, "");
  const auto message = [&] {
    try {
      ReadPicture(file);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message(), "000001.jpg has 0 bytes (expected 1 to 16777216)");
  fs::remove(file);
  EXPECT_EQ(message(), "000001.jpg: No such file or directory");
}

}  // namespace
}  // namespace strainwave::bench::page_picture_test
