// SPDX-License-Identifier: Apache-2.0
// Habits that a reader meets in every file, kept by reading every file.
#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tests/repository/source_tree.h"

namespace strainwave::repository::house_rules_test {
namespace {

constexpr std::size_t kMostLines = 400;

bool IsScript(std::string_view path) {
  return HasSuffix(path, ".sh") || HasSuffix(path, ".py") || path == ".ci/run";
}

bool IsBuildFile(std::string_view path) {
  return HasSuffix(path, "CMakeLists.txt") || HasSuffix(path, ".cmake");
}

bool IsCode(std::string_view path) { return IsCpp(path) || IsScript(path) || IsBuildFile(path); }

std::vector<SourceFile> ReadCode() {
  std::vector<SourceFile> files;
  for (const std::string& path : ListSources()) {
    if (IsCode(path)) {
      files.push_back(ReadSource(path));
    }
  }
  EXPECT_GT(files.size(), 30U) << "hardly a file was read: the test looks in the wrong place";
  return files;
}

std::string LineOrNothing(const SourceFile& file, std::size_t index) {
  return index < file.lines.size() ? file.lines[index] : "";
}

TEST(HouseRules, EveryFileOpensWithItsLicenceLine) {
  for (const SourceFile& file : ReadCode()) {
    const std::size_t at = LineOrNothing(file, 0).starts_with("#!") ? 1 : 0;
    const std::string mark = IsCpp(file.path) ? "//" : "#";
    EXPECT_EQ(LineOrNothing(file, at), mark + " SPDX-License-Identifier: Apache-2.0")
        << file.path << ":" << at + 1;
  }
}

TEST(HouseRules, EveryHeaderIsReadOnce) {
  for (const SourceFile& file : ReadCode()) {
    if (HasSuffix(file.path, ".h")) {
      EXPECT_EQ(std::count(file.lines.begin(), file.lines.end(), "#pragma once"), 1) << file.path;
    }
  }
}

TEST(HouseRules, NoLineHasATabOrACarriageReturn) {
  for (const SourceFile& file : ReadCode()) {
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      EXPECT_EQ(file.lines[i].find_first_of("\t\r"), std::string::npos) << file.path << ":" << i + 1;
    }
  }
}

TEST(HouseRules, NoMergeIsLeftHalfDone) {
  const auto marks = [](const std::string& line) {
    return line.starts_with("<<<<<<< ") || line.starts_with(">>>>>>> ");
  };
  for (const std::string& path : ListSources()) {
    const SourceFile file = ReadSource(path);
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      EXPECT_FALSE(marks(file.lines[i])) << path << ":" << i + 1;
    }
  }
}

TEST(HouseRules, FilesStayShort) {
  for (const SourceFile& file : ReadCode()) {
    EXPECT_LE(file.lines.size(), kMostLines) << file.path << " is to be split";
  }
}

// Files of one program are compiled together, and tests like short names: each has a namespace of its own.
TEST(HouseRules, EveryTestHasItsOwnNamespace) {
  for (const SourceFile& file : ReadCode()) {
    if (!file.path.starts_with("tests/") || !HasSuffix(file.path, "_test.cc")) continue;
    const std::string name = std::filesystem::path(file.path).stem().string();
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      const std::string& line = file.lines[i];
      if (!line.starts_with("namespace strainwave") || line.find('=') != std::string::npos) continue;
      EXPECT_EQ(line, line.substr(0, line.rfind("::")) + "::" + name + " {") << file.path << ":" << i + 1;
    }
  }
}

// Whoever writes past it waits for a stopped terminal, dies of a closed pipe or throws on a full disk.
TEST(HouseRules, CommandsWriteThroughOneDoor) {
  const std::regex past(
      R"(fmt::print|\bprintf\(|std::(cout|cerr|clog|puts|putchar|perror)\b|\b(stdout|stderr)\b[,)])");
  for (const SourceFile& file : ReadCode()) {
    if (!file.path.starts_with("bench/") || !IsCpp(file.path) || file.path == "bench/commands/output.cc")
      continue;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      EXPECT_FALSE(std::regex_search(file.lines[i], past)) << file.path << ":" << i + 1;
    }
  }
}

TEST(HouseRules, NothingIsLeftForLater) {
  // Put together here, so that this file does not find itself.
  const std::string marks[] = {std::string("TO") + "DO", std::string("FIX") + "ME"};
  for (const SourceFile& file : ReadCode()) {
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      for (const std::string& mark : marks) {
        EXPECT_EQ(file.lines[i].find(mark), std::string::npos) << file.path << ":" << i + 1;
      }
    }
  }
}

TEST(HouseRules, ReadmeNamesExactlyTwoCommandsOfSetup) {
  const std::regex command(R"(\./setup\.sh( \S+)?)");
  std::set<std::string> in_blocks;
  bool in_block = false;
  for (const std::string& line : ReadSource("README.md").lines) {
    if (line.starts_with("```")) {
      in_block = !in_block;
    }
    std::smatch match;
    if (in_block && std::regex_search(line, match, command)) {
      in_blocks.insert(match.str());
    }
  }
  EXPECT_EQ(in_blocks, (std::set<std::string>{"./setup.sh demo", "./setup.sh test"}));
}

}  // namespace
}  // namespace strainwave::repository::house_rules_test
