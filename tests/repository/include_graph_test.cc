// SPDX-License-Identifier: Apache-2.0
// Dependencies point one way: bench is where the modules meet, and the four below it know only
// analysis/units.h of each other.
#include <algorithm>
#include <filesystem>
#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tests/checkout.h"
#include "tests/repository/source_tree.h"

namespace strainwave::repository::include_graph_test {
namespace {

constexpr std::string_view kFour[] = {"analysis", "daq", "protocols", "schedules"};

bool IsOneOfFour(std::string_view folder) {
  return std::count(std::begin(kFour), std::end(kFour), folder) != 0;
}

bool IsDeviceCode(std::string_view path) {
  return path.starts_with("bench/devices/") || path.starts_with("bench/roles/");
}

// The rooms of bench from the lowest layer to the highest; each knows those before it, and none of its own
// layer but itself.
const std::vector<std::vector<std::string_view>> kLayers{{"", "errors", "plots"},
                                                         {"realtime"},
                                                         {"alarms"},
                                                         {"roles"},
                                                         {"devices", "safety"},
                                                         {"configuration", "controller", "serving"},
                                                         {"machines", "accounts"},
                                                         {"campaign"},
                                                         {"trip_test", "integrity", "life"},
                                                         {"records"},
                                                         {"diagnosis", "data_sets", "studies"},
                                                         {"prediction"},
                                                         {"health", "faults", "fingerprint", "fleet"},
                                                         {"monitor", "page"},
                                                         {"notices", "report", "central"},
                                                         {"predictor_api"},
                                                         {"commands"}};

// "devices" of "bench/devices/can/wire_bits.h"; empty for a file of bench itself.
std::string_view RoomOf(std::string_view path) {
  constexpr std::string_view kBench = "bench/";
  path.remove_prefix(kBench.size());
  const std::size_t end = path.find('/');
  return end == path.npos ? std::string_view() : path.substr(0, end);
}

// Of a room; none where the picture has no such room.
std::optional<std::size_t> LayerOf(std::string_view room) {
  for (std::size_t layer = 0; layer < kLayers.size(); ++layer) {
    if (std::count(kLayers[layer].begin(), kLayers[layer].end(), room) != 0) return layer;
  }
  return std::nullopt;
}

std::optional<std::string> BrokenLayer(std::string_view path, std::string_view target) {
  const std::string_view from = RoomOf(path);
  const std::string_view to = RoomOf(target);
  if (from == to) return std::nullopt;
  const std::optional<std::size_t> own = LayerOf(from);
  const std::optional<std::size_t> known = LayerOf(to);
  if (own && known && *known < *own) return std::nullopt;
  return "bench/" + std::string(from) + " does not include bench/" + std::string(to) +
         ", which lies above or beside it";
}

// The rule that `path` breaks by including "target", or nothing.
std::optional<std::string> BrokenRule(std::string_view path, std::string_view target) {
  const std::string from = FolderOf(path);
  const std::string to = FolderOf(target);
  if (path == "analysis/units.h") {
    return "analysis/units.h includes standard headers only";
  }
  if (to != from && std::count(std::begin(kTopFolders), std::end(kTopFolders), to) == 0) {
    return "includes start at the root of the checkout";
  }
  if (from == "bench" && to == "bench") {
    return BrokenLayer(path, target);
  }
  if (to == from || target == "analysis/units.h") {
    return std::nullopt;
  }
  if (IsOneOfFour(from)) {
    return from + " includes only itself and analysis/units.h";
  }
  if (from == "bench" && to == "tests") {
    return "bench does not include tests";
  }
  if (IsDeviceCode(path) && to == "schedules") {
    return "no device code knows what a schedule is";
  }
  return std::nullopt;
}

std::optional<std::string> QuotedInclude(const std::string& line) {
  static const std::regex kInclude(R"re(^\s*#\s*include\s*"([^"]+)")re");
  std::smatch match;
  return std::regex_search(line, match, kInclude) ? std::optional<std::string>(match[1]) : std::nullopt;
}

// What is in the checkout for an included header: of one that protoc writes, the .proto.
std::string SourceOf(const std::string& target) {
  constexpr std::string_view kGenerated = ".pb.h";
  return target.ends_with(kGenerated) ? target.substr(0, target.size() - kGenerated.size()) + ".proto"
                                      : target;
}

TEST(IncludeGraph, HoldsInEveryFile) {
  int includes = 0;
  for (const std::string& path : ListSources()) {
    if (!IsCpp(path)) {
      continue;
    }
    const SourceFile file = ReadSource(path);
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      const std::optional<std::string> target = QuotedInclude(file.lines[i]);
      if (!target) {
        continue;
      }
      ++includes;
      const std::optional<std::string> rule = BrokenRule(path, *target);
      EXPECT_FALSE(rule) << path << ":" << i + 1 << ": includes \"" << *target << "\" (expected: " << *rule
                         << ")";
      EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(SourceFolder()) / SourceOf(*target)))
          << path << ":" << i + 1 << ": there is no " << *target;
    }
  }
  EXPECT_GT(includes, 50) << "hardly an include was read: the test looks in the wrong place";
}

TEST(IncludeGraph, AllowsWhatThePictureShows) {
  EXPECT_EQ(BrokenRule("daq/record.h", "analysis/units.h"), std::nullopt);
  EXPECT_EQ(BrokenRule("analysis/transmission_error.cc", "analysis/model/spring.h"), std::nullopt);
  EXPECT_EQ(BrokenRule("bench/controller/cycle.cc", "schedules/reader/schedule.h"), std::nullopt);
  EXPECT_EQ(BrokenRule("bench/devices/simulated/plant.cc", "analysis/model/spring.h"), std::nullopt);
  EXPECT_EQ(BrokenRule("bench/controller/motion.h", "bench/roles/sampler.h"), std::nullopt);
  EXPECT_EQ(BrokenRule("bench/controller/motion.h", "bench/text.h"), std::nullopt);
  EXPECT_EQ(BrokenRule("bench/configuration/read_bench_file.cc", "bench/alarms/alarm_rules.h"), std::nullopt);
  EXPECT_EQ(BrokenRule("bench/devices/can/wire_bits.cc", "bench/devices/wake.h"), std::nullopt);
  EXPECT_EQ(BrokenRule("tests/daq/record_test.cc", "daq/record.h"), std::nullopt);
}

TEST(IncludeGraph, NamesTheRuleThatAnEdgeBreaks) {
  EXPECT_EQ(BrokenRule("daq/record.h", "analysis/transmission_error.h"),
            "daq includes only itself and analysis/units.h");
  EXPECT_EQ(BrokenRule("analysis/model/spring.h", "daq/record.h"),
            "analysis includes only itself and analysis/units.h");
  EXPECT_EQ(BrokenRule("schedules/reader/schedule.h", "bench/roles/sampler.h"),
            "schedules includes only itself and analysis/units.h");
  EXPECT_EQ(BrokenRule("protocols/cia402.cc", "tests/pch.h"),
            "protocols includes only itself and analysis/units.h");
  EXPECT_EQ(BrokenRule("bench/devices/simulated/plant.cc", "schedules/reader/schedule.h"),
            "no device code knows what a schedule is");
  EXPECT_EQ(BrokenRule("bench/plots/script.cc", "tests/pch.h"), "bench does not include tests");
  EXPECT_EQ(BrokenRule("bench/roles/sampler.h", "bench/controller/motion.h"),
            "bench/roles does not include bench/controller, which lies above or beside it");
  EXPECT_EQ(BrokenRule("bench/configuration/read_teds.h", "bench/controller/motion.h"),
            "bench/configuration does not include bench/controller, which lies above or beside it");
  EXPECT_EQ(BrokenRule("bench/campaign/journal.cc", "bench/page/page_state.h"),
            "bench/campaign does not include bench/page, which lies above or beside it");
  EXPECT_EQ(BrokenRule("bench/alarms/alarm_list.h", "bench/roles/sampler.h"),
            "bench/alarms does not include bench/roles, which lies above or beside it");
  EXPECT_EQ(BrokenRule("bench/text.h", "bench/attic/any.h"),
            "bench/ does not include bench/attic, which lies above or beside it");
  EXPECT_EQ(BrokenRule("analysis/units.h", "analysis/angles.h"),
            "analysis/units.h includes standard headers only");
  EXPECT_EQ(BrokenRule("bench/plots/script.cc", "script.h"), "includes start at the root of the checkout");
  EXPECT_EQ(BrokenRule("bench/plots/script.cc", "../plots/script.h"),
            "includes start at the root of the checkout");
}

TEST(SourceOf, AGeneratedHeaderIsItsProto) {
  EXPECT_EQ(SourceOf("protocols/payload.pb.h"), "protocols/payload.proto");
  EXPECT_EQ(SourceOf("daq/record.h"), "daq/record.h");
}

TEST(QuotedInclude, SeesOnlyIncludeLines) {
  EXPECT_EQ(QuotedInclude("#include \"daq/record.h\""), "daq/record.h");
  EXPECT_EQ(QuotedInclude("  #  include \"daq/record.h\"  // why"), "daq/record.h");
  EXPECT_EQ(QuotedInclude("#include <vector>"), std::nullopt);
  EXPECT_EQ(QuotedInclude("// as #include \"daq/record.h\" does"), std::nullopt);
}

}  // namespace
}  // namespace strainwave::repository::include_graph_test
