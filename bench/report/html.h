// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/report/document.h"

namespace strainwave::bench {

/// One page that loads nothing and needs no script; on paper A4, sections that begin a page do. Of a table of
/// more than 60 rows the first and the last 30, and how many are left out.
std::string HtmlOf(const ReportDocument& document);

}  // namespace strainwave::bench
