// SPDX-License-Identifier: Apache-2.0
#include "daq/software.h"

namespace strainwave::daq {

// Weak, so that a program's own comes in its place: no library and no test is built anew with every commit,
// and what tests compare does not depend on one.
[[gnu::weak]] std::string_view Software() { return "strainwave " STRAINWAVE_VERSION; }

}  // namespace strainwave::daq
