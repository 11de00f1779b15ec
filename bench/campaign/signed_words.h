// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace strainwave::bench {

/// The name of who does something, without blanks around it. @throws BenchError where it is empty or too
/// long, with what was expected.
std::string SignerOf(const std::string& by);

/// What that person has to say, as it was written. @param option  that it was given with, for the message.
/// @throws BenchError where it is too long, or is empty and may not be.
std::string WordsOf(const std::string& option, const std::string& text, bool may_be_empty);

}  // namespace strainwave::bench
