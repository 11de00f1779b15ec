// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "bench/fleet/plan.h"
#include "daq/file_descriptor.h"

namespace strainwave::bench {

/// What came of the records of a shard.
struct ShardEnd {
  std::size_t were_there{};
  std::size_t kept{};
  std::size_t failed{};
  std::size_t changed{};    // of the failed: records that are not what they were
  std::string first_words;  // of the first failure
};

/// Held while a shard runs on this machine, for whoever asks; the kernel lets go however the process ends. It
/// keeps nobody out: a shard that runs twice makes the same results twice.
class ShardMark {
 public:
  ShardMark(const PlanFolder& folder, std::size_t shard);
  static bool IsHeld(const PlanFolder& folder, std::size_t shard);

 private:
  daq::FileDescriptor file_;
};

/// Computes what is not there yet of a shard. Each record goes to a process of its own, so that a crash costs
/// one result, and a result is what the command itself says of that record. The current folder has to be the
/// plan's.
/// @param after_each  called when a record is done with.
/// @throws BenchError where the plan is of another program, or has no such shard; DataFileError where a
/// result
///   cannot be kept.
ShardEnd RunShard(const PlanFolder& folder, const FleetPlan& plan, const FleetProgram& program,
                  std::size_t shard, const std::function<void()>& after_each = {});

/// All shards on this machine, `jobs` at a time.
ShardEnd RunAllShards(const PlanFolder& folder, const FleetPlan& plan, const FleetProgram& program,
                      std::size_t jobs, const std::function<void(std::size_t done)>& progress);

/// The folder that the plan's paths start from. @throws BenchError where it is not there.
void EnterWorkingFolder(const PlanFolder& folder, const FleetPlan& plan);

}  // namespace strainwave::bench
