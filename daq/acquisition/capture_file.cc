// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/capture_file.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "daq/acquisition/gap_ledger.h"
#include "daq/acquisition/stream_file_writer.h"

namespace strainwave::daq::acquisition {
namespace {

std::optional<Gap> GapBetween(const BlockHeader& last, const BlockHeader& next) {
  const bool is_reset = (next.flags & kAfterReset) != 0;
  if (next.lost_before == 0 && !is_reset) return std::nullopt;
  return Gap{.first_lost = next.first_sample - next.lost_before,
             .lost = next.lost_before,
             .is_exact = (next.flags & kLostIsEstimate) == 0,
             .is_reset = is_reset,
             .last_arrival = last.arrival,
             .arrival = next.arrival,
             .last_device_time = last.device_time,
             .device_time = next.device_time};
}

}  // namespace

void WriteCapture(const std::filesystem::path& path, const SourceDescription& source, const Capture& capture,
                  Attributes attributes) {
  attributes.emplace_back("trigger_cause", capture.cause);
  attributes.emplace_back("trigger_sample", std::to_string(capture.trigger_sample));
  attributes.emplace_back("trigger_row", std::to_string(capture.trigger_row));
  StreamFileWriter file(path, source, attributes);
  const BlockHeader* last = nullptr;
  for (const Capture::Piece& piece : capture.pieces) {
    SampleBlock block(std::size_t{piece.header.samples} * piece.header.channels);
    block.header = piece.header;
    std::ranges::copy(std::span(capture.words).subspan(piece.row * capture.channels, block.size()),
                      block.words().begin());
    file.Append(block, last == nullptr ? std::nullopt : GapBetween(*last, piece.header));
    last = &piece.header;
  }
  file.Close();
}

}  // namespace strainwave::daq::acquisition
