// SPDX-License-Identifier: Apache-2.0
#include "bench/plots/gnuplot.h"

#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "bench/plots/child_program.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

void RunScript(const std::string& program, const std::string& script) {
  ChildEnd end;
  try {
    // As a file by name: what it is merely fed, gnuplot reads a byte at a time.
    end = RunChild({program, "/dev/stdin"}, script);
  } catch (const std::system_error& error) {
    throw GnuplotError(fmt::format("{} could not be run: {}", program, error.what()));
  }
  if (end.error != 0) {
    throw GnuplotError(fmt::format("{} could not be started: {} (expected the package gnuplot-nox)", program,
                                   std::strerror(end.error)));
  }
  if (end.signal != 0)
    throw GnuplotError(fmt::format("{} was ended by signal {}: {}", program, end.signal, end.said));
  if (end.exit_code != 0)
    throw GnuplotError(fmt::format("{} ended with exit code {}: {}", program, end.exit_code, end.said));
}

fs::path WithSuffix(const fs::path& stem, std::string_view suffix) {
  fs::path path = stem;
  path += suffix;
  return path;
}

std::string BytesOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Whether there is a picture of that name which is not this one.
bool HoldsAnother(const fs::path& name, const fs::path& svg, const fs::path& png) {
  const auto differs = [&](std::string_view ending, const fs::path& file) {
    const fs::path there = WithSuffix(name, ending);
    return fs::exists(there) && BytesOf(there) != BytesOf(file);
  };
  return differs(".svg", svg) || differs(".png", png);
}

}  // namespace

fs::path RenderPictureWith(const std::string& program, const std::string& script, const fs::path& stem,
                           PictureSize size) {
  if (stem.has_parent_path()) {
    fs::create_directories(stem.parent_path());
  }
  const fs::path svg = WithSuffix(stem, ".svg.part");
  const fs::path png = WithSuffix(stem, ".png.part");
  // One terminal counts type in pixels, the other in points: the scale makes one script serve both.
  const std::string both = fmt::format(
      "set encoding utf8\n"
      "set terminal svg size {0},{1} font 'sans-serif,15' rounded background rgb 'white' noenhanced\n"
      "set output {2}\n{4}\nunset output\n"
      "reset\n"
      "set terminal pngcairo size {0},{1} font 'sans-serif,15' fontscale 0.75 rounded background rgb 'white' "
      "noenhanced\n"
      "set output {3}\n{4}\nunset output\n",
      size.width_px, size.height_px, Quoted(svg.string()), Quoted(png.string()), script);
  try {
    RunScript(program, both);
    for (const fs::path& part : {svg, png}) {
      if (!fs::exists(part) || fs::file_size(part) == 0) {
        throw GnuplotError(fmt::format("{} left no picture at {}", program, part.string()));
      }
    }
  } catch (const GnuplotError&) {
    std::error_code ignored;
    fs::remove(svg, ignored);
    fs::remove(png, ignored);
    throw;
  }
  fs::path name = stem;
  for (int number = 2; HoldsAnother(name, svg, png); ++number)
    name = WithSuffix(stem, fmt::format("_{}", number));
  fs::rename(svg, WithSuffix(name, ".svg"));
  fs::rename(png, WithSuffix(name, ".png"));
  return name;
}

fs::path RenderPicture(const std::string& script, const fs::path& stem, PictureSize size) {
  return RenderPictureWith("gnuplot", script, stem, size);
}

}  // namespace strainwave::bench
