// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/camera/camera.h"

#include <algorithm>
#include <exception>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <span>
#include <stdexcept>
#include <utility>

#include "daq/whole_file.h"

namespace strainwave::bench {

/// Used from the camera's thread. A source that fails is opened again for the next picture.
class Camera::Source {
 public:
  explicit Source(const CameraSettings& settings) : settings_(settings) {}

  /// @throws std::exception saying why there is no picture.
  void Write(const std::filesystem::path& file) {
    const cv::Mat picture = Take();
    std::vector<unsigned char> bytes;
    if (!cv::imencode(file.extension().string(), picture, bytes)) {
      throw std::runtime_error("the picture cannot be packed");
    }
    daq::WriteFileAtomically(file, std::as_bytes(std::span(bytes)));
  }

 private:
  cv::Mat Take() {
    // A camera's driver keeps pictures that were taken before they were asked for.
    constexpr int kKeptByDriver = 4;
    const bool is_camera = std::holds_alternative<int>(settings_.source);
    if (!capture_.isOpened() && !Open()) throw std::runtime_error("the camera or its file cannot be opened");
    cv::Mat picture;
    for (int i = 0; is_camera && i < kKeptByDriver; ++i) capture_.grab();
    if (!capture_.read(picture) || picture.empty()) {
      if (is_camera) capture_.release();
      throw std::runtime_error(is_camera ? "the camera gives no picture" : "the file has no further picture");
    }
    return picture;
  }

  bool Open() {
    if (const int* number = std::get_if<int>(&settings_.source)) return capture_.open(*number, cv::CAP_V4L2);
    const auto& name = std::get<std::string>(settings_.source);
    const bool pictures = name.find('%') != std::string::npos;
    return capture_.open(name, pictures ? cv::CAP_IMAGES : cv::CAP_FFMPEG);
  }

  const CameraSettings& settings_;
  cv::VideoCapture capture_;
};

Camera::Camera(CameraSettings settings, const BenchClock& clock)
    : settings_(std::move(settings)), clock_(clock), thread_([this] { Run(); }) {}

Camera::~Camera() {
  stop_ = true;
  wake_.Call();
  thread_.join();
}

bool Camera::Ask(std::string_view file) noexcept {
  if (waiting_.load(std::memory_order_acquire) || file.size() > path_.size()) {
    ++refused_;
    return false;
  }
  std::ranges::copy(file, path_.begin());
  path_length_ = file.size();
  asked_ = clock_.Now();
  waiting_.store(true, std::memory_order_release);
  wake_.Call();
  return true;
}

std::vector<Snapshot> Camera::TakeSnapshots() {
  const std::lock_guard lock(mutex_);
  return std::exchange(done_, {});
}

void Camera::Run() {
  Source source(settings_);
  while (!stop_) {
    wake_.Wait(std::chrono::hours(1));
    wake_.Take();
    if (!waiting_.load(std::memory_order_acquire)) continue;
    Snapshot snapshot{std::string(path_.data(), path_length_), asked_, {}, false, {}};
    waiting_.store(false, std::memory_order_release);
    try {
      source.Write(snapshot.file);
    } catch (const std::exception& error) {
      snapshot.trouble = error.what();
    }
    snapshot.taken = clock_.Now();
    snapshot.late = snapshot.taken - snapshot.asked > settings_.patience;
    const std::lock_guard lock(mutex_);
    done_.push_back(std::move(snapshot));
  }
}

}  // namespace strainwave::bench
