// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "bench/campaign/folder.h"
#include "bench/commands/commands.h"
#include "bench/commands/no_core.h"
#include "bench/commands/output.h"
#include "bench/commands/page_options.h"
#include "bench/commands/person.h"
#include "bench/errors/bench_error.h"
#include "bench/page/page_gate.h"
#include "bench/page/page_server.h"
#include "bench/serving/addresses.h"

namespace strainwave::bench {
namespace {

struct ServeOptions {
  std::string folder;
  PageOptions page;
};

std::unique_ptr<PageServer> Serve(const ServeOptions& options, const TlsIdentity* tls) {
  const int port = options.page.port;
  PageSettings settings{.folder = {options.folder},
                        .address = options.page.listen,
                        .names = options.page.hosts,
                        .port = port,
                        .users_file = {},
                        .tls = tls,
                        .complain = {}};
  settings.predictor = options.page.predictor;
  settings.baseline = options.page.baseline;
  if (!options.page.users.empty()) settings.users_file = options.page.users;
  settings.complain = [](const std::string& sentence) { ToStderr("warning: {}\n", sentence); };
  try {
    return std::make_unique<PageServer>(settings);
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::address_in_use) {
      throw BenchError(ExitCode::kMachineFailed,
                       fmt::format("error: port {} is taken by another program, perhaps another page "
                                   "(expected a free one: --port {}, or --port 0 for any)",
                                   port, port < 65535 ? port + 1 : 8080));
    }
    if (error.code() == std::errc::address_not_available) {
      throw BenchError(ExitCode::kMachineFailed,
                       fmt::format("error: {} is no address of this machine (expected one that ip address "
                                   "lists, or 0.0.0.0 for all of them)",
                                   options.page.listen));
    }
    if (error.code() == std::errc::permission_denied && port > 0 && port < 1024) {
      throw BenchError(ExitCode::kMachineFailed,
                       fmt::format("error: port {} is for root alone (expected 1024 or higher)", port));
    }
    throw;
  }
}

int Run(const ServeOptions& options) {
  LeaveNoCore();
  ListenForQuickStop();
  const CampaignFolder folder{options.folder};
  if (!std::filesystem::is_directory(folder.root)) {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("{}: error: there is no such folder (expected that of a campaign, which "
                                 "strainwave run SCHEDULE --out {} makes)",
                                 options.folder, options.folder));
  }
  CheckPageOptions(options.page);
  std::optional<TlsIdentity> tls;
  try {
    if (!options.page.tls.empty()) tls.emplace(options.page.tls[0], options.page.tls[1]);
  } catch (const std::runtime_error& error) {
    throw BenchError(ExitCode::kWrongInput, error.what());
  }
  const auto server = Serve(options, tls ? &*tls : nullptr);
  ToStdout("{}: {}   ({}Ctrl-C ends the page, not the campaign)\n", options.folder,
           PageUrl(tls.has_value(), options.page.listen, options.page.hosts, server->port()),
           IsEveryAddress(options.page.listen) ? "and at every address of this machine; " : "");
  while (Requested() == StopRequest::kNone) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddServe(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "serve",
      "The live page of a campaign, running or not, for browsers: progress, readings, trends, and the quick "
      "stop.\n"
      "It is a program of its own: whatever becomes of it, the campaign goes on. Everybody who sees the page "
      "may stop the bench; all else needs a login, by a file of users. "
      "It is served to this machine alone; from another one: ssh -L 8080:127.0.0.1:8080 HOST, or --listen "
      "with --users and --tls, and then who looks on logs in.\n"
      "Example: strainwave serve campaigns/first --port 8080");
  auto options = std::make_shared<ServeOptions>();
  command->add_option("DIR", options->folder, "the campaign's folder")->required();
  AddPageOptions(*command, options->page, nullptr);
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

}  // namespace strainwave::bench
