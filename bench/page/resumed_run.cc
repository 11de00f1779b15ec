// SPDX-License-Identifier: Apache-2.0
#include "bench/page/resumed_run.h"

#include <sys/wait.h>

#include <chrono>
#include <exception>
#include <filesystem>

#include <fmt/core.h>

#include "bench/campaign/journal.h"
#include "bench/campaign/run_begun.h"
#include "bench/page/another_process.h"

namespace strainwave::bench {
namespace {

constexpr std::chrono::seconds kPatience{30};

// Whether that process has begun a run; also of a journal that cannot be read at this moment.
bool HasBegun(const CampaignFolder& folder, pid_t process) {
  try {
    const auto text = Journal::OpenAsRead(folder.Journal()).Property(kRunBegun);
    const auto begun = text ? ParseRunBegun(*text) : std::nullopt;
    return begun && begun->process == process;
  } catch (const std::exception&) {
    return false;
  }
}

// What SQLite has committed is there first.
std::filesystem::path LogOfJournal(const CampaignFolder& folder) {
  return folder.Journal().string() + "-wal";
}

// The pace of a simulated bench is that of the run before.
std::string PaceOf(const CampaignFolder& folder) {
  return Journal::OpenAsRead(folder.Journal()).Property(kRunPace).value_or("max");
}

}  // namespace

ActionAnswer ResumeRun(const CampaignFolder& folder, const AskedAction& asked, const std::string& now_utc) {
  const std::filesystem::path output = folder.root / "resumed.txt";
  // Those of before that have ended by now.
  while (::waitpid(-1, nullptr, WNOHANG) > 0) {
  }
  pid_t process{};
  try {
    process =
        StartAnother({"run", "--out", folder.root.string(), "--resume", "--pace", PaceOf(folder)}, output);
  } catch (const std::exception& error) {
    return NotDone(500, "process", fmt::format("the campaign cannot be gone on with: {}", error.what()));
  }
  const auto begun = [&] { return HasBegun(folder, process); };
  switch (Await(process, LogOfJournal(folder), kPatience, begun)) {
    case Awaited::kDone:
      return Done(asked, fmt::format("process {} goes on with the campaign", process), now_utc);
    case Awaited::kEnded:
      return NotDone(409, "process",
                     fmt::format("the campaign was not gone on with: {}", LastLineOf(output)));
    case Awaited::kNothing:
      break;
  }
  return Done(asked,
              fmt::format("process {} has not begun yet; what it says is in {}", process, output.string()),
              now_utc);
}

}  // namespace strainwave::bench
