// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <string>
#include <vector>

namespace strainwave::bench {

/// A program that speaks to the test in lines over its standard input and output, and is ended with it.
class PeerProcess {
 public:
  explicit PeerProcess(std::vector<std::string> command) {
    int pair[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0) return;
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(pair[1], 0);
      ::dup2(pair[1], 1);
      ::execvp(arguments[0], arguments.data());
      ::_exit(127);
    }
    ::close(pair[1]);
    stream_ = ::fdopen(pair[0], "r+");
  }
  PeerProcess(const PeerProcess&) = delete;
  PeerProcess& operator=(const PeerProcess&) = delete;
  ~PeerProcess() { End(); }

  /// The next line, without its end; empty when the peer has ended.
  std::string Line() {
    std::string line;
    for (int c = std::getc(stream_); c != EOF && c != '\n'; c = std::getc(stream_)) {
      line += static_cast<char>(c);
    }
    return line;
  }

  /// Says a line and gives the one that comes back.
  std::string Say(const std::string& line) {
    std::fprintf(stream_, "%s\n", line.c_str());
    std::fflush(stream_);
    return Line();
  }

  /// Whether it has ended by itself.
  bool ended() {
    siginfo_t info{};
    return pid_ <= 0 || (::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
                         info.si_pid == pid_);
  }

  /// Ends the peer at once, if it still runs. Its exit status, or -1 when it was killed.
  int End() {
    if (pid_ <= 0) return -1;
    int status = 0;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    std::fclose(stream_);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t pid_{-1};
  std::FILE* stream_{};
};

}  // namespace strainwave::bench
