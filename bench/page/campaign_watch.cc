// SPDX-License-Identifier: Apache-2.0
#include "bench/page/campaign_watch.h"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <utility>

#include <fmt/core.h>

#include "bench/campaign/campaign.h"
#include "bench/page/http_text.h"

namespace strainwave::bench {
namespace {

constexpr std::chrono::milliseconds kLookInterval{100};
// How often a folder is tried again that could not be read.
constexpr std::chrono::seconds kRetry{1};
constexpr int kEventsKept = 100;

// By which a file is known, wherever it has been moved to.
using FileIdentity = std::pair<dev_t, ino_t>;

std::optional<FileIdentity> IdentityOf(const std::filesystem::path& file) {
  struct stat found {};
  if (::stat(file.c_str(), &found) != 0) return std::nullopt;
  return FileIdentity{found.st_dev, found.st_ino};
}

}  // namespace

struct CampaignWatch::Opened {
  explicit Opened(const CampaignFolder& folder)
      : identity(IdentityOf(folder.Journal())),
        journal(OpenCampaign(folder, Database::Mode::kReadOnly)),
        inputs(ReadFrozenInputs(folder, journal)),
        campaign(journal.Identity()),
        has_camera(std::ranges::any_of(inputs.bench.devices, [](const DeviceDescription& device) {
          return device.kind == DeviceDescription::Kind::kCamera;
        })) {}

  // What the journal says, read anew where it has changed: a few times a cycle.
  void ReadJournal(const CampaignFolder& folder) {
    const std::int64_t version = DataVersion();
    if (version == data_version) return;
    // More cycles for the same campaign: the journal has them.
    if (const auto cycles = journal.Property(kCycles); cycles != cycles_property) {
      inputs = ReadFrozenInputs(folder, journal);
      cycles_property = cycles;
    }
    progress = JournalProgressOf(journal, inputs);
    events = journal.EventsAfter(0, kEventsKept);
    // Of all phases: those of complete cycles are added up once.
    if (progress.last_complete > credited_cycles) {
      credited_s +=
          journal.CreditedLoad_s(credited_cycles + 1) - journal.CreditedLoad_s(progress.last_complete + 1);
      credited_cycles = progress.last_complete;
    }
    data_version = version;
  }

  // Another with every change by another process.
  std::int64_t DataVersion() const {
    Statement statement = journal.database().Prepare("PRAGMA data_version");
    statement.Step();
    return statement.Integer(0);
  }

  std::optional<FileIdentity> identity;
  Journal journal;
  CampaignInputs inputs;
  std::uint64_t campaign;
  bool has_camera;
  PictureWatch pictures;
  std::optional<std::string> cycles_property{journal.Property(kCycles)};
  std::int64_t data_version{-1};
  JournalProgress progress;
  std::vector<Event> events;  // the newest, oldest first
  int credited_cycles{-1};
  double credited_s{};  // in those
};

CampaignWatch::CampaignWatch(const CampaignFolder& folder)
    : folder_(folder), opened_(std::make_unique<Opened>(folder)), newest_(Read()) {}

CampaignWatch::~CampaignWatch() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  stopping_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void CampaignWatch::Begin(std::function<void()> changed) {
  changed_ = std::move(changed);
  thread_ = std::thread([this] { Watch(); });
}

WatchedCampaign CampaignWatch::Newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

CampaignSnapshot CampaignWatch::Snapshot() const {
  const std::lock_guard lock(mutex_);
  return newest_.snapshot;
}

bool CampaignWatch::IsInPlace() const { return IdentityOf(folder_.Journal()) == opened_->identity; }

WatchedCampaign CampaignWatch::Read() {
  if (opened_ && !IsInPlace()) opened_.reset();
  if (!opened_) opened_ = std::make_unique<Opened>(folder_);
  Opened& opened = *opened_;
  opened.ReadJournal(folder_);
  WatchedCampaign read;
  CampaignSnapshot& snapshot = read.snapshot;
  snapshot.campaign = std::filesystem::weakly_canonical(folder_.root).filename().string();
  snapshot.specimen = opened.inputs.schedule.specimen.identity;
  snapshot.progress = ProgressOf(folder_, opened.progress, opened.inputs);
  // A run that has ended since the journal was read is not one that is gone without a word.
  if (snapshot.progress.process == 0 && opened.DataVersion() != opened.data_version) {
    opened.ReadJournal(folder_);
    snapshot.progress = ProgressOf(folder_, opened.progress, opened.inputs);
  }
  snapshot.run = RunId(opened.campaign, opened.progress.run_begun, snapshot.progress.process);
  snapshot.view = ViewOf(snapshot.progress, opened.progress.run_begun.has_value());
  // Of a phase under way the checkpoint knows more than the journal; that is in the progress.
  snapshot.credited_load_s = opened.credited_s + snapshot.progress.credited_load_s;
  read.events = opened.events;
  snapshot.has_camera = opened.has_camera;
  if (opened.has_camera) snapshot.picture = opened.pictures.Look(folder_, snapshot.progress.complete);
  snapshot.last_event = read.events.empty() ? 0 : read.events.back().id;
  return read;
}

WatchedCampaign CampaignWatch::Look() {
  try {
    return Read();
  } catch (const std::exception& error) {
    // Whatever has become of the folder, it is told and tried again.
    opened_.reset();
    WatchedCampaign read = Newest();
    read.snapshot.view = BenchView::kUnreadable;
    read.snapshot.trouble = fmt::format("the campaign's folder cannot be read: {}", error.what());
    read.snapshot.progress.live.clear();
    read.snapshot.progress.live_taken.reset();
    return read;
  }
}

void CampaignWatch::Watch() {
  std::string told;
  std::unique_lock lock(mutex_);
  while (!stop_) {
    lock.unlock();
    WatchedCampaign read = Look();
    const bool readable = read.snapshot.view != BenchView::kUnreadable;
    // By what is told at one fixed moment: ages alone are no change.
    std::string state = JsonText(StateJson(read.snapshot, Moment{}));
    const auto taken = read.snapshot.progress.live_taken;
    state += fmt::format(" {} {}", taken ? taken->utc_ms : 0, read.snapshot.last_event);
    const bool changed = state != told;
    told = std::move(state);
    lock.lock();
    read.version = newest_.version + (changed ? 1 : 0);
    newest_ = std::move(read);
    version_ = newest_.version;
    lock.unlock();
    if (changed) changed_();
    lock.lock();
    stopping_.wait_for(lock, readable ? kLookInterval : kRetry, [this] { return stop_; });
  }
}

}  // namespace strainwave::bench
