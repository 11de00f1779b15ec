// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/sdo_server.h"

#include <boost/crc.hpp>

#include "protocols/canopen/device_frames.h"

namespace strainwave::protocols::canopen::device {
namespace {

constexpr std::uint32_t kRequestId = 0x600;
constexpr std::uint32_t kAnswerId = 0x580;

// The first byte of a frame (CiA 301, 7.2.4.3.3 and on): the upper three bits are the command.
constexpr unsigned kDownloadSegmentRequest = 0;
constexpr unsigned kDownloadRequest = 1;
constexpr unsigned kUploadRequest = 2;
constexpr unsigned kUploadSegmentRequest = 3;
constexpr unsigned kAbort = 4;
constexpr unsigned kBlockUploadRequest = 5;
constexpr unsigned kBlockDownloadRequest = 6;

constexpr std::uint8_t kDownloadAnswer = 0x60;
constexpr std::uint8_t kDownloadSegmentAnswer = 0x20;
constexpr std::uint8_t kUploadExpedited = 0x43;
constexpr std::uint8_t kUploadSized = 0x41;
constexpr std::uint8_t kBlockDownloadAnswer = 0xA4;  // with checksum
constexpr std::uint8_t kBlockReceipt = 0xA2;
constexpr std::uint8_t kBlockDownloadEndAnswer = 0xA1;
constexpr std::uint8_t kBlockUploadAnswer = 0xC6;  // with checksum and size
constexpr std::uint8_t kBlockUploadEnd = 0xC1;

constexpr std::uint8_t kToggle = 0x10;
constexpr std::uint8_t kLastSegment = 0x80;  // of a block
constexpr std::size_t kSegmentBytes = 7;
constexpr std::uint8_t kMostSegments = 127;  // a block

}  // namespace

std::uint16_t BlockChecksum(std::span<const std::uint8_t> bytes) {
  boost::crc_xmodem_t crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return static_cast<std::uint16_t>(crc.checksum());
}

SdoServer::SdoServer(ObjectDictionary& objects, std::uint8_t node_id, std::chrono::nanoseconds timeout)
    : objects_(objects), node_id_(node_id), timeout_(timeout) {
  data_.reserve(ObjectDictionary::kMostBytes);
}

void SdoServer::Reset() {
  state_ = State::kIdle;
  answer_ready_ = false;
}

// An answer of zeros but for the command and, where the service has it, the address.
std::uint8_t* SdoServer::Answer(std::uint8_t command, bool with_address) {
  answer_ = CanFrame{};
  answer_.id = kAnswerId + node_id_;
  answer_.length = 8;
  answer_.data[0] = command;
  if (with_address) {
    PutLittleEndian(std::span(answer_.data).subspan(1, 2), address_.index);
    answer_.data[3] = address_.subindex;
  }
  answer_ready_ = true;
  return answer_.data.data();
}

void SdoServer::Abort(SdoAbort reason) {
  Answer(0x80, true);
  PutLittleEndian(std::span(answer_.data).subspan(4), static_cast<std::uint32_t>(reason));
  state_ = State::kIdle;
}

void SdoServer::TakeAddress(Bytes request) {
  address_.index = static_cast<std::uint16_t>(GetLittleEndian(request.subspan(1, 2)));
  address_.subindex = request[3];
}

bool SdoServer::OnFrame(const CanFrame& frame, std::chrono::nanoseconds now) {
  if (frame.id != kRequestId + node_id_ || !IsPlainData(frame)) return false;
  if (frame.length != 8) return true;
  const Bytes request(frame.data);
  last_request_ = now;
  const unsigned command = request[0] >> 5;
  if (command == kAbort && (state_ != State::kDownloadBlock || request[0] == 0x80)) {
    Reset();
    return true;
  }
  // Within a block a frame has no command, but a number; an abort alone is told from it by number zero.
  if (state_ == State::kDownloadBlock) {
    OnBlockSegment(request);
    return true;
  }
  switch (command) {
    case kDownloadSegmentRequest:
      OnDownloadSegment(request);
      break;
    case kDownloadRequest:
      OnDownload(request);
      break;
    case kUploadRequest:
      OnUpload(request);
      break;
    case kUploadSegmentRequest:
      OnUploadSegment(request);
      break;
    case kBlockUploadRequest:
      OnBlockUpload(request);
      break;
    case kBlockDownloadRequest:
      OnBlockDownload(request);
      break;
    default:
      Abort(SdoAbort::kUnknownCommand);
  }
  return true;
}

void SdoServer::Poll(std::chrono::nanoseconds now) {
  if (state_ != State::kIdle && now - last_request_ > timeout_) Abort(SdoAbort::kTimedOut);
}

bool SdoServer::Next(CanFrame& frame) {
  if (answer_ready_) {
    frame = answer_;
    answer_ready_ = false;
    return true;
  }
  if (state_ != State::kUploadBlockSending) return false;
  SendBlockSegment(frame);
  return true;
}

bool SdoServer::Store() {
  if (announced_ && *announced_ != data_.size()) {
    Abort(data_.size() > *announced_ ? SdoAbort::kLengthTooHigh : SdoAbort::kLengthTooLow);
    return false;
  }
  if (const std::optional<SdoAbort> abort = objects_.Write(address_, data_)) {
    Abort(*abort);
    return false;
  }
  state_ = State::kIdle;
  return true;
}

void SdoServer::OnDownload(Bytes request) {
  TakeAddress(request);
  const bool expedited = (request[0] & 0x02) != 0;
  const bool sized = (request[0] & 0x01) != 0;
  data_.clear();
  announced_.reset();
  if (expedited) {
    std::size_t length = sized ? 4U - (request[0] >> 2 & 0x03U) : 4U;
    // A client that does not say how much it sends means as much as the object takes.
    if (const Object* object = objects_.Find(address_); !sized && object != nullptr && object->size() < 4) {
      length = object->size();
    }
    data_.assign(request.begin() + 4, request.begin() + 4 + static_cast<std::ptrdiff_t>(length));
    if (Store()) Answer(kDownloadAnswer, true);
    return;
  }
  if (sized) {
    announced_ = GetLittleEndian(request.subspan(4, 4));
    if (*announced_ > ObjectDictionary::kMostBytes) return Abort(SdoAbort::kOutOfMemory);
  }
  toggle_ = false;
  state_ = State::kDownloadSegments;
  Answer(kDownloadAnswer, true);
}

void SdoServer::OnDownloadSegment(Bytes request) {
  if (state_ != State::kDownloadSegments) return Abort(SdoAbort::kUnknownCommand);
  if (((request[0] & kToggle) != 0) != toggle_) return Abort(SdoAbort::kToggleBitNotAlternated);
  const std::size_t length = kSegmentBytes - (request[0] >> 1 & 0x07U);
  if (data_.size() + length > ObjectDictionary::kMostBytes) return Abort(SdoAbort::kOutOfMemory);
  data_.insert(data_.end(), request.begin() + 1, request.begin() + 1 + static_cast<std::ptrdiff_t>(length));
  if ((request[0] & 0x01) != 0 && !Store()) return;
  Answer(static_cast<std::uint8_t>(kDownloadSegmentAnswer | (toggle_ ? kToggle : 0)), false);
  toggle_ = !toggle_;
}

void SdoServer::StartUpload() {
  done_ = 0;
  if (const std::optional<SdoAbort> abort = objects_.Read(address_, data_)) Abort(*abort);
}

void SdoServer::OnUpload(Bytes request) {
  TakeAddress(request);
  state_ = State::kIdle;
  answer_ready_ = false;
  StartUpload();
  if (!answer_ready_) AnswerUpload();
}

void SdoServer::AnswerUpload() {
  const std::size_t length = data_.size();
  if (length >= 1 && length <= 4) {
    std::uint8_t* answer = Answer(static_cast<std::uint8_t>(kUploadExpedited | (4 - length) << 2), true);
    std::copy(data_.begin(), data_.end(), answer + 4);
    state_ = State::kIdle;
    return;
  }
  Answer(kUploadSized, true);
  PutLittleEndian(std::span(answer_.data).subspan(4), length);
  toggle_ = false;
  state_ = State::kUploadSegments;
}

void SdoServer::OnUploadSegment(Bytes request) {
  if (state_ != State::kUploadSegments) return Abort(SdoAbort::kUnknownCommand);
  if (((request[0] & kToggle) != 0) != toggle_) return Abort(SdoAbort::kToggleBitNotAlternated);
  const std::size_t length = std::min(kSegmentBytes, data_.size() - done_);
  const bool last = done_ + length == data_.size();
  std::uint8_t* answer = Answer(
      static_cast<std::uint8_t>((toggle_ ? kToggle : 0) | (kSegmentBytes - length) << 1 | (last ? 1 : 0)),
      false);
  std::copy_n(data_.begin() + static_cast<std::ptrdiff_t>(done_), length, answer + 1);
  done_ += length;
  toggle_ = !toggle_;
  if (last) state_ = State::kIdle;
}

void SdoServer::OnBlockDownload(Bytes request) {
  if ((request[0] & 0x01) != 0) return OnBlockDownloadEnd(request);
  TakeAddress(request);
  checksum_wanted_ = (request[0] & 0x04) != 0;
  data_.clear();
  announced_.reset();
  if ((request[0] & 0x02) != 0) {
    announced_ = GetLittleEndian(request.subspan(4, 4));
    if (*announced_ > ObjectDictionary::kMostBytes) return Abort(SdoAbort::kOutOfMemory);
  }
  // What will not be taken at the end is refused at the beginning.
  const Object* object = objects_.Find(address_);
  if (object != nullptr && !object->writable()) return Abort(SdoAbort::kReadOnlyObject);
  sequence_ = 0;
  last_segment_ = false;
  state_ = State::kDownloadBlock;
  Answer(kBlockDownloadAnswer, true)[4] = kMostSegments;
}

void SdoServer::OnBlockSegment(Bytes request) {
  const auto number = static_cast<std::uint8_t>(request[0] & ~kLastSegment);
  const bool last = (request[0] & kLastSegment) != 0;
  if (number == 0 || number > kMostSegments) return Abort(SdoAbort::kInvalidSequenceNumber);
  if (number == sequence_ + 1) {
    if (data_.size() + kSegmentBytes > ObjectDictionary::kMostBytes + kSegmentBytes) {
      return Abort(SdoAbort::kOutOfMemory);
    }
    data_.insert(data_.end(), request.begin() + 1, request.end());
    sequence_ = number;
    last_segment_ = last;
  }
  // The receipt names the last one of an unbroken run; the client sends again from there.
  if (number != kMostSegments && !last) return;
  std::uint8_t* answer = Answer(kBlockReceipt, false);
  answer[1] = sequence_;
  answer[2] = kMostSegments;
  sequence_ = 0;
  if (last_segment_) state_ = State::kDownloadBlockEnd;
}

void SdoServer::OnBlockDownloadEnd(Bytes request) {
  if (state_ != State::kDownloadBlockEnd) return Abort(SdoAbort::kUnknownCommand);
  const std::size_t unused = request[0] >> 2 & 0x07U;
  data_.resize(data_.size() - std::min(unused, data_.size()));
  const auto checksum = static_cast<std::uint16_t>(GetLittleEndian(request.subspan(1, 2)));
  if (checksum_wanted_ && checksum != BlockChecksum(data_)) return Abort(SdoAbort::kCrcError);
  if (Store()) Answer(kBlockDownloadEndAnswer, false);
}

bool SdoServer::TakeBlockSize(std::uint8_t size) {
  if (size < 1 || size > kMostSegments) {
    Abort(SdoAbort::kInvalidBlockSize);
    return false;
  }
  block_size_ = size;
  return true;
}

void SdoServer::OnBlockUpload(Bytes request) {
  switch (request[0] & 0x03) {
    case 0:
      break;
    case 1:
      if (state_ != State::kUploadBlockEnd) return Abort(SdoAbort::kUnknownCommand);
      state_ = State::kIdle;
      return;
    case 2:
      return OnBlockReceipt(request);
    default:
      return OnBlockUploadStart(request);
  }
  TakeAddress(request);
  checksum_wanted_ = (request[0] & 0x04) != 0;
  state_ = State::kIdle;
  answer_ready_ = false;
  if (!TakeBlockSize(request[4])) return;
  StartUpload();
  if (answer_ready_) return;
  // The client would have short values by the ordinary transfer.
  const std::size_t threshold = request[5];
  if (threshold != 0 && data_.size() <= threshold) return AnswerUpload();
  Answer(kBlockUploadAnswer, true);
  PutLittleEndian(std::span(answer_.data).subspan(4), data_.size());
  state_ = State::kUploadBlockStart;
}

void SdoServer::OnBlockUploadStart(Bytes) {
  if (state_ != State::kUploadBlockStart) return Abort(SdoAbort::kUnknownCommand);
  sequence_ = 0;
  state_ = State::kUploadBlockSending;
}

void SdoServer::SendBlockSegment(CanFrame& frame) {
  const std::size_t begin = done_ + kSegmentBytes * sequence_;
  const std::size_t length = std::min(kSegmentBytes, data_.size() - begin);
  const bool last = begin + length == data_.size();
  ++sequence_;
  frame = CanFrame{};
  frame.id = kAnswerId + node_id_;
  frame.length = 8;
  frame.data[0] = static_cast<std::uint8_t>(sequence_ | (last ? kLastSegment : 0));
  std::copy_n(data_.begin() + static_cast<std::ptrdiff_t>(begin), length, frame.data.begin() + 1);
  last_segment_ = last;
  last_length_ = length;
  if (last || sequence_ == block_size_) state_ = State::kUploadBlockAnswer;
}

void SdoServer::OnBlockReceipt(Bytes request) {
  if (state_ != State::kUploadBlockAnswer) return Abort(SdoAbort::kUnknownCommand);
  const std::uint8_t received = request[1];
  if (received > sequence_) return Abort(SdoAbort::kInvalidSequenceNumber);
  if (!TakeBlockSize(request[2])) return;
  if (received == sequence_ && last_segment_) {
    const auto unused = static_cast<std::uint8_t>(kSegmentBytes - last_length_);
    std::uint8_t* answer = Answer(static_cast<std::uint8_t>(kBlockUploadEnd | unused << 2), false);
    if (checksum_wanted_) PutLittleEndian(std::span(answer + 1, 2), BlockChecksum(data_));
    state_ = State::kUploadBlockEnd;
    return;
  }
  done_ += kSegmentBytes * received;
  sequence_ = 0;
  state_ = State::kUploadBlockSending;
}

}  // namespace strainwave::protocols::canopen::device
