// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocols/canopen/eds_file.h"

namespace strainwave::bench {

/// The data sheet of the drive that the device side is: bench/devices/profiles/strainwave_drive.eds.
const protocols::canopen::EdsFile& OwnDriveEds();

}  // namespace strainwave::bench
