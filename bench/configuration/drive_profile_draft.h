// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "protocols/canopen/eds_file.h"

namespace strainwave::bench {

/// What stands in a draft for a value that no file of the maker can tell. It is neither a number nor a mode
/// of operation, so that whoever reads the profile refuses it by line and name until a person has put one.
inline constexpr std::string_view kToBeFilledIn = "to be filled in";

/// A drive profile to start from.
struct DriveProfileDraft {
  std::string text;                     // YAML, as `ParseDriveProfile` reads it
  std::vector<std::string> to_fill_in;  // keys, as in "limits.speed"
  /// What the program does with a drive and this one cannot, according to its maker, one finding each.
  std::vector<protocols::canopen::FileNote> findings;
};

/// Identity, modes, units and missing objects of a drive, as far as its EDS or DCF file tells them; each
/// comment says where its value comes from. What belongs to one motor (counts of its encoder, rated torque)
/// is taken from a DCF, which says what one node is set to, not from the defaults of an EDS. Limits are left
/// to be filled in. A unit that was taken becomes an object to be found in the drive at each start, so that a
/// drive that is set otherwise is refused.
/// @param eds_key  the file as the profile names it: its path from the profile's folder.
DriveProfileDraft DraftDriveProfile(const protocols::canopen::EdsFile& eds, std::string_view eds_key);

}  // namespace strainwave::bench
