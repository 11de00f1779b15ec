// SPDX-License-Identifier: Apache-2.0
// The module `strainwave_camera.so`: all that needs OpenCV's video and picture libraries.
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <span>
#include <stdexcept>

#include "bench/devices/camera/picture_source.h"

namespace strainwave::bench {
namespace {

class OpencvPictureSource final : public PictureSource {
 public:
  explicit OpencvPictureSource(std::variant<int, std::string> source) : source_(std::move(source)) {}

  std::vector<std::byte> Take(const std::string& extension) override {
    const cv::Mat picture = Capture();
    std::vector<unsigned char> bytes;
    if (!cv::imencode(extension, picture, bytes)) throw std::runtime_error("the picture cannot be packed");
    const auto packed = std::as_bytes(std::span(bytes));
    return {packed.begin(), packed.end()};
  }

 private:
  cv::Mat Capture() {
    // A camera's driver keeps pictures that were taken before they were asked for.
    constexpr int kKeptByDriver = 4;
    const bool is_camera = std::holds_alternative<int>(source_);
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
    if (const int* number = std::get_if<int>(&source_)) return capture_.open(*number, cv::CAP_V4L2);
    const auto& name = std::get<std::string>(source_);
    const bool pictures = name.find('%') != std::string::npos;
    return capture_.open(name, pictures ? cv::CAP_IMAGES : cv::CAP_FFMPEG);
  }

  std::variant<int, std::string> source_;
  cv::VideoCapture capture_;
};

}  // namespace
}  // namespace strainwave::bench

extern "C" strainwave::bench::PictureSource* StrainwaveMakePictureSource(
    const std::variant<int, std::string>& source) {
  return new strainwave::bench::OpencvPictureSource(source);
}
