// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace strainwave::bench {

/// gnuplot is missing, or refused a script; the message carries what gnuplot wrote on its standard error.
class GnuplotError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Size of a picture. SVG takes it in user units, so both files look the same.
struct PictureSize {
  int width_px{1200};
  int height_px{800};
};

/// Draws `script` with gnuplot into `stem`.svg and `stem`.png. Each file is written aside and renamed, so it
/// appears whole or not at all; the folder of `stem` is made when it is missing. A picture that is there
/// already is never overwritten by another one, which then is `stem`_2.
///
/// @param script  gnuplot commands with inline data; no `set terminal` and no `set output`.
/// @return the picture's path without ending.
/// @throws GnuplotError if gnuplot cannot be started, ends with an error, or leaves no picture.
/// @throws std::filesystem::filesystem_error if the folder or a file cannot be written.
std::filesystem::path RenderPicture(const std::string& script, const std::filesystem::path& stem,
                                    PictureSize size = {});

/// The same with another program in gnuplot's place.
std::filesystem::path RenderPictureWith(const std::string& program, const std::string& script,
                                        const std::filesystem::path& stem, PictureSize size = {});

}  // namespace strainwave::bench
