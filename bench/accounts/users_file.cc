// SPDX-License-Identifier: Apache-2.0
#include "bench/accounts/users_file.h"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cstddef>

#include <fmt/core.h>

#include "bench/accounts/password_hash.h"
#include "bench/configuration/device_file.h"
#include "daq/whole_file.h"
#include "schedules/reader/yaml_map.h"

namespace strainwave::bench {
namespace {

constexpr schedules::FileKind kUsersFile{"users", "users: 1"};
constexpr std::size_t kLongestName = 40;
constexpr std::string_view kExpectedName = "expected 1 to 40 letters, digits, spaces in between, . _ - @";

bool IsLetter(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return std::isalnum(byte) != 0 || byte >= 0x80;  // of UTF-8
}

User ReadUser(schedules::YamlMap map, const std::vector<User>& before) {
  User user;
  user.name = map.Text("name");
  if (!IsUserName(user.name)) {
    map.AddError("name", fmt::format("name = {} is no name of a user ({})", user.name, kExpectedName));
  }
  if (std::ranges::find(before, user.name, &User::name) != before.end()) {
    map.AddError("name",
                 fmt::format("name = {} is a second user of that name (expected another)", user.name));
  }
  user.role = map.Choice<UserRole>("role", {{Name(UserRole::kViewer), UserRole::kViewer},
                                            {Name(UserRole::kOperator), UserRole::kOperator}});
  user.password = map.Secret("password");
  if (!IsPasswordHash(user.password)) {
    // Whatever stands there may be somebody's password: it is not repeated.
    map.AddError("password",
                 "password is not what strainwave users writes (expected scrypt$15$8$3$SALT$HASH; passwords "
                 "do not stand in this file)");
  }
  map.Finish();
  return user;
}

}  // namespace

std::string_view Name(UserRole role) { return role == UserRole::kOperator ? "operator" : "viewer"; }

bool IsUserName(std::string_view name) {
  if (name.empty() || name.size() > kLongestName || name.front() == ' ' || name.back() == ' ') return false;
  return std::ranges::all_of(name, [](char c) {
    return IsLetter(c) || std::string_view(" ._-@").find(c) != std::string_view::npos;
  });
}

std::vector<User> ParseUsersFile(const std::string& text, std::string_view file_name) {
  return ParseFile<UsersFileError>(
      text, file_name, kUsersFile, [](const schedules::YamlNode& root, schedules::ReadContext& context) {
        schedules::YamlMap map(root, context);
        map.Version("users");
        std::vector<User> users;
        for (schedules::YamlMap& account : map.MapList("accounts", schedules::Presence::kOptional)) {
          users.push_back(ReadUser(std::move(account), users));
        }
        map.Finish();
        return users;
      });
}

std::vector<User> ReadUsersFile(const std::filesystem::path& path) {
  std::vector<User> users = ParseUsersFile(TextOfFile<UsersFileError>(path, kUsersFile), path.string());
  struct stat found {};
  if (::stat(path.c_str(), &found) == 0 && (found.st_mode & (S_IROTH | S_IWOTH | S_IWGRP)) != 0) {
    schedules::FindingList findings;
    findings.AddError(0, 0,
                      fmt::format("everybody may read or write the file of users (expected its owner alone: "
                                  "chmod 600 {})",
                                  path.string()));
    throw UsersFileError(path.string(), findings);
  }
  return users;
}

void WriteUsersFile(const std::filesystem::path& path, const std::vector<User>& users) {
  std::string text =
      "# Users of the live page; strainwave users keeps this file. Passwords as scrypt (RFC 7914).\n"
      "users: 1\n";
  text += users.empty() ? "accounts: []\n" : "accounts:\n";
  for (const User& user : users) {
    text += fmt::format("  - name: \"{}\"\n    role: {}\n    password: {}\n", user.name, Name(user.role),
                        user.password);
  }
  const mode_t mask = ::umask(S_IRWXG | S_IRWXO);
  try {
    daq::WriteFileAtomically(path, text);
  } catch (...) {
    ::umask(mask);
    throw;
  }
  ::umask(mask);
}

}  // namespace strainwave::bench
