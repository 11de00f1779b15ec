// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/central/server.h"

namespace strainwave::bench {

/// The version of the server's tables that this program makes and works with.
inline constexpr int kSchemaVersion = 2;

/// Makes the tables, or brings those of an earlier version up: each version in a transaction of its own, one
/// program at a time. Nothing of what the tables hold is lost.
/// @param to  at most kSchemaVersion; another one is for tests.
/// @return the versions that it has made; none where all were there.
/// @throws BenchError (exit code 2) for tables of a newer version, or a server older than PostgreSQL 15;
///   ServerError.
std::vector<int> Migrate(Server& server, int to = kSchemaVersion);

/// @throws BenchError (exit code 2) where the tables are missing, older or newer than this program.
void DemandSchema(Server& server);

}  // namespace strainwave::bench
