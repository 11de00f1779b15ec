// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/stream_recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <stdexcept>

namespace strainwave::daq::acquisition {
namespace {

const RecorderSettings& Checked(const RecorderSettings& settings) {
  if (settings.name.empty() || settings.name.find('/') != std::string::npos) {
    throw std::invalid_argument(fmt::format("name = '{}' cannot name a file", settings.name));
  }
  if (settings.most_rows_a_file == 0) throw std::invalid_argument("most_rows_a_file = 0 is not above zero");
  if (settings.rows_between_flushes == 0) {
    throw std::invalid_argument("rows_between_flushes = 0 is not above zero");
  }
  return settings;
}

std::uint64_t HighestNumber(const std::filesystem::path& folder, const std::string& name) {
  // Made once: to make one writes a cache of the locale, which two threads would do without a lock.
  static const std::regex kNumbered(R"(\.?(.*)-(\d{6,12})\.h5(\.partial)?)");
  std::uint64_t highest = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string file = entry.path().filename().string();
    std::smatch match;
    if (std::regex_match(file, match, kNumbered) && match[1] == name) {
      highest = std::max<std::uint64_t>(highest, std::stoull(match[2]));
    }
  }
  return highest;
}

}  // namespace

StreamRecorder::StreamRecorder(const RecorderSettings& settings, SourceDescription source)
    : settings_(Checked(settings)),
      source_(std::move(source)),
      ring_(settings_.ring_blocks, SampleBlock(source_.channels.size() * source_.most_samples_a_block)),
      ledger_({.bits = source_.counter_bits}, source_.rate_hz),
      next_number_(HighestNumber(settings_.folder, settings_.name) + 1) {
  // Here, so that a folder that cannot be written to is known before anything runs.
  file_ = std::make_unique<StreamFileWriter>(NextPath(), source_, settings_.attributes);
  writer_ = std::thread([this] { Write(); });
}

StreamRecorder::~StreamRecorder() {
  try {
    Finish();
  } catch (...) {
    // Who wants to know calls Finish().
    static_cast<void>(failure_);
  }
}

std::filesystem::path StreamRecorder::NextPath() {
  return settings_.folder / fmt::format("{}-{:06}.h5", settings_.name, next_number_++);
}

bool StreamRecorder::Push(const SampleBlock& block) {
  SampleBlock* const slot = ring_.BeginWrite();
  if (slot == nullptr) {
    refused_ = block.header;
    return false;
  }
  slot->CopyFrom(block);
  refused_.reset();
  ring_.EndWrite();
  doorbell_.fetch_add(1, std::memory_order_release);
  doorbell_.notify_one();
  return true;
}

template <typename Call>
void StreamRecorder::Guarded(Call call) noexcept {
  if (failure_) return;
  try {
    call();
  } catch (...) {
    failure_ = std::current_exception();
    has_failed_.store(true, std::memory_order_release);
  }
}

void StreamRecorder::CloseFile() {
  file_->Close();
  file_.reset();
  const std::scoped_lock lock(totals_mutex_);
  ++totals_.files;
}

void StreamRecorder::WriteBlock(SampleBlock& block) noexcept {
  const std::optional<Gap> gap = ledger_.Admit(block);
  Guarded([&] {
    if (file_->rows() >= settings_.most_rows_a_file) {
      CloseFile();
      file_ = std::make_unique<StreamFileWriter>(NextPath(), source_, settings_.attributes);
    }
    file_->Append(block, gap);
    unflushed_rows_ += block.header.samples;
    if (unflushed_rows_ < settings_.rows_between_flushes) return;
    file_->Flush();
    unflushed_rows_ = 0;
  });
}

void StreamRecorder::Write() noexcept {
  while (true) {
    const std::uint32_t rung = doorbell_.load(std::memory_order_acquire);
    const bool ends = ends_.load(std::memory_order_acquire);
    while (SampleBlock* const block = ring_.BeginRead()) {
      const std::uint64_t waiting = ring_.unread();
      WriteBlock(*block);
      const std::uint32_t samples = block->header.samples;
      ring_.EndRead();
      const std::scoped_lock lock(totals_mutex_);
      totals_.samples = ledger_.totals();
      totals_.peak_waiting = std::max(totals_.peak_waiting, waiting);
      if (failure_) totals_.not_written += samples;
    }
    if (ends) break;
    doorbell_.wait(rung, std::memory_order_acquire);
  }
  Guarded([this] {
    if (refused_) {
      if (const std::optional<Gap> gap = ledger_.EndAfter(*refused_)) file_->AppendGap(*gap);
    }
    CloseFile();
  });
  const std::scoped_lock lock(totals_mutex_);
  totals_.samples = ledger_.totals();
}

void StreamRecorder::Finish() {
  if (writer_.joinable()) {
    ends_.store(true, std::memory_order_release);
    doorbell_.fetch_add(1, std::memory_order_release);
    doorbell_.notify_one();
    writer_.join();
    file_.reset();
  }
  if (failure_) std::rethrow_exception(failure_);
}

RecorderTotals StreamRecorder::totals() const {
  const std::scoped_lock lock(totals_mutex_);
  RecorderTotals totals = totals_;
  totals.blocks_without_room = ring_.overruns();
  return totals;
}

}  // namespace strainwave::daq::acquisition
