// SPDX-License-Identifier: Apache-2.0
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "bench/devices/can/socket_can_bus.h"
#include "bench/devices/canopen/scan_nodes.h"
#include "bench/devices/monotonic_clock.h"
#include "bench/machines/listing/find_devices.h"

namespace strainwave::bench {

using protocols::canopen::FoundNode;
using protocols::canopen::NodeScan;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

namespace {

constexpr milliseconds kPatience{300};  // with a slow node on a slow bus

}  // namespace

FoundDevice Described(const FoundNode& node, const std::string& interface, const KnownProfiles& known) {
  FoundDevice found;
  found.where = fmt::format("{}, node {}", interface, node.node_id);
  found.what = node.device_type ? protocols::canopen::DeviceTypeWords(*node.device_type)
                                : "node that does not say what it is";
  found.fields.emplace_back("interface", interface);
  found.fields.emplace_back("node", std::int64_t{node.node_id});
  for (const auto& [name, number] : protocols::canopen::IdentityNumbers(node)) {
    found.fields.emplace_back(name, number);
  }
  if (node.nmt_state) found.fields.emplace_back("state", std::string(Name(*node.nmt_state)));
  const auto fits = [&](const auto& entry) {
    const auto& identity = entry.second.identity;
    return identity.vendor != 0 && identity.vendor == node.vendor && identity.product == node.product;
  };
  const auto profile = std::ranges::find_if(known.drives, fits);
  if (profile != known.drives.end()) found.profile = profile->first.string();
  return found;
}

std::string MissingCan() {
  const int socket = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, 1);
  if (socket >= 0) {
    ::close(socket);
    return {};
  }
  if (errno != EAFNOSUPPORT && errno != EPROTONOSUPPORT) {
    return std::system_category().message(errno);
  }
  return "this kernel has no CAN (try: modprobe can can_raw; a USB adapter needs its driver, too; without, a "
         "bench file with 'interface: in_process' needs no kernel)";
}

std::vector<std::string> CanInterfaces() {
  constexpr int kOfCan = 280;  // ARPHRD_CAN
  std::vector<std::string> interfaces;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator("/sys/class/net", none)) {
    std::ifstream file(entry.path() / "type");
    int type = 0;
    if (file >> type && type == kOfCan) interfaces.push_back(entry.path().filename().string());
  }
  std::ranges::sort(interfaces);
  return interfaces;
}

void FindOnCan(CanBus& bus, BenchClock& clock, const std::string& interface, const KnownProfiles& known,
               FoundPart& part) {
  std::string note;
  NodeScan scan(kPatience);
  const std::vector<FoundNode> nodes = ScanNodes(bus, clock, scan, note);
  for (const FoundNode& node : nodes) part.devices.push_back(Described(node, interface, known));
  if (!note.empty()) part.notes.push_back(fmt::format("{} {}", interface, note));
  if (note.empty() && nodes.empty()) part.notes.push_back(fmt::format("{}: no node answers", interface));
}

void FindOnCan(const std::string& interface, const KnownProfiles& known, FoundPart& part) {
  try {
    MonotonicClock clock;
    SocketCanSettings settings;
    settings.interface = interface;
    settings.clock_zero = -clock.FromKernel({});
    SocketCanBus bus(settings);
    FindOnCan(bus, clock, interface, known, part);
  } catch (const std::system_error& error) {
    part.notes.emplace_back(error.what());
  }
}

}  // namespace strainwave::bench
