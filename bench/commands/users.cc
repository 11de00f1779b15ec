// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "bench/accounts/password_hash.h"
#include "bench/accounts/users_file.h"
#include "bench/commands/commands.h"
#include "bench/commands/hidden_line.h"
#include "bench/commands/no_core.h"
#include "bench/commands/output.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kShortestPassword = 8;

struct UsersOptions {
  std::string file;
  std::string verb{"list"};
  std::string name;
  UserRole role{UserRole::kViewer};
};

std::string ReadPassword(const std::string& name) {
  const auto ask = [&](const char* what) {
    auto line = ReadHiddenLine(fmt::format("{} of {}: ", what, name));
    if (!line) {
      throw BenchError(ExitCode::kWrongInput,
                       "error: there is no password on standard input (expected one line of it)");
    }
    return *line;
  };
  const std::string password = ask("password");
  if (password.size() < kShortestPassword) {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("error: the password has {} characters (expected at least {})",
                                 password.size(), kShortestPassword));
  }
  if (IsAtTerminal() && ask("again, the password") != password) {
    throw BenchError(ExitCode::kWrongInput, "error: the two passwords differ (expected the same twice)");
  }
  return password;
}

void DemandName(const UsersOptions& options) {
  if (IsUserName(options.name)) return;
  throw BenchError(ExitCode::kWrongInput,
                   fmt::format("NAME: error: '{}' is no name of a user (expected 1 to 40 letters, digits, "
                               "spaces in between, . _ - @)",
                               options.name));
}

int Change(const UsersOptions& options, std::vector<User> users) {
  DemandName(options);
  const auto known = std::ranges::find(users, options.name, &User::name);
  const bool is_known = known != users.end();
  if (options.verb == "remove") {
    if (!is_known) {
      throw BenchError(ExitCode::kWrongInput,
                       fmt::format("{}: error: there is no user '{}' (expected one that strainwave users {} "
                                   "lists)",
                                   options.file, options.name, options.file));
    }
    users.erase(known);
  } else {
    DemandOutputFile(options.file);
    User user{options.name, options.role, HashPassword(ReadPassword(options.name))};
    is_known ? static_cast<void>(*known = std::move(user)) : users.push_back(std::move(user));
  }
  WriteUsersFile(options.file, users);
  ToStdout("{}: {} {}\n", options.file, options.name,
           options.verb == "remove" ? "is no user any more, and logged out"
           : is_known               ? fmt::format("has a new password and is {}", Name(options.role))
                                    : fmt::format("is a user now, {}", Name(options.role)));
  return static_cast<int>(ExitCode::kDone);
}

int Run(const UsersOptions& options) {
  LeaveNoCore();
  const bool is_there = std::filesystem::exists(options.file);
  if (!is_there && options.verb != "add") {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("{}: error: there is no such file (expected one that strainwave users FILE "
                                 "add NAME makes)",
                                 options.file));
  }
  std::vector<User> users = is_there ? ReadUsersFile(options.file) : std::vector<User>();
  if (options.verb != "list") return Change(options, std::move(users));
  for (const User& user : users) ToStdout("{:40} {}\n", user.name, Name(user.role));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddUsers(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "users",
      "Who may act on the live page: list them, add one or give one a new password, remove one. A viewer "
      "leaves notes and comments; an operator also pauses, resumes, and answers alarms. The password is "
      "asked "
      "for, or is the first line of standard input.\n"
      "Example: strainwave users users.yaml add \"A. Meier\" --role operator");
  auto options = std::make_shared<UsersOptions>();
  command->add_option("FILE", options->file, "the file of users (YAML)")->required();
  command->add_option("VERB", options->verb, "list, add or remove")
      ->capture_default_str()
      ->check(CLI::IsMember({"list", "add", "remove"}));
  command->add_option("NAME", options->name, "of the user");
  command
      ->add_option_function<std::string>(
          "--role",
          [options](const std::string& role) {
            options->role = role == "operator" ? UserRole::kOperator : UserRole::kViewer;
          },
          "of add: viewer, or operator")
      ->check(CLI::IsMember({"viewer", "operator"}))
      ->default_str("viewer");
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

}  // namespace strainwave::bench
