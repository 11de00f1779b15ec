// SPDX-License-Identifier: Apache-2.0
#include "bench/report/svg_text.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <regex>
#include <system_error>

#include <fmt/format.h>

#include "bench/plots/gnuplot.h"
#include "daq/whole_file.h"

namespace strainwave::bench {

ScratchFolder::ScratchFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "strainwave-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    throw std::system_error(errno, std::generic_category(), "a folder for pictures, " + name);
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string SvgText(const std::filesystem::path& stem) {
  const std::string text = daq::ReadWholeFile(stem.string() + ".svg");
  const std::size_t begin = text.find("<svg");
  const std::size_t body = begin == std::string::npos ? begin : text.find('>', begin);
  if (body == std::string::npos) throw GnuplotError("gnuplot wrote no picture to " + stem.string() + ".svg");
  std::string head = text.substr(begin, body - begin);
  std::smatch box;
  static const std::regex kBox(R"(viewBox="([0-9. ]+)\")");
  if (!std::regex_search(head, box, kBox))
    throw GnuplotError("gnuplot wrote a picture without a size to " + stem.string() + ".svg");
  std::string svg = fmt::format("<svg role=\"img\" viewBox=\"{}\">", box[1].str());
  // Line by line: one expression over a megabyte would be slow.
  std::size_t at = text.find('\n', body) + 1;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string line = text.substr(at, end - at);
    at = end + 1;
    if (line.starts_with("<title>") || line.starts_with("<desc>")) continue;
    for (const std::string_view name : {"<g id=\"gnuplot_", "\t<g id=\"gnuplot_"}) {
      if (!line.starts_with(name)) continue;
      const std::size_t close = line.find('"', name.size());
      if (const std::size_t title = line.find("<title>"); title != std::string::npos) line.resize(title);
      line = "<g" + line.substr(close + 1);
    }
    svg += line + '\n';
  }
  return svg;
}

}  // namespace strainwave::bench
