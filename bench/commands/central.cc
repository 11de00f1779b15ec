// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "bench/central/forward_loop.h"
#include "bench/central/roles.h"
#include "bench/central/schema.h"
#include "bench/commands/central_commands.h"
#include "bench/commands/commands.h"
#include "bench/commands/no_core.h"
#include "bench/commands/output.h"
#include "bench/commands/person.h"
#include "bench/commands/server_option.h"
#include "bench/utc.h"

namespace strainwave::bench {
namespace {

bool IsToEndCentral() { return Requested() != StopRequest::kNone; }

int MigrateServer(const std::string& conninfo) {
  CheckConninfo(conninfo);
  Server server(conninfo);
  const std::vector<int> made = Migrate(server);
  for (const int version : made) ToStdout("version {} of the tables made\n", version);
  if (made.empty()) ToStdout("the tables are of version {}: nothing to do\n", kSchemaVersion);
  return static_cast<int>(ExitCode::kDone);
}

void AddMigrate(CLI::App& central, Action& action) {
  CLI::App* command = central.add_subcommand(
      "migrate",
      "Make the tables in a database, or bring those of an earlier version up. Safe to repeat.\n"
      "The role needs the right to make a schema there, and roles.\n"
      "Example: strainwave central migrate --server 'host=db.lab dbname=strainwave user=admin'");
  auto conninfo = std::make_shared<std::string>();
  AddServerOption(*command, *conninfo);
  command->callback([=, &action] { action = [conninfo] { return MigrateServer(*conninfo); }; });
}

struct RoleOptions {
  std::string conninfo;
  RoleOrder order;
  std::string passfile;
};

int AddRole(const RoleOptions& options) {
  LeaveNoCore();
  CheckConninfo(options.conninfo);
  RoleOrder order = options.order;
  order.passfile = options.passfile.empty() ? RoleOf(order.kind, order.name) + ".pgpass" : options.passfile;
  Server server(options.conninfo);
  DemandSchema(server);
  ToStdout("{}\n", MakeRole(server, order));
  return static_cast<int>(ExitCode::kDone);
}

void AddAddRole(CLI::App& central, Action& action, RoleKind kind) {
  const bool is_bench = kind == RoleKind::kBench;
  CLI::App* command = central.add_subcommand(
      is_bench ? "add-bench" : "add-reader",
      is_bench
          ? "Make the role of a bench, which sees and writes its own rows only, with a random password in a "
            "file for its machine.\n"
            "Example: strainwave central add-bench hall-3 --server service=lab"
          : "Make a role that sees all and writes nothing, for the page, fetch, life and report.\n"
            "Example: strainwave central add-reader office --server service=lab");
  auto options = std::make_shared<RoleOptions>();
  options->order.kind = kind;
  command->add_option("NAME", options->order.name, is_bench ? "of the bench" : "of the reader")->required();
  AddServerOption(*command, options->conninfo);
  command->add_option("--passfile", options->passfile,
                      "file to write: as ~/.pgpass, for its owner alone (default: ROLE.pgpass)");
  command->add_flag("--new-password", options->order.new_password, "of a role that is there");
  if (is_bench) {
    command->add_flag("--new-machine", options->order.new_machine,
                      "the bench's machine was replaced: the next one that forwards is taken for its own");
  }
  command->callback([options, &action] { action = [options] { return AddRole(*options); }; });
}

struct ForwardOptions {
  ForwardOrder order;
  std::string store;
  std::string machine_id{"/etc/machine-id"};
};

int Forward(const ForwardOptions& options) {
  LeaveNoCore();
  CheckConninfo(options.order.conninfo);
  ListenForQuickStop();
  ForwardOrder order = options.order;
  order.settings.machine = MachineId(options.machine_id);
  order.settings.store = options.store;
  order.settings.utc_ms = UtcMilliseconds;
  // Nobody who reads the words, or does not, holds up the campaign's way to the server.
  const LiveOutput output(IsToEndCentral, LiveOutput::Results::kDropped);
  const bool all =
      RunForward(order, IsToEndCentral, [](const std::string& line) { ToStderr("{} {}\n", UtcNow(), line); });
  return static_cast<int>(all ? ExitCode::kDone : ExitCode::kMachineFailed);
}

void AddForward(CLI::App& central, Action& action) {
  CLI::App* command = central.add_subcommand(
      "forward",
      "Bring campaigns, running or not, to the server: all that it lacks, each row once.\n"
      "It is a program of its own beside run, which it neither touches nor slows down: the campaign's folder "
      "is only "
      "read, and holds what waits while the server is away. With --follow it goes on until Ctrl-C, which "
      "ends the "
      "forwarding, not the campaign.\n"
      "Example: strainwave central forward campaigns/first --server service=lab --follow");
  auto options = std::make_shared<ForwardOptions>();
  options->order.patience_s = 60.0;
  command->add_option("CAMPAIGN", options->order.folders, "folders of campaigns")->required();
  AddServerOption(*command, options->order.conninfo);
  command->add_option(
      "--store", options->store,
      "folder for the raw records, each under the SHA-256 of its bytes; may be shared by all benches");
  CLI::Option* const follow =
      command->add_flag("--follow", options->order.follow, "go on with what a running campaign adds");
  command
      ->add_option(
          "--patience", options->order.patience_s,
          "s that the server may be away before this ends with exit code 3; attempts included; with --follow there is no end")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str()
      ->excludes(follow);
  command
      ->add_option("--machine-id", options->machine_id,
                   "file that tells this machine from others, so that no two forward under one bench's name")
      ->capture_default_str();
  command->callback([options, &action] { action = [options] { return Forward(*options); }; });
}

}  // namespace

void AddCentral(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "central",
      "Many benches beside each other in a PostgreSQL server: their campaigns, results and alarms.\n"
      "Each bench keeps its own journal as ever and forwards it; one page shows all of them, and life and "
      "report take "
      "campaigns from there (--from-server).\n"
      "Passwords are taken from ~/.pgpass, PGPASSFILE or a service file of libpq, never from the command "
      "line.");
  command->require_subcommand(1);
  AddMigrate(*command, action);
  AddAddRole(*command, action, RoleKind::kBench);
  AddAddRole(*command, action, RoleKind::kReader);
  AddForward(*command, action);
  AddCentralPage(*command, action);
  AddCentralCampaigns(*command, action);
}

}  // namespace strainwave::bench
