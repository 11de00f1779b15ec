// SPDX-License-Identifier: Apache-2.0
#include "bench/page/resumed_run.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <exception>
#include <memory>
#include <optional>
#include <system_error>
#include <thread>
#include <vector>

#include <fmt/core.h>

#include "bench/campaign/journal.h"
#include "bench/campaign/run_begun.h"

namespace strainwave::bench {
namespace {

constexpr std::chrono::seconds kPatience{30};
constexpr std::chrono::milliseconds kInterval{20};

void Demand(int error, const char* what) {
  if (error != 0) throw std::system_error(error, std::generic_category(), what);
}

// Of what a new process gets; C's own pairs of init and destroy.
class SpawnSettings {
 public:
  explicit SpawnSettings(const std::filesystem::path& output) {
    Demand(::posix_spawn_file_actions_init(&actions_), "posix_spawn");
    Demand(::posix_spawnattr_init(&attributes_), "posix_spawn");
    Demand(::posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0), "/dev/null");
    Demand(::posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, output.c_str(),
                                              O_WRONLY | O_CREAT | O_APPEND, 0644),
           "resumed.txt");
    Demand(::posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO), "resumed.txt");
    // This process hears signals in its own way, which a new one would inherit.
    sigset_t all{};
    sigset_t none{};
    ::sigfillset(&all);
    ::sigemptyset(&none);
    Demand(::posix_spawnattr_setsigdefault(&attributes_, &all), "posix_spawn");
    Demand(::posix_spawnattr_setsigmask(&attributes_, &none), "posix_spawn");
    Demand(::posix_spawnattr_setflags(&attributes_, static_cast<short>(POSIX_SPAWN_SETSIGDEF |
                                                                       POSIX_SPAWN_SETSIGMASK |
                                                                       POSIX_SPAWN_SETSID)),
           "posix_spawn");
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
  ~SpawnSettings() {
    ::posix_spawn_file_actions_destroy(&actions_);
    ::posix_spawnattr_destroy(&attributes_);
  }

  pid_t Spawn(std::vector<std::string> words) const {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_t process{};
    Demand(::posix_spawn(&process, "/proc/self/exe", &actions_, &attributes_, arguments.data(), environ),
           "strainwave run");
    return process;
  }

 private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

std::string LastLineOf(const std::filesystem::path& file) {
  std::string text;
  try {
    text = ReadText(file);
  } catch (const std::system_error&) {
    return "";
  }
  text.erase(text.find_last_not_of('\n') + 1);
  return text.substr(text.rfind('\n') + 1);
}

// Whether that process has begun a run; also of a journal that cannot be read at this moment.
bool HasBegun(const CampaignFolder& folder, pid_t process) {
  try {
    const auto text = Journal::OpenChecked(folder.Journal()).Property(kRunBegun);
    const auto begun = text ? ParseRunBegun(*text) : std::nullopt;
    return begun && begun->process == process;
  } catch (const std::exception&) {
    return false;
  }
}

// The pace of a simulated bench is that of the run before.
std::string PaceOf(const CampaignFolder& folder) {
  return Journal::OpenChecked(folder.Journal()).Property(kRunPace).value_or("max");
}

}  // namespace

ActionAnswer ResumeRun(const CampaignFolder& folder, const AskedAction& asked, const std::string& now_utc) {
  const std::filesystem::path output = folder.root / "resumed.txt";
  // Those of before that have ended by now.
  while (::waitpid(-1, nullptr, WNOHANG) > 0) {
  }
  pid_t process{};
  try {
    process = SpawnSettings(output).Spawn({"strainwave", "run", folder.Schedule().string(), "--out",
                                           folder.root.string(), "--resume", "--pace", PaceOf(folder)});
  } catch (const std::exception& error) {
    return NotDone(500, "process", fmt::format("the campaign cannot be gone on with: {}", error.what()));
  }
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!HasBegun(folder, process)) {
    int status{};
    if (::waitpid(process, &status, WNOHANG) == process) {
      return NotDone(409, "process",
                     fmt::format("the campaign was not gone on with: {}", LastLineOf(output)));
    }
    if (std::chrono::steady_clock::now() >= until) {
      return Done(asked,
                  fmt::format("process {} has not begun yet; what it says is in {}", process, output.string()),
                  now_utc);
    }
    std::this_thread::sleep_for(kInterval);
  }
  return Done(asked, fmt::format("process {} goes on with the campaign", process), now_utc);
}

}  // namespace strainwave::bench
