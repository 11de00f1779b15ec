// SPDX-License-Identifier: Apache-2.0
#include "bench/plots/child_program.h"

#include <poll.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <memory>
#include <system_error>

#include "daq/file_descriptor.h"

namespace strainwave::bench {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

File OpenScratch() {
  File file(std::tmpfile());
  if (!file) throw std::system_error(errno, std::generic_category(), "no scratch file could be made");
  return file;
}

std::string ReadAll(std::FILE* file) {
  std::rewind(file);
  std::string text;
  std::array<char, 4096> block{};
  while (const std::size_t n = std::fread(block.data(), 1, block.size(), file)) text.append(block.data(), n);
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text;
}

// In a process group of its own, so that it can be ended with all that it has started.
class SpawnAttributes {
 public:
  explicit SpawnAttributes(bool own_group) {
    sigset_t signals;
    posix_spawnattr_init(&attributes_);
    sigemptyset(&signals);
    posix_spawnattr_setsigmask(&attributes_, &signals);
    for (const int signal : {SIGPIPE, SIGTTIN, SIGTTOU}) sigaddset(&signals, signal);
    posix_spawnattr_setsigdefault(&attributes_, &signals);
    int flags = POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF;
    if (own_group) flags |= POSIX_SPAWN_SETPGROUP;
    posix_spawnattr_setflags(&attributes_, static_cast<short>(flags));
  }
  ~SpawnAttributes() { posix_spawnattr_destroy(&attributes_); }
  SpawnAttributes(const SpawnAttributes&) = delete;
  SpawnAttributes& operator=(const SpawnAttributes&) = delete;
  const posix_spawnattr_t* get() const { return &attributes_; }

 private:
  posix_spawnattr_t attributes_;
};

class SpawnActions {
 public:
  SpawnActions() { posix_spawn_file_actions_init(&actions_); }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;
  void Redirect(int from, int to) { posix_spawn_file_actions_adddup2(&actions_, from, to); }
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

// Whether a child ends within the time.
bool EndsWithin(pid_t child, std::chrono::milliseconds limit) {
  const daq::FileDescriptor watched(static_cast<int>(::syscall(SYS_pidfd_open, child, 0)));
  if (!watched.is_open())
    throw std::system_error(errno, std::generic_category(), "a program cannot be watched");
  const auto until = std::chrono::steady_clock::now() + limit;
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    pollfd ended{watched.get(), POLLIN, 0};
    const int count =
        ::poll(&ended, 1, static_cast<int>(std::max(left, std::chrono::milliseconds(0)).count()));
    if (count > 0) return true;
    if (count == 0) return false;
    if (errno != EINTR)
      throw std::system_error(errno, std::generic_category(), "a program cannot be watched");
  }
}

}  // namespace

// Input and output pass through unnamed files rather than pipes: neither side can block the other, and a
// program that dies early raises no SIGPIPE here.
ChildEnd RunChild(std::vector<std::string> command, const std::string& input,
                  std::optional<std::chrono::milliseconds> limit, ChildOutputs outputs) {
  const File in = OpenScratch();
  const File out = OpenScratch();
  const File apart = outputs == ChildOutputs::kApart ? OpenScratch() : nullptr;
  if (std::fwrite(input.data(), 1, input.size(), in.get()) != input.size() || std::fflush(in.get()) != 0)
    throw std::system_error(errno, std::generic_category(), "a program's input could not be written");
  // The child shares the offset of the file.
  lseek(fileno(in.get()), 0, SEEK_SET);
  const SpawnAttributes attributes(limit.has_value());
  SpawnActions actions;
  actions.Redirect(fileno(in.get()), STDIN_FILENO);
  actions.Redirect(fileno(out.get()), STDOUT_FILENO);
  actions.Redirect(fileno(apart ? apart.get() : out.get()), STDERR_FILENO);
  std::vector<char*> arguments;
  for (std::string& word : command) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ChildEnd end;
  pid_t child = 0;
  end.error =
      posix_spawnp(&child, arguments.front(), actions.get(), attributes.get(), arguments.data(), environ);
  if (end.error != 0) return end;
  end.late = limit && !EndsWithin(child, *limit);
  if (end.late) ::kill(-child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR)
      throw std::system_error(errno, std::generic_category(), "a program was lost sight of");
  }
  end.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  end.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
  end.said = ReadAll(out.get());
  if (apart) end.words = ReadAll(apart.get());
  return end;
}

}  // namespace strainwave::bench
