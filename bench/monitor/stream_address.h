// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "daq/acquisition/sources/iio_source.h"
#include "daq/acquisition/sources/replay_source.h"
#include "daq/acquisition/sources/tcp_stream_source.h"

namespace strainwave::bench {

using StreamAddress = std::variant<daq::acquisition::TcpStreamSettings, daq::acquisition::IioSettings,
                                   daq::acquisition::ReplaySettings>;

inline constexpr const char* kStreamAddresses =
    "tcp://HOST:PORT, iio:URI/DEVICE as in iio:ip:10.0.0.7/adxl355, or replay:FILE";

/// Where samples come from: "tcp://10.0.0.7:5025" (TCP_STREAM.md), "iio:local:/adxl355", "replay:stream.h5".
/// @throws std::invalid_argument naming the text and `kStreamAddresses`.
StreamAddress ParseStreamAddress(std::string_view text);

/// @param pace  of a replayed file: times real time; infinity: as fast as it is asked for.
std::unique_ptr<daq::acquisition::SampleSource> MakeSampleSource(StreamAddress address, double pace);

}  // namespace strainwave::bench
