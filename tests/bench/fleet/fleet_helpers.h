// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "bench/errors/bench_error.h"
#include "bench/fleet/plan.h"
#include "bench/sha256.h"
#include "tests/simulation/program.h"

namespace strainwave::bench {

/// A folder with records, and a program that stands in for strainwave: its report of a record holds what is
/// in it. The current folder while this lives.
class FleetFolder {
 public:
  FleetFolder() : before_(std::filesystem::current_path()) {
    std::filesystem::current_path(scratch_.path());
    // Called as: COMMAND RECORD --json OPTION...
    Write("program", R"sh(#!/bin/sh
record=$2
text=$(cat "$record")
case $text in
  refused*) echo "$record: error: $text (expected a record)" >&2; exit 2 ;;
  killed*) kill -9 $$ ;;
  broken*) echo "the disk is full" >&2; exit 3 ;;
  grows*) echo more >>"$record" ;;
  waits*) read -r word <fifo ;;
esac
shift 3
printf '{"text":"%s","length":%d,"options":"%s"}\n' "$text" "${#text}" "$*"
case $text in fails*) exit 1 ;; esac
)sh");
    std::filesystem::permissions("program", std::filesystem::perms::owner_all);
    program_ = {std::filesystem::absolute("program").string(), "strainwave 9.9.9 (0000000)",
                Sha256OfFile("program")};
  }
  ~FleetFolder() { std::filesystem::current_path(before_); }
  FleetFolder(const FleetFolder&) = delete;
  FleetFolder& operator=(const FleetFolder&) = delete;

  static void Write(const std::string& name, const std::string& text) {
    std::ofstream(name, std::ios::binary) << text;
  }
  const FleetProgram& program() const { return program_; }
  PlanFolder At(const std::string& name) const { return {scratch_ / name}; }
  std::string Path(const std::string& name) const { return (scratch_ / name).string(); }

  /// A plan of a command over these records, which is written.
  FleetPlan Planned(const std::string& name, const std::vector<std::string>& records,
                    std::size_t shards) const {
    FleetPlan plan = MakePlan({"recompute", records, {}, shards}, program_);
    WritePlan(At(name), plan);
    return plan;
  }

 private:
  ScratchFolder scratch_;
  std::filesystem::path before_;
  FleetProgram program_;
};

/// What is told of wrong input, behind its exit code.
template <typename F>
std::string ToldBy(const F& call) {
  try {
    call();
  } catch (const BenchError& error) {
    return std::to_string(static_cast<int>(error.exit_code())) + " " + error.what();
  }
  return "nothing";
}

}  // namespace strainwave::bench
