// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/live_sources.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "daq/data_file_error.h"

namespace strainwave::bench {
namespace {

using nlohmann::json;

constexpr std::int64_t kSourcesInterval_ms = 1000;
constexpr int kSourcesVersion = 1;
constexpr std::size_t kLongestTrouble = 300;

json CountsJson(const SourceCounts& source) {
  const daq::acquisition::GapTotals& samples = source.samples;
  return {{"name", source.name},
          {"received", samples.received},
          {"lost", samples.lost},
          {"estimated", samples.estimated},
          {"repeated", samples.repeated},
          {"gaps", samples.gaps},
          {"resets", samples.resets},
          {"clock_restarts", source.clock_restarts},
          {"trouble", source.trouble.substr(0, kLongestTrouble)},
          {"last_sample_utc_ms", source.last_sample_utc_ms},
          {"last_loss_utc_ms", source.last_loss_utc_ms}};
}

SourceCounts CountsOf(const json& counts) {
  return {counts.at("name"),
          {counts.at("received"), counts.at("lost"), counts.at("estimated"), counts.at("repeated"),
           counts.at("gaps"), counts.at("resets")},
          counts.at("clock_restarts"),
          counts.at("trouble"),
          counts.at("last_sample_utc_ms"),
          counts.at("last_loss_utc_ms")};
}

}  // namespace

void SourceWatch::Look(std::span<const SourceTotals> sources, std::int64_t utc_ms) {
  std::vector<SourceCounts> now;
  for (const SourceTotals& source : sources) {
    const auto before = std::ranges::find(sources_, source.name, &SourceCounts::name);
    SourceCounts counts = before == sources_.end() ? SourceCounts{} : *before;
    if (source.samples.received > counts.samples.received) counts.last_sample_utc_ms = utc_ms;
    if (source.samples.lost > counts.samples.lost) counts.last_loss_utc_ms = utc_ms;
    counts.name = source.name;
    counts.samples = source.samples;
    counts.clock_restarts = source.clock_restarts;
    counts.trouble = source.trouble;
    now.push_back(std::move(counts));
  }
  sources_ = std::move(now);
}

void LiveSourcesFile::Show(std::span<const SourceTotals> sources, const Moment& now) {
  if (failed_ || sources.empty()) return;
  if (file_ && now.since_boot_ms - written_.since_boot_ms < kSourcesInterval_ms) return;
  try {
    if (!file_) {
      begun_ = now;
      std::error_code none;
      std::filesystem::remove(path_, none);  // of the run before
      file_.emplace(path_);
    }
    watch_.Look(sources, now.utc_ms);
    written_ = now;
    json shown{{"version", kSourcesVersion}, {"since_utc_ms", begun_.utc_ms},
               {"utc_ms", now.utc_ms},       {"since_boot_ms", now.since_boot_ms},
               {"boot", now.boot},           {"sources", json::array()}};
    for (const SourceCounts& source : watch_.sources()) shown["sources"].push_back(CountsJson(source));
    const std::string text = shown.dump(-1, ' ', false, json::error_handler_t::replace);
    file_->Write(std::as_bytes(std::span(text)));
  } catch (const daq::DataFileError&) {
    failed_ = true;  // a campaign does not end because nobody can look on
  } catch (const std::invalid_argument&) {
    failed_ = true;  // more sources than the file has room for
  }
}

std::optional<LiveSources> ReadLiveSources(const std::filesystem::path& path) {
  try {
    const auto newest = daq::ReadCheckpoint(path);
    if (!newest) return std::nullopt;
    const json shown = json::parse(
        std::string_view(reinterpret_cast<const char*>(newest->payload.data()), newest->payload.size()));
    if (shown.at("version") != kSourcesVersion) return std::nullopt;
    LiveSources live{
        shown.at("since_utc_ms"), {shown.at("utc_ms"), shown.at("since_boot_ms"), shown.at("boot")}, {}};
    for (const json& counts : shown.at("sources")) live.sources.push_back(CountsOf(counts));
    return live;
  } catch (const daq::DataFileError&) {
    return std::nullopt;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

}  // namespace strainwave::bench
