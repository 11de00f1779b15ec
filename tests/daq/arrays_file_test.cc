// SPDX-License-Identifier: Apache-2.0
#include "daq/arrays_file.h"

#include <hdf5.h>

#include <fstream>

#include <gtest/gtest.h>

#include "daq/hdf5_handle.h"
#include "daq/record_error.h"
#include "daq/whole_file.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::arrays_file_test {
namespace {

ArraysFile TwoArrays() {
  return {.attributes = {{"wavelet", "sym8"}, {"levels", "7"}},
          .arrays = {{"zebra", {2, 3}, {1.0, -2.5, 3.0, 1e-300, 5.0, 6.0}}, {"ape", {1}, {0.1}}}};
}

std::string ErrorOf(const std::filesystem::path& path) {
  try {
    ReadArrays(path);
  } catch (const RecordError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ArraysFile, GivesBackWhatWasWritten) {
  const ScratchFolder folder;
  WriteArraysAtomically(folder / "a.h5", TwoArrays());
  const ArraysFile read = ReadArrays(folder / "a.h5");
  EXPECT_EQ(read.attributes, TwoArrays().attributes);
  ASSERT_EQ(read.arrays.size(), 2U);
  EXPECT_EQ(read.arrays[0].name, "zebra");  // in the order written
  EXPECT_EQ(read.arrays[0].shape, (std::vector<std::size_t>{2, 3}));
  EXPECT_EQ(read.arrays[0].values, TwoArrays().arrays[0].values);
  EXPECT_EQ(read.Find("ape")->values.front(), 0.1);
  EXPECT_EQ(read.Find("bee"), nullptr);
}

TEST(ArraysFile, SaysWhatIsWrongWithAFile) {
  const ScratchFolder folder;
  const auto path = folder / "a.h5";
  EXPECT_NE(ErrorOf(path).find("a.h5: error: "), std::string::npos) << ErrorOf(path);
  WriteArraysAtomically(path, TwoArrays());
  const std::string whole = ReadWholeFile(path);
  for (const std::size_t length : {std::size_t{0}, std::size_t{100}, whole.size() / 2}) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << whole.substr(0, length);
    EXPECT_NE(ErrorOf(path), "no error") << length;
  }
}

// 2^33 · 2^33 is nothing in 64 bits.
TEST(ArraysFile, RefusesExtentsWhoseProductIsBeyondAnyNumber) {
  const ScratchFolder folder;
  const auto path = folder / "a.h5";
  {
    const Hdf5Handle ordered(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    Check(H5Pset_link_creation_order(ordered.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
    const Hdf5Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, ordered.get(), H5P_DEFAULT), H5Fclose);
    constexpr hsize_t kExtents[] = {hsize_t{1} << 33U, hsize_t{1} << 33U};
    constexpr hsize_t kChunk[] = {16, 16};
    const Hdf5Handle space(H5Screate_simple(2, kExtents, nullptr), H5Sclose);
    const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    Check(H5Pset_chunk(creation.get(), 2, kChunk));
    const Hdf5Handle set(
        H5Dcreate2(file.get(), "huge", H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
        H5Dclose);
  }
  EXPECT_EQ(ErrorOf(path), path.string() +
                               ": error: HDF5 cannot read the file: array 'huge' is too large (expected the "
                               "arrays as they were written)");
}

TEST(ArraysFile, RefusesAShapeThatDoesNotFit) {
  const ScratchFolder folder;
  ArraysFile file = TwoArrays();
  file.arrays[0].shape = {2, 2};
  try {
    WriteArraysAtomically(folder / "a.h5", file);
    FAIL() << "written";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "array 'zebra' has 6 values (expected the product of its shape, 4)");
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "a.h5"));
}

}  // namespace
}  // namespace strainwave::daq::arrays_file_test
