// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/commissioning_file.h"

#include <algorithm>

#include <fmt/format.h>

#include "bench/configuration/device_file.h"
#include "bench/configuration/read_bench_file.h"
#include "schedules/reader/yaml_map.h"

namespace strainwave::bench {

using schedules::Bound;
using schedules::Dimension;
using schedules::Presence;
using schedules::ReadContext;
using schedules::YamlMap;

namespace {

constexpr schedules::FileKind kCommissioningFile{"commissioning record", "commissioned: 1"};

std::vector<MeasuredStop> ReadCommissioned(const schedules::YamlNode& root, ReadContext& context) {
  YamlMap map(root, context);
  map.Version("commissioned");
  std::vector<MeasuredStop> stops;
  for (YamlMap& drive : map.MapList("drives", Presence::kRequired)) {
    MeasuredStop stop;
    stop.servo = drive.Identifier("servo");
    stop.identity = drive.Text("identity", "");
    stop.left_enabled_s = drive.Quantity("left_enabled", Dimension::kTime, Bound::kNotNegative);
    stop.stood_s = drive.Quantity("stood", Dimension::kTime, Bound::kNotNegative);
    stop.measured = drive.Text("measured");
    drive.Finish();
    stops.push_back(std::move(stop));
  }
  map.Finish();
  return stops;
}

}  // namespace

std::filesystem::path CommissioningFileOf(const std::filesystem::path& bench_file) {
  std::filesystem::path file = bench_file;
  const auto folder = std::filesystem::absolute(bench_file).lexically_normal().parent_path();
  if (folder.filename() == "examples" && folder.parent_path().filename() == "bench") {
    file = folder.parent_path().parent_path() / "campaigns" / bench_file.filename();
  }
  return file.replace_extension(".commissioned.yaml");
}

std::string CommissioningText(const std::vector<MeasuredStop>& stops) {
  std::string text =
      "# Written by strainwave bench commission: how long each drive took to stop after the last word of "
      "this "
      "program.\n"
      "commissioned: 1\n"
      "drives:\n";
  for (const MeasuredStop& stop : stops) {
    const std::string identity =
        stop.identity.empty() ? "" : fmt::format("identity: \"{}\", ", stop.identity);
    text += fmt::format("  - {{servo: {}, {}left_enabled: {:.0f} ms, stood: {:.0f} ms, measured: \"{}\"}}\n",
                        stop.servo, identity, 1e3 * stop.left_enabled_s, 1e3 * stop.stood_s, stop.measured);
  }
  return text;
}

std::vector<MeasuredStop> ParseCommissioningFile(const std::string& text, std::string_view file_name) {
  return ParseFile<BenchFileError>(text, file_name, kCommissioningFile, ReadCommissioned);
}

std::vector<MeasuredStop> ReadCommissioningFile(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return {};
  return ParseCommissioningFile(TextOfFile<BenchFileError>(path, kCommissioningFile), path.string());
}

StopTimeFinding JudgeStopTime(const std::string& servo, const MeasuredStop* stop, const std::string& identity,
                              double longest_s) {
  constexpr const char* kDo = "measure it with strainwave bench commission";
  if (stop == nullptr) {
    return {false,
            fmt::format("{}: how long it takes to stop when this program is gone was never measured ({})",
                        servo, kDo)};
  }
  if (!identity.empty() && !stop->identity.empty() && identity != stop->identity) {
    return {true, fmt::format("{}: the time to stop was measured on another drive: {} (this one is {}; {})",
                              servo, stop->identity, identity, kDo)};
  }
  const double took_s = std::max(stop->left_enabled_s, stop->stood_s);
  if (took_s > longest_s) {
    return {true, fmt::format("{}: it took {:.0f} ms to stop when this program was gone, longer than "
                              "longest_stop_time, {:.0f} ms (check its supervision and its ramps, then {})",
                              servo, 1e3 * took_s, 1e3 * longest_s, kDo)};
  }
  return {};
}

}  // namespace strainwave::bench
