// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/sdo_client.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "protocols/canopen/wire_bytes.h"

namespace strainwave::protocols::canopen {
namespace {

using std::chrono::nanoseconds;

// Command specifiers: the upper three bits of the first byte (CiA 301, 7.2.4.3).
constexpr int kServerUploadSegment = 0;
constexpr int kServerDownloadSegment = 1;
constexpr int kServerUploadInitiate = 2;
constexpr int kServerDownloadInitiate = 3;

constexpr std::uint8_t kAbortCommand = 0x80;
constexpr std::uint32_t kRequestBase = 0x600;
constexpr std::uint32_t kAnswerBase = 0x580;

constexpr std::array<std::uint8_t, 8> WithAddress(std::uint8_t command, ObjectAddress address,
                                                  std::uint32_t last_four) {
  std::array<std::uint8_t, 8> payload{command};
  ToLittleEndian(address.index, std::span(payload).subspan(1, 2));
  payload[3] = address.subindex;
  ToLittleEndian(last_four, std::span(payload).subspan(4, 4));
  return payload;
}

}  // namespace

std::string Words(const ObjectAddress& address) {
  return fmt::format("{:04X}h:{:02X}", address.index, address.subindex);
}

std::string Words(const SdoFailure& failure) {
  return fmt::format("node {}, {}: {}{}{} ({:08X}h {})", failure.node_id, Words(failure.address),
                     Words(failure.code), failure.detail.empty() ? "" : ": ", failure.detail,
                     static_cast<std::uint32_t>(failure.code),
                     failure.by_node ? "from the node" : "from this side");
}

SdoClient::SdoClient(std::uint8_t node_id, nanoseconds timeout) : node_id_(node_id), timeout_(timeout) {
  if (node_id < 1 || node_id > 127) {
    throw std::invalid_argument(fmt::format("node_id = {} is not 1 to 127", node_id));
  }
  if (timeout <= nanoseconds::zero()) {
    throw std::invalid_argument(fmt::format("timeout = {} ns is not above zero", timeout.count()));
  }
}

bool SdoClient::StartUpload(ObjectAddress address, std::size_t expected_bytes, SdoTransfer transfer,
                            nanoseconds now) noexcept {
  if (state_ == State::kBusy) return false;
  size_ = 0;
  expected_bytes_ = expected_bytes;
  Start(address, transfer == SdoTransfer::kBlock ? Phase::kBlockUploadInitiate : Phase::kUploadInitiate, now);
  return true;
}

bool SdoClient::StartDownload(ObjectAddress address, std::span<const std::uint8_t> bytes,
                              SdoTransfer transfer, nanoseconds now) noexcept {
  if (state_ == State::kBusy || bytes.size() > kMostBytes) return false;
  std::copy(bytes.begin(), bytes.end(), bytes_.begin());
  size_ = bytes.size();
  expected_bytes_ = 0;
  // A block has one segment at least, so that nothing cannot be sent in one.
  const bool in_blocks = transfer == SdoTransfer::kBlock && size_ > 0;
  Start(address, in_blocks ? Phase::kBlockDownloadInitiate : Phase::kDownloadInitiate, now);
  return true;
}

void SdoClient::Start(ObjectAddress address, Phase phase, nanoseconds now) noexcept {
  address_ = address;
  state_ = State::kBusy;
  phase_ = phase;
  failure_ = {};
  announced_bytes_.reset();
  offset_ = 0;
  toggle_ = 0;
  repeats_ = 0;
  request_due_ = now < quiet_until_;
  if (!request_due_) SendRequest(now);
}

void SdoClient::Reset() noexcept {
  out_.Purge();
  state_ = State::kIdle;
  phase_ = Phase::kNone;
  request_due_ = false;
}

std::span<const std::uint8_t> SdoClient::data() const noexcept {
  return state_ == State::kDone ? std::span(bytes_).first(size_) : std::span<const std::uint8_t>();
}

std::optional<CanFrame> SdoClient::Poll(nanoseconds now) noexcept {
  if (state_ == State::kBusy) {
    if (request_due_ && now >= quiet_until_) {
      request_due_ = false;
      SendRequest(now);
    } else if (!request_due_ && phase_ != Phase::kBlockDownloadSending && now >= deadline_) {
      OnTimeout(now);
    }
  }
  if (const std::optional<CanFrame> frame = out_.Pop()) return frame;
  if (phase_ == Phase::kBlockDownloadSending) return NextBlockSegment(now);
  return std::nullopt;
}

void SdoClient::OnFrame(const CanFrame& frame, nanoseconds now) noexcept {
  if (!IsDataFrame(frame, kAnswerBase + node_id_)) return;
  if (state_ != State::kBusy || request_due_) {
    ++unsolicited_;
    return;
  }
  if (frame.length != 8) {
    return Fail(SdoAbort::kGeneralError, "an answer is not eight bytes long", now);
  }
  // While a block comes in, bit 7 closes it and only the sequence number zero is left for an abort.
  if (frame.data[0] == kAbortCommand) return OnAbort(frame.data, now);
  switch (phase_) {
    case Phase::kNone:
      break;
    case Phase::kDownloadInitiate:
      return OnDownloadInitiate(frame.data, now);
    case Phase::kDownloadSegment:
      return OnDownloadSegment(frame.data, now);
    case Phase::kUploadInitiate:
      return OnUploadInitiate(frame.data, now);
    case Phase::kUploadSegment:
      return OnUploadSegment(frame.data, now);
    case Phase::kBlockDownloadInitiate:
      return OnBlockDownloadInitiate(frame.data, now);
    case Phase::kBlockDownloadSending:
      return Fail(SdoAbort::kUnknownCommand, "an answer came in the middle of a block", now);
    case Phase::kBlockDownloadAcknowledge:
      return OnBlockDownloadAcknowledge(frame.data, now);
    case Phase::kBlockDownloadEnd:
      return OnBlockDownloadEnd(frame.data, now);
    case Phase::kBlockUploadInitiate:
      return OnBlockUploadInitiate(frame.data, now);
    case Phase::kBlockUploadReceiving:
      return OnBlockUploadSegment(frame.data, now);
    case Phase::kBlockUploadEnd:
      return OnBlockUploadEnd(frame.data, now);
  }
}

void SdoClient::Send(const Payload& payload, nanoseconds now) noexcept {
  // Each answer asks for one frame at most, and Poll takes them out between; if nobody polls, the transfer
  // times out.
  (void)out_.Push(FrameOf(kRequestBase + node_id_, payload));
  deadline_ = now + timeout_;
}

void SdoClient::SendRequest(nanoseconds now) noexcept {
  const auto size = static_cast<std::uint32_t>(size_);
  switch (phase_) {
    case Phase::kDownloadInitiate:
      is_last_ = size_ > 0 && size_ <= 4;
      if (is_last_) {
        const auto command = static_cast<std::uint8_t>(0x23 | (4 - size_) << 2);
        Send(WithAddress(command, address_,
                         static_cast<std::uint32_t>(FromLittleEndian(std::span(bytes_).first(size_)))),
             now);
      } else {
        Send(WithAddress(0x21, address_, size), now);
      }
      break;
    case Phase::kUploadInitiate:
      Send(WithAddress(0x40, address_, 0), now);
      break;
    case Phase::kBlockDownloadInitiate:
      Send(WithAddress(0xC6, address_, size), now);  // CRC supported, size indicated
      break;
    case Phase::kBlockUploadInitiate:
      block_size_ = kMostSegments;
      Send(WithAddress(0xA4, address_, block_size_), now);  // CRC supported, no change of protocol
      break;
    case Phase::kNone:
    case Phase::kDownloadSegment:
    case Phase::kUploadSegment:
    case Phase::kBlockDownloadSending:
    case Phase::kBlockDownloadAcknowledge:
    case Phase::kBlockDownloadEnd:
    case Phase::kBlockUploadReceiving:
    case Phase::kBlockUploadEnd:
      break;
  }
}

void SdoClient::Finish() noexcept {
  state_ = State::kDone;
  phase_ = Phase::kNone;
}

void SdoClient::End(SdoAbort code, bool by_node, std::string_view detail) noexcept {
  state_ = State::kFailed;
  phase_ = Phase::kNone;
  failure_ = {node_id_, address_, code, by_node, detail};
}

void SdoClient::Fail(SdoAbort code, std::string_view detail, nanoseconds now) noexcept {
  out_.Purge();
  Send(WithAddress(kAbortCommand, address_, static_cast<std::uint32_t>(code)), now);
  End(code, false, detail);
}

void SdoClient::OnTimeout(nanoseconds now) noexcept {
  if (phase_ == Phase::kBlockUploadReceiving && !reminded_) {
    // The last segment of the block may be lost; what came in order is acknowledged once more.
    reminded_ = true;
    return AcknowledgeBlock(now);
  }
  Fail(SdoAbort::kTimedOut, {}, now);
  quiet_until_ = now + timeout_;
}

void SdoClient::OnAbort(const Payload& data, nanoseconds now) noexcept {
  out_.Purge();
  if (phase_ == Phase::kBlockUploadInitiate || phase_ == Phase::kBlockDownloadInitiate) {
    // Whatever the reason, the plain transfer either works or gives the true one.
    phase_ = phase_ == Phase::kBlockUploadInitiate ? Phase::kUploadInitiate : Phase::kDownloadInitiate;
    return SendRequest(now);
  }
  End(static_cast<SdoAbort>(FromLittleEndian(std::span(data).subspan(4, 4))), true, {});
}

bool SdoClient::IsForThisObject(const Payload& data, nanoseconds now) noexcept {
  const ObjectAddress address{static_cast<std::uint16_t>(FromLittleEndian(std::span(data).subspan(1, 2))),
                              data[3]};
  if (address == address_) return true;
  Fail(SdoAbort::kGeneralError, "the answer is for another object", now);
  return false;
}

void SdoClient::OnDownloadInitiate(const Payload& data, nanoseconds now) noexcept {
  if (data[0] >> 5 != kServerDownloadInitiate) return Fail(SdoAbort::kUnknownCommand, {}, now);
  if (!IsForThisObject(data, now)) return;
  if (is_last_) return Finish();
  phase_ = Phase::kDownloadSegment;
  SendDownloadSegment(now);
}

void SdoClient::SendDownloadSegment(nanoseconds now) noexcept {
  const std::size_t count = std::min<std::size_t>(7, size_ - offset_);
  is_last_ = offset_ + count == size_;
  Payload payload{
      static_cast<std::uint8_t>(unsigned{toggle_} << 4 | (7 - count) << 1 | (is_last_ ? 1U : 0U))};
  std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset_), count, payload.begin() + 1);
  offset_ += count;
  Send(payload, now);
}

void SdoClient::OnDownloadSegment(const Payload& data, nanoseconds now) noexcept {
  if (data[0] >> 5 != kServerDownloadSegment) return Fail(SdoAbort::kUnknownCommand, {}, now);
  if ((data[0] >> 4 & 1) != toggle_) return Fail(SdoAbort::kToggleBitNotAlternated, {}, now);
  if (is_last_) return Finish();
  toggle_ ^= 1;
  SendDownloadSegment(now);
}

bool SdoClient::Announce(std::uint32_t bytes, nanoseconds now) noexcept {
  announced_bytes_ = bytes;
  if (expected_bytes_ != 0 && bytes != expected_bytes_) {
    Fail(SdoAbort::kLengthMismatch, "the object has another length than expected", now);
    return false;
  }
  if (bytes > kMostBytes) {
    Fail(SdoAbort::kOutOfMemory, "the object is longer than this side can hold", now);
    return false;
  }
  return true;
}

bool SdoClient::HasPromisedLength() const noexcept {
  return (!announced_bytes_ || size_ == *announced_bytes_) &&
         (expected_bytes_ == 0 || size_ == expected_bytes_);
}

bool SdoClient::Append(std::span<const std::uint8_t> bytes, nanoseconds now) noexcept {
  if (size_ + bytes.size() > bytes_.size()) {
    Fail(SdoAbort::kOutOfMemory, "the object is longer than this side can hold", now);
    return false;
  }
  std::copy(bytes.begin(), bytes.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += bytes.size();
  return true;
}

void SdoClient::OnUploadInitiate(const Payload& data, nanoseconds now) noexcept {
  if (data[0] >> 5 != kServerUploadInitiate) return Fail(SdoAbort::kUnknownCommand, {}, now);
  if (!IsForThisObject(data, now)) return;
  const bool is_expedited = (data[0] & 2) != 0;
  const bool has_size = (data[0] & 1) != 0;
  if (is_expedited) {
    // Without a size the four bytes are of the object's own length, which only the caller may know.
    std::size_t count = has_size ? 4U - (data[0] >> 2 & 3U) : 4U;
    if (!has_size && expected_bytes_ > 0) count = std::min<std::size_t>(count, expected_bytes_);
    (void)Append(std::span(data).subspan(4, count), now);
    if (HasPromisedLength()) return Finish();
    return Fail(SdoAbort::kLengthMismatch, "the object has another length than expected", now);
  }
  if (has_size &&
      !Announce(static_cast<std::uint32_t>(FromLittleEndian(std::span(data).subspan(4, 4))), now)) {
    return;
  }
  phase_ = Phase::kUploadSegment;
  Send({0x60}, now);
}

void SdoClient::OnUploadSegment(const Payload& data, nanoseconds now) noexcept {
  if (data[0] >> 5 != kServerUploadSegment) return Fail(SdoAbort::kUnknownCommand, {}, now);
  if ((data[0] >> 4 & 1) != toggle_) return Fail(SdoAbort::kToggleBitNotAlternated, {}, now);
  const std::size_t count = 7U - (data[0] >> 1 & 7U);
  const bool is_last = (data[0] & 1) != 0;
  // Segments without data and without end would go on for ever.
  if (count == 0 && !is_last) return Fail(SdoAbort::kLengthMismatch, "a segment is empty", now);
  if (size_ + count > kMostBytes) {
    return Fail(SdoAbort::kOutOfMemory, "the object is longer than this side can hold", now);
  }
  if (!Append(std::span(data).subspan(1, count), now)) return;
  if (announced_bytes_ && size_ > *announced_bytes_) {
    return Fail(SdoAbort::kLengthTooHigh, "more came than the node had announced", now);
  }
  if (is_last) {
    if (HasPromisedLength()) return Finish();
    return Fail(SdoAbort::kLengthMismatch, "the object has another length than promised", now);
  }
  toggle_ ^= 1;
  Send({static_cast<std::uint8_t>(0x60 | toggle_ << 4)}, now);
}

}  // namespace strainwave::protocols::canopen
