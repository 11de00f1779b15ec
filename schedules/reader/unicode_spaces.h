// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace strainwave::schedules {

/// `text` with a plain space in the place of every other space of Unicode (category Zs: the no-break space
/// U+00A0, the thin spaces, ...), and without the characters of no width that come with copied text (U+200B,
/// U+2060, U+FEFF). Web pages, PDF files and word processors put them between a number and its unit, where
/// nobody sees them.
std::string WithPlainSpaces(std::string_view text);

/// For a message about a text in which a letter may look like another: " with U+2212" for the first character
/// of `text` that is not ASCII; empty where all are.
std::string NonAsciiIn(std::string_view text);

}  // namespace strainwave::schedules
