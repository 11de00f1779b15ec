// SPDX-License-Identifier: Apache-2.0
// Any bytes to the decoder of a TCP stream, cut into pieces as the first byte says. The CRCs that no fuzzer
// guesses are put right where a message begins, so that what is behind them is reached too.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "daq/acquisition/sources/tcp_stream_decoder.h"
#include "daq/crc32.h"

namespace {

constexpr std::size_t kHeader_bytes = strainwave::daq::acquisition::TcpStreamDecoder::kHeader_bytes;

void PutRight(std::vector<std::byte>& bytes) {
  const char magic[] = "SWS1";
  for (std::size_t at = 0; at + kHeader_bytes <= bytes.size();) {
    if (std::memcmp(bytes.data() + at, magic, 4) != 0) {
      ++at;
      continue;
    }
    std::uint32_t length{};
    std::memcpy(&length, bytes.data() + at + 8, 4);
    const std::span<const std::byte> all(bytes);
    const std::size_t there = std::min<std::size_t>(length, bytes.size() - at - kHeader_bytes);
    const std::uint32_t crcs[] = {strainwave::daq::Crc32(all.subspan(at, 12)),
                                  strainwave::daq::Crc32(all.subspan(at + kHeader_bytes, there))};
    std::memcpy(bytes.data() + at + 12, crcs, sizeof(crcs));
    at += kHeader_bytes + there;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::daq::acquisition;
  if (size < 3) return 0;
  const std::size_t piece = 1 + data[0];
  std::vector<std::byte> bytes(size - 2);
  std::memcpy(bytes.data(), data + 2, size - 2);
  if (data[1] % 4 != 0) PutRight(bytes);
  // Made once: its buffer is large, and a new connection must not see anything of the one before.
  static TcpStreamDecoder decoder;
  static SampleBlock block(1000);
  decoder.Reset();
  double sum = 0;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::span<std::byte> room = decoder.Room();
    const std::size_t count = std::min({piece, room.size(), bytes.size() - at});
    if (count == 0) __builtin_trap();  // it would wait for ever
    std::memcpy(room.data(), bytes.data() + at, count);
    decoder.Received(count);
    at += count;
    for (TcpStreamEvent event; (event = decoder.Next(block)) != TcpStreamEvent::kNeedsMore;) {
      if (event != TcpStreamEvent::kBlock) continue;
      for (std::uint32_t i = 0; i < block.header.samples; ++i)
        sum += block.Value(i, block.header.channels - 1);
    }
  }
  return sum == 0.12345 ? 1 : 0;
}
