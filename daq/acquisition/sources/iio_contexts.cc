// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/sources/iio_contexts.h"

#include <cerrno>
#include <memory>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <iio.h>

namespace strainwave::daq::acquisition {

std::vector<IioContextInfo> FindIioContexts(std::vector<std::string>& troubles) {
  std::vector<IioContextInfo> found;
  constexpr std::pair<const char*, const char*> kWays[] = {
      {"local", "this machine"}, {"usb", "USB"}, {"ip", "the network"}};
  // One after the other: where one way is not to be had, libiio gives up the others, too.
  for (const auto& [backend, words] : kWays) {
    const std::unique_ptr<iio_scan_context, decltype(&iio_scan_context_destroy)> scan(
        iio_create_scan_context(backend, 0), iio_scan_context_destroy);
    iio_context_info** list = nullptr;
    const ssize_t count = scan ? iio_scan_context_get_info_list(scan.get(), &list) : -errno;
    if (count < 0) {
      const auto error = static_cast<int>(-count);
      // Without sensors there is no such folder in /sys; that is nobody's trouble.
      if (error != ENOENT) {
        troubles.push_back(fmt::format("IIO devices on {} cannot be looked for: {}", words,
                                       std::system_category().message(error)));
      }
      continue;
    }
    for (ssize_t i = 0; i < count; ++i) {
      found.push_back({iio_context_info_get_uri(list[i]), iio_context_info_get_description(list[i])});
    }
    iio_context_info_list_free(list);
  }
  return found;
}

}  // namespace strainwave::daq::acquisition
