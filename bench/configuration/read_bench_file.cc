// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/read_bench_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "bench/configuration/bench_bounds.h"
#include "bench/configuration/device_file.h"
#include "bench/configuration/read_devices.h"
#include "bench/configuration/read_teds.h"
#include "bench/roles/sampler.h"
#include "schedules/reader/yaml_map.h"

namespace strainwave::bench {
namespace {

using schedules::Bound;
using schedules::Dimension;
using schedules::FileKind;
using schedules::FindingList;
using schedules::Presence;
using schedules::ReadContext;
using schedules::YamlMap;
using schedules::YamlNode;

constexpr FileKind kBenchFile{"bench", "bench: 1"};
constexpr FileKind kPlantFile{"plant", "plant: 1"};

// YYYY-MM-DD of a day that exists; a bench without a due date leaves the key out.
bool IsDate(const std::string& text) {
  constexpr int kDays[] = {31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return false;
  int digits[3] = {};
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (i == 4 || i == 7) continue;
    if (text[i] < '0' || text[i] > '9') return false;
    int& part = digits[i < 4 ? 0 : i < 7 ? 1 : 2];
    part = 10 * part + (text[i] - '0');
  }
  const auto [year, month, day] = digits;
  if (month < 1 || month > 12 || day < 1 || day > kDays[month - 1]) return false;
  const bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
  return month != 2 || day < 29 || leap;
}

std::string ReadDate(YamlMap& map, std::string_view key, ReadContext& context) {
  std::string text = map.Text(key, "");
  if (!text.empty() && !map.is_wrong(key) && !IsDate(text)) {
    const schedules::Origin& origin = context.origins[map.PathOf(key)];
    context.findings.AddError(origin.line, origin.column,
                              fmt::format("{} = {} is not a date (expected YYYY-MM-DD)", key, origin.text));
  }
  return text;
}

// A sensor with a data sheet has its calibration from there, and is the one that the sheet speaks of.
template <typename Sensor>
void ReadCalibration(YamlMap& map, Sensor& sensor, ReadContext& context) {
  sensor.serial = map.Text("serial", "");
  sensor.calibration = map.Text("calibration", "");
  sensor.calibration_due = ReadDate(map, "calibration_due", context);
  sensor.teds = ReadTeds(map);
  for (const char* key : {"calibration", "calibration_due"}) {
    if (!map.has("teds") || !map.has(key)) continue;
    map.AddError(
        key, fmt::format("{} stands in the sensor's data sheet (expected teds, or {}, not both)", key, key));
  }
  if (!sensor.teds) return;
  if (map.has("serial") && sensor.serial != sensor.teds->sensor_serial) {
    map.AddError("serial",
                 fmt::format("serial = {} is another sensor than that of its data sheet (expected {})",
                             sensor.serial, sensor.teds->sensor_serial));
  }
  sensor.serial = sensor.teds->sensor_serial;
  sensor.calibration = sensor.teds->id;
  if (sensor.teds->due) sensor.calibration_due = daq::acquisition::TextOf(*sensor.teds->due);
}

ServoDescription ReadServo(YamlMap map, const std::filesystem::path& folder) {
  ServoDescription servo;
  servo.serial = map.Text("serial", "");
  servo.peak_torque_Nm = map.Quantity("peak_torque", Dimension::kTorque, Bound::kPositive);
  servo.peak_speed_rad_per_s = map.Quantity("peak_speed", Dimension::kAngularSpeed, Bound::kPositive);
  servo.max_acceleration_rad_per_s2 =
      map.Quantity("max_acceleration", Dimension::kAngularAcceleration, Bound::kPositive);
  servo.drive = ReadDriveLink(map.Map("drive", Presence::kOptional), folder);
  map.Finish();
  return servo;
}

TransducerDescription ReadTransducer(YamlMap map, ReadContext& context) {
  TransducerDescription transducer;
  ReadCalibration(map, transducer, context);
  transducer.range_Nm = map.Quantity("range", Dimension::kTorque, Bound::kPositive);
  transducer.relative_linearity = map.Quantity("linearity", Dimension::kShare, Bound::kNotNegative, "0.3 %");
  transducer.relative_gain_uncertainty =
      map.Quantity("gain_uncertainty", Dimension::kShare, Bound::kNotNegative, "0.05 %");
  YamlMap shunt = map.Map("shunt", Presence::kOptional);
  if (map.has("shunt")) {
    transducer.shunt.device = shunt.Identifier("device");
    transducer.shunt.source = shunt.Identifier("source");
  }
  shunt.Finish();
  map.Finish();
  return transducer;
}

EncoderDescription ReadEncoder(YamlMap map, ReadContext& context) {
  constexpr int kMostCounts = 1 << 30;
  EncoderDescription encoder;
  encoder.serial = map.Text("serial", "");
  encoder.calibration = map.Text("calibration", "");
  encoder.calibration_due = ReadDate(map, "calibration_due", context);
  encoder.counts_per_rev = map.Count("counts_per_rev", 1, kMostCounts);
  encoder.accuracy_rad = map.Quantity("accuracy", Dimension::kAngle, Bound::kPositive);
  encoder.sign = map.Choice<int>("sign", {{"1", 1}, {"-1", -1}}, "1");
  map.Finish();
  return encoder;
}

std::vector<AccelerometerDescription> ReadAccelerometers(std::vector<YamlMap> maps, ReadContext& context) {
  std::vector<AccelerometerDescription> accelerometers;
  for (YamlMap& map : maps) {
    AccelerometerDescription accelerometer;
    accelerometer.name = map.Identifier("name");
    ReadCalibration(map, accelerometer, context);
    accelerometer.sensitivity_V_per_m_per_s2 =
        map.Quantity("sensitivity", Dimension::kSensitivity, Bound::kPositive, "100 mV/g");
    accelerometer.range_m_per_s2 = map.Quantity("range", Dimension::kAcceleration, Bound::kPositive, "50 g");
    map.Finish();
    // Another would be taken for one and read by nobody.
    if (!map.is_wrong("name") &&
        std::ranges::find(kAccelerometers, accelerometer.name) == kAccelerometers.end()) {
      map.AddError("name", fmt::format("name = {} is none of the accelerometers of a bench (expected {})",
                                       accelerometer.name, fmt::join(kAccelerometers, ", ")));
    }
    const bool taken = std::any_of(accelerometers.begin(), accelerometers.end(),
                                   [&](const auto& other) { return other.name == accelerometer.name; });
    if (taken && !map.is_wrong("name")) {
      const schedules::Origin& origin = context.origins[map.PathOf("name")];
      context.findings.AddError(
          origin.line, origin.column,
          fmt::format("two accelerometers are named '{}' (expected a name of its own)", accelerometer.name));
    }
    accelerometers.push_back(std::move(accelerometer));
  }
  return accelerometers;
}

std::vector<TermDescription> ReadTerms(std::vector<YamlMap> maps, ReadContext& context) {
  std::vector<TermDescription> terms;
  std::map<std::string, int> lines;
  for (YamlMap& map : maps) {
    TermDescription term;
    term.line = map.line();
    term.name = map.Identifier("term");
    term.enabled = map.Flag("enabled", "true");
    term.parameters = map.NumberMap("parameters");
    map.Finish();
    const auto [first, is_new] = lines.emplace(term.name, term.line);
    if (!is_new && !map.is_wrong("term")) {
      const schedules::Origin& origin = context.origins[map.PathOf("term")];
      context.findings.AddError(
          origin.line, origin.column,
          fmt::format("term '{}' is there twice (expected once; it is already on line {})", term.name,
                      first->second));
    }
    terms.push_back(std::move(term));
  }
  return terms;
}

std::vector<AlarmRule> ReadAlarms(std::vector<YamlMap> maps) {
  std::vector<std::string_view> codes;
  for (const AlarmKind& kind : kAlarmKinds) codes.push_back(kind.code);
  std::vector<AlarmRule> rules;
  std::map<std::string, int> lines;
  for (YamlMap& map : maps) {
    AlarmRule rule;
    rule.code = map.Identifier("interlock");
    // What the file leaves out is the kind's own, which has no one default.
    const auto priority = map.Choice<AlarmPriority>(
        "priority",
        {{"low", AlarmPriority::kLow}, {"medium", AlarmPriority::kMedium}, {"high", AlarmPriority::kHigh}},
        "medium");
    if (map.has("priority")) rule.priority = priority;
    const bool latching = map.Flag("latching", "false");
    if (map.has("latching")) rule.latching = latching;
    rule.guidance = fmt::format("{}", fmt::join(map.TextList("guidance"), "\n"));
    map.Finish();
    if (!map.is_wrong("interlock") && std::ranges::find(codes, rule.code) == codes.end()) {
      map.AddError("interlock", fmt::format("interlock = {} is no kind of alarm (expected one of {})",
                                            rule.code, fmt::join(codes, ", ")));
    }
    const auto [first, is_new] = lines.emplace(rule.code, map.line());
    if (!is_new && !map.is_wrong("interlock")) {
      map.AddError("interlock",
                   fmt::format("interlock '{}' is there twice (expected once; it is already on line {})",
                               rule.code, first->second));
    }
    rules.push_back(std::move(rule));
  }
  return rules;
}

SimulationDescription ReadSimulation(YamlMap map, const std::filesystem::path& folder, ReadContext& context) {
  constexpr int kLargestSeed = 2'000'000'000;
  SimulationDescription simulation;
  simulation.seed = static_cast<std::uint64_t>(map.Count("seed", 0, kLargestSeed, "1"));
  simulation.time_skew_s = map.Quantity("time_skew", Dimension::kTime, Bound::kAny, "0 s");
  simulation.write_truth = map.Flag("write_truth", "false");
  simulation.terms = ReadTerms(map.MapList("plant", Presence::kOptional), context);
  simulation.plant_file = map.Text("plant_file", "");
  map.Finish();
  if (simulation.plant_file.empty()) return simulation;
  const schedules::Origin origin = context.origins[map.PathOf("plant_file")];
  if (map.has("plant")) {
    context.findings.AddError(origin.line, origin.column,
                              "plant_file stands beside plant (expected one of the two)");
  } else if (!origin.wrong) {
    try {
      simulation.terms = ReadPlantFile(folder / simulation.plant_file);
    } catch (const BenchFileError& error) {
      map.AddError("plant_file",
                   fmt::format("plant_file cannot be used (expected a plant file):\n{}", error.what()));
    }
  }
  return simulation;
}

BenchDescription ReadTop(const YamlNode& root, const std::filesystem::path& folder, ReadContext& context) {
  context.bounds = BenchBounds();
  YamlMap map(root, context);
  map.Version("bench");
  BenchDescription bench;
  bench.name = map.Text("name");
  bench.simulated = map.Flag("simulated", "false");
  bench.control_period_s = map.Quantity("control_period", Dimension::kTime, Bound::kPositive, "10 ms");
  bench.fast_control_period_s =
      map.Quantity("fast_control_period", Dimension::kTime, Bound::kPositive, "1 ms");
  bench.stale_after_s = map.OptionalQuantity("stale_after", Dimension::kTime, Bound::kPositive)
                            .value_or(3.0 * bench.control_period_s);
  if (bench.stale_after_s < bench.control_period_s && !map.is_wrong("control_period")) {
    map.AddError(
        "stale_after",
        fmt::format("stale_after = {} is below control_period = {} (expected more, or no reading would "
                    "ever be fresh)",
                    context.origins["stale_after"].text, context.origins["control_period"].text));
  }
  bench.longest_stop_s = map.Quantity("longest_stop_time", Dimension::kTime, Bound::kPositive, "2 s");
  bench.vibration_rate_hz =
      map.Quantity("vibration_rate", Dimension::kFrequency, Bound::kPositive, "51.2 kHz");
  bench.driving_servo = ReadServo(map.Map("driving_servo", Presence::kRequired), folder);
  bench.load_servo = ReadServo(map.Map("load_servo", Presence::kRequired), folder);
  bench.load_reducer_ratio = map.Number("load_reducer_ratio", Bound::kPositive, "70");
  bench.transducer = ReadTransducer(map.Map("torque_transducer", Presence::kRequired), context);
  bench.input_encoder = ReadEncoder(map.Map("input_encoder", Presence::kRequired), context);
  bench.output_encoder = ReadEncoder(map.Map("output_encoder", Presence::kRequired), context);
  bench.blank_reference_accuracy_rad =
      map.Quantity("blank_reference_accuracy", Dimension::kAngle, Bound::kPositive, "0.5 arcsec");
  bench.accelerometers = ReadAccelerometers(map.MapList("accelerometers", Presence::kOptional), context);
  const bool has_devices = map.has("devices");
  bench.devices = ReadDevices(map.MapList("devices", Presence::kOptional), folder, context);
  bench.channels = ReadChannelLinks(map.MapList("channels", Presence::kOptional), context);
  bench.alarms = ReadAlarms(map.MapList("alarms", Presence::kOptional));
  const bool has_simulation = map.has("simulation");
  bench.simulation = ReadSimulation(map.Map("simulation", Presence::kOptional), folder, context);
  map.Finish();
  if (map.is_wrong("simulated")) return bench;
  if (has_devices && bench.simulated) {
    const schedules::Origin& origin = context.origins["simulated"];
    context.findings.AddError(
        origin.line, origin.column,
        "a simulated bench has no devices (expected 'simulated: false', or no devices)");
  }
  if (has_simulation && !has_devices && !bench.simulated) {
    const schedules::Origin& origin = context.origins["simulation"];
    context.findings.AddError(origin.line, origin.column,
                              "simulation belongs to a simulated bench (expected 'simulated: true')");
  }
  if (has_devices && !bench.simulated) CheckDevices(bench, context.origins["devices"].line, context);
  return bench;
}

}  // namespace

BenchDescription ReadBenchFile(const std::filesystem::path& path) {
  return ParseBenchFile(TextOfFile<BenchFileError>(path, kBenchFile), path.string(), path.parent_path());
}

BenchDescription ParseBenchFile(const std::string& text, std::string_view file_name,
                                const std::filesystem::path& folder) {
  return ParseFile<BenchFileError>(text, file_name, kBenchFile,
                                   [&](const YamlNode& root, ReadContext& context) {
                                     BenchDescription bench = ReadTop(root, folder, context);
                                     bench.file_name = file_name;
                                     bench.origins = std::move(context.origins);
                                     return bench;
                                   });
}

std::vector<TermDescription> ReadPlantFile(const std::filesystem::path& path) {
  const std::string text = TextOfFile<BenchFileError>(path, kPlantFile);
  return ParseFile<BenchFileError>(
      text, path.string(), kPlantFile, [](const YamlNode& root, ReadContext& context) {
        YamlMap map(root, context);
        map.Version("plant");
        // `diagnose` writes there where the terms come from, and may have none to write.
        const bool diagnosed = map.has("diagnosis");
        map.Map("diagnosis", Presence::kOptional);
        std::vector<TermDescription> terms =
            ReadTerms(map.MapList("terms", diagnosed ? Presence::kOptional : Presence::kRequired), context);
        map.Finish();
        return terms;
      });
}

}  // namespace strainwave::bench
