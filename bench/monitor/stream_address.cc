// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/stream_address.h"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "bench/devices/tcp_address.h"

namespace strainwave::bench {
namespace {

using daq::acquisition::IioSettings;
using daq::acquisition::SampleSource;
using daq::acquisition::TcpStreamSettings;

[[noreturn]] void RefuseAddress(std::string_view text) {
  throw std::invalid_argument(fmt::format("address = {} (expected {})", text, kStreamAddresses));
}

// What follows the scheme, where it is that one.
std::optional<std::string_view> After(std::string_view scheme, std::string_view text) {
  if (!text.starts_with(scheme)) return std::nullopt;
  return text.substr(scheme.size());
}

TcpStreamSettings TcpFrom(std::string_view text, std::string_view rest) {
  TcpAddress at;
  try {
    at = ParseTcpAddress(fmt::format("tcp:{}", rest));
  } catch (const std::invalid_argument&) {
    RefuseAddress(text);
  }
  if (at.port == 0) RefuseAddress(text);
  TcpStreamSettings settings;
  settings.host = at.host;
  settings.port = static_cast<std::uint16_t>(at.port);
  return settings;
}

IioSettings IioFrom(std::string_view text, std::string_view rest) {
  const std::size_t slash = rest.rfind('/');
  if (slash == std::string_view::npos || slash == 0 || slash + 1 == rest.size()) RefuseAddress(text);
  IioSettings settings;
  settings.uri = rest.substr(0, slash);
  settings.device = rest.substr(slash + 1);
  return settings;
}

}  // namespace

StreamAddress ParseStreamAddress(std::string_view text) {
  if (const auto rest = After("tcp://", text)) return TcpFrom(text, *rest);
  if (const auto rest = After("tcp:", text)) return TcpFrom(text, *rest);
  if (const auto rest = After("iio:", text)) return IioFrom(text, *rest);
  if (const auto rest = After("replay:", text); rest && !rest->empty()) {
    return daq::acquisition::ReplaySettings{.path = std::string(*rest)};
  }
  RefuseAddress(text);
}

std::unique_ptr<SampleSource> MakeSampleSource(StreamAddress address, double pace) {
  return std::visit(
      [pace](auto settings) -> std::unique_ptr<SampleSource> {
        using Settings = decltype(settings);
        if constexpr (std::is_same_v<Settings, TcpStreamSettings>) {
          return std::make_unique<daq::acquisition::TcpStreamSource>(std::move(settings));
        } else if constexpr (std::is_same_v<Settings, IioSettings>) {
          return std::make_unique<daq::acquisition::IioSource>(std::move(settings));
        } else {
          settings.speed = std::isfinite(pace) ? pace : 0.0;
          return std::make_unique<daq::acquisition::ReplaySource>(std::move(settings));
        }
      },
      std::move(address));
}

}  // namespace strainwave::bench
