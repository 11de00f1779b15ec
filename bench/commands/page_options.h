// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace strainwave::bench {

/// Where a page is served, who may look, and what predicts beside it, as `serve` and `run --serve` are told.
struct PageOptions {
  std::string listen{"127.0.0.1"};
  std::vector<std::string> hosts;
  int port{8080};
  std::string users;             // file; empty: none
  std::vector<std::string> tls;  // certificate and key
  std::string predictor;         // folder; empty: none
  std::string baseline;          // file, of a predictor of changes
};

/// --listen, --host, --port, --users, --tls, --predictor, --baseline. @param needs  an option without which
/// they mean nothing; null: none. @param options  outlives the command.
void AddPageOptions(CLI::App& command, PageOptions& options, CLI::Option* needs);

/// What a page needs that other machines reach: users and TLS, and names that are names.
/// @throws BenchError with what to add.
void CheckPageOptions(const PageOptions& options);

/// The same options as words of a command line.
std::vector<std::string> WordsOf(const PageOptions& options);

}  // namespace strainwave::bench
