// SPDX-License-Identifier: Apache-2.0
#include <sndfile.h>

#include <array>
#include <cstdint>
#include <fstream>
#include <memory>
#include <string_view>

#include <fmt/format.h>

#include "daq/import/foreign_file.h"
#include "daq/record_error.h"
#include "daq/record_limits.h"

namespace strainwave::daq {
namespace {

struct CloseSound {
  void operator()(SNDFILE* file) const { sf_close(file); }
};

std::uint32_t Little(const char* bytes) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8U | static_cast<unsigned char>(bytes[i]);
  return value;
}

// The library shortens what a WAV file says to what is there, without a word.
void CheckDataChunk(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 12> head{};
  file.read(head.data(), head.size());
  if (!file || std::string_view(head.data(), 4) != "RIFF") return;
  const std::uint64_t size = std::filesystem::file_size(path);
  constexpr std::uint32_t kStreamed = 0xFFFFFFFF;  // a recorder that never knew
  constexpr int kMostChunks = 10'000;              // a recorder writes a dozen
  int chunks = 0;
  for (std::uint64_t at = head.size(); at + 8 <= size;) {
    if (++chunks > kMostChunks)
      throw RecordError(fmt::format("{}: byte {}", path.string(), at),
                        fmt::format("{} chunks come before the samples", kMostChunks),
                        "fewer of them, as recorders write");
    std::array<char, 8> chunk{};
    file.seekg(static_cast<std::streamoff>(at));
    file.read(chunk.data(), chunk.size());
    const std::uint64_t bytes = Little(chunk.data() + 4);
    if (std::string_view(chunk.data(), 4) == "data") {
      if (bytes != kStreamed && at + 8 + bytes > size)
        throw RecordError(
            fmt::format("{}: byte {}", path.string(), at),
            fmt::format("the file is cut off: {} of {} bytes of samples are there", size - at - 8, bytes),
            "a whole file");
      return;
    }
    at += 8 + bytes + bytes % 2;
  }
}

}  // namespace

ForeignFile ReadAudioFile(const std::filesystem::path& path) {
  CheckDataChunk(path);
  SF_INFO info{};
  const std::unique_ptr<SNDFILE, CloseSound> sound(sf_open(path.c_str(), SFM_READ, &info));
  if (!sound)
    throw RecordError(path.string(), fmt::format("cannot be read: {}", sf_strerror(nullptr)), "WAV or FLAC");
  const auto channels = static_cast<std::size_t>(info.channels);
  const auto frames = static_cast<std::size_t>(info.frames);
  if (info.frames <= 0) throw RecordError(path.string(), "has no samples", "a record");
  if (frames > kMostValues / channels)
    throw RecordError(path.string(), fmt::format("{} samples of {} channels", frames, channels),
                      fmt::format("{} values at most", kMostValues));
  const int coding = info.format & SF_FORMAT_SUBMASK;
  const bool floats = coding == SF_FORMAT_FLOAT || coding == SF_FORMAT_DOUBLE;
  ForeignFile file;
  file.format = (info.format & SF_FORMAT_TYPEMASK) == SF_FORMAT_FLAC ? "FLAC" : "WAV";
  file.dialect.emplace_back(floats ? "numbers with a point, as they stand"
                                   : "whole numbers; full scale is 1");
  for (std::size_t c = 0; c < channels; ++c)
    file.channels.push_back({.name = std::to_string(c + 1),
                             .unit = floats ? "" : "full scale",
                             .values = {},
                             .words = {},
                             .sample_rate_hz = info.samplerate});
  constexpr std::size_t kTogether = 8192;
  std::vector<double> block(kTogether * channels);
  for (std::size_t at = 0; at < frames;) {
    const sf_count_t got = sf_readf_double(sound.get(), block.data(), static_cast<sf_count_t>(kTogether));
    if (got <= 0)
      throw RecordError(path.string(),
                        fmt::format("the file is cut off: {} of {} samples are there", at, frames),
                        "a whole file");
    for (std::size_t i = 0; i < static_cast<std::size_t>(got); ++i) {
      for (std::size_t c = 0; c < channels; ++c) file.channels[c].values.push_back(block[i * channels + c]);
    }
    at += static_cast<std::size_t>(got);
  }
  return file;
}

}  // namespace strainwave::daq
