// SPDX-License-Identifier: Apache-2.0
#include "bench/page/picture.h"

#include <sys/stat.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <fmt/core.h>

#include "bench/utc.h"

namespace strainwave::bench {
namespace {

constexpr std::string_view kPictureExtension = ".jpg";
constexpr std::uintmax_t kLongestPicture_bytes = 16 * 1024 * 1024;

}  // namespace

std::optional<int> CycleOfPicture(std::string_view name) {
  constexpr std::ptrdiff_t kFewestDigits = 6;
  int cycle{};
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), cycle);
  const std::string_view rest(end, name.data() + name.size());
  if (error != std::errc() || end - name.data() < kFewestDigits || !name.ends_with(kPictureExtension) ||
      cycle < 0) {
    return std::nullopt;
  }
  if (rest != kPictureExtension && !rest.starts_with('-')) return std::nullopt;
  return cycle;
}

void PictureWatch::Take(const std::filesystem::path& file) {
  const auto cycle = CycleOfPicture(file.filename().string());
  struct stat found {};
  if (!cycle || ::stat(file.c_str(), &found) != 0 || !S_ISREG(found.st_mode)) return;
  const std::int64_t taken_utc_ms = found.st_mtim.tv_sec * 1000 + found.st_mtim.tv_nsec / 1'000'000;
  if (newest_ && newest_->taken_utc_ms > taken_utc_ms) return;
  newest_ = BenchPicture{file, *cycle, taken_utc_ms};
}

const std::optional<BenchPicture>& PictureWatch::Look(const CampaignFolder& folder, int last_complete) {
  std::error_code none;
  if (looked_up_to_ < 0) {
    for (const auto& entry : std::filesystem::directory_iterator(folder.Cycles(), none)) Take(entry.path());
  }
  // That of the cycle under way may come before its row in the journal, and that of the last one late.
  const auto of_cycle = [&](int cycle) {
    Take(std::filesystem::path(folder.CycleFile(cycle)).replace_extension(kPictureExtension));
  };
  for (int cycle = std::max(0, looked_up_to_); cycle <= last_complete + 1; ++cycle) of_cycle(cycle);
  for (const auto& entry : std::filesystem::directory_iterator(folder.Faults(), none)) Take(entry.path());
  looked_up_to_ = std::max(0, last_complete - 1);
  return newest_;
}

std::string WhyStale(const std::optional<BenchPicture>& picture, int last_complete) {
  if (!picture) return "the camera has given no picture yet";
  if (picture->cycle >= last_complete) return {};
  const int missing = last_complete - picture->cycle;
  return fmt::format("of cycle {}; the camera has given none in the {} complete since", picture->cycle,
                     missing == 1 ? std::string("cycle") : fmt::format("{} cycles", missing));
}

nlohmann::json PictureJson(const std::optional<BenchPicture>& picture, int last_complete,
                           std::int64_t now_utc_ms) {
  nlohmann::json shown{{"name", nullptr},
                       {"cycle", nullptr},
                       {"taken_utc", nullptr},
                       {"age_s", nullptr},
                       {"stale", WhyStale(picture, last_complete)}};
  if (!picture) return shown;
  shown["name"] = picture->file.filename().string();
  shown["cycle"] = picture->cycle;
  shown["taken_utc"] = UtcText(picture->taken_utc_ms);
  shown["age_s"] = 1e-3 * static_cast<double>(now_utc_ms - picture->taken_utc_ms);
  return shown;
}

std::string ReadPicture(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (error) throw std::runtime_error(fmt::format("{}: {}", file.filename().string(), error.message()));
  if (bytes == 0 || bytes > kLongestPicture_bytes) {
    throw std::runtime_error(fmt::format("{} has {} bytes (expected 1 to {})", file.filename().string(),
                                         bytes, kLongestPicture_bytes));
  }
  std::string read(bytes, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(read.data(), static_cast<std::streamsize>(bytes));
  if (!in) throw std::runtime_error(fmt::format("{} cannot be read", file.filename().string()));
  return read;
}

}  // namespace strainwave::bench
