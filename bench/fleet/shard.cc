// SPDX-License-Identifier: Apache-2.0
#include "bench/fleet/shard.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <atomic>
#include <exception>
#include <filesystem>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"
#include "bench/fleet/kept_results.h"
#include "bench/fleet/plan_files.h"
#include "bench/plots/child_program.h"
#include "daq/record_error.h"

namespace strainwave::bench {
namespace {

std::filesystem::path MarkOf(const PlanFolder& folder, std::size_t shard) {
  return folder.Shards() / fmt::format("{}", shard);
}

// The machine's trouble: another try, or another machine, may do.
struct NoResult {
  std::string words;
};

std::string LastLine(const std::string& text) { return text.substr(text.rfind('\n') + 1); }

FleetResult ResultOf(ChildEnd end) {
  if (end.error != 0)
    throw NoResult{"the program could not be started: " + std::generic_category().message(end.error)};
  if (end.signal != 0) throw NoResult{fmt::format("the program was ended by signal {}", end.signal)};
  constexpr int kRefused = static_cast<int>(ExitCode::kWrongInput);
  if (end.exit_code == kRefused) return {kRefused, nullptr, std::move(end.words)};
  if (end.exit_code > kRefused)
    throw NoResult{fmt::format("exit code {}: {}", end.exit_code, LastLine(end.words))};
  try {
    return {end.exit_code, nlohmann::ordered_json::parse(end.said), ""};
  } catch (const nlohmann::ordered_json::exception&) {
    throw NoResult{fmt::format("what the program wrote is no JSON: {} bytes", end.said.size())};
  }
}

FleetResult Compute(const FleetPlan& plan, const PlannedInput& input, const FleetProgram& program) {
  std::vector<std::string> words{program.run, plan.command, input.file.path, "--json"};
  words.insert(words.end(), plan.options.begin(), plan.options.end());
  return ResultOf(RunChild(std::move(words), "", std::nullopt, ChildOutputs::kApart));
}

void DemandOptionsUnchanged(const FleetPlan& plan, SeenFiles& files) {
  for (const PlannedFile& file : plan.option_files) DemandUnchanged(file, files.Look(file.path));
}

void RunInput(const PlanFolder& folder, const FleetPlan& plan, const PlannedInput& input,
              const FleetProgram& program, SeenFiles& files, ShardEnd& end) {
  if (ReadResult(folder, input)) {
    ++end.were_there;
    return;
  }
  std::string words;
  try {
    DemandUnchanged(input, files);
    const FleetResult result = Compute(plan, input, program);
    // What the program read lies between two looks.
    SeenFiles again;
    DemandUnchanged(input, again);
    KeepResult(folder, input, result);
    ++end.kept;
    return;
  } catch (const BenchError& error) {
    words = error.what();
    ++end.changed;
  } catch (const daq::RecordError& error) {
    words = error.what();
    ++end.changed;
  } catch (const NoResult& none) {
    words = fmt::format("{}: {}", input.file.path, none.words);
  }
  ++end.failed;
  if (end.first_words.empty()) end.first_words = words;
  KeepFailure(folder, input, words);
}

void Add(ShardEnd& sum, const ShardEnd& one) {
  sum.were_there += one.were_there;
  sum.kept += one.kept;
  sum.failed += one.failed;
  sum.changed += one.changed;
  if (sum.first_words.empty()) sum.first_words = one.first_words;
}

}  // namespace

ShardMark::ShardMark(const PlanFolder& folder, std::size_t shard)
    : file_(::open(MarkOf(folder, shard).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
  if (!file_.is_open()) return;
  ::flock(file_.get(), LOCK_SH | LOCK_NB);
  ::futimens(file_.get(), nullptr);  // since when it runs
}

bool ShardMark::IsHeld(const PlanFolder& folder, std::size_t shard) {
  const daq::FileDescriptor file(::open(MarkOf(folder, shard).c_str(), O_RDONLY | O_CLOEXEC));
  return file.is_open() && ::flock(file.get(), LOCK_EX | LOCK_NB) != 0;
}

void EnterWorkingFolder(const PlanFolder& folder, const FleetPlan& plan) {
  std::error_code error;
  std::filesystem::current_path(plan.working_folder, error);
  if (!error) return;
  Refuse(
      folder.Plan(),
      fmt::format("its working folder {} cannot be entered here: {}", plan.working_folder, error.message()),
      "a file system that all machines share");
}

ShardEnd RunShard(const PlanFolder& folder, const FleetPlan& plan, const FleetProgram& program,
                  std::size_t shard, const std::function<void()>& after_each) {
  DemandProgram(folder, plan, program);
  if (shard >= plan.shards)
    Refuse(folder.Plan(), fmt::format("has no shard {}", shard), fmt::format("0 to {}", plan.shards - 1));
  const ShardMark mark(folder, shard);
  SeenFiles files;
  DemandOptionsUnchanged(plan, files);
  ShardEnd end;
  for (const PlannedInput& input : plan.inputs) {
    if (input.shard != shard) continue;
    RunInput(folder, plan, input, program, files, end);
    if (after_each) after_each();
  }
  return end;
}

ShardEnd RunAllShards(const PlanFolder& folder, const FleetPlan& plan, const FleetProgram& program,
                      std::size_t jobs, const std::function<void(std::size_t done)>& progress) {
  std::atomic<std::size_t> next{0};
  std::mutex guard;
  ShardEnd sum;
  std::size_t done = 0;
  std::exception_ptr trouble;
  const auto work = [&] {
    try {
      for (std::size_t shard = next++; shard < plan.shards; shard = next++) {
        const ShardEnd end = RunShard(folder, plan, program, shard, [&] {
          const std::scoped_lock lock(guard);
          progress(++done);
        });
        const std::scoped_lock lock(guard);
        Add(sum, end);
      }
    } catch (...) {
      next = plan.shards;
      const std::scoped_lock lock(guard);
      if (!trouble) trouble = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> workers;
    for (std::size_t i = 1; i < jobs; ++i) workers.emplace_back(work);
    work();
  }
  if (trouble) std::rethrow_exception(trouble);
  return sum;
}

}  // namespace strainwave::bench
