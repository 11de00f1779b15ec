// SPDX-License-Identifier: Apache-2.0
// Block transfers of the SDO client (CiA 301, 7.2.4.3.9 to 7.2.4.3.16).
#include <algorithm>
#include <boost/crc.hpp>

#include "protocols/canopen/sdo_client.h"
#include "protocols/canopen/wire_bytes.h"

namespace strainwave::protocols::canopen {
namespace {

using std::chrono::nanoseconds;

constexpr std::size_t kSegmentBytes = 7;

// x¹⁶ + x¹² + x⁵ + 1 from zero, highest bit first: "123456789" gives 31C3h (CiA 301, 7.2.4.3.16).
std::uint16_t Crc(std::span<const std::uint8_t> bytes) {
  boost::crc_xmodem_t crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return static_cast<std::uint16_t>(crc.checksum());
}

// Command specifier and sub-command of an answer; between them are flags.
constexpr std::uint8_t Command(std::uint8_t first_byte) {
  return static_cast<std::uint8_t>(first_byte & 0xE3);
}

}  // namespace

void SdoClient::OnBlockDownloadInitiate(const Payload& data, nanoseconds now) noexcept {
  if (Command(data[0]) != 0xA0) return Fail(SdoAbort::kUnknownCommand, {}, now);
  if (!IsForThisObject(data, now)) return;
  has_crc_ = (data[0] & 4) != 0;
  block_size_ = data[4];
  if (block_size_ < 1 || block_size_ > kMostSegments) return Fail(SdoAbort::kInvalidBlockSize, {}, now);
  block_start_ = 0;
  segments_ = 0;
  phase_ = Phase::kBlockDownloadSending;
}

CanFrame SdoClient::NextBlockSegment(nanoseconds now) noexcept {
  const std::size_t count = std::min(kSegmentBytes, size_ - offset_);
  ++segments_;
  is_last_ = offset_ + count == size_;
  Payload payload{static_cast<std::uint8_t>(segments_ | (is_last_ ? 0x80 : 0))};
  std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset_), count, payload.begin() + 1);
  offset_ += count;
  if (is_last_ || segments_ == block_size_) {
    phase_ = Phase::kBlockDownloadAcknowledge;
    deadline_ = now + timeout_;
  }
  return FrameOf(0x600U + node_id_, payload);
}

void SdoClient::OnBlockDownloadAcknowledge(const Payload& data, nanoseconds now) noexcept {
  if (Command(data[0]) != 0xA2) return Fail(SdoAbort::kUnknownCommand, {}, now);
  const std::uint8_t acknowledged = data[1];
  if (acknowledged > segments_) return Fail(SdoAbort::kInvalidSequenceNumber, {}, now);
  if (data[2] < 1 || data[2] > kMostSegments) return Fail(SdoAbort::kInvalidBlockSize, {}, now);
  repeats_ = acknowledged == 0 ? repeats_ + 1 : 0;
  if (repeats_ > kMostRepeats) {
    return Fail(SdoAbort::kInvalidSequenceNumber, "no segment of a block comes through", now);
  }
  offset_ = std::min(size_, block_start_ + acknowledged * kSegmentBytes);
  if (acknowledged == segments_ && is_last_) {
    const std::size_t unused = (kSegmentBytes - size_ % kSegmentBytes) % kSegmentBytes;
    const std::uint16_t crc = has_crc_ ? Crc(std::span(bytes_).first(size_)) : std::uint16_t{0};
    phase_ = Phase::kBlockDownloadEnd;
    return Send({static_cast<std::uint8_t>(0xC1 | unused << 2), static_cast<std::uint8_t>(crc),
                 static_cast<std::uint8_t>(crc >> 8)},
                now);
  }
  block_size_ = data[2];
  block_start_ = offset_;
  segments_ = 0;
  phase_ = Phase::kBlockDownloadSending;
}

void SdoClient::OnBlockDownloadEnd(const Payload& data, nanoseconds now) noexcept {
  if (Command(data[0]) != 0xA1) return Fail(SdoAbort::kUnknownCommand, {}, now);
  Finish();
}

void SdoClient::OnBlockUploadInitiate(const Payload& data, nanoseconds now) noexcept {
  if ((data[0] & 0xE1) != 0xC0) return Fail(SdoAbort::kUnknownCommand, {}, now);
  if (!IsForThisObject(data, now)) return;
  has_crc_ = (data[0] & 4) != 0;
  const bool has_size = (data[0] & 2) != 0;
  if (has_size &&
      !Announce(static_cast<std::uint32_t>(FromLittleEndian(std::span(data).subspan(4, 4))), now)) {
    return;
  }
  segments_ = 0;
  is_last_ = false;
  reminded_ = false;
  phase_ = Phase::kBlockUploadReceiving;
  Send({0xA3}, now);
}

void SdoClient::OnBlockUploadSegment(const Payload& data, nanoseconds now) noexcept {
  const std::uint8_t number = data[0] & 0x7F;
  if (number < 1 || number > block_size_) return Fail(SdoAbort::kInvalidSequenceNumber, {}, now);
  const bool closes_transfer = (data[0] & 0x80) != 0;
  deadline_ = now + timeout_;
  // Behind a gap nothing is kept: the node sends it again.
  if (number == segments_ + 1) {
    if (!Append(std::span(data).subspan(1), now)) return;
    ++segments_;
    is_last_ = closes_transfer;
    reminded_ = false;
  }
  if (closes_transfer || number == block_size_) AcknowledgeBlock(now);
}

void SdoClient::AcknowledgeBlock(nanoseconds now) noexcept {
  repeats_ = segments_ == 0 ? repeats_ + 1 : 0;
  if (repeats_ > kMostRepeats) {
    return Fail(SdoAbort::kInvalidSequenceNumber, "no segment of a block comes through", now);
  }
  const std::uint8_t received = segments_;
  // Where segments get lost, shorter blocks cost less to repeat.
  if (!is_last_) {
    const int next = received < block_size_ ? (block_size_ + 1) / 2 : 2 * block_size_;
    block_size_ = static_cast<std::uint8_t>(std::min<int>(next, kMostSegments));
  }
  segments_ = 0;
  if (is_last_) phase_ = Phase::kBlockUploadEnd;
  Send({0xA2, received, block_size_}, now);
}

void SdoClient::OnBlockUploadEnd(const Payload& data, nanoseconds now) noexcept {
  if (Command(data[0]) != 0xC1) return Fail(SdoAbort::kUnknownCommand, {}, now);
  const std::size_t unused = data[0] >> 2 & 7U;
  size_ -= std::min(size_, unused);
  if (size_ > kMostBytes || !HasPromisedLength()) {
    return Fail(SdoAbort::kLengthMismatch, "the object has another length than promised", now);
  }
  if (has_crc_ && FromLittleEndian(std::span(data).subspan(1, 2)) != Crc(std::span(bytes_).first(size_))) {
    return Fail(SdoAbort::kCrcError, {}, now);
  }
  Send({0xA1}, now);
  Finish();
}

}  // namespace strainwave::protocols::canopen
