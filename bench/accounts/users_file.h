// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "schedules/reader/findings.h"

namespace strainwave::bench {

/// A viewer looks and leaves words; an operator acts on the campaign, too.
enum class UserRole { kViewer, kOperator };

/// "viewer", "operator".
std::string_view Name(UserRole role);

struct User {
  std::string name;
  UserRole role{UserRole::kViewer};
  std::string password;  // its hash, as `HashPassword` makes it
};

/// A file of users that cannot be used.
class UsersFileError : public schedules::FileError {
 public:
  using FileError::FileError;
};

/// Reads a file of users (`users: 1`, then `accounts:`).
/// @throws UsersFileError with every error of the file; one that others may read is such an error.
std::vector<User> ReadUsersFile(const std::filesystem::path& path);
/// The same for a text, which messages call `file_name`.
std::vector<User> ParseUsersFile(const std::string& text, std::string_view file_name);

/// Readable for its owner alone, whole or not at all. @throws daq::DataFileError.
void WriteUsersFile(const std::filesystem::path& path, const std::vector<User>& users);

/// Whether it may be a user's: 1 to 40 letters, digits, spaces in between, and . _ - @
bool IsUserName(std::string_view name);

}  // namespace strainwave::bench
