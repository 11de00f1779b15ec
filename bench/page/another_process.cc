// SPDX-License-Identifier: Apache-2.0
#include "bench/page/another_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <csignal>
#include <system_error>

#include "bench/campaign/folder.h"

namespace strainwave::bench {
namespace {

void Demand(int error, const char* what) {
  if (error != 0) throw std::system_error(error, std::generic_category(), what);
}

// Of what a new process gets; C's own pairs of init and destroy.
class SpawnSettings {
 public:
  explicit SpawnSettings(const std::filesystem::path& output) {
    Demand(::posix_spawn_file_actions_init(&actions_), "posix_spawn");
    Demand(::posix_spawnattr_init(&attributes_), "posix_spawn");
    Demand(::posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0),
           "/dev/null");
    Demand(::posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, output.c_str(),
                                              O_WRONLY | O_CREAT | O_APPEND, 0644),
           "output of another process");
    Demand(::posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO),
           "output of another process");
    // This process hears signals in its own way, which a new one would inherit.
    sigset_t all{};
    sigset_t none{};
    ::sigfillset(&all);
    ::sigemptyset(&none);
    Demand(::posix_spawnattr_setsigdefault(&attributes_, &all), "posix_spawn");
    Demand(::posix_spawnattr_setsigmask(&attributes_, &none), "posix_spawn");
    Demand(::posix_spawnattr_setflags(
               &attributes_,
               static_cast<short>(POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSID)),
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
           "strainwave");
    return process;
  }

 private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

}  // namespace

pid_t StartAnother(std::vector<std::string> words, const std::filesystem::path& output) {
  words.insert(words.begin(), "strainwave");
  return SpawnSettings(output).Spawn(std::move(words));
}

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

}  // namespace strainwave::bench
