// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/socket.h>

#include <string>
#include <string_view>

/// IP addresses as text: "192.0.2.7", "2001:db8::1".
namespace strainwave::bench {

/// Of a socket's end, without its port; an IPv4 address that came as one of IPv6 (::ffff:192.0.2.7) is given
/// as that of IPv4. Empty where it is no IP address.
std::string AddressText(const sockaddr_storage& address);

/// The same text for all spellings of an address ("0:0::1" is "::1"); empty where it is none.
std::string CanonicalAddress(std::string_view text);

/// Whether only this machine itself reaches it: 127.0.0.0/8 (RFC 1122, 3.2.1.3) and ::1 (RFC 4291, 2.5.3).
bool IsLoopbackAddress(std::string_view text);

/// Whether it stands for all addresses of a machine: 0.0.0.0 and ::
bool IsEveryAddress(std::string_view text);

/// For who counts by address: IPv4 whole, IPv6 by its first 64 bits, since a machine has all of the others to
/// choose from (RFC 4291, 2.5.4).
std::string NetworkOf(std::string_view text);

}  // namespace strainwave::bench
