// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/page_options.h"

#include <fmt/core.h>

#include "bench/accounts/users_file.h"
#include "bench/errors/bench_error.h"
#include "bench/page/page_gate.h"
#include "bench/serving/addresses.h"

namespace strainwave::bench {
void AddPageOptions(CLI::App& command, PageOptions& options, CLI::Option* needs) {
  std::vector<CLI::Option*> added;
  CLI::Option* const listen =
      command
          .add_option("--listen", options.listen,
                      "address where the page is served; one that other machines reach needs --users and "
                      "--tls, and whoever looks on logs in; 0.0.0.0: all of this machine")
          ->capture_default_str()
          ->type_name("ADDRESS");
  added.push_back(listen);
  added.push_back(command
                      .add_option("--host", options.hosts,
                                  "name by which other machines call this one, beside its address; may be "
                                  "given several times")
                      ->type_name("NAME")
                      ->needs(listen));
  added.push_back(command.add_option("--port", options.port, "of the page; 0: any free one")
                      ->capture_default_str()
                      ->check(CLI::Range(0, 65535)));
  added.push_back(command.add_option(
      "--users", options.users, "who may do more than look on and stop: a file that strainwave users keeps"));
  added.push_back(command.add_option("--tls", options.tls, "certificate and key (PEM): the page by https")
                      ->expected(2)
                      ->type_name("CERT KEY"));
  CLI::Option* const predictor = command.add_option(
      "--predictor", options.predictor,
      "what it says of the newest cycle beside what was measured: a folder that train has written");
  added.push_back(predictor);
  added.push_back(
      command
          .add_option(
              "--baseline", options.baseline,
              "what the reducer was like at first, as `baseline` writes it, for a predictor of changes")
          ->needs(predictor));
  if (needs == nullptr) return;
  // One that needs another one needs what that one does; of two, help would name either first.
  for (CLI::Option* option : added)
    if (option->get_needs().empty()) option->needs(needs);
}

void CheckPageOptions(const PageOptions& options) {
  if (CanonicalAddress(options.listen).empty()) {
    Refuse("--listen", fmt::format("'{}' is no IP address", options.listen),
           "one of this machine, as 192.0.2.7, or 0.0.0.0 for all of them");
  }
  for (const std::string& host : options.hosts) {
    if (IsHostName(host)) continue;
    Refuse("--host", fmt::format("'{}' is no name of a machine", host),
           "letters, digits, hyphens and dots, without a port");
  }
  if (IsLoopbackAddress(options.listen)) return;
  std::string missing;
  if (options.users.empty()) {
    missing +=
        "--users FILE, so that only people whom you know look on (strainwave users FILE add NAME "
        "--role operator makes one); ";
  }
  if (options.tls.empty()) missing += "--tls CERT KEY, so that nobody reads passwords on the way; ";
  if (!missing.empty()) {
    Refuse("--listen", fmt::format("other machines reach {}", options.listen),
           fmt::format("too: {}or no --listen, and from the other machine: ssh -L {}:127.0.0.1:{} HOST",
                       missing, options.port, options.port));
  }
  if (ReadUsersFile(options.users).empty()) {
    Refuse(options.users, "nobody could look at the page, for the file has no users",
           fmt::format("one: strainwave users {} add NAME --role operator", options.users));
  }
}

std::vector<std::string> WordsOf(const PageOptions& options) {
  std::vector<std::string> words{"--listen", options.listen, "--port", std::to_string(options.port)};
  for (const std::string& host : options.hosts) words.insert(words.end(), {"--host", host});
  if (!options.users.empty()) words.insert(words.end(), {"--users", options.users});
  if (!options.tls.empty()) words.insert(words.end(), {"--tls", options.tls[0], options.tls[1]});
  if (!options.predictor.empty()) words.insert(words.end(), {"--predictor", options.predictor});
  if (!options.baseline.empty()) words.insert(words.end(), {"--baseline", options.baseline});
  return words;
}

}  // namespace strainwave::bench
