// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/checkout.h"

namespace strainwave {

/// What the program did when it was run as a user runs it.
struct ProgramResult {
  int exit_code{};
  std::string out;
  std::string error;
};

inline std::string WholeFile(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return std::move(text).str();
}

/// A folder of its own, gone when the test is over.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "strainwave-test-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() { std::filesystem::remove_all(path_); }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Starts the program with its output going to files in `folder`.
/// @param in  where it is run; empty: here.
inline pid_t StartProgram(const std::vector<std::string>& arguments, const ScratchFolder& folder,
                          const std::filesystem::path& in = {}) {
  const std::string& program = ProgramPath();
  const pid_t process = ::fork();
  if (process != 0) return process;
  if (!in.empty() && ::chdir(in.c_str()) != 0) ::_exit(126);
  const int out = ::open((folder / "stdout").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const int error = ::open((folder / "stderr").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(error, STDERR_FILENO);
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  ::execv(program.c_str(), argv.data());
  ::_exit(127);
}

inline ProgramResult WaitForProgram(pid_t process, const ScratchFolder& folder) {
  int status = 0;
  ::waitpid(process, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), WholeFile(folder / "stdout"),
          WholeFile(folder / "stderr")};
}

inline ProgramResult RunProgram(const std::vector<std::string>& arguments,
                                const std::filesystem::path& in = {}) {
  const ScratchFolder folder;
  return WaitForProgram(StartProgram(arguments, folder, in), folder);
}

}  // namespace strainwave
