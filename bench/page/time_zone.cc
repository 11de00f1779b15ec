// SPDX-License-Identifier: Apache-2.0
#include "bench/page/time_zone.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace strainwave::bench {

std::string TimeZoneIn(const std::string& text) {
  constexpr std::string_view kFolder = "zoneinfo/";
  const std::size_t folder = text.rfind(kFolder);
  std::string name = folder == std::string::npos ? text : text.substr(folder + kFolder.size());
  if (name.starts_with(':')) name.erase(0, 1);
  const bool is_name =
      !name.empty() && !name.starts_with('/') && std::ranges::all_of(name, [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '/' || c == '_' || c == '-' || c == '+';
      });
  return is_name ? name : "";
}

std::string TimeZone() {
  if (const char* variable = std::getenv("TZ"); variable != nullptr && *variable != '\0') {
    if (std::string name = TimeZoneIn(variable); !name.empty()) return name;
  }
  std::error_code none;
  const std::string file = std::filesystem::canonical("/etc/localtime", none).string();
  const std::string name = file.find("zoneinfo/") == std::string::npos ? "" : TimeZoneIn(file);
  return name.empty() ? "UTC" : name;
}

}  // namespace strainwave::bench
