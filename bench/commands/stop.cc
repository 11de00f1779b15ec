// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "bench/campaign/end_request.h"
#include "bench/campaign/folder.h"
#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

struct StopOptions {
  std::string folder;
  std::string verb{"pause"};
};

const std::map<std::string, EndRequest>& Requests() {
  static const std::map<std::string, EndRequest> requests{{"pause", EndRequest::kPause},
                                                          {"finish-cycle", EndRequest::kFinishCycle},
                                                          {"quick-stop", EndRequest::kQuickStop},
                                                          {"shutdown", EndRequest::kShutdown}};
  return requests;
}

int Stop(const StopOptions& options) {
  const CampaignFolder folder{options.folder};
  const int process = AskToEnd(folder, Requests().at(options.verb));
  if (process <= 0 && std::filesystem::exists(folder.Journal())) {
    ToStdout(
        "{}: nobody runs this campaign: there is nobody to ask for a stop (after a kill or a power cut the "
        "drives stop by their own supervision: look at the bench before anybody goes near)\n",
        folder.root.string());
    return static_cast<int>(ExitCode::kDone);
  }
  if (process <= 0) {
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("{}: error: nobody runs this campaign (expected the folder of a running one)",
                    folder.root.string()));
  }
  ToStdout("asked process {} for: {}\n", process, options.verb);
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddStop(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("stop",
                                         "End a running campaign: at the next checkpoint (pause), after the "
                                         "cycle (finish-cycle), after ramping down "
                                         "(shutdown), or at once (quick-stop).\nEach leaves torque off, "
                                         "brakes on, and a campaign that --resume goes on "
                                         "with.\nThis is not an emergency stop: that one is wired.\n"
                                         "Example: strainwave stop campaigns/first finish-cycle");
  auto options = std::make_shared<StopOptions>();
  command->add_option("DIR", options->folder, "the campaign's folder")->required();
  command->add_option("VERB", options->verb, "pause, finish-cycle, shutdown or quick-stop")
      ->capture_default_str()
      ->check(CLI::IsMember({"pause", "finish-cycle", "shutdown", "quick-stop"}));
  command->callback([options, &action] { action = [options] { return Stop(*options); }; });
}

}  // namespace strainwave::bench
