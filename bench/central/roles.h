// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "bench/central/server.h"

namespace strainwave::bench {

enum class RoleKind { kBench, kReader };

/// What add-bench and add-reader are asked for.
struct RoleOrder {
  RoleKind kind{};
  std::string name;                // of the bench or the person
  std::filesystem::path passfile;  // is written; must not be there
  bool new_password{};             // of a role that is there
  bool new_machine{};              // of a bench that is there: forget by which machine it was forwarded
};

/// "bench_NAME" or "reader_NAME".
std::string RoleOf(RoleKind kind, const std::string& name);

/// Makes the role with a random password, which goes into a file of libpq's own format for the machine that
/// will use it; the server is told what SCRAM keeps of it. Both or none.
/// @return what was done, in words.
/// @throws BenchError (exit code 2) for a bad or taken name, a file that is there; ServerError.
std::string MakeRole(Server& server, const RoleOrder& order);

}  // namespace strainwave::bench
