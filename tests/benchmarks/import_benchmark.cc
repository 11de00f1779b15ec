// SPDX-License-Identifier: Apache-2.0
// How long files of others take to become series of doubles, beside reading their bytes.
//
// usage: import_benchmark FILE...
//
// Each file is read once to have it in the page cache; then its bytes, through a buffer of 1 MiB, and its
// series, in turn, best of three. Peak memory counts the pages of the file that are mapped.
#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "daq/import/foreign_file.h"

namespace {

using Clock = std::chrono::steady_clock;
using strainwave::daq::ForeignChannel;
using strainwave::daq::ForeignFile;

double SecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

enum class Into { kMemory, kOneBuffer };

double ReadBytes_s(const std::filesystem::path& path, Into into) {
  constexpr std::size_t kBuffer_bytes = std::size_t{1} << 20;
  const Clock::time_point begin = Clock::now();
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const std::size_t size = into == Into::kMemory ? std::filesystem::file_size(path) : 0;
  const auto memory = std::make_unique_for_overwrite<char[]>(size + kBuffer_bytes);
  std::size_t at = 0;
  for (ssize_t got = 0; (got = ::read(file, memory.get() + at, kBuffer_bytes)) > 0;) {
    if (into == Into::kMemory) at += static_cast<std::size_t>(got);
  }
  ::close(file);
  return SecondsSince(begin);
}

double PeakMemory_MB() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024e-6;
}

void Measure(const std::filesystem::path& path) {
  constexpr int kRounds = 3;
  double bytes_s = 1e9;
  double buffer_s = 1e9;
  double series_s = 1e9;
  double values = 0.0;
  std::string format;
  ReadBytes_s(path, Into::kOneBuffer);
  for (int round = 0; round < kRounds; ++round) {
    bytes_s = std::min(bytes_s, ReadBytes_s(path, Into::kMemory));
    buffer_s = std::min(buffer_s, ReadBytes_s(path, Into::kOneBuffer));
    const Clock::time_point begin = Clock::now();
    const ForeignFile file = strainwave::daq::ReadForeignFile(path);
    series_s = std::min(series_s, SecondsSince(begin));
    values = 0.0;
    for (const ForeignChannel& channel : file.channels) values += static_cast<double>(channel.size());
    format = file.format;
  }
  const double size_MB = static_cast<double>(std::filesystem::file_size(path)) * 1e-6;
  fmt::print(
      "{}: {}, {:.0f} MB, {:.0f} MB of doubles: bytes {:.3f} s, through a buffer {:.3f} s; series {:.3f} s, "
      "{:.0f} MB/s, "
      "{:.2f} of the speed of the bytes; peak memory {:.0f} MB\n",
      path.filename().string(), format, size_MB, values * 8e-6, bytes_s, buffer_s, series_s,
      size_MB / series_s, bytes_s / series_s, PeakMemory_MB());
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) Measure(argv[i]);
  return 0;
}
