// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/page_beside.h"

#include <sys/wait.h>

#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>
#include <vector>

#include "bench/commands/output.h"
#include "bench/page/another_process.h"

namespace strainwave::bench {
namespace {

constexpr std::chrono::seconds kBeginsWithin{10};
constexpr std::chrono::milliseconds kInterval{20};

}  // namespace

void ServeBeside(const CampaignFolder& folder, const PageOptions& options) {
  if (!options.serves) return;
  const std::filesystem::path output = folder.root / "page.txt";
  std::vector<std::string> words{"serve", folder.root.string(), "--port", std::to_string(options.port)};
  if (!options.users.empty()) words.insert(words.end(), {"--users", options.users});
  pid_t process{};
  try {
    std::filesystem::remove(output);  // of the page before
    process = StartAnother(words, output);
  } catch (const std::system_error& error) {
    ToStderr("warning: the campaign runs without its page: {}\n", error.what());
    return;
  }
  const auto until = std::chrono::steady_clock::now() + kBeginsWithin;
  while (std::chrono::steady_clock::now() < until) {
    const std::string said = LastLineOf(output);
    if (::waitpid(process, nullptr, WNOHANG) == process) {
      ToStderr("warning: the campaign runs without its page: {}\n", said);
      return;
    }
    if (const std::size_t at = said.find("http://"); at != said.npos) {
      ToStderr("page: {}, in process {}, which stays when the run has ended (kill {} ends it)\n",
               said.substr(at, said.find(' ', at) - at), process, process);
      return;
    }
    std::this_thread::sleep_for(kInterval);
  }
  ToStderr("warning: the page has not begun yet; what it says is in {}\n", output.string());
}

}  // namespace strainwave::bench
