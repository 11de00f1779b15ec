// SPDX-License-Identifier: Apache-2.0
#include "tests/checkout.h"

#include <filesystem>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/daq/scratch_folder.h"

namespace strainwave::repository::checkout_test {
namespace {

TEST(Checkout, IsTheOneThatHoldsThisTest) {
  EXPECT_TRUE(
      std::filesystem::exists(std::filesystem::path(SourceFolder()) / "tests/repository/checkout_test.cc"));
}

TEST(Checkout, HasItsProgramInTheBuildFolder) {
  EXPECT_EQ(std::filesystem::path(ProgramPath()), BuildFolder() / "strainwave");
  EXPECT_TRUE(std::filesystem::exists(BuildFolder() / "CMakeCache.txt"));
}

TEST(Checkout, ThatNobodyNamesIsAskedFor) {
  const daq::ScratchFolder build;
  const std::string words = (build / "source_folder").string() +
                            " is missing or empty (expected the folder of the checkout; cmake --preset "
                            "release writes it)";
  const auto read = [&] { return SourceFolderOf(build.path()); };
  EXPECT_EQ(daq::MessageOf<std::runtime_error>(read), words);
  daq::WriteBytes(build / "source_folder", "\n");
  EXPECT_EQ(daq::MessageOf<std::runtime_error>(read), words);
  daq::WriteBytes(build / "source_folder", "/somewhere else\n");
  EXPECT_EQ(read(), "/somewhere else");
}

}  // namespace
}  // namespace strainwave::repository::checkout_test
