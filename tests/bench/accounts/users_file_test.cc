// SPDX-License-Identifier: Apache-2.0
#include "bench/accounts/users_file.h"

#include <sys/stat.h>

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "bench/accounts/password_hash.h"

namespace strainwave::bench::users_file_test {
namespace {

const std::string kHash = HashPassword("correct horse", {.log2_n = 4, .r = 1, .p = 1});

std::string ErrorOf(const std::string& text) {
  try {
    ParseUsersFile(text, "users.yaml");
  } catch (const UsersFileError& error) {
    return error.what();
  }
  return "none";
}

TEST(UsersFile, ComesBackAsItWasWritten) {
  const auto file = std::filesystem::path(testing::TempDir()) / "users_file_test.yaml";
  const std::vector<User> users{{"A. Meier", UserRole::kOperator, kHash}, {"Jörg", UserRole::kViewer, kHash}};
  WriteUsersFile(file, users);
  const std::vector<User> read = ReadUsersFile(file);
  ASSERT_EQ(read.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read[i].name, users[i].name);
    EXPECT_EQ(read[i].role, users[i].role);
    EXPECT_EQ(read[i].password, users[i].password);
  }
  struct stat written {};
  ASSERT_EQ(::stat(file.c_str(), &written), 0);
  EXPECT_EQ(written.st_mode & 0777U, 0600U);
  WriteUsersFile(file, {});
  EXPECT_TRUE(ReadUsersFile(file).empty());
}

TEST(UsersFile, IsNotForEverybodysEyes) {
  const auto file = std::filesystem::path(testing::TempDir()) / "users_file_open_test.yaml";
  WriteUsersFile(file, {});
  for (const unsigned mode : {0604U, 0602U, 0620U, 0666U}) {
    std::filesystem::permissions(file, std::filesystem::perms(mode));
    try {
      ReadUsersFile(file);
      FAIL() << "read with " << mode;
    } catch (const UsersFileError& error) {
      EXPECT_EQ(std::string(error.what()),
                file.string() +
                    ": error: everybody may read or write the file of users (expected its owner alone: "
                    "chmod 600 " +
                    file.string() + ")");
    }
  }
  std::filesystem::permissions(file, std::filesystem::perms(0640));
  EXPECT_TRUE(ReadUsersFile(file).empty()) << "a group of administrators may read it";
}

TEST(UsersFile, LeavesTheMaskOfNewFilesAsItWas) {
  const auto file = std::filesystem::path(testing::TempDir()) / "users_file_mask_test.yaml";
  const mode_t before = ::umask(0027);
  WriteUsersFile(file, {});
  EXPECT_EQ(::umask(0027), 0027U);
  EXPECT_ANY_THROW(WriteUsersFile(file / "no folder", {}));
  EXPECT_EQ(::umask(before), 0027U);
}

TEST(UserNames, AreLettersDigitsAndAFewSigns) {
  for (const std::string& name : {std::string("a"), std::string("A. Meier"), std::string("Jörg"),
                                  std::string("a_b-c@d.e"), std::string(40, 'x'), std::string("7")}) {
    EXPECT_TRUE(IsUserName(name)) << name;
  }
  for (const std::string& name : {std::string(), std::string(" a"), std::string("a "), std::string(41, 'x'),
                                  std::string("a\tb"), std::string("a\nb"), std::string("a\"b"),
                                  std::string("a/b"), std::string("a:b"), std::string("a\0b", 3)}) {
    EXPECT_FALSE(IsUserName(name)) << name;
  }
}

TEST(UsersFile, SaysWhereItIsWrong) {
  EXPECT_EQ(ErrorOf("users: 2\n"),
            "users.yaml:1:8: error: users = 2: not a known version (expected 'users: 1', the version of the "
            "format)");
  EXPECT_EQ(ErrorOf("accounts: []\n"),
            "users.yaml:1:1: error: missing key 'users' (expected 'users: 1', the version of the format)");
  const std::string head = "users: 1\naccounts:\n";
  EXPECT_EQ(
      ErrorOf(head + "  - {name: \"-\\t\", role: viewer, password: " + kHash + "}\n"),
      "users.yaml:3:12: error: name = -\t is no name of a user (expected 1 to 40 letters, digits, spaces in "
      "between, . _ - @)");
  EXPECT_EQ(ErrorOf(head + "  - {name: a, role: operatr, password: " + kHash + "}\n"),
            "users.yaml:3:21: error: role = operatr: not known; did you mean 'operator'? (expected viewer or "
            "operator)");
  EXPECT_EQ(ErrorOf(head + "  - {name: a, role: viewer, password: secret99}\n"),
            "users.yaml:3:39: error: password is not what strainwave users writes (expected "
            "scrypt$15$8$3$SALT$HASH; passwords do not stand in this file)");
  const std::string account = "  - {name: a, role: viewer, password: " + kHash + "}\n";
  EXPECT_EQ(ErrorOf(head + account + account),
            "users.yaml:4:12: error: name = a is a second user of that name (expected another)");
  EXPECT_EQ(ErrorOf(head + account), "none");
}

}  // namespace
}  // namespace strainwave::bench::users_file_test
