// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <iio.h>

/// What every use of libiio begins with. For the sources of this folder alone.
namespace strainwave::daq::acquisition {

using IioContext = std::unique_ptr<iio_context, decltype(&iio_context_destroy)>;

/// @param uri  a copy: libiio 0.24 cuts the port off in place.
/// @returns null where there is none; errno then says why.
inline IioContext OpenIioContext(std::string uri) {
  return {iio_create_context_from_uri(uri.data()), iio_context_destroy};
}

inline bool IsIioTimeStamp(const iio_channel* channel) {
  return std::string_view(iio_channel_get_id(channel)) == "timestamp";
}

/// Whether it comes with a buffer: a measured quantity, or the time stamp.
inline bool IsScanned(const iio_channel* channel) {
  return iio_channel_is_scan_element(channel) && !iio_channel_is_output(channel);
}

}  // namespace strainwave::daq::acquisition
