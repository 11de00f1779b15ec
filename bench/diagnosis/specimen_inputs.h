// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/diagnosis/make_study.h"

namespace strainwave::bench {

/// The records of one specimen, ready to be diagnosed.
struct SpecimenInput {
  std::string name;    // as its records say, or that of the file
  std::string folder;  // a name for its files, of letters, digits, '.', '-' and '_'; different for each
  StudyInput input;
};

/// Reads record files and puts those of one specimen together (metadata `specimen`, of the record or of an
/// HDF5 file), in the order in which they first come. A file that names none is a specimen of its own, which
/// a warning says.
/// @throws as ReadStudyInput; BenchError for a folder, and where all records are of one specimen.
std::vector<SpecimenInput> ReadSpecimenInputs(const std::vector<std::string>& paths,
                                              const RecordChoice& choice);

}  // namespace strainwave::bench
