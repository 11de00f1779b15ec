// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace strainwave::bench {

/// Process exit codes (docs/contract.md#exit-codes).
enum class ExitCode : int {
  kDone = 0,
  kEndedBadly = 1,
  kWrongInput = 2,
  kMachineFailed = 3,
  kInterrupted = 130
};

/// Something that the person at the bench can act on, with the exit code that goes with it.
class BenchError : public std::runtime_error {
 public:
  BenchError(ExitCode exit_code, const std::string& message)
      : std::runtime_error(message), exit_code_(exit_code) {}
  ExitCode exit_code() const { return exit_code_; }

 private:
  ExitCode exit_code_;
};

/// Wrong input: "WHERE: error: WHAT (expected EXPECTED)". @throws BenchError always.
[[noreturn]] void Refuse(const std::filesystem::path& where, const std::string& what,
                         const std::string& expected);

}  // namespace strainwave::bench
