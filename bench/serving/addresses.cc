// SPDX-License-Identifier: Apache-2.0
#include "bench/serving/addresses.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

namespace strainwave::bench {
namespace {

constexpr std::size_t kNetwork_bytes = 8;

std::string TextOf(const in_addr& address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  return ::inet_ntop(AF_INET, &address, text.data(), text.size()) == nullptr ? "" : text.data();
}

std::string TextOf(const in6_addr& address) {
  if (IN6_IS_ADDR_V4MAPPED(&address)) {
    in_addr mapped{};
    std::memcpy(&mapped, address.s6_addr + 12, sizeof mapped);
    return TextOf(mapped);
  }
  std::array<char, INET6_ADDRSTRLEN> text{};
  return ::inet_ntop(AF_INET6, &address, text.data(), text.size()) == nullptr ? "" : text.data();
}

std::optional<in6_addr> Ipv6Of(std::string_view text) {
  in6_addr address{};
  if (::inet_pton(AF_INET6, std::string(text).c_str(), &address) != 1) return std::nullopt;
  return address;
}

}  // namespace

std::string AddressText(const sockaddr_storage& address) {
  if (address.ss_family == AF_INET) return TextOf(reinterpret_cast<const sockaddr_in&>(address).sin_addr);
  if (address.ss_family == AF_INET6) return TextOf(reinterpret_cast<const sockaddr_in6&>(address).sin6_addr);
  return "";
}

std::string CanonicalAddress(std::string_view text) {
  in_addr address{};
  if (::inet_pton(AF_INET, std::string(text).c_str(), &address) == 1) return TextOf(address);
  const auto long_one = Ipv6Of(text);
  return long_one ? TextOf(*long_one) : "";
}

bool IsLoopbackAddress(std::string_view text) {
  const std::string address = CanonicalAddress(text);
  return address == "::1" || address.starts_with("127.");
}

bool IsEveryAddress(std::string_view text) {
  const std::string address = CanonicalAddress(text);
  return address == "0.0.0.0" || address == "::";
}

std::string NetworkOf(std::string_view text) {
  auto address = Ipv6Of(CanonicalAddress(text));
  if (!address) return std::string(text);
  std::fill(std::begin(address->s6_addr) + kNetwork_bytes, std::end(address->s6_addr), std::uint8_t{0});
  return TextOf(*address);
}

}  // namespace strainwave::bench
