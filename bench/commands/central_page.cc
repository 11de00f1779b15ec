// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <memory>
#include <string>
#include <system_error>
#include <thread>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "bench/central/fleet_server.h"
#include "bench/central/schema.h"
#include "bench/commands/central_commands.h"
#include "bench/commands/no_core.h"
#include "bench/commands/output.h"
#include "bench/commands/person.h"
#include "bench/commands/server_option.h"

namespace strainwave::bench {
namespace {

std::unique_ptr<FleetServer> ServeFleet(const FleetSettings& settings) {
  try {
    return std::make_unique<FleetServer>(settings);
  } catch (const std::system_error& error) {
    if (error.code() != std::errc::address_in_use) throw;
    throw BenchError(
        ExitCode::kMachineFailed,
        fmt::format("error: port {} is taken by another program (expected a free one: --port 0 for any)",
                    settings.port));
  }
}

int ServeAllBenches(const FleetSettings& settings) {
  LeaveNoCore();
  CheckConninfo(settings.conninfo);
  ListenForQuickStop();
  // What is wrong with the server is said here, before anybody looks at the page.
  {
    Server server(settings.conninfo, [] { return Requested() != StopRequest::kNone; });
    DemandSchema(server);
  }
  const auto page = ServeFleet(settings);
  ToStdout("all benches: http://127.0.0.1:{}/   (Ctrl-C ends the page, nothing else)\n", page->port());
  while (Requested() == StopRequest::kNone) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddCentralPage(CLI::App& central, Action& action) {
  CLI::App* command = central.add_subcommand(
      "page",
      "One page of all benches, for browsers: what each does, its last alarm, when it was last seen; and "
      "specimens "
      "beside each other by one quantity.\n"
      "It reads the server and changes nothing. It is served to this machine alone; from another one: ssh -L "
      "8090:127.0.0.1:8090 HOST.\n"
      "Example: strainwave central page --server service=lab --port 8090");
  auto settings = std::make_shared<FleetSettings>();
  settings->port = 8090;
  AddServerOption(*command, settings->conninfo);
  command->add_option("--port", settings->port, "of the page; 0: any free one")
      ->capture_default_str()
      ->check(CLI::Range(0, 65535));
  command->callback([settings, &action] { action = [settings] { return ServeAllBenches(*settings); }; });
}

}  // namespace strainwave::bench
