// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/server_option.h"

namespace strainwave::bench {

CLI::Option* AddServerOption(CLI::App& command, std::string& conninfo) {
  return command
      .add_option("--server", conninfo,
                  "PostgreSQL, as libpq takes it: 'host=HOST dbname=NAME user=ROLE', a URI, or service=NAME; without "
                  "a password")
      ->type_name("CONNINFO")
      ->required();
}

}  // namespace strainwave::bench
