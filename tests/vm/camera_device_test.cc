// SPDX-License-Identifier: Apache-2.0
// A camera of the kernel's own (vivid, a test driver): listed, and a picture of it. Skipped without one; in a
// virtual machine that has it: tests/vm/run.sh build/tests/camera_device_test.
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "bench/devices/camera/camera.h"
#include "bench/machines/listing/find_devices.h"
#include "tests/bench/real_time.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::camera_device_test {
namespace {

class CameraDevice : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists("/sys/module/vivid")) {
      GTEST_SKIP() << "no test camera (expected a kernel with the module vivid)";
    }
  }
};

TEST_F(CameraDevice, IsListedOnceThoughItHasTwoDevices) {
  const FoundPart part = FindCameras();
  ASSERT_EQ(part.devices.size(), 1U);
  EXPECT_EQ(part.devices[0].where, "/dev/video0");
  EXPECT_EQ(part.devices[0].what, "vivid");
  EXPECT_TRUE(std::filesystem::exists("/dev/video1"));
  EXPECT_TRUE(part.notes.empty());
}

TEST_F(CameraDevice, GivesAPictureForEachRequest) {
  const daq::ScratchFolder scratch;
  const SteadyBenchClock clock;
  Camera camera({0, std::chrono::minutes(1)}, clock);
  for (const char* name : {"1.jpg", "2.jpg"}) {
    const std::filesystem::path file = scratch.path() / name;
    ASSERT_TRUE(camera.Ask(file.string()));
    std::vector<Snapshot> done;
    ASSERT_TRUE(Until([&] { return done = camera.TakeSnapshots(), !done.empty(); }));
    EXPECT_EQ(done[0].trouble, "");
    const cv::Mat picture = cv::imread(file.string());
    ASSERT_GE(picture.cols, 160) << file;
    cv::Scalar mean, deviation;
    cv::meanStdDev(picture, mean, deviation);
    // Bars of all colours.
    for (int colour = 0; colour < 3; ++colour) EXPECT_GT(deviation[colour], 30.0) << file;
  }
}

}  // namespace
}  // namespace strainwave::bench::camera_device_test
