// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace strainwave::bench {

/// An HTTP request without its headers Range and If-Range, which a server may ignore (RFC 9110, 14.2).
/// cpp-httplib would send as many copies of an answer as a head has room for, some thousand, and reads the
/// header with a regular expression whose depth of calls is the header's length.
std::string WithoutRanges(std::string_view request);

}  // namespace strainwave::bench
