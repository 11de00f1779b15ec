// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/can/candump_log.h"

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <exception>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace strainwave::bench {

using std::chrono::microseconds;
using std::chrono::nanoseconds;
namespace fs = std::filesystem;

CandumpFiles::CandumpFiles(CandumpLogSettings settings) : settings_(std::move(settings)) {
  fs::create_directories(settings_.folder);
}

bool CandumpFiles::Fail(const std::string& what) {
  trouble_ = fmt::format("{}: {}", what, std::generic_category().message(errno));
  file_.reset();
  return false;
}

// The names sort as the files were begun.
void CandumpFiles::RemoveOldest() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(settings_.folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(settings_.interface + "-") && name.ends_with(".log")) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (std::size_t i = 0; i + settings_.most_files < files.size(); ++i) {
    std::error_code none;
    fs::remove(files[i], none);
  }
}

bool CandumpFiles::Begin(microseconds time) {
  const std::time_t seconds = std::chrono::floor<std::chrono::seconds>(time).count();
  const fs::path name = settings_.folder / fmt::format("{}-{:%Y%m%d-%H%M%S}-{:04}.log", settings_.interface,
                                                       fmt::gmtime(seconds), ++number_);
  file_.reset(std::fopen(name.c_str(), "we"));
  if (!file_) return Fail(name.string());
  bytes_ = 0;
  names_.push_back(name);
  if (names_.size() > 2) names_.pop_front();
  RemoveOldest();
  return true;
}

bool CandumpFiles::Write(const protocols::LoggedFrame& logged) {
  const std::lock_guard lock(mutex_);
  if (!trouble_.empty()) return false;
  try {
    if ((!file_ || bytes_ >= settings_.most_file_bytes) && !Begin(logged.time)) return false;
    const std::string line = protocols::CandumpLine(logged) + '\n';
    bytes_ += line.size();
    return std::fputs(line.c_str(), file_.get()) >= 0 || Fail(names_.back().string());
  } catch (const std::exception& error) {
    // A folder that cannot be listed, no memory: on this thread it would end the program under load.
    trouble_ = error.what();
    file_.reset();
    return false;
  }
}

void CandumpFiles::Flush() {
  const std::lock_guard lock(mutex_);
  if (file_ && std::fflush(file_.get()) != 0) Fail(names_.back().string());
}

void CandumpFiles::Keep(const fs::path& stem) {
  const std::lock_guard lock(mutex_);
  if (file_ && std::fflush(file_.get()) != 0) Fail(names_.back().string());
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const bool is_newest = i + 1 == names_.size();
    const fs::path kept =
        fmt::format("{}.{}{}.log", stem.string(), settings_.interface, is_newest ? "" : ".before");
    std::error_code error;
    // A second name keeps the file when its first one goes. Not every file system has that.
    fs::create_hard_link(names_[i], kept, error);
    if (error) fs::copy_file(names_[i], kept, fs::copy_options::overwrite_existing, error);
    if (error && trouble_.empty()) trouble_ = fmt::format("{}: {}", kept.string(), error.message());
  }
}

std::string CandumpFiles::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

CandumpLog::CandumpLog(CanBus& listener, const BenchClock& clock, const CandumpLogSettings& settings)
    : listener_(listener),
      interface_(settings.interface),
      utc_of_zero_(std::chrono::system_clock::now().time_since_epoch() - clock.Now()),
      files_(settings) {
  // What has waited in the listener since it was made is older than the log, and may have holes.
  ReceivedFrame older;
  while (listener_.Receive(older)) continue;
  lost_before_ = listener_.lost_frames();
  thread_ = std::thread([this] { Run(); });
}

CandumpLog::~CandumpLog() {
  ending_ = true;
  thread_.join();
}

void CandumpLog::Run() {
  constexpr std::chrono::milliseconds kLook{5};
  while (!ending_) {
    Drain();
    std::this_thread::sleep_for(kLook);
  }
  Drain();
}

void CandumpLog::Drain() {
  ReceivedFrame received;
  bool any = false;
  while (listener_.Receive(received)) {
    const auto time = std::chrono::floor<microseconds>(utc_of_zero_ + received.time);
    if (files_.Write({time, interface_, received.frame})) {
      ++frames_;
    } else {
      ++unwritten_;
    }
    any = true;
  }
  if (any) files_.Flush();
  lost_ = unwritten_ + listener_.lost_frames() - lost_before_;
}

}  // namespace strainwave::bench
