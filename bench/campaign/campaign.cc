// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/campaign.h"

#include <algorithm>
#include <sstream>
#include <system_error>
#include <vector>

#include <fmt/core.h>

#include "bench/campaign/campaign_alarms.h"
#include "bench/configuration/commissioning_file.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/errors/bench_error.h"
#include "bench/utc.h"
#include "daq/record_checks.h"
#include "daq/synced_folder.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace

std::string Difference(const std::string& before, const std::string& after) {
  const std::vector<std::string> old_lines = Lines(before);
  const std::vector<std::string> new_lines = Lines(after);
  // Longest common subsequence; schedules are short.
  const std::size_t n = old_lines.size();
  const std::size_t m = new_lines.size();
  std::vector<std::vector<int>> common(n + 1, std::vector<int>(m + 1, 0));
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t j = m; j-- > 0;) {
      common[i][j] = old_lines[i] == new_lines[j] ? common[i + 1][j + 1] + 1
                                                  : std::max(common[i + 1][j], common[i][j + 1]);
    }
  }
  std::string difference;
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < n || j < m) {
    if (i < n && j < m && old_lines[i] == new_lines[j]) {
      ++i;
      ++j;
    } else if (j == m || (i < n && common[i + 1][j] >= common[i][j + 1])) {
      difference += fmt::format("  line {}: -{}\n", i + 1, old_lines[i]);
      ++i;
    } else {
      difference += fmt::format("  line {}: +{}\n", j + 1, new_lines[j]);
      ++j;
    }
  }
  return difference;
}

namespace {

// Of all files that the bench file names, one after the other.
std::string DeviceFilesSha256(const BenchDescription& bench) {
  std::string all;
  const auto add = [&](const std::filesystem::path& file) {
    if (!file.empty()) all += ReadText(file);
  };
  for (const DeviceDescription& device : bench.devices) add(device.file);
  add(bench.driving_servo.drive.profile);
  add(bench.load_servo.drive.profile);
  return Sha256(all);
}

// The text of a schedule with another number of cycles in the place of its own.
std::string WithCycles(const CampaignInputs& inputs, int cycles) {
  std::string text = inputs.schedule_text;
  const schedules::Origin& origin = inputs.schedule.origins.at("cycles");
  std::size_t at = 0;
  for (int line = 1; line < origin.line; ++line) at = text.find('\n', at) + 1;
  at += static_cast<std::size_t>(origin.column - 1);
  if (text.compare(at, origin.text.size(), origin.text) == 0) {
    text.replace(at, origin.text.size(), std::to_string(cycles));
  }
  return text;
}

// @param frozen  with the campaign's cycles.
[[noreturn]] void RefuseSchedule(const CampaignFolder& folder, const CampaignInputs& frozen,
                                 const CampaignInputs& given, std::string_view or_else) {
  Refuse(folder.root, "the schedule has changed since the start",
         fmt::format("the frozen schedule.yaml; the difference is:\n{}  {}",
                     Difference(WithCycles(frozen, frozen.schedule.cycles), given.schedule_text), or_else));
}

bool SameButForCycles(const CampaignInputs& frozen, const CampaignInputs& given) {
  return WithCycles(frozen, 1) == WithCycles(given, 1);
}

// What is made of a campaign that does not come to be is taken back.
class Beginning {
 public:
  Beginning() = default;
  Beginning(const Beginning&) = delete;
  Beginning& operator=(const Beginning&) = delete;
  ~Beginning() {
    std::error_code gone;
    for (auto made = made_.rbegin(); made != made_.rend(); ++made) std::filesystem::remove(*made, gone);
  }

  void MakeFolder(const std::filesystem::path& folder) {
    if (!std::filesystem::exists(folder)) made_.push_back(folder);
    daq::MakeFolders(folder);
  }
  void WriteFile(const std::filesystem::path& file, const std::string& text) {
    if (!std::filesystem::exists(file)) made_.push_back(file);
    daq::WriteFileAtomically(file, text);
  }
  /// A database that begins anew, with the files that stand beside one in use.
  void MakeDatabase(const std::filesystem::path& file) {
    for (const char* const beside : {"", "-wal", "-shm"}) {
      made_.emplace_back(file.string() + beside);
      std::filesystem::remove(made_.back());
    }
  }
  void Keep() { made_.clear(); }

 private:
  std::vector<std::filesystem::path> made_;
};

// Records that a run reads when its shafts can move already: a damaged file, of which the HDF5 library may
// crash, is found here.
void DemandReadable(const std::filesystem::path& unfinished) {
  for (const auto& entry : std::filesystem::directory_iterator(unfinished)) {
    if (entry.path().extension() == ".h5") daq::DemandReadable(entry.path());
  }
}

}  // namespace

Journal CreateCampaign(const CampaignFolder& folder, const CampaignInputs& inputs) {
  if (std::filesystem::exists(folder.Journal())) {
    Refuse(folder.root, "the folder holds a campaign already", "a new folder, or --resume to go on with it");
  }
  if (std::filesystem::exists(folder.root) && !std::filesystem::is_directory(folder.root)) {
    Refuse(folder.root, "is not a folder", "a new or empty folder");
  }
  Beginning beginning;
  for (const auto& made : {folder.root, folder.Cycles(), folder.Unfinished()}) beginning.MakeFolder(made);
  beginning.WriteFile(folder.Schedule(), inputs.schedule_text);
  beginning.WriteFile(folder.Bench(), inputs.bench_text);
  // What the drives' times to stop were measured to be, so that --resume has it, too; and not that of a bench
  // that a run was killed with before it had its journal.
  const auto commissioned = CommissioningFileOf(inputs.bench.file_name);
  if (std::filesystem::exists(commissioned)) {
    beginning.WriteFile(folder.Commissioned(), ReadText(commissioned));
  } else {
    std::filesystem::remove(folder.Commissioned());
  }
  if (!inputs.plant_text.empty()) beginning.WriteFile(folder.Plant(), inputs.plant_text);
  // The journal appears last: a folder without it is not a campaign yet, and may be begun again.
  const std::filesystem::path aside = folder.root / "campaign.db.new";
  beginning.MakeDatabase(aside);
  {
    Journal journal = Journal::Create(aside);
    Transaction transaction(journal.database());
    journal.SetProperty("format", "1");
    journal.SetProperty("schedule_name", inputs.schedule.name);
    for (const FrozenFile& frozen : FrozenFiles(folder)) {
      const bool there = std::filesystem::exists(frozen.file);
      journal.SetProperty(frozen.property, there ? Sha256OfFile(frozen.file) : "");
    }
    if (!inputs.bench.devices.empty()) {
      journal.SetProperty("bench_folder", inputs.bench_folder.string());
      journal.SetProperty("device_files_sha256", DeviceFilesSha256(inputs.bench));
    }
    journal.SetProperty("started_utc", UtcNow());
    journal.SetProperty(kCycles, std::to_string(inputs.schedule.cycles));
    journal.SetProperty("specimen", inputs.schedule.specimen.identity);
    AddLinks(journal.database(), ChainedRow::kProperty);
    transaction.Commit();
    journal.database().Execute("PRAGMA wal_checkpoint(TRUNCATE)");
  }
  std::filesystem::rename(aside, folder.Journal());
  beginning.Keep();
  daq::SyncFolder(folder.root);
  return Journal::Open(folder.Journal(), Database::Mode::kReadWrite);
}

BenchDescription BenchToResume(const CampaignFolder& folder, const Journal& journal) {
  const BenchDescription frozen = ReadFrozenInputs(folder, journal).bench;
  if (frozen.devices.empty()) return frozen;
  BenchDescription bench = ParseBenchFile(ReadText(folder.Bench()), folder.Bench().string(),
                                          journal.Property("bench_folder").value_or(""));
  if (DeviceFilesSha256(bench) != journal.Property("device_files_sha256")) {
    Refuse(folder.root, "a file that describes a device has changed since the start",
           "the profiles and register maps as they were, beside the bench file in " +
               journal.Property("bench_folder").value_or("its folder"));
  }
  return bench;
}

std::string ExtendCampaign(const CampaignFolder& folder, const CampaignInputs& given, Journal& journal) {
  const CampaignInputs frozen = ReadFrozenInputs(folder, journal);
  if (!SameButForCycles(frozen, given)) RefuseSchedule(folder, frozen, given, {});
  const int before = frozen.schedule.cycles;
  const int cycles = given.schedule.cycles;
  if (cycles <= before) {
    Refuse(folder.root, fmt::format("the schedule has {} cycles, the campaign {}", cycles, before),
           "more, to extend the campaign");
  }
  std::string words = fmt::format("extended from {} to {} cycles", before, cycles);
  Transaction transaction(journal.database());
  journal.SetProperty(kCycles, std::to_string(cycles));
  journal.AddEvent(
      {journal.LatestTime_s(), UtcNow(), journal.LastCompleteCycle() + 1, "", "info", "extended", words});
  transaction.Commit();
  return words;
}

std::optional<ResumePoint> PrepareResume(const CampaignFolder& folder, const CampaignInputs& given,
                                         Journal& journal, const ResumeOrder& order) {
  const CampaignInputs frozen = ReadFrozenInputs(folder, journal);
  const bool unchanged = SameButForCycles(frozen, given);
  if (!unchanged || given.schedule.cycles != frozen.schedule.cycles) {
    const bool more = unchanged && given.schedule.cycles > frozen.schedule.cycles;
    RefuseSchedule(folder, frozen, given, more ? "or --extend, to go on with more cycles" : "");
  }
  if (journal.LastCompleteCycle() >= given.schedule.cycles) return std::nullopt;
  const auto checkpoint = ReadCheckpoint(folder.Checkpoint());
  if (!checkpoint) {
    // Killed before the first phase began: there is nothing to go on from, and nothing to lose.
    // Its first phase is of the preparation, or of cycle 1 where there is none.
    if (journal.Phases(0).empty() && journal.Phases(1).empty()) {
      Transaction transaction(journal.database());
      ReturnAlarmsOfLastRun(journal, journal.LatestTime_s());
      transaction.Commit();
      ResumePoint from_the_start;
      from_the_start.time_s = journal.LatestTime_s();
      return from_the_start;
    }
    Refuse(folder.Checkpoint(), "the checkpoint is missing or damaged",
           "the file that the campaign has written");
  }
  const Moment now = Now();
  ResumePoint point{*checkpoint, PauseBetween(checkpoint->written, now),
                    std::max(checkpoint->time_s, journal.LatestTime_s())};
  const std::optional<double>& pause_s = point.pause.length_s;
  if (!pause_s && !order.accept_pause) {
    Refuse(folder.root, "how long the campaign has stood is not known: " + point.pause.clock,
           "--accept-pause, to go on as after the longest pause and have it noted");
  }
  if (pause_s && *pause_s > given.schedule.resume.longest_pause_s && !order.accept_pause) {
    Refuse(folder.root,
           fmt::format("the campaign has stood for {:.1f} h, longer than resume.longest_pause allows",
                       *pause_s / 3600.0),
           "--accept-pause, to go on all the same and have it noted");
  }
  DemandReadable(folder.Unfinished());
  const int cycle = journal.LastCompleteCycle() + 1;
  Transaction transaction(journal.database());
  std::string cut_phase;
  for (const PhaseRow& row : journal.Phases(cycle)) {
    if (row.outcome != "running") continue;
    double earlier_s = 0.0;
    for (const PhaseRow& other : journal.Phases(cycle)) {
      if (other.step == row.step && other.repeat == row.repeat && other.id < row.id)
        earlier_s += other.credited_load_s;
    }
    const bool same =
        checkpoint->cycle == row.cycle && checkpoint->step == row.step && checkpoint->repeat == row.repeat;
    const double credited_s = same ? std::max(0.0, checkpoint->credited_load_s - earlier_s) : 0.0;
    // Cut between the last checkpoint of a phase and its end in the journal, nothing is missing but that row.
    const bool finished = same && checkpoint->finished;
    journal.EndPhase(row.id, point.time_s, finished ? "complete" : "interrupted", credited_s);
    if (!finished) cut_phase = row.name;
  }
  const std::string cause =
      cut_phase.empty() ? "stopped between two phases or on request" : "the program was cut off";
  const std::string now_utc = UtcText(now.utc_ms);
  ReturnAlarmsOfLastRun(journal, point.time_s);
  journal.AddHole(
      {cycle, cut_phase, point.time_s, UtcText(checkpoint->written.utc_ms), now_utc, cause,
       fmt::format("{}{}; bench time stood still", pause_s ? "" : "length not known: ", point.pause.clock)});
  journal.AddEvent(
      {point.time_s, now_utc, cycle, cut_phase, "info", "resume",
       pause_s ? fmt::format("resumed after {:.1f} s: {}", *pause_s, cause)
               : fmt::format("resumed after a pause of unknown length ({}): {}", point.pause.clock, cause)});
  if (order.restart > 0) {
    journal.AddEvent(
        {point.time_s, now_utc, cycle, cut_phase, "warning", "unattended",
         fmt::format("goes on without a person, {} of the {} times that resume.unattended allows",
                     order.restart, given.schedule.resume.unattended)});
  } else if (given.schedule.resume.operator_acknowledges) {
    journal.AddEvent(
        {point.time_s, now_utc, cycle, cut_phase, "info", "acknowledged",
         fmt::format("{} has ordered --resume, and with it that shafts may move again", order.by)});
  }
  transaction.Commit();
  return point;
}

}  // namespace strainwave::bench
