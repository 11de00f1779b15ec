// SPDX-License-Identifier: Apache-2.0
#include "bench/page/page_gate.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "bench/page/http_text.h"
#include "bench/serving/addresses.h"
#include "bench/text.h"

namespace strainwave::bench {
namespace {

constexpr std::string_view kProgramsPath = "/api/";
constexpr std::size_t kLongestHostName = 253;  // RFC 1035, 2.3.4, as text

// "bench" of "bench:8443"; "2001:db8::1" of "[2001:db8::1]:8443". Empty where that is no host.
std::string_view NameIn(std::string_view host) {
  std::string_view name = host;
  std::string_view port;
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    if (end == host.npos) return {};
    name = host.substr(1, end - 1);
    port = host.substr(end + 1);
    if (CanonicalAddress(name).empty()) return {};
  } else if (const std::size_t colon = host.find(':'); colon != host.npos) {
    name = host.substr(0, colon);
    port = host.substr(colon);
  }
  const bool is_port =
      port.empty() || (port.front() == ':' &&
                       std::ranges::all_of(port.substr(1), [](char c) { return c >= '0' && c <= '9'; }));
  return is_port ? name : std::string_view();
}

}  // namespace

PageGate::PageGate(std::string_view address, std::vector<std::string> names)
    : is_open_(IsLoopbackAddress(address)), names_(std::move(names)) {
  for (std::string& name : names_) name = LowerCase(name);
}

bool PageGate::IsGuarded(std::string_view path) const {
  return !is_open_ && path.starts_with(kProgramsPath) && path != kLoginPath && path != kLogoutPath;
}

std::optional<std::string> PageGate::WrongHost(std::string_view host, std::string_view own_address) const {
  const std::string name = LowerCase(NameIn(host));
  if (name == "localhost" || name == "127.0.0.1" || name == "::1") return std::nullopt;
  if (std::ranges::find(names_, name) != names_.end()) return std::nullopt;
  if (!is_open_ && !name.empty() && CanonicalAddress(name) == own_address) return std::nullopt;
  if (is_open_) return "the page is not served under this name (expected localhost or 127.0.0.1)";
  return "the page is not served under this name (expected this machine's address, or a name of it that "
         "--host allows)";
}

bool IsHostName(std::string_view name) {
  const auto fits = [](unsigned char c) {
    return c < 0x80 && (std::isalnum(c) != 0 || c == '-' || c == '.');
  };
  return !name.empty() && name.size() <= kLongestHostName && std::ranges::all_of(name, fits) &&
         name.front() != '-' && name.front() != '.';
}

std::string PageUrl(bool is_encrypted, std::string_view address, const std::vector<std::string>& names,
                    int port) {
  std::string host = !names.empty() ? names.front() : CanonicalAddress(address);
  if (names.empty() && IsEveryAddress(address)) host = "127.0.0.1";
  if (host.find(':') != host.npos) host = fmt::format("[{}]", host);
  return fmt::format("{}://{}:{}/", is_encrypted ? "https" : "http", host, port);
}

}  // namespace strainwave::bench
