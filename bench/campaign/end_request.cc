// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/end_request.h"

#include <cerrno>
#include <csignal>
#include <system_error>

#include <fmt/core.h>

namespace strainwave::bench {
namespace {

int SignalOf(EndRequest request) {
  switch (request) {
    case EndRequest::kPause:
      return SIGUSR1;
    case EndRequest::kFinishCycle:
      return SIGUSR2;
    case EndRequest::kShutdown:
      return SIGTERM;
    case EndRequest::kQuickStop:
      return SIGINT;
  }
  return SIGINT;
}

}  // namespace

int AskToEnd(const CampaignFolder& folder, EndRequest request) {
  const int process = CampaignLock::Holder(folder);
  if (process <= 0) return 0;
  if (::kill(process, SignalOf(request)) != 0) {
    throw std::system_error(errno, std::generic_category(), fmt::format("process {}", process));
  }
  return process;
}

}  // namespace strainwave::bench
