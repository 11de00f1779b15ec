// SPDX-License-Identifier: Apache-2.0
// 16 channels at 51.2 kHz, float32, to HDF5 through the recorder: first in real time, then as fast as it
// goes, then so many times as fast as real time, for as long: what it holds of that, it loses nothing of.
// usage: acquisition_benchmark FOLDER SECONDS [SECONDS_AT_FULL_SPEED [TIMES_REAL_TIME...]]
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

SourceDescription Source(double rate_hz) {
  SourceDescription source{
      .name = "benchmark", .type = SampleType::kFloat32, .rate_hz = rate_hz, .most_samples_a_block = kBlock};
  for (std::size_t i = 0; i < kChannels; ++i) {
    source.channels.push_back({.name = fmt::format("accel_{}_m_per_s2", i), .unit = "m/s^2"});
  }
  return source;
}

SampleBlock NoisyBlock(double rate_hz) {
  std::mt19937 random(1);
  std::normal_distribution<float> noise;
  SampleBlock block(kChannels * kBlock);
  block.header = {.channels = kChannels, .samples = kBlock, .type = SampleType::kFloat32, .rate_hz = rate_hz};
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
      std::chrono::nanoseconds(std::llround(static_cast<double>(number) * 1e9 / block.header.rate_hz));
  block.header.arrival = Clock::now().time_since_epoch();
}

// Blocks come in so many times as fast as they would from 16 channels at 51.2 kHz.
void RunPaced(const std::filesystem::path& folder, double seconds, double times) {
  StreamRecorder recorder(Settings(folder, fmt::format("paced_{:g}", times).c_str()),
                          Source(times * kRate_hz));
  SampleBlock block = NoisyBlock(times * kRate_hz);
  const auto blocks = static_cast<std::uint64_t>(times * seconds * kRate_hz / kBlock);
  const std::chrono::duration<double> between(kBlock / kRate_hz / times);
  const double cpu_before = CpuTime_s();
  const Clock::time_point begin = Clock::now();
  double early_memory_MB = 0;
  double latest_s = 0;
  for (std::uint64_t i = 0; i < blocks; ++i) {
    const auto due =
        begin + std::chrono::duration_cast<Clock::duration>(static_cast<double>(i + 1) * between);
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
      "{} times real time, {} s: samples received {} lost {} (a channel), blocks waiting at most {}, files "
      "{}\n",
      times, seconds, totals.samples.received, totals.samples.lost, totals.peak_waiting, totals.files);
  fmt::print(
      "  CPU {:.2f} % of one core; peak memory {:.1f} MB after a quarter, {:.1f} MB at the end; "
      "pacing late by at most {:.1f} ms\n",
      100 * cpu_s / wall_s, early_memory_MB, PeakMemory_MB(), 1e3 * latest_s);
}

void RunAtFullSpeed(const std::filesystem::path& folder, double seconds) {
  StreamRecorder recorder(Settings(folder, "full"), Source(kRate_hz));
  SampleBlock block = NoisyBlock(kRate_hz);
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
    fmt::print(stderr,
               "usage: acquisition_benchmark FOLDER SECONDS [SECONDS_AT_FULL_SPEED [TIMES_REAL_TIME...]]\n");
    return 2;
  }
  const std::filesystem::path folder = arguments[1];
  RunPaced(folder, std::atof(arguments[2]), 1.0);
  if (count > 3) RunAtFullSpeed(folder, std::atof(arguments[3]));
  for (int i = 4; i < count; ++i) RunPaced(folder, std::atof(arguments[3]), std::atof(arguments[i]));
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
