// SPDX-License-Identifier: Apache-2.0
// What a source's reader keeps of its raw samples: while it is asked to, and around a trip.
#include <algorithm>
#include <mutex>
#include <utility>

#include "bench/machines/field/source_reader.h"

namespace strainwave::bench {

using daq::acquisition::SourceDescription;
using daq::acquisition::TriggerKind;
using daq::acquisition::TriggerSettings;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

namespace {

// docs/requirements.md R20. More than a device has under way is not waited for.
constexpr milliseconds kAroundTrip{10'000};
constexpr milliseconds kOnTheWay{500};
constexpr std::size_t kMostAroundTrip_bytes = std::size_t{128} << 20;

}  // namespace

// 16 channels at 51.2 kHz fit.
TriggerSettings SourceReader::AroundTrip(const SourceDescription& source) {
  const std::size_t row_bytes = daq::acquisition::TriggeredCapture::RowBytes(source);
  const auto fit = static_cast<double>(kMostAroundTrip_bytes / row_bytes / 2);
  const double wanted = std::chrono::duration<double>(kAroundTrip).count() * source.rate_hz;
  const auto rows = static_cast<std::uint64_t>(std::min(fit, wanted));
  return {.kind = TriggerKind::kEvent, .before = rows, .after = rows};
}

void SourceReader::StartRecording(const daq::acquisition::RecorderSettings& settings) {
  auto recorder = std::make_unique<daq::acquisition::StreamRecorder>(settings, description_);
  const std::lock_guard lock(mutex_);
  recorder_ = std::move(recorder);
}

std::optional<SourceReader::Recorded> SourceReader::StopRecording() {
  std::unique_ptr<daq::acquisition::StreamRecorder> recorder;
  {
    const std::lock_guard lock(mutex_);
    recorder = std::move(recorder_);
  }
  if (!recorder) return std::nullopt;
  Recorded recorded;
  try {
    recorder->Finish();
  } catch (const std::exception& error) {
    recorded.trouble = error.what();
  }
  recorded.totals = recorder->totals();
  return recorded;
}

void SourceReader::MarkTrip() {
  const std::lock_guard lock(mutex_);
  if (trip_ == Trip::kNone) trip_ = Trip::kMarked;
}

// Of the reader's thread: a trip is seen, and a source that has fallen silent is not waited for any longer.
void SourceReader::FinishAroundTrip() {
  const nanoseconds now = clock_.Now();
  {
    const std::lock_guard lock(mutex_);
    if (trip_ == Trip::kMarked) {
      trip_ = Trip::kSeen;
      tripped_ = now;
      around_trip_.Fire("trip");
    }
  }
  if (!tripped_ || now - *tripped_ < kAroundTrip + kOnTheWay) return;
  around_trip_.Finish([this](daq::acquisition::Capture around) { Deliver(std::move(around)); });
}

void SourceReader::Deliver(daq::acquisition::Capture around) {
  tripped_.reset();
  const std::lock_guard lock(mutex_);
  delivered_ = std::move(around);
  delivery_.notify_all();
}

std::optional<daq::acquisition::Capture> SourceReader::TakeAroundTrip() {
  std::unique_lock lock(mutex_);
  if (trip_ == Trip::kNone) return std::nullopt;
  delivery_.wait_for(lock, kAroundTrip + 2 * kOnTheWay, [this] { return delivered_.has_value(); });
  trip_ = Trip::kNone;
  return std::exchange(delivered_, std::nullopt);
}

}  // namespace strainwave::bench
