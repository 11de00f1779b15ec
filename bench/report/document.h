// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <variant>
#include <vector>

#include "bench/report/campaign_sheet.h"

namespace strainwave::bench {

/// All text is plain text, with whatever people have written in it.
struct ReportTable {
  std::string name;  // of its CSV file, without ending; empty: it has none
  std::vector<std::string> heads;
  std::vector<std::vector<std::string>> rows;  // as long as `heads`
};

struct ReportPicture {
  std::string svg;  // as SvgText gives it
  std::string caption;
};

using ReportPart = std::variant<std::string, ReportTable, ReportPicture>;  // a string is a paragraph

struct ReportSection {
  std::string title;
  std::vector<ReportPart> parts;
  bool begins_page{};  // on paper
};

struct ReportDocument {
  std::string title;
  std::vector<ReportSection> sections;
};

/// One campaign, or several beside each other: trends overlaid first, then each by itself.
/// @param filed  sections that do not come from the campaigns (`filed_papers.h`); at the end.
/// @param warnings  what could not be shown is added.
ReportDocument ReportDocumentOf(std::span<const CampaignSheet> sheets,
                                const std::vector<ReportSection>& filed, std::vector<std::string>& warnings);

}  // namespace strainwave::bench
