// SPDX-License-Identifier: Apache-2.0
#include "bench/report/html.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "bench/escaped.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kRowsShown = 60;
constexpr std::size_t kLongestWord = 24;  // bytes

constexpr const char* kStyle = R"(
@page { size: A4; margin: 16mm 14mm; }
body { font: 10.5pt/1.4 sans-serif; color: #222; margin: 1.5em auto; max-width: 60em; padding: 0 1em; }
h1 { font-size: 1.7em; margin: 0 0 .3em; }
h2 { font-size: 1.25em; margin: 1.6em 0 .4em; border-bottom: 1px solid #888; break-after: avoid; }
p { margin: .4em 0; }
table { border-collapse: collapse; margin: .6em 0; font-size: .9em; }
th, td { border-bottom: 1px solid #ccc; padding: .15em .6em .15em 0; text-align: left; vertical-align: top; overflow-wrap: break-word; }
td.long { overflow-wrap: anywhere; }
th { border-bottom: 1px solid #444; overflow-wrap: normal; }
td.number { white-space: nowrap; font-variant-numeric: tabular-nums; }
thead { display: table-header-group; }
tr, figure { break-inside: avoid; }
figure { margin: .8em 0; }
figure svg { width: 100%; height: auto; }
figcaption { font-size: .9em; color: #444; }
@media print { body { margin: 0; max-width: none; padding: 0; font-size: 9pt; } section.page { break-before: page; } })";

// Plain text within an element or an attribute.
std::string HtmlText(std::string_view text) {
  std::string html;
  for (const char c : Escaped(text)) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      case '\'':
        html += "&#39;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

// A number, one with its error, or from one to another: stands in one line.
bool LooksLikeNumber(std::string_view text) {
  if (const std::size_t to = text.find(" to "); to != text.npos && to > 0)
    return LooksLikeNumber(text.substr(0, to)) && LooksLikeNumber(text.substr(to + 4));
  const std::size_t sign = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  return text == "–" || (text.size() > sign && text[sign] >= '0' && text[sign] <= '9' &&
                         text.find_first_not_of("0123456789.+-e ±*") == std::string_view::npos);
}

// A word that no column has room for may be broken anywhere; names and words of people's languages are not.
bool HasLongWord(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    if (end - at > kLongestWord) return true;
    at = end + 1;
  }
  return false;
}

// "2026-03-01T12:00:00.250Z".
bool IsTime(std::string_view text) { return text.size() == 24 && text[10] == 'T' && text.back() == 'Z'; }

std::string_view ClassOf(std::string_view cell) {
  if (LooksLikeNumber(cell) || IsTime(cell)) return " class=\"number\"";
  return HasLongWord(cell) ? " class=\"long\"" : "";
}

std::string RowHtml(const std::vector<std::string>& row) {
  std::string html = "<tr>";
  for (const std::string& cell : row) html += fmt::format("<td{}>{}</td>", ClassOf(cell), HtmlText(cell));
  return html + "</tr>\n";
}

std::string TableHtml(const ReportTable& table) {
  std::string html = "<table>\n<thead><tr>";
  for (const std::string& head : table.heads) html += fmt::format("<th>{}</th>", HtmlText(head));
  html += "</tr></thead>\n<tbody>\n";
  const std::size_t count = table.rows.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (count > kRowsShown && i == kRowsShown / 2) {
      const std::size_t left_out = count - kRowsShown;
      html +=
          fmt::format("<tr><td colspan=\"{}\">… {} rows more: {}.csv of --csv has all of them</td></tr>\n",
                      table.heads.size(), left_out, HtmlText(table.name));
      i += left_out;
    }
    html += RowHtml(table.rows[i]);
  }
  return html + "</tbody>\n</table>\n";
}

struct PartHtml {
  std::string operator()(const std::string& paragraph) const {
    return fmt::format("<p>{}</p>\n", HtmlText(paragraph));
  }
  std::string operator()(const ReportTable& table) const { return TableHtml(table); }
  std::string operator()(const ReportPicture& picture) const {
    return fmt::format("<figure>\n{}<figcaption>{}</figcaption>\n</figure>\n", picture.svg,
                       HtmlText(picture.caption));
  }
};

}  // namespace

std::string HtmlOf(const ReportDocument& document) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
      "http-equiv=\"Content-Security-Policy\" "
      "content=\"default-src 'none'; style-src 'unsafe-inline'\">\n<meta name=\"viewport\" "
      "content=\"width=device-width\">\n<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</"
      "h1>\n",
      HtmlText(document.title), kStyle);
  for (const ReportSection& section : document.sections) {
    html += fmt::format("<section{}>\n<h2>{}</h2>\n", section.begins_page ? " class=\"page\"" : "",
                        HtmlText(section.title));
    for (const ReportPart& part : section.parts) html += std::visit(PartHtml{}, part);
    html += "</section>\n";
  }
  return html + "</body>\n</html>\n";
}

}  // namespace strainwave::bench
