// SPDX-License-Identifier: Apache-2.0
#include "daq/limited_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <system_error>

namespace strainwave::daq {
namespace {

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kOutOfMemory = 2;
constexpr int kPipe_bytes = 1 << 20;

[[noreturn]] void ThrowLast(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

std::size_t AddressSpace_bytes() {
  std::FILE* const file = std::fopen("/proc/self/statm", "re");
  if (file == nullptr) ThrowLast("cannot read /proc/self/statm");
  unsigned long pages{};
  const bool known = std::fscanf(file, "%lu", &pages) == 1;
  std::fclose(file);
  if (!known) ThrowLast("cannot read /proc/self/statm");
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

// A limit that stands already may be lower, and cannot be raised.
void Limit(__rlimit_resource resource, rlim_t most) {
  rlimit limit{};
  if (::getrlimit(resource, &limit) != 0) ::_exit(kFailed);
  limit.rlim_cur = std::min(limit.rlim_max, most);
  if (::setrlimit(resource, &limit) != 0) ::_exit(kFailed);
}

// What is said of the end of a run is the parent's; this one dies with it.
void BecomeWorker(const ProcessLimits& limits, std::size_t address_space_bytes, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kFailed);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, SIG_IGN);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGPIPE, SIGXCPU})
    std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  // What a library prints when it crashes is of no use to anybody.
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  if (nowhere < 0) ::_exit(kFailed);
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, standard);
  Limit(RLIMIT_CORE, 0);
  Limit(RLIMIT_FSIZE, 0);
  Limit(RLIMIT_CPU, static_cast<rlim_t>(limits.processor.count()));
  Limit(RLIMIT_AS, address_space_bytes + limits.memory_bytes);
}

[[noreturn]] void Work(const std::function<void(int)>& work, int pipe) noexcept {
  try {
    work(pipe);
  } catch (const std::bad_alloc&) {
    ::_exit(kOutOfMemory);
  } catch (...) {
    ::_exit(kFailed);
  }
  ::_exit(kDone);
}

}  // namespace

LimitedProcess::LimitedProcess(const ProcessLimits& limits, const std::function<void(int)>& work)
    : limits_(limits) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) ThrowLast("cannot make a pipe");
  pipe_ = FileDescriptor(ends[0]);
  FileDescriptor input(ends[1]);
  ::fcntl(pipe_.get(), F_SETPIPE_SZ, kPipe_bytes);  // only faster
  const std::size_t address_space_bytes = AddressSpace_bytes();
  const pid_t parent = ::getpid();
  child_ = ::fork();
  if (child_ < 0) ThrowLast("cannot start a process");
  if (child_ > 0) return;
  BecomeWorker(limits, address_space_bytes, parent);
  Work(work, input.get());
}

LimitedProcess::~LimitedProcess() {
  if (child_ < 0) return;
  Kill();
  while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void LimitedProcess::Kill() noexcept { ::kill(child_, SIGKILL); }

std::size_t LimitedProcess::Read(std::span<std::byte> bytes) {
  pollfd ready{pipe_.get(), POLLIN, 0};
  const auto patience_ms =
      static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(limits_.silence).count());
  int seen{};
  while ((seen = ::poll(&ready, 1, patience_ms)) < 0 && errno == EINTR) {
  }
  if (seen < 0) ThrowLast("cannot wait for a process");
  if (seen == 0) {
    was_silent_ = true;
    Kill();
    return 0;
  }
  ssize_t got{};
  while ((got = ::read(pipe_.get(), bytes.data(), bytes.size())) < 0 && errno == EINTR) {
  }
  if (got < 0) ThrowLast("cannot read from a process");
  return static_cast<std::size_t>(got);
}

std::string LimitedProcess::End() {
  pipe_ = FileDescriptor(-1);  // so that one that goes on writing ends, too
  int status{};
  while (::waitpid(child_, &status, 0) < 0) {
    if (errno != EINTR) ThrowLast("cannot wait for a process");
  }
  child_ = -1;
  if (was_silent_) return fmt::format("said nothing for {} s", limits_.silence.count());
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU) return fmt::format("took more than {} s", limits_.processor.count());
    return fmt::format("crashed ({})", ::strsignal(signal));
  }
  if (WEXITSTATUS(status) == kDone) return {};
  if (WEXITSTATUS(status) == kOutOfMemory)
    return fmt::format("needed more than {} MiB of memory", limits_.memory_bytes >> 20);
  return "failed";
}

void WriteToPipe(int pipe, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(pipe, bytes.data(), bytes.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      ThrowLast("cannot write to a pipe");
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

}  // namespace strainwave::daq
