// SPDX-License-Identifier: Apache-2.0
// Any node's answers to an SDO client: it ends, and never with a value that no node gave.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/canopen/sdo_client.h"

using namespace strainwave::protocols;
using namespace strainwave::protocols::canopen;
using namespace std::chrono_literals;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span<const std::uint8_t> input(data, size);
  if (input.empty()) return 0;
  SdoClient client(3, 100ms);
  std::chrono::nanoseconds now = 1s;
  const std::uint8_t how = input[0];
  input = input.subspan(1);
  constexpr std::uint8_t kBytes[300]{1, 2, 3};
  const auto transfer = how % 2 == 0 ? SdoTransfer::kExpeditedOrSegmented : SdoTransfer::kBlock;
  const std::size_t expected = how / 4 % 8;
  const bool is_upload = how / 2 % 2 == 0;
  if (is_upload) {
    (void)client.StartUpload({0x6041, 0}, expected, transfer, now);
  } else {
    (void)client.StartDownload({0x6041, 0}, std::span(kBytes).first(how), transfer, now);
  }
  // Each nine bytes are a pause in milliseconds and an answer, its command byte first.
  while (input.size() >= 9) {
    now += std::chrono::milliseconds(input[0] % 128);
    CanFrame frame{.id = 0x583, .length = 8};
    std::copy_n(input.begin() + 1, 8, frame.data.begin());
    if (input[0] >= 0xF8) frame.length = static_cast<std::uint8_t>(input[0] - 0xF8);
    client.OnFrame(frame, now);
    for (int sent = 0; client.Poll(now); ++sent) {
      if (sent > 127 + 4) std::abort();  // more than a block for one answer
    }
    input = input.subspan(9);
  }
  if (client.state() != SdoClient::State::kDone && !client.data().empty()) std::abort();
  if (is_upload && client.state() == SdoClient::State::kDone && expected != 0 &&
      client.data().size() != expected) {
    std::abort();
  }
  // Whatever has happened, silence ends it.
  for (int i = 0; i < 20 && client.state() == SdoClient::State::kBusy; ++i) {
    now += 100ms;
    while (client.Poll(now)) continue;
  }
  if (client.state() == SdoClient::State::kBusy) std::abort();
  return 0;
}
