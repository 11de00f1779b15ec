// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daq/record.h"

namespace strainwave::bench {

/// What is odd about a record's metadata, in sentences: a number that is not there, so that its default is
/// taken (daq/record_rules.h, MetadataNumber), and a key that nothing reads, with the one that was meant
/// where one is near. Of a vibration any key may be a label, so that only those near one that is read are
/// told.
std::vector<std::string> MetadataWarnings(const daq::Record& record);

}  // namespace strainwave::bench
