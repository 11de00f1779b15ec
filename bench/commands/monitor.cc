// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <set>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "analysis/units.h"
#include "bench/campaign/folder.h"
#include "bench/commands/commands.h"
#include "bench/commands/map_option.h"
#include "bench/commands/no_core.h"
#include "bench/commands/output.h"
#include "bench/commands/pace.h"
#include "bench/commands/signals.h"
#include "bench/configuration/embedded_bench.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/errors/bench_error.h"
#include "bench/machines/simulated_vibration_source.h"
#include "bench/monitor/acquisition_source.h"
#include "bench/monitor/modbus_server.h"
#include "bench/monitor/monitor_loop.h"
#include "bench/monitor/mqtt_publisher.h"
#include "bench/monitor/open_exported.h"
#include "bench/monitor/prometheus_server.h"
#include "bench/monitor/replay_records.h"
#include "bench/monitor/replay_source.h"
#include "bench/monitor/settings.h"
#include "bench/monitor/sparkplug_metrics.h"
#include "bench/monitor/stream_address.h"
#include "bench/utc.h"

namespace strainwave::bench {
namespace {

struct MonitorCommand {
  std::string predictor;
  std::string baseline;
  std::string source;
  std::vector<std::string> replay;
  int rounds{1};
  double every_s{};
  bool simulate{};
  std::string bench;
  std::optional<double> input_speed_rpm;
  std::optional<double> output_torque_Nm;
  std::optional<double> temperature_degC;
  double duration_s{60.0};
  std::string settings;
  std::string pace{"real"};
  double linger_s{2.0};
  std::string map;
  bool json{};
};

std::atomic<bool> g_stop{false};

constexpr double kSimulatedSpeed_rpm = 2400.0;
constexpr double kSimulatedTorque_Nm = 40.0;

// A device that can never give what the predictor takes is told before anything is published.
void RequireFit(const AcquisitionSource& source, const SignalSettings& wanted) {
  if (DecimationFactor(source.sample_rate_hz(), wanted) == 0) {
    throw BenchError(ExitCode::kWrongInput, fmt::format("{}: error: {}", source.name(),
                                                        RateFault(source.sample_rate_hz(), wanted).text));
  }
  for (const std::string& channel : wanted.channels) {
    if (std::ranges::find(source.channels(), channel) != source.channels().end()) continue;
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format(
            "{}: error: there is no channel {} among {} (expected it; `source: channels:` of the settings "
            "renames others)",
            source.name(), channel, fmt::join(source.channels(), ", ")));
  }
}

std::unique_ptr<VibrationSource> MakeAcquisitionSource(const MonitorCommand& command,
                                                       const MonitorSettings& settings,
                                                       const SignalSettings& wanted, std::int64_t start_ns) {
  StreamSettings given = settings.source.value_or(StreamSettings{});
  if (!command.source.empty()) given.address = ParseStreamAddress(command.source);
  const double pace = ParsePace(command.pace);
  AcquisitionStream stream{.ratio = settings.ratio,
                           .input_speed_rad_per_s = given.input_speed_rad_per_s,
                           .renamed = given.renamed,
                           .silent_after = std::chrono::milliseconds(given.silent_after_ms),
                           .pace = {},
                           .start_ns = start_ns};
  if (command.input_speed_rpm) stream.input_speed_rad_per_s = RadPerSFromRpm(*command.input_speed_rpm);
  if (std::holds_alternative<daq::acquisition::ReplaySettings>(given.address)) stream.pace = pace;
  auto source = std::make_unique<AcquisitionSource>(MakeSampleSource(std::move(given.address), pace),
                                                    std::move(stream));
  RequireFit(*source, wanted);
  return source;
}

std::unique_ptr<VibrationSource> MakeSource(const MonitorCommand& command, const MonitorSettings& settings,
                                            const SignalNeeds& needs) {
  const double pace = ParsePace(command.pace);
  const std::int64_t start_ns = UtcMilliseconds() * 1'000'000;
  const auto asked = command.simulate + !command.replay.empty() + !command.source.empty();
  if (asked > 1 || (asked == 0 && !settings.source)) {
    throw BenchError(ExitCode::kWrongInput,
                     "error: there must be one stream (expected --source with an address, --replay with "
                     "records, --simulate, or a section `source` in the settings)");
  }
  if (!command.source.empty() || asked == 0)
    return MakeAcquisitionSource(command, settings, needs.signals, start_ns);
  if (!command.simulate) {
    return std::make_unique<ReplaySource>(
        ReplaySettings{.files = RecordFilesOf({command.replay.begin(), command.replay.end()}),
                       .read = ReplayedRecords(needs, RecordReader(command.map)),
                       .rounds = command.rounds,
                       .every_s = command.every_s,
                       .pace = pace,
                       .ratio = settings.ratio,
                       .start_ns = start_ns});
  }
  return std::make_unique<SimulatedVibrationSource>(
      command.bench.empty() ? EmbeddedBench() : ReadBenchFile(command.bench),
      SimulatedStream{
          .input_speed_rad_per_s = RadPerSFromRpm(command.input_speed_rpm.value_or(kSimulatedSpeed_rpm)),
          .output_torque_Nm = command.output_torque_Nm.value_or(kSimulatedTorque_Nm),
          .ratio = settings.ratio,
          .sample_rate_hz = needs.signals.sample_rate_hz,
          .duration_s = command.duration_s,
          .pace = pace,
          .start_ns = start_ns});
}

// What the options say of the gear, and the settings where they do not; a simulated gear tells it itself.
OperatingPoint GivenPoint(const MonitorCommand& command, const MonitorSettings& settings) {
  OperatingPoint given;
  if (!command.simulate) {
    given[OperatingQuantity::kOutputTorque] = command.output_torque_Nm;
    given[OperatingQuantity::kInputSpeed] = command.input_speed_rpm;
  }
  given[OperatingQuantity::kTemperature] = command.temperature_degC;
  for (const OperatingQuantity quantity : kOperatingQuantities) {
    if (given[quantity]) given[quantity] = std::abs(*given[quantity]);
  }
  return settings.source ? Completed(given, settings.source->operating) : given;
}

nlohmann::ordered_json JsonOf(const MonitorResult& result, const MonitorFrame& frame) {
  nlohmann::ordered_json json{{"window", result.number},
                              {"begin_utc", UtcText(result.begin_ms)},
                              {"end_utc", UtcText(result.end_ms)},
                              {"origin", result.origin}};
  if (result.fault) {
    json["status"] = NameOf(ValueStatus::kBad);
    json["fault"] = NameOf(result.fault->kind);
    json["error"] = result.fault->text;
  } else {
    json["status"] = NameOf(result.outside_training ? ValueStatus::kOutsideTraining : ValueStatus::kGood);
    json["distance"] = result.distance;
    json["outside_training"] = result.outside_training;
    if (!result.left.empty()) json["outside"] = result.left;
    if (!result.not_known.empty()) json["warnings"] = result.not_known;
    if (!frame.classes) json["coverage"] = frame.coverage;
  }
  json["alarm"] = NameOf(result.alarm);
  if (frame.classes && !result.outputs.empty()) {
    json["class"] = frame.outputs[LikeliestOf(result.outputs)];
    for (std::size_t i = 0; i < result.outputs.size(); ++i)
      json["probabilities"][frame.outputs[i]] = result.outputs[i].value;
    return json;
  }
  for (std::size_t i = 0; i < result.outputs.size(); ++i) {
    const MonitoredOutput& output = result.outputs[i];
    json["values"][frame.outputs[i]] = {{"value", output.value},
                                        {"low", output.low},
                                        {"high", output.high},
                                        {"alarm", NameOf(result.alarms[i])}};
  }
  return json;
}

std::string LineOf(const MonitorResult& result, const MonitorFrame& frame) {
  std::string line =
      fmt::format("{}  window {}  {}", UtcText(result.end_ms), result.number, NameOf(result.alarm));
  if (result.outside_training) {
    line += fmt::format("  outside what the predictor was trained on ({}): not valid:",
                        OutsideText(result.distance, result.left));
  }
  if (frame.classes && !result.outputs.empty()) {
    const std::size_t likeliest = LikeliestOf(result.outputs);
    return line +
           fmt::format("  class {} ({:.3f})", frame.outputs[likeliest], result.outputs[likeliest].value);
  }
  for (std::size_t i = 0; i < result.outputs.size(); ++i) {
    const MonitoredOutput& output = result.outputs[i];
    line += fmt::format("  {} {:.5g}", frame.outputs[i], output.value);
    if (!result.outside_training) line += fmt::format(" ± {:.2g}", 0.5 * (output.high - output.low));
  }
  return line;
}

// "FILE: error: WHAT", unless the text says so itself.
std::string ErrorOf(const MonitorResult& result) {
  const std::string& text = result.fault->text;
  return text.starts_with(result.origin + ":") ? text : fmt::format("{}: error: {}", result.origin, text);
}

void Print(const MonitorResult& result, const MonitorFrame& frame, bool json) {
  if (result.fault) ToStderr("{}\n", ErrorOf(result));
  for (const std::string& text : result.not_known) ToStderr("warning: {}\n", text);
  if (json) {
    ToStdout("{}\n", JsonOf(result, frame).dump());
  } else if (!result.fault) {
    ToStdout("{}\n", LineOf(result, frame));
  }
}

void Say(const std::string& line) { ToStderr("{}\n", line); }

// As the last line, with the cause.
void TellLost(const MqttPublisher::NotDelivered& left, const std::filesystem::path& outbox_file) {
  if (left.dropped != 0) {
    Say(
        fmt::format("mqtt: error: {} windows found no room while they waited for a broker and are lost "
                    "(keep_windows and keep_mebibytes of the settings give more)",
                    left.dropped));
  }
  if (left.waiting == 0) return;
  Say(outbox_file.empty()
          ? fmt::format("mqtt: error: {} windows were not delivered and are lost: {}", left.waiting,
                        left.cause)
          : fmt::format("mqtt: {} windows were not delivered and wait in {} for the next start: {}",
                        left.waiting, outbox_file.string(), left.cause));
}

// Windows as in training, unless the settings have others.
WindowRule RuleFor(const MonitorCommand& command, const MonitorSettings& settings, const SignalNeeds& needs) {
  WindowRule rule = settings.windows;
  // A replayed cycle of a motor is a measurement of its own, and no two have quite as many samples.
  const bool by_cycles = needs.records == daq::RecordKind::kMotor && !command.replay.empty();
  rule.length = by_cycles ? WindowLength{} : needs.window;
  rule.sample_rate_hz = needs.signals.decimates ? needs.signals.sample_rate_hz : 0.0;
  rule.trigger_samples = needs.least_samples;
  rule.ratio = settings.ratio;
  const bool whole_records = rule.by != WindowRule::By::kRevolution && rule.trigger_channel.empty() &&
                             (rule.by == WindowRule::By::kTrigger || rule.length == WindowLength{});
  if (!whole_records || !command.replay.empty()) return rule;
  // A stream that runs on without a mark: a turn of the simulated bench, and of a device as many samples as
  // the shortest record of the training had.
  rule.by = command.simulate ? WindowRule::By::kRevolution : WindowRule::By::kTraining;
  rule.length = {.samples = needs.least_samples, .turns = 0};
  return rule;
}

int Run(const MonitorCommand& command) {
  LeaveNoCore();
  ListenToSignals([](int, pid_t) { g_stop = true; });
  // A device waits for nobody; a replay and a simulation do.
  const bool waits = command.simulate || !command.replay.empty();
  const LiveOutput output([] { return g_stop.load(); },
                          waits ? LiveOutput::Results::kWaitedFor : LiveOutput::Results::kDropped);
  const MonitorSettings settings =
      command.settings.empty() ? MonitorSettings{} : ReadMonitorSettings(command.settings);
  const std::unique_ptr<ExportedModel> model = OpenExported(command.predictor, command.baseline);
  const SignalNeeds needs = model->needs();
  std::unique_ptr<OutboxStore> store;
  if (settings.mqtt && !settings.mqtt->outbox_file.empty())
    store = std::make_unique<OutboxStore>(settings.mqtt->outbox_file);
  WindowJudge judge(*model, settings.limits, store ? store->last_window() : 0, GivenPoint(command, settings));
  const std::unique_ptr<VibrationSource> source = MakeSource(command, settings, needs);
  WindowCutter cutter(RuleFor(command, settings, needs));
  Board board({model->outputs(), model->coverage(), settings.stale_after_ms, model->classes()},
              [&source] { return source->NowNanoseconds() / 1'000'000; });
  Say(fmt::format("self-test of {}: files unchanged, network off its golden vectors by {:.1e}",
                  command.predictor, model->worst_disagreement()));
  std::optional<PrometheusServer> prometheus;
  std::optional<ModbusServer> modbus;
  std::optional<MqttPublisher> mqtt;
  if (settings.prometheus) {
    prometheus.emplace(*settings.prometheus, board);
    Say(fmt::format("prometheus: http://{}:{}/metrics", settings.prometheus->address, prometheus->port()));
  }
  if (settings.modbus) {
    modbus.emplace(*settings.modbus, board);
    Say(fmt::format("modbus: input registers on {} port {}", settings.modbus->address, modbus->port()));
  }
  if (settings.mqtt) mqtt.emplace(*settings.mqtt, board, Say, std::move(store));
  const auto publish = [&](std::int64_t at_ms) {
    if (mqtt) mqtt->Publish(SparkplugMetrics(board.State(), board.frame(), at_ms));
  };
  std::set<std::string> told;  // what is not known of the gear, once
  RunMonitor(*source, cutter, judge, board,
             {.on_result =
                  [&](const MonitorResult& result) {
                    // As it was at its own time: a result that comes late is still a result. First, so that
                    // whatever was shown is kept.
                    publish(result.end_ms);
                    MonitorResult shown = result;
                    std::erase_if(shown.not_known,
                                  [&](const auto& text) { return !told.insert(text).second; });
                    Print(shown, board.frame(), command.json);
                  },
              .on_stale =
                  [&] {
                    Say("stale: no new window for longer than stale_after");
                    publish(board.NowMilliseconds());
                  }},
             g_stop);
  const std::chrono::duration<double> linger(command.linger_s);
  const auto left = mqtt ? mqtt->Finish(std::chrono::duration_cast<std::chrono::milliseconds>(linger))
                         : MqttPublisher::NotDelivered{};
  const MonitorState state = board.State();
  Say(fmt::format("windows: {} good, {} bad, {} outside the training", state.good_windows, state.bad_windows,
                  state.outside_windows));
  if (mqtt) TellLost(left, settings.mqtt->outbox_file);
  if (g_stop) return static_cast<int>(ExitCode::kInterrupted);
  // A record that cannot be used is wrong input here as with `predict`; a device that was away for a while
  // was told as it happened.
  const bool of_records = !command.replay.empty();
  return static_cast<int>(of_records && state.bad_windows > 0 ? ExitCode::kWrongInput : ExitCode::kDone);
}

}  // namespace

void AddMonitor(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "monitor",
      "Run an exported predictor on a stream of vibration, motor signals or joints: windows, values with "
      "intervals, alarms; publish "
      "them to MQTT (Sparkplug B), Prometheus and Modbus TCP as the settings file says "
      "(bench/monitor/monitor.yaml has every key). Tests the predictor's folder before it starts.\n"
      "Ctrl-C ends it with a death certificate, exit code 130. What the broker does not take is kept, at "
      "most keep_windows (10000) windows and keep_mebibytes (64) MiB, on disk with outbox_file and in "
      "memory without; beyond, the oldest go and are counted. Without outbox_file, what is undelivered at "
      "the end is lost and told.\n"
      "A device that is lost is tried again for as long as the monitor runs; a window with lost samples, "
      "and a device that is silent, are published as bad, never as a value.\n"
      "Example: strainwave monitor exported --replay campaigns/first --settings bench/monitor/monitor.yaml\n"
      "Example: strainwave monitor exported --source tcp://10.0.0.7:5025 --input-speed 2400");
  auto options = std::make_shared<MonitorCommand>();
  command->add_option("PREDICTOR", options->predictor, "folder that export has written")->required();
  command->add_option(
      "--baseline", options->baseline,
      "what the reducer was like at first, as `baseline` writes it, for a predictor of changes");
  command->add_option("--source", options->source,
                      fmt::format("a device that sends samples: {}", kStreamAddresses));
  command->add_option(
      "--replay", options->replay,
      "records of the kind that the model was trained on, as a stream: CSV, HDF5, campaign folders");
  command->add_option("--rounds", options->rounds, "of a replay: times through all records")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command->add_option("--every", options->every_s, "of a replay: seconds from record to record; 0: at once")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  command->add_flag("--simulate", options->simulate, "the simulated bench as a stream, turning evenly");
  command->add_option("--bench", options->bench, "of --simulate: bench file; without it, the embedded one");
  command->add_option("--input-speed", options->input_speed_rpm,
                      "rpm of the input shaft, of --simulate (2400) or where the stream does not tell it");
  command->add_option("--output-torque", options->output_torque_Nm,
                      "Nm at the output, of --simulate (40) or where the stream does not tell it");
  command->add_option("--temperature", options->temperature_degC,
                      "degC of the gear, where the stream does not tell it");
  command->add_option("--duration", options->duration_s, "of --simulate: seconds")
      ->check(CLI::Range(0.0, 1e9))
      ->capture_default_str();
  command->add_option("--settings", options->settings, "windows, thresholds and where to publish (YAML)");
  command->add_option("--pace", options->pace, "of the stream: real, max, or N times real time")
      ->capture_default_str();
  command->add_option("--linger", options->linger_s, "seconds at the end for what still waits for the broker")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  AddMapOption(*command, options->map);
  command->add_flag("--json", options->json, "one object a window, each on a line of its own");
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

}  // namespace strainwave::bench
