// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/output.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kRoom_bytes = 1 << 20;  // hours of words of a campaign
constexpr std::size_t kPiece_bytes = 4096;    // what a pipe takes as a whole
constexpr std::chrono::seconds kPatience{1};  // without a byte taken
constexpr std::string_view kEraseLine = "\r\033[K";

class Stream {
 public:
  explicit Stream(int descriptor) : descriptor_(descriptor), is_terminal_(::isatty(descriptor) == 1) {}

  bool is_terminal() const { return is_terminal_; }

  void Put(std::string_view text) {
    std::unique_lock lock(mutex_);
    const auto has_room = [&] { return texts_.empty() || texts_.size() + text.size() <= kRoom_bytes; };
    if (served_ && !drops_) Await(lock, has_room);
    if (!has_room()) {
      ++dropped_;
      return;
    }
    texts_ += text;
    Pass(lock);
  }

  void PutLine(std::string_view text) {
    if (!is_terminal_) return;
    std::unique_lock lock(mutex_);
    if (text.empty() && !line_shown_) {
      line_.reset();
      return;
    }
    line_ = text;
    Pass(lock);
  }

  // From now on by a thread; what is written to stays in its way no longer.
  void Serve(std::function<bool()> stop_asked, bool drops) {
    const std::lock_guard lock(mutex_);
    if (served_) {
      drops_ = drops;
      return;
    }
    // Nobody can join a thread that a stopped terminal holds: it ends with the process. Where the machine
    // refuses one, words are written as before.
    std::thread([this] { WriteAsItComes(); }).detach();
    served_ = true;
    drops_ = drops;
    stop_asked_ = std::move(stop_asked);
  }

  void DropNothing() {
    const std::lock_guard lock(mutex_);
    drops_ = false;
  }

  void Drain() {
    std::unique_lock lock(mutex_);
    if (served_) Await(lock, [&] { return !IsWaiting() && !writing_; });
  }

  bool drops() {
    const std::lock_guard lock(mutex_);
    return drops_;
  }

  struct Losses {
    bool served;
    std::size_t dropped;
    std::error_code failure;
    bool Matter() const { return failure && failure != std::errc::broken_pipe; }
  };
  Losses Lost() {
    const std::lock_guard lock(mutex_);
    return {served_, dropped_, failure_};
  }

 private:
  bool IsWaiting() const { return !texts_.empty() || line_.has_value(); }

  void Pass(std::unique_lock<std::mutex>& lock) {
    if (served_) {
      changed_.notify_all();
    } else {
      WriteNow(lock);
    }
  }

  void WriteAsItComes() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return IsWaiting(); });
      WriteNow(lock);
      changed_.notify_all();
    }
  }

  // A shown line gives way to words, and these to the newest line.
  void WriteNow(std::unique_lock<std::mutex>& lock) {
    std::string text(line_shown_ ? kEraseLine : "");
    text += std::exchange(texts_, {});
    line_shown_ = line_ && !line_->empty();
    if (line_) text += *std::exchange(line_, {});
    writing_ = true;
    std::string_view rest = text;
    while (!rest.empty()) {
      lock.unlock();
      const ssize_t taken = ::write(descriptor_, rest.data(), std::min(rest.size(), kPiece_bytes));
      const int error = taken < 0 ? errno : 0;
      if (error == EAGAIN) {
        pollfd ready{descriptor_, POLLOUT, 0};
        ::poll(&ready, 1, -1);
      }
      lock.lock();
      if (error == EAGAIN || error == EINTR) continue;
      if (error != 0) {
        if (!failure_) failure_ = {error, std::generic_category()};
        break;  // words that come later are tried again
      }
      rest.remove_prefix(static_cast<std::size_t>(taken));
      ++pieces_written_;
      given_up_ = false;
      changed_.notify_all();
    }
    writing_ = false;
  }

  // A pipe's reader takes the time that it needs, until somebody wants to leave; a stopped terminal may never
  // go on, and nobody reads words from the end of a pipe that is not read.
  template <typename Done>
  void Await(std::unique_lock<std::mutex>& lock, const Done& done) {
    const bool patient = descriptor_ == STDOUT_FILENO && !is_terminal_;
    while (!done() && !given_up_) {
      const std::size_t before = pieces_written_;
      const auto moved = [&] { return done() || pieces_written_ != before; };
      if (changed_.wait_for(lock, kPatience, moved)) continue;
      given_up_ = !patient || stop_asked_();
    }
  }

  const int descriptor_;
  const bool is_terminal_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string texts_;                // wait to be written,
  std::optional<std::string> line_;  // and after them, this
  bool line_shown_{};
  bool writing_{};
  bool served_{};
  bool drops_{};
  bool given_up_{};
  std::function<bool()> stop_asked_;
  std::size_t pieces_written_{};
  std::size_t dropped_{};
  std::error_code failure_;
};

// Never destroyed: the threads that write outlast `main`.
Stream& StreamOf(Output output) {
  static Stream& results = *new Stream(STDOUT_FILENO);
  static Stream& words = *new Stream(STDERR_FILENO);
  return output == Output::kResults ? results : words;
}

void TellLosses(const char* stream, const Stream::Losses& lost) {
  if (lost.Matter()) ToStderr("error: {} could not be written: {}\n", stream, lost.failure.message());
  if (lost.dropped > 0) {
    ToStderr("error: {} was not read in time: {} texts were dropped\n", stream, lost.dropped);
  }
}

}  // namespace

void Write(Output output, std::string_view text) {
  if (output == Output::kResults && StreamOf(output).is_terminal()) ShowLine({});
  // What goes to one terminal comes in the order in which it was written.
  const Output other = output == Output::kResults ? Output::kWords : Output::kResults;
  if (!StreamOf(output).drops()) StreamOf(other).Drain();
  StreamOf(output).Put(text);
}

void ShowLine(std::string_view text) { StreamOf(Output::kWords).PutLine(text); }

bool StderrIsTerminal() { return StreamOf(Output::kWords).is_terminal(); }

void PrepareOutput() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) >= 0) continue;
    // The lowest free number, which is this one. Read alone, so that writing fails as it should.
    [[maybe_unused]] const int opened = ::open("/dev/null", O_RDONLY);
  }
  std::signal(SIGPIPE, SIG_IGN);
}

LiveOutput::LiveOutput(std::function<bool()> stop_asked, Results results) {
  StreamOf(Output::kResults).Serve(stop_asked, results == Results::kDropped);
  StreamOf(Output::kWords).Serve(std::move(stop_asked), true);
}

LiveOutput::~LiveOutput() {
  for (const Output output : {Output::kWords, Output::kResults}) {
    StreamOf(output).DropNothing();
    StreamOf(output).Drain();
  }
}

int FinishOutput(int code) {
  Stream& results = StreamOf(Output::kResults);
  Stream& words = StreamOf(Output::kWords);
  results.Drain();
  words.Drain();
  const Stream::Losses lost = results.Lost();
  TellLosses("standard output", lost);
  TellLosses("standard error", words.Lost());
  words.Drain();
  return code == 0 && lost.Matter() && !lost.served ? static_cast<int>(ExitCode::kMachineFailed) : code;
}

}  // namespace strainwave::bench
