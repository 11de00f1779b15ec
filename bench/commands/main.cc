// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <filesystem>
#include <sstream>
#include <system_error>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "bench/campaign/database.h"
#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/commands/version.h"
#include "bench/errors/bench_error.h"
#include "daq/data_file_error.h"
#include "daq/record_error.h"
#include "schedules/reader/findings.h"

namespace {

using strainwave::bench::ExitCode;

constexpr const char* kNoMemory =
    "error: the machine has no memory left for this program (expected more: end what else runs, or raise the "
    "limit that `ulimit -v` shows)";

constexpr const char* kNoThread =
    "error: the machine refuses this program another thread (expected more memory or threads: end what else "
    "runs, or raise the limits that `ulimit -v` and `ulimit -u` show)";

int Fail(ExitCode code, const char* message) {
  strainwave::bench::ToStderr("{}\n", message);
  return static_cast<int>(code);
}

// What no path can be is wrong input, wherever it was met; a lost folder or a full disk is not.
int FailOfFile(const std::error_code& code, const std::string& path, const std::string& message) {
  if (code == std::errc::filename_too_long || code == std::errc::not_a_directory ||
      code == std::errc::too_many_symbolic_link_levels) {
    return Fail(ExitCode::kWrongInput,
                fmt::format("{}: error: {} (expected another path)", path, code.message()).c_str());
  }
  return Fail(ExitCode::kMachineFailed, message.c_str());
}

// One place that turns what went wrong into words and an exit code.
int Guarded(const strainwave::bench::Action& action) {
  try {
    return action();
  } catch (const strainwave::schedules::FileError& error) {
    return Fail(ExitCode::kWrongInput, error.what());
  } catch (const strainwave::daq::RecordError& error) {
    return Fail(ExitCode::kWrongInput, error.what());
  } catch (const strainwave::bench::BenchError& error) {
    return Fail(error.exit_code(), error.what());
  } catch (const strainwave::daq::DataFileError& error) {
    return FailOfFile(error.code(), error.path(), error.what());
  } catch (const strainwave::bench::DatabaseError& error) {
    return Fail(ExitCode::kMachineFailed, error.what());
  } catch (const std::bad_alloc&) {
    return Fail(ExitCode::kMachineFailed, kNoMemory);
  } catch (const std::filesystem::filesystem_error& error) {
    return FailOfFile(error.code(), error.path1().string(), fmt::format("error: {}", error.what()));
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::resource_unavailable_try_again)
      return Fail(ExitCode::kMachineFailed, kNoThread);
    return Fail(ExitCode::kMachineFailed, fmt::format("error: {}", error.what()).c_str());
  } catch (const std::invalid_argument& error) {
    return Fail(ExitCode::kWrongInput, fmt::format("error: {}", error.what()).c_str());
  } catch (const std::exception& error) {
    return Fail(ExitCode::kMachineFailed, fmt::format("internal error: {}", error.what()).c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  using strainwave::bench::FinishOutput, strainwave::bench::ToStderr, strainwave::bench::ToStdout,
      strainwave::bench::kVersionHelp;
  strainwave::bench::PrepareOutput();
  if (const auto answered = strainwave::bench::AnswerVersion(argc, argv)) return FinishOutput(*answered);
  CLI::App app(
      "strainwave runs accelerated life tests of harmonic drives and tells what the reducer is really "
      "doing.\n"
      "Example: strainwave run schedules/quick.yaml --out campaigns/first");
  app.require_subcommand(1);
  app.add_flag("--version", kVersionHelp);
  strainwave::bench::Action action;
  strainwave::bench::AddValidate(app, action);
  strainwave::bench::AddRun(app, action);
  strainwave::bench::AddDevices(app, action);
  strainwave::bench::AddBench(app, action);
  strainwave::bench::AddDriveProfile(app, action);
  strainwave::bench::AddStatus(app, action);
  strainwave::bench::AddServe(app, action);
  strainwave::bench::AddUsers(app, action);
  strainwave::bench::AddStop(app, action);
  strainwave::bench::AddAlarms(app, action);
  strainwave::bench::AddNote(app, action);
  strainwave::bench::AddWatch(app, action);
  strainwave::bench::AddCentral(app, action);
  strainwave::bench::AddRecompute(app, action);
  strainwave::bench::AddDiagnose(app, action);
  strainwave::bench::AddTable(app, action);
  strainwave::bench::AddVerify(app, action);
  strainwave::bench::AddReport(app, action);
  strainwave::bench::AddConvert(app, action);
  strainwave::bench::AddSimulate(app, action);
  strainwave::bench::AddFeatures(app, action);
  strainwave::bench::AddTrain(app, action);
  strainwave::bench::AddBaseline(app, action);
  strainwave::bench::AddPredict(app, action);
  strainwave::bench::AddExport(app, action);
  strainwave::bench::AddMonitor(app, action);
  strainwave::bench::AddLife(app, action);
  strainwave::bench::AddHealth(app, action);
  strainwave::bench::AddFaults(app, action);
  strainwave::bench::AddFingerprint(app, action);
  strainwave::bench::AddFleet(app, action);
  std::ostringstream results;
  std::ostringstream words;
  int code = 0;
  try {
    app.parse(argc, argv);
    code = Guarded(action);
  } catch (const CLI::ParseError& error) {
    // Help is a result; it comes this way, too.
    code = app.exit(error, results, words) == 0 ? 0 : static_cast<int>(ExitCode::kWrongInput);
    ToStdout("{}", results.str());
    ToStderr("{}", words.str());
  }
  return FinishOutput(code);
}
