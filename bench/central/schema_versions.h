// SPDX-License-Identifier: Apache-2.0
#pragma once

/// The statements of each version of the server's tables, in the order in which they are made (schema.h).
namespace strainwave::bench {

extern const char* const kTablesOfVersion1;
extern const char* const kRightsOfVersion2;

}  // namespace strainwave::bench
