// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/alarms/alarm_list.h"
#include "bench/campaign/database.h"
#include "bench/campaign/journal_chain.h"

namespace strainwave::bench {

/// One number of one cycle, in the unit that its quantity's name ends in.
struct Result {
  std::string quantity;  // "k1_Nm_per_rad", "e_max_arcmin", …
  double value{};
  double standard_error{};
  std::string flag;  // empty: good; else why not, in words
};

struct PhaseRow {
  std::int64_t id{};
  int cycle{};
  int step{};     // place in the cycle
  int repeat{};   // measurement taken again after a failed check
  int attempt{};  // of the same step after an interruption
  std::string name;
  std::string kind;
  double started_s{};
  double ended_s{};
  std::string outcome;  // running, complete, interrupted, suspended, pause, quick_stop, shutdown, fault
  double credited_load_s{};
};

/// One result of a complete cycle, and when that ended.
struct CycleResult {
  int cycle{};
  double ended_s{};
  Result result;
};

/// How far a journal goes: the numbers of its last rows.
struct JournalEnd {
  std::int64_t phase{};
  std::int64_t event{};
};

struct CycleRow {
  int cycle{};
  std::string outcome;  // running, complete
  double started_s{};
  double ended_s{};
};

struct Event {
  double time_s{};
  std::string utc;
  int cycle{};
  std::string phase;
  std::string severity;  // info, warning, alarm
  std::string code;
  std::string text;
  std::int64_t id{};  // as the journal has numbered it; it gives one itself to those that are added
};

struct Calibration {
  std::string name;
  double value{};
  double standard_error{};
  std::string unit;
  std::string source;
};

/// A channel of the bench that gives no value, for as long as that lasts (docs/requirements.md R22).
struct ChannelTrouble {
  std::string channel;
  std::string reason;
  std::string since_utc;

  bool operator==(const ChannelTrouble&) const = default;
};

/// What was done about an alarm instance, when and by whom; nobody: by itself.
struct AlarmAction {
  std::int64_t number{};  // of the instance
  std::string utc;
  std::string by;
  std::string action;  // acknowledge, confirm, comment, shelve, unshelve, shelf_over
  std::string text;
};

struct OperatorNote {
  std::string utc;
  std::string author;
  std::string text;
};

/// What a file was when it was registered.
struct FileDigest {
  std::uint64_t bytes{};
  std::string sha256;
};

/// Time in which the bench was not under the program's eye (docs/requirements.md R11).
struct Hole {
  int cycle{};
  std::string phase;
  double time_s{};  // bench time at which it opened
  std::string start_utc;
  std::string end_utc;
  std::string cause;
  std::string clock;
};

/// Property: the campaign's cycles, those that it was extended by among them.
inline constexpr const char* kCycles = "cycles";

/// Which pages of a journal are compared with their checksums: all before the first is used, or each as it is
/// read. A damaged one that nothing reads goes unnoticed in the second case.
enum class PagesChecked { kAll, kAsRead };

/// The campaign's journal, `campaign.db`: what was done, when, with which outcome, and every result.
/// Times in seconds are bench time, which stands still while the program does not run; `utc` is for people.
/// Every page carries a checksum (`page_checksums.h`) but in journals of earlier versions of this program.
class Journal {
 public:
  /// "SWAV": tells a campaign from any other SQLite file.
  static constexpr int kApplicationId = 0x53574156;
  static constexpr int kVersion = 2;

  /// A new journal. @throws DatabaseError.
  static Journal Create(const std::filesystem::path& file);
  /// Looks at every page of the file first, by a descriptor of its own: not in a process that has the journal
  /// open already, since closing any descriptor of a file lets go of all locks that the process has on it
  /// (POSIX fcntl), SQLite's too.
  /// @throws DatabaseError when the file is missing, damaged, or not a journal of this program.
  static Journal Open(const std::filesystem::path& file, Database::Mode mode);

  /// Its pages are looked at as they are read, and not all at first. It must exist.
  static Journal OpenAsRead(const std::filesystem::path& file,
                            Database::Mode mode = Database::Mode::kReadOnly);

  const Database& database() const { return database_; }
  /// What of the file no checksum covers, in words; empty: nothing.
  std::string Unchecked() const;
  JournalEnd end() const { return end_; }
  /// The latest bench time in any row: no later run begins before it.
  double LatestTime_s() const;
  /// Tells one campaign from another, also of the same schedule.
  std::uint64_t Identity() const;

  void SetProperty(std::string_view key, std::string_view value);
  std::optional<std::string> Property(std::string_view key) const;

  void BeginCycle(int cycle, double time_s);
  /// @param records_sha256  of the cycle's file; empty where there is none.
  void EndCycle(int cycle, double time_s, std::string_view outcome, std::string_view records_sha256 = {});
  std::vector<CycleRow> Cycles() const;
  /// As given when the cycle ended; empty without one, and in journals of earlier versions.
  std::string RecordsSha256(int cycle) const;
  int LastCompleteCycle() const;  // −1: none
  /// Bench time from one of the newest complete cycles to the next, with retries and suspensions, without the
  /// preparation. Nothing while fewer than `fewest` are complete.
  std::optional<double> MeanCycle_s(int newest, int fewest) const;

  std::int64_t BeginPhase(const PhaseRow& row);
  void EndPhase(std::int64_t id, double time_s, std::string_view outcome, double credited_load_s);
  std::vector<PhaseRow> Phases(int cycle) const;
  /// Credited in all phases from one cycle on.
  double CreditedLoad_s(int first_cycle) const;

  void AddResults(int cycle, int repeat, const std::vector<Result>& results);
  /// Replaces what the cycle's earlier attempt at storing has left.
  void ClearResults(int cycle);
  std::vector<Result> Results(int cycle, int repeat) const;
  /// Calls `take` with the results of complete cycles whose quantity begins with `prefix`, in the order of
  /// cycles, until it returns false.
  void ForEachResult(std::string_view prefix, const std::function<bool(const CycleResult&)>& take,
                     int first_cycle = 1) const;
  /// The same for some quantities by their whole names, from one complete cycle to another. A result without
  /// a value is left out.
  void ForEachResultOf(std::span<const std::string> quantities, int first_cycle, int last_cycle,
                       const std::function<void(const CycleResult&)>& take) const;
  /// One quantity in the last complete cycles from 1 on that have it, at most `count`, newest last.
  std::vector<Result> NewestResults(std::string_view quantity, std::size_t count) const;
  std::vector<int> RepeatsOf(int cycle) const;

  void AddEvent(const Event& event);
  std::vector<Event> Events(int newest) const;
  /// The newest that no person has asked for (severity "action"): what the bench did last.
  std::optional<Event> LastEventOfBench() const;
  /// The newest of those that came after the one with that number, at most `most`; oldest first.
  std::vector<Event> EventsAfter(std::int64_t id, int most) const;
  /// Since the campaign was last resumed or complete, however many events ago that is; newest first.
  std::vector<Event> OpenAlarms() const;
  /// Those that are open, and those raised or returned since then; oldest first. A journal of an earlier
  /// version, opened to be read, gives its open alarms.
  std::vector<AlarmInstance> Alarms(double since_s) const;
  /// A new one gets its number.
  void StoreAlarm(AlarmInstance& instance);
  void AddAlarmAction(const AlarmAction& action);
  /// Of all instances, in the order of time.
  std::vector<AlarmAction> AlarmActions() const;
  void AddOperatorNote(const OperatorNote& note);
  /// Newest first.
  std::vector<OperatorNote> OperatorNotes(int newest) const;
  /// All that are bad by now, or were when the program ended.
  void SetChannelTroubles(const std::vector<ChannelTrouble>& troubles);
  std::vector<ChannelTrouble> ChannelTroubles() const;
  void AddHole(const Hole& hole);
  std::vector<Hole> Holes() const;
  /// Registers a file beside the cycles' own: a picture, a raw stream, what is kept of a fault.
  /// @param path  from the campaign's folder on, with slashes. Registered anew, the last one counts.
  void AddFile(std::string_view path, const FileDigest& digest);
  std::map<std::string, FileDigest> Files() const;
  void SetCalibration(const Calibration& calibration, std::string_view utc);
  std::optional<Calibration> FindCalibration(std::string_view name) const;
  /// All whose name begins so, by name.
  std::vector<Calibration> CalibrationsLike(std::string_view prefix) const;

 private:
  Journal(Database database, int version, std::uint32_t unsealed_pages);
  bool HasAlarms() const;
  /// Those that journals of earlier versions lack: alarms, where what is open becomes instances, and the
  /// chain (`journal_chain.h`).
  void AddTables();
  void AddAlarmTables();
  /// Of a journal that is open to be written.
  bool is_chained() const;
  /// Both or none: a new row, and its link in the chain. @return the row's number.
  std::int64_t AddChained(ChainedRow kind, Statement& insert);
  std::vector<AlarmInstance> AlarmsOfEvents() const;
  static Journal OfFile(const std::filesystem::path& file, Database::Mode mode, std::uint32_t unsealed_pages);

  Database database_;
  int version_;
  std::uint32_t unsealed_pages_;
  JournalEnd end_;
};

}  // namespace strainwave::bench
