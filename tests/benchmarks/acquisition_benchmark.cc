// SPDX-License-Identifier: Apache-2.0
// 16 channels at 51.2 kHz, float32, to HDF5 through the recorder: first in real time, then as fast as it
// goes. usage: acquisition_benchmark FOLDER SECONDS [SECONDS_AT_FULL_SPEED]
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <random>
#include <thread>

#include "daq/acquisition/stream_recorder.h"

namespace strainwave::daq::acquisition {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kChannels = 16;
constexpr double kRate_hz = 51200;
constexpr std::uint32_t kBlock = 512;
constexpr std::uint64_t kSecond = static_cast<std::uint64_t>(kRate_hz);
constexpr double kMega = 1e6;

double CpuTime_s() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double PeakMemory_MB() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024 / kMega;
}

SourceDescription Source() {
  SourceDescription source{
      .name = "benchmark", .type = SampleType::kFloat32, .rate_hz = kRate_hz, .most_samples_a_block = kBlock};
  for (std::size_t i = 0; i < kChannels; ++i) {
    source.channels.push_back({.name = fmt::format("accel_{}_m_per_s2", i), .unit = "m/s^2"});
  }
  return source;
}

SampleBlock NoisyBlock() {
  std::mt19937 random(1);
  std::normal_distribution<float> noise;
  SampleBlock block(kChannels * kBlock);
  block.header = {
      .channels = kChannels, .samples = kBlock, .type = SampleType::kFloat32, .rate_hz = kRate_hz};
  for (std::uint32_t& word : block.words()) word = std::bit_cast<std::uint32_t>(noise(random));
  return block;
}

RecorderSettings Settings(const std::filesystem::path& folder, const char* name) {
  return {.folder = folder,
          .name = name,
          .most_rows_a_file = 60 * kSecond,
          .ring_blocks = 500,
          .rows_between_flushes = kSecond};
}

void Stamp(SampleBlock& block, std::uint64_t number) {
  block.header.device_counter = number;
  block.header.device_time =
      std::chrono::nanoseconds(std::llround(static_cast<double>(number) * 1e9 / kRate_hz));
  block.header.arrival = Clock::now().time_since_epoch();
}

void RunInRealTime(const std::filesystem::path& folder, double seconds) {
  StreamRecorder recorder(Settings(folder, "paced"), Source());
  SampleBlock block = NoisyBlock();
  const auto blocks = static_cast<std::uint64_t>(seconds * kRate_hz / kBlock);
  const double cpu_before = CpuTime_s();
  const Clock::time_point begin = Clock::now();
  double early_memory_MB = 0;
  double latest_s = 0;
  for (std::uint64_t i = 0; i < blocks; ++i) {
    const auto due = begin + std::chrono::nanoseconds((i + 1) * kBlock * 1'000'000'000 / kSecond);
    std::this_thread::sleep_until(due);
    latest_s = std::max(latest_s, std::chrono::duration<double>(Clock::now() - due).count());
    Stamp(block, i * kBlock);
    recorder.Push(block);
    if (i == blocks / 4) early_memory_MB = PeakMemory_MB();
  }
  const double cpu_s = CpuTime_s() - cpu_before;
  const double wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  recorder.Finish();
  const RecorderTotals totals = recorder.totals();
  fmt::print(
      "real time, {} s: samples received {} lost {} (a channel), blocks waiting at most {}, files {}\n",
      seconds, totals.samples.received, totals.samples.lost, totals.peak_waiting, totals.files);
  fmt::print(
      "  CPU {:.2f} % of one core; peak memory {:.1f} MB after a quarter, {:.1f} MB at the end; "
      "pacing late by at most {:.1f} ms\n",
      100 * cpu_s / wall_s, early_memory_MB, PeakMemory_MB(), 1e3 * latest_s);
}

void RunAtFullSpeed(const std::filesystem::path& folder, double seconds) {
  StreamRecorder recorder(Settings(folder, "full"), Source());
  SampleBlock block = NoisyBlock();
  const double cpu_before = CpuTime_s();
  const Clock::time_point begin = Clock::now();
  std::uint64_t number = 0;
  while (Clock::now() - begin < std::chrono::duration<double>(seconds)) {
    Stamp(block, number);
    if (recorder.Push(block)) {
      number += kBlock;
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  recorder.Finish();
  const double wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  const double recorded_s = static_cast<double>(number) / kRate_hz;
  fmt::print(
      "full speed, {:.1f} s: {:.1f} x real time with fsync, {:.1f} MB/s, {:.2f} ms of CPU a second of data\n",
      wall_s, recorded_s / wall_s, recorded_s * kRate_hz * kChannels * 4 / kMega / wall_s,
      1e3 * (CpuTime_s() - cpu_before) / recorded_s);
}

int Main(int count, char** arguments) {
  if (count < 3) {
    fmt::print(stderr, "usage: acquisition_benchmark FOLDER SECONDS [SECONDS_AT_FULL_SPEED]\n");
    return 2;
  }
  RunInRealTime(arguments[1], std::atof(arguments[2]));
  if (count > 3) RunAtFullSpeed(arguments[1], std::atof(arguments[3]));
  return 0;
}

}  // namespace
}  // namespace strainwave::daq::acquisition

int main(int count, char** arguments) {
  try {
    return strainwave::daq::acquisition::Main(count, arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 3;
  }
}
