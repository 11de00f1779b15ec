// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "protocols/can_frame.h"
#include "protocols/canopen/frame_queue.h"
#include "protocols/canopen/object.h"
#include "protocols/canopen/sdo_abort.h"

namespace strainwave::protocols::canopen {

/// Why a transfer gave no result.
struct SdoFailure {
  std::uint8_t node_id{};
  ObjectAddress address;
  SdoAbort code{};
  bool by_node{};           // the node aborted; otherwise this side did
  std::string_view detail;  // what was wrong with the node's answer, where this side gave up
};

/// "node 3, 6041h:00: there is no such object (06020000h from the node)".
std::string Words(const SdoFailure& failure);

/// "6041h:00".
std::string Words(const ObjectAddress& address);

/// How a transfer starts. `kBlock` goes on segmented when the node refuses block transfers.
enum class SdoTransfer : std::uint8_t { kExpeditedOrSegmented, kBlock };

/// Client of one node's default SDO (CiA 301, 7.2.4): one transfer at a time, expedited, segmented or in
/// blocks with CRC. Any answer that does not fit exactly (another object, toggle bit, sequence number,
/// length) ends the transfer with an abort to the node: a value is right or it is not there.
///
/// After a time-out nothing is asked for one more time-out, so that a late answer meets no new question.
/// Nothing allocates or throws.
class SdoClient {
 public:
  enum class State : std::uint8_t { kIdle, kBusy, kDone, kFailed };

  static constexpr std::size_t kMostBytes = 8192;

  /// @throws std::invalid_argument if node_id is not 1 to 127 or timeout is not above zero.
  explicit SdoClient(std::uint8_t node_id, std::chrono::nanoseconds timeout = std::chrono::milliseconds(500));

  /// Reads an object. With `expected_bytes` above zero an answer of another length is a failure.
  /// False, and nothing changes, while a transfer is under way.
  [[nodiscard]] bool StartUpload(ObjectAddress address, std::size_t expected_bytes, SdoTransfer transfer,
                                 std::chrono::nanoseconds now) noexcept;

  /// Writes an object. False while a transfer is under way, and for more than `kMostBytes`.
  [[nodiscard]] bool StartDownload(ObjectAddress address, std::span<const std::uint8_t> bytes,
                                   SdoTransfer transfer, std::chrono::nanoseconds now) noexcept;

  /// Drops the transfer and what is yet to be sent, without a word to the node.
  void Reset() noexcept;

  void OnFrame(const CanFrame& frame, std::chrono::nanoseconds now) noexcept;

  /// The next frame to send, if any; to be called until there is none, or as often as the bus takes more.
  std::optional<CanFrame> Poll(std::chrono::nanoseconds now) noexcept;

  State state() const noexcept { return state_; }
  /// What an upload read, once done.
  std::span<const std::uint8_t> data() const noexcept;
  /// Valid once failed.
  const SdoFailure& failure() const noexcept { return failure_; }
  /// Answers that no question was open for; they change nothing.
  std::uint64_t unsolicited() const noexcept { return unsolicited_; }

 private:
  enum class Phase : std::uint8_t {
    kNone,
    kDownloadInitiate,
    kDownloadSegment,
    kUploadInitiate,
    kUploadSegment,
    kBlockDownloadInitiate,
    kBlockDownloadSending,
    kBlockDownloadAcknowledge,
    kBlockDownloadEnd,
    kBlockUploadInitiate,
    kBlockUploadReceiving,
    kBlockUploadEnd,
  };
  using Payload = std::array<std::uint8_t, 8>;
  static constexpr std::uint8_t kMostSegments = 127;  // of a block
  static constexpr int kMostRepeats = 3;              // of a block of which nothing came through

  void Start(ObjectAddress address, Phase phase, std::chrono::nanoseconds now) noexcept;
  void Send(const Payload& payload, std::chrono::nanoseconds now) noexcept;
  void SendRequest(std::chrono::nanoseconds now) noexcept;
  void SendDownloadSegment(std::chrono::nanoseconds now) noexcept;
  void Finish() noexcept;
  /// Gives up, and tells the node.
  void Fail(SdoAbort code, std::string_view detail, std::chrono::nanoseconds now) noexcept;
  void End(SdoAbort code, bool by_node, std::string_view detail) noexcept;
  bool IsForThisObject(const Payload& data, std::chrono::nanoseconds now) noexcept;
  bool Append(std::span<const std::uint8_t> bytes, std::chrono::nanoseconds now) noexcept;
  bool HasPromisedLength() const noexcept;
  bool Announce(std::uint32_t bytes, std::chrono::nanoseconds now) noexcept;

  void OnTimeout(std::chrono::nanoseconds now) noexcept;
  void OnAbort(const Payload& data, std::chrono::nanoseconds now) noexcept;
  void OnDownloadInitiate(const Payload& data, std::chrono::nanoseconds now) noexcept;
  void OnDownloadSegment(const Payload& data, std::chrono::nanoseconds now) noexcept;
  void OnUploadInitiate(const Payload& data, std::chrono::nanoseconds now) noexcept;
  void OnUploadSegment(const Payload& data, std::chrono::nanoseconds now) noexcept;

  // sdo_client_block.cc
  CanFrame NextBlockSegment(std::chrono::nanoseconds now) noexcept;
  void OnBlockDownloadInitiate(const Payload& data, std::chrono::nanoseconds now) noexcept;
  void OnBlockDownloadAcknowledge(const Payload& data, std::chrono::nanoseconds now) noexcept;
  void OnBlockDownloadEnd(const Payload& data, std::chrono::nanoseconds now) noexcept;
  void OnBlockUploadInitiate(const Payload& data, std::chrono::nanoseconds now) noexcept;
  void OnBlockUploadSegment(const Payload& data, std::chrono::nanoseconds now) noexcept;
  void OnBlockUploadEnd(const Payload& data, std::chrono::nanoseconds now) noexcept;
  void AcknowledgeBlock(std::chrono::nanoseconds now) noexcept;

  std::uint8_t node_id_;
  std::chrono::nanoseconds timeout_;

  State state_{State::kIdle};
  Phase phase_{Phase::kNone};
  bool request_due_{};  // the first frame waits for the end of the quiet time
  std::chrono::nanoseconds quiet_until_{std::chrono::nanoseconds::min()};
  std::chrono::nanoseconds deadline_{};
  FrameQueue<4> out_;
  SdoFailure failure_;
  std::uint64_t unsolicited_{};

  ObjectAddress address_;
  std::array<std::uint8_t, kMostBytes + 8> bytes_{};  // the last segment of a block is cut to length later
  std::size_t size_{};                                // of what is written, or has been read so far
  std::size_t offset_{};                              // of what has been sent
  std::size_t expected_bytes_{};
  std::optional<std::uint32_t> announced_bytes_;
  bool is_last_{};  // the segment under way closes the transfer
  std::uint8_t toggle_{};

  bool has_crc_{};
  std::uint8_t block_size_{};
  std::uint8_t segments_{};    // of this block: sent, or received in order
  std::size_t block_start_{};  // offset of its first byte
  int repeats_{};
  bool reminded_{};
};

}  // namespace strainwave::protocols::canopen
