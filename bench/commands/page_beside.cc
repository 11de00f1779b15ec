// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/page_beside.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <vector>

#include "bench/commands/output.h"
#include "bench/page/another_process.h"

namespace strainwave::bench {
namespace {

constexpr std::chrono::seconds kBeginsWithin{30};

}  // namespace

void ServeBeside(const CampaignFolder& folder, const PageOptions& options) {
  const std::filesystem::path output = folder.root / "page.txt";
  std::vector<std::string> words{"serve", folder.root.string()};
  std::ranges::copy(WordsOf(options), std::back_inserter(words));
  pid_t process{};
  try {
    std::filesystem::remove(output);  // of the page before
    process = StartAnother(words, output);
  } catch (const std::system_error& error) {
    ToStderr("warning: the campaign runs without its page: {}\n", error.what());
    return;
  }
  const auto address = [&] {
    const std::string said = LastLineOf(output);
    const std::size_t mark = said.find("://");
    if (mark == said.npos) return std::string();
    const std::size_t at = said.rfind(' ', mark) + 1;
    return said.substr(at, said.find(' ', at) - at);
  };
  switch (Await(process, output, kBeginsWithin, [&] { return !address().empty(); })) {
    case Awaited::kDone:
      ToStderr("page: {}, in process {}, which stays when the run has ended (kill {} ends it)\n", address(),
               process, process);
      return;
    case Awaited::kEnded:
      ToStderr("warning: the campaign runs without its page: {}\n", LastLineOf(output));
      return;
    case Awaited::kNothing:
      ToStderr("warning: the page has not begun yet; what it says is in {}\n", output.string());
      return;
  }
}

}  // namespace strainwave::bench
