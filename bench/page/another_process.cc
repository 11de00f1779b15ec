// SPDX-License-Identifier: Apache-2.0
#include "bench/page/another_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/inotify.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
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

// How long after a change a file is looked at once more: SQLite writes a row before it counts. Where the
// kernel gives no watch, a file is looked at so often.
constexpr std::chrono::milliseconds kSettled{200};

class Descriptor {
 public:
  explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

// Of one file, which may not be there yet: its folder is watched.
class FileWatch {
 public:
  explicit FileWatch(const std::filesystem::path& file)
      : name_(file.filename().string()), inotify_(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
    const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
    is_watched_ = inotify_.get() >= 0 && ::inotify_add_watch(inotify_.get(), folder.c_str(),
                                                             IN_MODIFY | IN_CREATE | IN_MOVED_TO) >= 0;
  }

  // −1: it cannot be watched.
  int get() const { return is_watched_ ? inotify_.get() : -1; }

  // Whether the file has changed since the last call.
  bool Take() const {
    bool has_changed = false;
    alignas(inotify_event) std::array<char, 4096> buffer{};
    for (ssize_t got = 0; is_watched_ && (got = ::read(inotify_.get(), buffer.data(), buffer.size())) > 0;) {
      for (const char* at = buffer.data(); at < buffer.data() + got;) {
        const auto* const event = reinterpret_cast<const inotify_event*>(at);
        const bool is_lost = (event->mask & IN_Q_OVERFLOW) != 0;
        has_changed = has_changed || is_lost || (event->len > 0 && name_ == event->name);
        at += sizeof(inotify_event) + event->len;
      }
    }
    return has_changed;
  }

 private:
  std::string name_;
  Descriptor inotify_;
  bool is_watched_{};
};

}  // namespace

Awaited Await(pid_t process, const std::filesystem::path& file, std::chrono::seconds patience,
              const std::function<bool()>& is_done) {
  using std::chrono::milliseconds, std::chrono::steady_clock;
  const FileWatch changes(file);
  // The header of glibc 2.36 declares pidfd_open for C alone.
  const Descriptor end(static_cast<int>(::syscall(SYS_pidfd_open, process, 0)));
  const bool sees_all = changes.get() >= 0 && end.get() >= 0;
  const auto until = steady_clock::now() + patience;
  bool looks_again = !sees_all;
  while (!is_done()) {
    while (true) {
      const auto left = std::chrono::ceil<milliseconds>(until - steady_clock::now());
      if (left.count() <= 0) return Awaited::kNothing;
      std::array<pollfd, 2> waits{{{changes.get(), POLLIN, 0}, {end.get(), POLLIN, 0}}};
      const milliseconds sleep = looks_again ? std::min(left, kSettled) : left;
      const int ready = ::poll(waits.data(), waits.size(), static_cast<int>(sleep.count()));
      if (::waitpid(process, nullptr, WNOHANG) == process)
        return is_done() ? Awaited::kDone : Awaited::kEnded;
      const bool has_changed = changes.Take();
      const bool is_settled = looks_again && ready == 0;
      looks_again = has_changed || !sees_all;
      if (has_changed || is_settled) break;
    }
  }
  return Awaited::kDone;
}

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
