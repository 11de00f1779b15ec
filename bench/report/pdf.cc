// SPDX-License-Identifier: Apache-2.0
#include "bench/report/pdf.h"

#include <unistd.h>

#include <chrono>
#include <cstring>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/plots/child_program.h"
#include "bench/report/svg_text.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

// A page of 3500 cycles takes seconds; what takes longer than that hangs.
constexpr std::chrono::minutes kLimit{2};
constexpr std::string_view kBeginsPdf = "%PDF-";

// Everything but letters, digits and what a path's parts are made of.
std::string FileUrl(const fs::path& file) {
  std::string url = "file://";
  for (const char character : file.string()) {
    const bool plain = (character >= 'a' && character <= 'z') || (character >= 'A' && character <= 'Z') ||
                       (character >= '0' && character <= '9') || std::strchr("/._-~", character) != nullptr;
    url += plain ? std::string(1, character) : fmt::format("%{:02X}", static_cast<unsigned char>(character));
  }
  return url;
}

std::string LastLine(const std::string& text) {
  const std::size_t end = text.find_last_of('\n');
  return end == std::string::npos ? text : text.substr(end + 1);
}

ChildEnd Print(const std::string& browser, const fs::path& folder, const fs::path& page,
               const fs::path& printed) {
  std::vector<std::string> command{browser,
                                   "--headless",
                                   "--disable-gpu",
                                   "--no-first-run",
                                   "--no-pdf-header-footer",
                                   "--host-resolver-rules=MAP * ~NOTFOUND",
                                   "--user-data-dir=" + (folder / "profile").string(),
                                   "--print-to-pdf=" + printed.string()};
  // Chromium's sandbox refuses to run as root.
  if (::geteuid() == 0) command.emplace_back("--no-sandbox");
  command.push_back(FileUrl(page));
  return RunChild(std::move(command), "", kLimit);
}

}  // namespace

void WritePdf(const std::string& html, const fs::path& pdf, const std::vector<std::string>& browsers) {
  const ScratchFolder folder;  // with the browser's profile in it, so that a person's own stays as it is
  const fs::path page = folder.path() / "page.html";
  const fs::path printed = folder.path() / "page.pdf";
  daq::WriteFileAtomically(page, html);
  for (const std::string& browser : browsers) {
    const ChildEnd end = Print(browser, folder.path(), page, printed);
    if (end.error == ENOENT) continue;
    if (end.error != 0)
      throw PdfError(fmt::format("{} could not be started: {}", browser, std::strerror(end.error)));
    if (end.late)
      throw PdfError(fmt::format("{} took longer than {} min and was ended", browser, kLimit.count()));
    const std::string bytes = fs::exists(printed) ? daq::ReadWholeFile(printed) : "";
    if (end.signal != 0 || end.exit_code != 0 || !bytes.starts_with(kBeginsPdf))
      throw PdfError(
          fmt::format("{} printed no PDF: {}", browser,
                      end.signal != 0 ? fmt::format("ended by signal {}", end.signal) : LastLine(end.said)));
    daq::WriteFileAtomically(pdf, bytes);
    return;
  }
  throw PdfError(
      fmt::format("there is no {} in the PATH (apt-get install chromium)", fmt::join(browsers, ", ")));
}

}  // namespace strainwave::bench
