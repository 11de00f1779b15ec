// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdio>
#include <string>

#include "tests/daq/scratch_folder.h"

namespace strainwave::daq {

/// What a script said, and how it ended.
struct PythonResult {
  int status;
  std::string output;
};

/// Runs it with the system's Python, the folder being its working directory.
inline PythonResult RunPython(const ScratchFolder& folder, const std::string& script) {
  WriteBytes(folder / "script.py", script);
  const std::string command = "cd '" + folder.path().string() + "' && /usr/bin/python3 script.py 2>&1";
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return {-1, ""};
  PythonResult result{0, ""};
  std::array<char, 4096> buffer{};
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    result.output.append(buffer.data(), got);
  }
  result.status = ::pclose(pipe);
  return result;
}

}  // namespace strainwave::daq
