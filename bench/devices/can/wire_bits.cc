// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/can/wire_bits.h"

#include <boost/crc.hpp>

namespace strainwave::bench {
namespace {

constexpr int kErrorFrameBits = 6 + 6 + 8 + 3;
// CRC delimiter, acknowledgement and its delimiter, end of frame, pause: never stuffed.
constexpr int kTailBits = 1 + 1 + 1 + 7 + 3;

// Counts the bits of the stuffed part as they go out, and knows its checksum.
class BitCounter {
 public:
  void Put(std::uint32_t value, int bits) noexcept {
    for (int i = bits - 1; i >= 0; --i) {
      const bool bit = (value >> i & 1U) != 0;
      checksum_.process_bit(bit);
      Count(bit);
    }
  }
  void PutChecksum() noexcept {
    const std::uint32_t checksum = checksum_.checksum();
    for (int i = 14; i >= 0; --i) Count((checksum >> i & 1U) != 0);
  }
  int bits() const { return bits_; }

 private:
  void Count(bool bit) noexcept {
    ++bits_;
    run_ = bit == last_ ? run_ + 1 : 1;
    last_ = bit;
    if (run_ == 5) {  // an opposite bit goes in, and starts a run of its own
      ++bits_;
      run_ = 1;
      last_ = !bit;
    }
  }

  boost::crc_basic<15> checksum_{0x4599};
  int bits_{};
  int run_{};
  bool last_{true};  // the bus is recessive before a frame
};

}  // namespace

int WireBits(const protocols::CanFrame& frame) noexcept {
  if (frame.error) return kErrorFrameBits;
  BitCounter counter;
  const std::uint32_t remote = frame.remote ? 1 : 0;
  counter.Put(0, 1);  // start of frame
  if (frame.extended) {
    counter.Put(frame.id >> 18U, 11);
    counter.Put(0b11, 2);  // substitute remote request, identifier extension
    counter.Put(frame.id, 18);
    counter.Put(remote, 1);
    counter.Put(0, 2);
  } else {
    counter.Put(frame.id, 11);
    counter.Put(remote, 1);
    counter.Put(0, 2);
  }
  counter.Put(frame.length, 4);
  for (std::size_t i = 0; !frame.remote && i < frame.length; ++i) counter.Put(frame.data[i], 8);
  counter.PutChecksum();
  return counter.bits() + kTailBits;
}

}  // namespace strainwave::bench
