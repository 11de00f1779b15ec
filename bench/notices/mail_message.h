// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "bench/notices/notice.h"

namespace strainwave::bench {

/// Who gets a notice as mail. Whoever should get an escalation is the first list where there is no second.
std::vector<std::string> RecipientsOf(const Notice& notice, const std::vector<std::string>& first,
                                      const std::vector<std::string>& second);

/// A mail (RFC 5322) with lines that end in CR LF: the subject as encoded words (RFC 2047), the text in
/// base64, so that neither can make a header, whatever stands in them. Its Message-ID is the notice's id: who
/// gets one twice can tell.
/// @param from, to  addresses without what headers give a meaning to
std::string MailMessage(const Notice& notice, const std::string& from, const std::vector<std::string>& to);

/// RFC 4648, without line ends.
std::string Base64(std::string_view bytes);

/// "Sun, 01 Mar 2026 12:00:00 +0000"
std::string MailDate(std::int64_t utc_ms);

}  // namespace strainwave::bench
