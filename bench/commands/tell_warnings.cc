// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/tell_warnings.h"

#include "bench/commands/output.h"

namespace strainwave::bench {

void TellWarnings(std::span<const RecordWarning> warnings) {
  for (const RecordWarning& warning : warnings) ToStderr("{}\n", WarningLine(warning));
}

}  // namespace strainwave::bench
