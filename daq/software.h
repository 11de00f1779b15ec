// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace strainwave::daq {

/// Name and version of what runs here, with the commit it was built from: "strainwave 0.1.0 (1a2b3c4)",
/// "-dirty" behind the commit where files differed from it. It stands in every HDF5 file (attribute
/// `software`), in the journals of campaigns and in diagnoses. A program gives itself its own
/// (`strainwave_program`, cmake/software.cmake); without that, as in tests, and built outside of a git
/// checkout, the version stands alone.
std::string_view Software();

/// The attribute of HDF5 files, in the root group.
inline constexpr const char* kSoftwareName = "software";

}  // namespace strainwave::daq
