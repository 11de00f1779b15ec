// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "analysis/diagnosis/study.h"

/// The pieces of text that the reports of a diagnosis share.
namespace strainwave::bench {

inline constexpr std::size_t kLineWidth = 110;

/// Words in lines of at most kLineWidth, the first one behind `head`.
std::string Wrapped(const std::string& head, const std::string& words, std::size_t indent);

/// Words behind a section's name, which stands in a column of its own.
std::string Section(std::string_view name, const std::string& words);

/// "0.213 ± 0.004 arcmin"; a dash for what the records leave open.
std::string ValueText(const analysis::diagnosis::ParameterValue& parameter);

}  // namespace strainwave::bench
