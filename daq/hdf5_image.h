// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <vector>

#include "daq/hdf5_handle.h"

namespace strainwave::daq {

/// An HDF5 file that the library builds in memory and the operating system writes: a full disk then meets a
/// plain write(), which says so, and not a library that holds half-written caches and tries again on closing.
/// Names and attributes keep the order of creation; the same content gives the same bytes.
/// @throws Hdf5Error.
Hdf5Handle CreateHdf5InMemory();

/// The bytes of such a file as they would stand on the disk. @throws Hdf5Error.
std::vector<std::byte> ImageOfHdf5(hid_t file);

}  // namespace strainwave::daq
