// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace strainwave::bench {

/// A camera or a file of pictures, as OpenCV opens it.
class PictureSource {
 public:
  virtual ~PictureSource() = default;
  /// The next picture, packed as the extension says (".jpg", ".png"). A source that failed is opened again.
  /// @throws std::exception saying why there is no picture.
  virtual std::vector<std::byte> Take(const std::string& extension) = 0;
};

/// A source out of the module `strainwave_camera.so`, which is loaded at the first call: the video libraries
/// behind OpenCV are 170 further shared objects, which would cost every start of the program half a second
/// and 50 MB.
/// @param source  number of a camera of this machine, or a video file or numbered pictures.
/// @throws std::runtime_error where the module cannot be loaded.
std::unique_ptr<PictureSource> MakePictureSource(const std::variant<int, std::string>& source);

}  // namespace strainwave::bench
