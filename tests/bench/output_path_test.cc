// SPDX-License-Identifier: Apache-2.0
#include "bench/errors/output_path.h"

#include <fstream>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "bench/errors/bench_error.h"
#include "tests/simulation/program.h"

namespace strainwave::bench::output_path_test {
namespace {

namespace fs = std::filesystem;

std::string Said(const std::function<void()>& what) {
  try {
    what();
  } catch (const BenchError& error) {
    return std::to_string(static_cast<int>(error.exit_code())) + ' ' + error.what();
  }
  return "none";
}

class OutputPath : public testing::Test {
 protected:
  OutputPath() { std::ofstream(folder_ / "file") << "x"; }
  std::string At(const std::string& name) const { return folder_ / name; }
  static std::string OfFolder(const fs::path& path) {
    return Said([&] { DemandOutputFolder(path); });
  }
  static std::string OfFile(const fs::path& path) {
    return Said([&] { DemandOutputFile(path); });
  }
  const ScratchFolder folder_;
};

TEST_F(OutputPath, OfAFolderMayBeMade) {
  const std::string expected = " (expected a folder, there or to be made)";
  EXPECT_EQ(OfFolder(folder_.path()), "none");
  EXPECT_EQ(OfFolder(At("a/b/c/")), "none");
  EXPECT_EQ(OfFolder("a/b"), "none");
  EXPECT_EQ(OfFolder(At("file")), "2 " + At("file") + ": error: is no folder" + expected);
  EXPECT_EQ(OfFolder(At("file/a/b")),
            "2 " + At("file/a/b") + ": error: " + At("file") + " is no folder" + expected);
  EXPECT_EQ(OfFolder(""), "2 '': error: is no folder" + expected);
  const std::string longest = At(std::string(300, 'a'));
  EXPECT_EQ(OfFolder(longest), "2 " + longest + ": error: cannot be written: File name too long" + expected);
  EXPECT_FALSE(fs::exists(At("a")));
}

TEST_F(OutputPath, OfAFileIsInAFolderThatIsThere) {
  EXPECT_EQ(OfFile(At("file")), "none");
  EXPECT_EQ(OfFile(At("new")), "none");
  EXPECT_EQ(OfFile("new"), "none");
  for (const std::string& path : {At("none/new"), At("file/new")}) {
    EXPECT_EQ(OfFile(path),
              "2 " + path + ": error: its folder is not there (expected a file in a folder that is)");
  }
  for (const std::string& path : {folder_.path().string(), std::string("/dev/null"), At("new/")}) {
    EXPECT_EQ(OfFile(path), "2 " + path + ": error: is no file (expected the name of a file to write)");
  }
  EXPECT_EQ(OfFile(""), "2 '': error: is no file (expected the name of a file to write)");
}

}  // namespace
}  // namespace strainwave::bench::output_path_test
