// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "bench/campaign/folder.h"

namespace strainwave::bench {

/// A picture of the bench, as its camera took it after a cycle or at a trip.
struct BenchPicture {
  std::filesystem::path file;
  int cycle{};
  std::int64_t taken_utc_ms{};

  bool operator==(const BenchPicture&) const = default;
};

/// The cycle in the name of such a file: 5 of "000005.jpg" and of "000005-120s.jpg"; none of another name.
std::optional<int> CycleOfPicture(std::string_view name);

/// The newest of a campaign, by the time at which it was taken. Looks at all there are once, then at those of
/// newer cycles alone.
class PictureWatch {
 public:
  const std::optional<BenchPicture>& Look(const CampaignFolder& folder, int last_complete);

 private:
  void Take(const std::filesystem::path& file);

  std::optional<BenchPicture> newest_;
  int looked_up_to_{-1};  // cycles; −1: all are still to be looked at
};

/// Why a picture does not show the bench as it is by now, in words; empty: it is of the newest complete cycle
/// or later. @param last_complete  cycle.
std::string WhyStale(const std::optional<BenchPicture>& picture, int last_complete);

/// `name`, `cycle`, `taken_utc`, `age_s`, `stale` (in words; empty: it is not); without a picture all but
/// `stale` are null.
nlohmann::json PictureJson(const std::optional<BenchPicture>& picture, int last_complete,
                           std::int64_t now_utc_ms);

/// Its bytes. @throws std::runtime_error where it cannot be read, is empty or longer than a picture is.
std::string ReadPicture(const std::filesystem::path& file);

}  // namespace strainwave::bench
