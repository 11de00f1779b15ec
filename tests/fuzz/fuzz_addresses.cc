// SPDX-License-Identifier: Apache-2.0
// Any text as each of the addresses, names and hashes that a command line or a file may give.
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>

#include "bench/accounts/password_hash.h"
#include "bench/devices/modbus/modbus_address.h"
#include "bench/devices/tcp_address.h"
#include "bench/monitor/stream_address.h"
#include "bench/page/page_gate.h"
#include "bench/page/picture.h"
#include "bench/page/time_zone.h"
#include "bench/serving/addresses.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::bench;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto refused_in_words = [&](auto read) {
    try {
      read(text);
    } catch (const std::invalid_argument& error) {
      if (std::string_view(error.what()).empty()) std::abort();
    }
  };
  refused_in_words(ParseStreamAddress);
  refused_in_words(ParseModbusAddress);
  refused_in_words(ParseTcpAddress);
  const std::string canonical = CanonicalAddress(text);
  if (CanonicalAddress(canonical) != canonical) std::abort();
  (void)IsLoopbackAddress(text);
  (void)IsEveryAddress(text);
  (void)NetworkOf(text);
  (void)IsHostName(text);
  (void)PageGate("192.0.2.7", {"bench"}).WrongHost(text, "192.0.2.7");
  (void)TimeZoneIn(text);
  (void)CycleOfPicture(text);
  (void)IsPasswordHash(text);
  return 0;
}
