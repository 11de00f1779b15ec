// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/camera/camera.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <utility>

#include "bench/devices/camera/picture_source.h"
#include "daq/whole_file.h"

namespace strainwave::bench {

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
  std::unique_ptr<PictureSource> source;
  while (!stop_) {
    wake_.Wait(std::chrono::hours(1));
    wake_.Take();
    if (!waiting_.load(std::memory_order_acquire)) continue;
    Snapshot snapshot{std::string(path_.data(), path_length_), asked_, {}, false, {}};
    waiting_.store(false, std::memory_order_release);
    try {
      if (!source) source = MakePictureSource(settings_.source);
      daq::WriteFileAtomically(snapshot.file, source->Take(snapshot.file.extension().string()));
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
