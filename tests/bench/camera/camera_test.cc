// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/camera/camera.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "tests/bench/real_time.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::camera_test {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

cv::Mat Picture(int number) { return {48, 64, CV_8UC3, cv::Scalar(10 * number, 100, 200 - 10 * number)}; }

class Cameras : public testing::Test {
 protected:
  // Pictures that are numbered, each of one colour.
  std::string Sequence(int pictures) {
    for (int i = 0; i < pictures; ++i) {
      cv::imwrite((folder_ / ("frame_" + std::to_string(i) + ".png")).string(), Picture(i));
    }
    return (folder_ / "frame_%d.png").string();
  }
  Snapshot AskAndWait(Camera& camera, const fs::path& file) {
    EXPECT_TRUE(camera.Ask(file.string()));
    std::vector<Snapshot> done;
    EXPECT_TRUE(Until([&] { return done = camera.TakeSnapshots(), !done.empty(); }));
    return done.empty() ? Snapshot{} : done.at(0);
  }
  static std::string Head(const fs::path& file, std::size_t bytes) {
    std::ifstream stream(file, std::ios::binary);
    std::string head(bytes, '\0');
    stream.read(head.data(), static_cast<std::streamsize>(bytes));
    return head;
  }

  daq::ScratchFolder scratch_;
  fs::path folder_ = scratch_.path();
  SteadyBenchClock clock_;
};

TEST_F(Cameras, GiveTheNextPictureOfASequenceForEachRequest) {
  Camera camera({Sequence(2), 1h}, clock_);
  for (int i = 0; i < 2; ++i) {
    const fs::path file = folder_ / ("cycle_" + std::to_string(i) + ".png");
    const Snapshot snapshot = AskAndWait(camera, file);
    EXPECT_EQ(snapshot.trouble, "");
    EXPECT_EQ(snapshot.file, file);
    EXPECT_FALSE(snapshot.late);
    EXPECT_GE(snapshot.taken, snapshot.asked);
    EXPECT_EQ(Head(file, 4), "\x89PNG");
    EXPECT_EQ(cv::norm(cv::imread(file.string()), Picture(i), cv::NORM_INF), 0.0);
  }
  EXPECT_EQ(AskAndWait(camera, folder_ / "third.png").trouble, "the file has no further picture");
  EXPECT_FALSE(fs::exists(folder_ / "third.png"));
}

TEST_F(Cameras, WriteJpegFromAVideo) {
  const std::string video = (folder_ / "video.avi").string();
  cv::VideoWriter writer(video, cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25,
                         {64, 48});
  for (int i = 0; i < 3; ++i) writer.write(Picture(5));
  writer.release();
  Camera camera({video}, clock_);
  const fs::path file = folder_ / "fault.jpg";
  EXPECT_EQ(AskAndWait(camera, file).trouble, "");
  EXPECT_EQ(Head(file, 2), "\xFF\xD8");
  constexpr double kCompression = 12;  // of 255, from what was drawn
  EXPECT_LT(cv::norm(cv::imread(file.string()), Picture(5), cv::NORM_INF), kCompression);
}

TEST_F(Cameras, TellWhatTheyCannotDo) {
  Camera none({(folder_ / "none.avi").string()}, clock_);
  EXPECT_EQ(AskAndWait(none, folder_ / "a.png").trouble, "the camera or its file cannot be opened");
  Camera camera({Sequence(3)}, clock_);
  const std::string nowhere = AskAndWait(camera, folder_ / "nowhere" / "a.png").trouble;
  EXPECT_NE(nowhere.find("No such file or directory"), std::string::npos) << nowhere;
  EXPECT_NE(AskAndWait(camera, folder_ / "a.unknown").trouble, "");
  EXPECT_EQ(AskAndWait(camera, folder_ / "a.png").trouble, "") << "and go on";
}

TEST_F(Cameras, SayWhenAPictureIsLate) {
  Camera camera({Sequence(1), 0ns}, clock_);
  const Snapshot snapshot = AskAndWait(camera, folder_ / "a.png");
  EXPECT_TRUE(snapshot.late);
  EXPECT_EQ(snapshot.trouble, "");
}

TEST_F(Cameras, ThatHangDelayNobody) {
  // A source that is opened for as long as nobody writes to it.
  const std::string pipe = (folder_ / "pipe.avi").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::vector<Snapshot> done;
  {
    Camera camera({pipe}, clock_);
    ASSERT_TRUE(camera.Ask("a.png"));
    ASSERT_TRUE(Until([&] { return camera.Ask("b.png"); })) << "the first is being taken";
    const std::uint64_t before = camera.refused();
    for (int i = 0; i < 1000; ++i) EXPECT_FALSE(camera.Ask("c.png"));
    EXPECT_EQ(camera.refused(), before + 1000);
    EXPECT_TRUE(camera.TakeSnapshots().empty());
    // Every opening ends when somebody opens the other end.
    ASSERT_TRUE(Until([&] {
      if (const int end = ::open(pipe.c_str(), O_WRONLY | O_NONBLOCK); end >= 0) ::close(end);
      for (Snapshot& snapshot : camera.TakeSnapshots()) done.push_back(std::move(snapshot));
      return done.size() == 2;
    }));
  }
  EXPECT_EQ(done[0].file, "a.png");
  EXPECT_EQ(done[1].trouble, "the camera or its file cannot be opened");
}

TEST_F(Cameras, RefuseAPathThatIsTooLong) {
  Camera camera({Sequence(1)}, clock_);
  EXPECT_FALSE(camera.Ask(std::string(Camera::kLongestPath + 1, 'a')));
  EXPECT_EQ(camera.refused(), 1U);
}

}  // namespace
}  // namespace strainwave::bench::camera_test
