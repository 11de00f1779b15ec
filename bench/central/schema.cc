// SPDX-License-Identifier: Apache-2.0
#include "bench/central/schema.h"

#include <iterator>

#include <fmt/core.h>

#include "bench/central/schema_versions.h"

namespace strainwave::bench {
namespace {

struct SchemaVersion {
  const char* what;
  const char* statements;
};

const SchemaVersion kVersions[] = {{"tables", kTablesOfVersion1}, {"roles and rights", kRightsOfVersion2}};
static_assert(std::size(kVersions) == kSchemaVersion);

constexpr int kOldestServer = 150000;  // of views that ask with the rights of whoever asks

// 0: there are none. Those that the program may not look at are somebody's all the same.
int VersionOf(Server& server) {
  const ServerRows there = server.Run("SELECT to_regclass('strainwave.versions') IS NOT NULL");
  if (!there.Truth(0, 0)) return 0;
  return static_cast<int>(
      server.Run("SELECT coalesce(max(version), 0) FROM strainwave.versions").Integer(0, 0));
}

[[noreturn]] void RefuseNewer(int version) {
  throw BenchError(
      ExitCode::kWrongInput,
      fmt::format(
          "error: the server's tables are of version {}, which is newer than this program (expected {} at "
          "most: a newer strainwave on this machine)",
          version, kSchemaVersion));
}

}  // namespace

std::vector<int> Migrate(Server& server, int to) {
  if (server.version() < kOldestServer) {
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("error: the server is PostgreSQL {} (expected 15 or newer)", server.version() / 10000));
  }
  std::vector<int> made;
  while (true) {
    ServerTransaction transaction(server);
    server.Run("SELECT pg_advisory_xact_lock(1398227286, 1)");
    const int version = VersionOf(server);
    if (version > kSchemaVersion) RefuseNewer(version);
    if (version >= to) return made;
    if (version == 0) {
      server.Execute(
          "CREATE SCHEMA IF NOT EXISTS strainwave; CREATE TABLE strainwave.versions(version integer PRIMARY "
          "KEY, "
          "what text NOT NULL, made timestamptz NOT NULL DEFAULT now())");
    }
    const SchemaVersion& next = kVersions[version];
    server.Execute(next.statements);
    server.Run("INSERT INTO strainwave.versions(version, what) VALUES ($1, $2)",
               {std::to_string(version + 1), std::string(next.what)});
    transaction.Commit();
    made.push_back(version + 1);
  }
}

void DemandSchema(Server& server) {
  int version = 0;
  try {
    version = VersionOf(server);
  } catch (const ServerError& error) {
    // Before rights were given, nobody but the owner sees how far the tables are.
    if (error.sqlstate() != "42501") throw;
  }
  if (version > kSchemaVersion) RefuseNewer(version);
  if (version < kSchemaVersion) {
    throw BenchError(
        ExitCode::kWrongInput,
        version == 0
            ? std::string("error: the server has no tables of strainwave that this role may use (expected "
                          "those of strainwave central migrate, and a role of add-bench or add-reader)")
            : fmt::format("error: the server's tables are of version {}, which is older than this program "
                          "(expected {}: strainwave central migrate)",
                          version, kSchemaVersion));
  }
}

}  // namespace strainwave::bench
