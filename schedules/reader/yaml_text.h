// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "schedules/reader/findings.h"
#include "schedules/reader/yaml_node.h"

namespace strainwave::schedules {

/// What can be said of a file before a YAML parser sees it: too large, empty, not UTF-8 text, tabs in the
/// indentation (every such line). Adds findings; adds none if the text may go to the parser.
void CheckYamlText(std::string_view text, const FileKind& kind, FindingList& findings);

/// "100.0 MB is too much for a schedule (expected at most 1 MiB)", or nothing to say: empty.
std::string TooLargeMessage(std::size_t bytes, const FileKind& kind);

/// `text` for a message: at most 40 characters, control characters as '?'.
std::string Shortened(std::string_view text);

}  // namespace strainwave::schedules
