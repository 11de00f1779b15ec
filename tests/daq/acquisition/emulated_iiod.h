// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/checkout.h"

namespace strainwave::daq::acquisition {

/// A MEMS accelerometer behind an iiod (`peers/iiod_emulator.py`), in a process of its own.
class EmulatedIiod {
 public:
  explicit EmulatedIiod(const std::vector<std::string>& arguments) {
    std::array<int, 2> out{};
    if (::pipe(out.data()) != 0) throw std::runtime_error("no pipe");
    process_ = ::fork();
    if (process_ == 0) {
      ::dup2(out[1], 1);
      std::vector<char*> words;
      std::vector<std::string> texts{"/usr/bin/python3",
                                     SourceFolder() + "/tests/daq/acquisition/peers/iiod_emulator.py"};
      texts.insert(texts.end(), arguments.begin(), arguments.end());
      for (std::string& text : texts) words.push_back(text.data());
      words.push_back(nullptr);
      ::execv(words[0], words.data());
      ::_exit(127);
    }
    ::close(out[1]);
    std::FILE* const file = ::fdopen(out[0], "r");
    if (std::fscanf(file, "%d", &port_) != 1) throw std::runtime_error("no emulator");
    std::fclose(file);
  }
  EmulatedIiod(const EmulatedIiod&) = delete;
  EmulatedIiod& operator=(const EmulatedIiod&) = delete;
  ~EmulatedIiod() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  std::string uri() const { return "ip:127.0.0.1:" + std::to_string(port_); }

 private:
  pid_t process_{};
  int port_{};
};

}  // namespace strainwave::daq::acquisition
