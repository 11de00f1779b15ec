// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/sealed_json.h"

#include <cstdint>
#include <fstream>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"
#include "bench/sha256.h"

namespace strainwave::bench {

void Seal(nlohmann::ordered_json& json) { json["sha256"] = Sha256(json.dump()); }

void RequireSeal(const std::filesystem::path& file, nlohmann::ordered_json json) {
  const auto own = json.at("sha256").get<std::string>();
  json.erase("sha256");
  if (Sha256(json.dump()) != own) {
    Refuse(file, "the file has changed since it was written", "the SHA-256 that it has of itself");
  }
}

std::string ReadBounded(const std::filesystem::path& file, const std::string& expected) {
  constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30;
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  if (error || !stream) Refuse(file, "cannot be read", expected);
  if (bytes > kMostBytes) Refuse(file, fmt::format("has {} bytes", bytes), "at most 1 GiB");
  std::ostringstream text;
  text << stream.rdbuf();
  return std::move(text).str();
}

std::string ReadListed(const std::filesystem::path& folder, const nlohmann::ordered_json& entry,
                       const std::string& expected) {
  const std::filesystem::path path = folder / entry.at("file").get<std::string>();
  std::string bytes = ReadBounded(path, expected);
  if (Sha256(bytes) != entry.at("sha256").get<std::string>())
    Refuse(path, "the file has changed since it was written", "the SHA-256 that recipe.json has of it");
  return bytes;
}

}  // namespace strainwave::bench
