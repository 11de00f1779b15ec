// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/prediction/source_rows.h"

namespace strainwave::bench {

/// What the rows of records that name no specimen are taken for.
enum class SpecimenPer { kGuessed, kFile, kFolder };

/// @throws std::invalid_argument for another name than `file` and `folder`.
SpecimenPer SpecimenPerOf(std::string_view name);

/// Which specimen is whose.
struct SpecimensFound {
  std::string
      taken_for;  // "file", "folder": what stands for a specimen that nothing names; empty: all are named
  std::string warning;  // empty as above
};

/// Gives a specimen to all rows that have none: campaigns stand for themselves; record files by their folder,
/// or each by itself. Guessed is the folder where files lie in several folders and not one a folder: runs to
/// failure are laid out so, a folder a specimen and a file a snapshot.
SpecimensFound NameSpecimens(std::vector<SourceRows>& sources, SpecimenPer per);

}  // namespace strainwave::bench
