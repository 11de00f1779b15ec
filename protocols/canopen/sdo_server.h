// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocols/can_frame.h"
#include "protocols/canopen/object_dictionary.h"

namespace strainwave::protocols::canopen::device {

/// CRC-16-CCITT of a block transfer (CiA 301, 7.2.4.3.16): polynomial 1021h, from zero, not reflected; of the
/// digits 123456789 it is 31C3h.
std::uint16_t BlockChecksum(std::span<const std::uint8_t> bytes);

/// The default SDO server of a node (CiA 301, 7.2.4): requests on 600h + id, answers on 580h + id; expedited,
/// segmented and block transfer, one at a time. A new request ends a transfer that was under way. Frames that
/// are not eight bytes long are no SDO and are passed over.
class SdoServer {
 public:
  /// @param timeout  how long the client may let a transfer wait before it is aborted.
  SdoServer(ObjectDictionary& objects, std::uint8_t node_id,
            std::chrono::nanoseconds timeout = std::chrono::seconds(1));

  /// @returns whether the frame was meant for this server.
  bool OnFrame(const CanFrame& frame, std::chrono::nanoseconds now);
  void Poll(std::chrono::nanoseconds now);
  /// The next frame to be sent, if there is one. A block is given out frame by frame, as the bus takes it.
  bool Next(CanFrame& frame);

  /// Forgets a transfer without a word, as at a change of the NMT state.
  void Reset();

 private:
  enum class State : std::uint8_t {
    kIdle,
    kDownloadSegments,
    kUploadSegments,
    kDownloadBlock,
    kDownloadBlockEnd,
    kUploadBlockStart,  // the client has not yet asked for the first block
    kUploadBlockSending,
    kUploadBlockAnswer,  // a block is out, its receipt is awaited
    kUploadBlockEnd,
  };
  using Bytes = std::span<const std::uint8_t, 8>;

  void OnDownload(Bytes request);
  void OnDownloadSegment(Bytes request);
  void OnUpload(Bytes request);
  void OnUploadSegment(Bytes request);
  void OnBlockDownload(Bytes request);
  void OnBlockSegment(Bytes request);
  void OnBlockDownloadEnd(Bytes request);
  void OnBlockUpload(Bytes request);
  void OnBlockUploadStart(Bytes request);
  void OnBlockReceipt(Bytes request);

  void StartUpload();
  void AnswerUpload();
  bool Store();
  void SendBlockSegment(CanFrame& frame);
  bool TakeBlockSize(std::uint8_t size);
  std::uint8_t* Answer(std::uint8_t command, bool with_address);
  void Abort(SdoAbort reason);
  void TakeAddress(Bytes request);

  ObjectDictionary& objects_;
  std::uint8_t node_id_;
  std::chrono::nanoseconds timeout_;
  std::chrono::nanoseconds last_request_{};
  State state_{State::kIdle};
  bool answer_ready_{};
  CanFrame answer_;

  ObjectAddress address_;
  std::vector<std::uint8_t> data_;
  std::size_t done_{};  // bytes of `data_` that the client has, or the size it said it would send
  bool toggle_{};
  bool checksum_wanted_{};
  std::uint8_t block_size_{};
  std::uint8_t sequence_{};  // of the last segment that was taken or sent in this block
  bool last_segment_{};
  std::size_t last_length_{};  // bytes used of the last segment of a block upload
  std::optional<std::size_t> announced_;
};

}  // namespace strainwave::protocols::canopen::device
