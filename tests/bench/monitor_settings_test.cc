// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/settings.h"

#include <sys/stat.h>

#include <cstdlib>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/bench/exported_helpers.h"
#include "tests/checkout.h"

namespace strainwave::bench::monitor_settings_test {
namespace {

std::string ErrorsOf(const std::string& text) {
  try {
    ParseMonitorSettings(text, "m.yaml");
  } catch (const MonitorSettingsError& error) {
    return error.what();
  }
  return "none";
}

TEST(MonitorSettings, TheExampleNamesEveryKey) {
  const MonitorSettings settings =
      ReadMonitorSettings(std::filesystem::path(SourceFolder()) / "bench/monitor/monitor.yaml");
  EXPECT_EQ(settings.stale_after_ms, 300'000);
  ASSERT_EQ(settings.limits.size(), 2U);
  EXPECT_EQ(settings.limits[0].first, "k2_Nm_per_rad");
  EXPECT_EQ(settings.limits[0].second.alarm_below, 21'000.0);
  EXPECT_EQ(settings.limits[0].second.hold_ms, 30'000);
  EXPECT_EQ(settings.limits[1].second.hysteresis, 0.05);
  EXPECT_EQ(settings.mqtt->node, "bench-1");
  EXPECT_EQ(settings.mqtt->keep.windows, 10'000U);
  EXPECT_EQ(settings.mqtt->keep.bytes, std::size_t{64} << 20);
  EXPECT_EQ(settings.prometheus->port, 9464);
  EXPECT_EQ(settings.modbus->port, 1502);
}

TEST(MonitorSettings, PublishNowhereUnlessASectionSaysSo) {
  const MonitorSettings settings = ParseMonitorSettings("monitor: 1\n", "m.yaml");
  EXPECT_FALSE(settings.mqtt);
  EXPECT_FALSE(settings.prometheus);
  EXPECT_FALSE(settings.modbus);
  EXPECT_EQ(settings.windows.by, WindowRule::By::kTraining);
  EXPECT_EQ(ParseMonitorSettings("monitor: 1\nwindows: {trigger_channel: t, trigger_level: 1}\n", "m.yaml")
                .windows.by,
            WindowRule::By::kTrigger);
}

TEST(MonitorSettings, TellAllMistakesWithTheirPlace) {
  EXPECT_EQ(
      ErrorsOf("monitor: 1\n"
               "stale_after: 5\n"
               "windows:\n"
               "  by: time\n"
               "mqtt:\n"
               "  port: 99999\n"
               "  nod: b\n"),
      "m.yaml:2:14: error: stale_after = 5: no unit (expected us, ms, s, min, h or d)\n"
      "m.yaml:4:7: error: by = time: not known (expected training, trigger or revolution)\n"
      "m.yaml:6:9: error: port = 99999: out of range (expected a whole number from 1 to 65535)\n"
      "m.yaml:7:3: error: unknown key 'nod', did you mean 'node'? (expected host, port, group, node, "
      "primary_host, user, password, password_file, password_variable, tls, keep_windows, keep_mebibytes, "
      "outbox_file)");
}

TEST(MonitorSettings, ADeviceIsAnAddressAndWhatItDoesNotSay) {
  const MonitorSettings settings = ParseMonitorSettings(
      "monitor: 1\nsource:\n  address: tcp://[::1]:5025\n  silent_after: 2 s\n  input_speed: 60 rpm\n"
      "  channels:\n    - {source: accel_x, name: accel_motor_z_m_per_s2}\n",
      "m.yaml");
  const auto& tcp = std::get<daq::acquisition::TcpStreamSettings>(settings.source->address);
  EXPECT_EQ(tcp.host, "::1");
  EXPECT_EQ(tcp.port, 5025);
  EXPECT_EQ(settings.source->silent_after_ms, 2000);
  EXPECT_NEAR(settings.source->input_speed_rad_per_s.value(), 6.283185307, 1e-9);
  EXPECT_EQ(settings.source->renamed.at(0).first, "accel_x");
  EXPECT_EQ(settings.source->renamed.at(0).second, "accel_motor_z_m_per_s2");
  const auto iio = std::get<daq::acquisition::IioSettings>(ParseStreamAddress("iio:ip:10.0.0.7/adxl355"));
  EXPECT_EQ(iio.uri, "ip:10.0.0.7");
  EXPECT_EQ(iio.device, "adxl355");
  EXPECT_EQ(std::get<daq::acquisition::ReplaySettings>(ParseStreamAddress("replay:a/b.h5")).path, "a/b.h5");
}

TEST(MonitorSettings, AnAddressThatIsNoneIsToldWithItsPlace) {
  for (const char* address :
       {"10.0.0.7:5025", "tcp://10.0.0.7", "tcp://host:0", "tcp://:5", "iio:adxl355", "replay:"}) {
    EXPECT_EQ(ErrorsOf(fmt::format("monitor: 1\nsource:\n  address: '{}'\n", address)),
              fmt::format("m.yaml:3:12: error: address = {} (expected tcp://HOST:PORT, iio:URI/DEVICE as in "
                          "iio:ip:10.0.0.7/adxl355, or replay:FILE)",
                          address));
  }
}

TEST(MonitorSettings, APasswordComesFromAFileOrTheEnvironment) {
  const TestFolder folder;
  const auto read = [&](const std::string& lines) {
    std::ofstream(folder.path() / "m.yaml") << "monitor: 1\nmqtt:\n  node: b\n" << lines;
    return ReadMonitorSettings(folder.path() / "m.yaml").mqtt->password;
  };
  std::ofstream(folder.path() / "word") << "open sesame\r\nsecond line\n";
  EXPECT_EQ(read("  password_file: word\n"), "open sesame");
  EXPECT_EQ(read("  password: plain\n"), "plain");
  ::setenv("STRAINWAVE_TEST_PASSWORD", "from outside", 1);
  EXPECT_EQ(read("  password_variable: STRAINWAVE_TEST_PASSWORD\n"), "from outside");
  ::unsetenv("STRAINWAVE_TEST_PASSWORD");
  const std::string mqtt = "monitor: 1\nmqtt:\n  node: b\n";
  EXPECT_EQ(
      ErrorsOf(mqtt + "  password_variable: STRAINWAVE_TEST_PASSWORD\n"),
      "m.yaml:4:22: error: the environment has no variable STRAINWAVE_TEST_PASSWORD (expected the password "
      "in it)");
  EXPECT_EQ(ErrorsOf(mqtt + "  password_file: /none/word\n"),
            "m.yaml:4:18: error: password_file = /none/word cannot be read (expected a file)");
  EXPECT_EQ(ErrorsOf(mqtt + "  password: a\n  password_file: " + (folder.path() / "word").string() + "\n"),
            "m.yaml:5:18: error: password_file names a second place for the password (expected one)");
}

TEST(MonitorSettings, WhatIsSecretIsRepeatedInNoMessage) {
  const std::string mqtt = "monitor: 1\nmqtt:\n  node: b\n";
  const std::string not_usable =
      "m.yaml:4:13: error: password is not usable (expected one line of 1 to 200 characters; it may be "
      "secret "
      "and is not shown)";
  EXPECT_EQ(ErrorsOf(mqtt + "  password: |\n    open sesame\n"), not_usable);
  EXPECT_EQ(ErrorsOf(mqtt + "  password: \"open\\nsesame\"\n"), not_usable);
  EXPECT_EQ(ErrorsOf(mqtt + "  password: " + std::string(201, 'x') + "\n"), not_usable);
  EXPECT_EQ(ErrorsOf(mqtt + "  password: [open, sesame]\n"),
            "m.yaml:4:13: error: password is a list (expected one line of 1 to 200 characters)");
  EXPECT_EQ(ErrorsOf(mqtt + "  password: !sesame\n"),
            "m.yaml:4:13: error: tag (expected plain values; a text that begins with '!' stands in quotes)");
  for (const char* host : {"mqtt://bench:sesame@broker", "bench:sesame@broker", "broker/sesame"}) {
    EXPECT_EQ(
        ErrorsOf(mqtt + "  host: \"" + host + "\"\n"),
        "m.yaml:4:9: error: host is more than a name or an address (expected that alone: port, user and "
        "password_file are keys beside it)");
  }
}

// A pipe that nobody writes to would be waited for, a device of zeros be read for ever.
TEST(MonitorSettings, AFileThatHasNoEndOrIsTooLargeIsRefused) {
  const TestFolder folder;
  const std::string pipe = folder.path() / "pipe", large = folder.path() / "large",
                    fits = folder.path() / "fits";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::ofstream(large) << std::string(65537, 'a');
  std::ofstream(fits) << std::string(65535, 'a') << '\n';
  const std::string mqtt = "monitor: 1\nmqtt:\n  node: b\n";
  const auto password = [&](const std::string& file) {
    return ErrorsOf(mqtt + "  password_file: " + file + "\n");
  };
  const std::string expected = " is a folder, a pipe or a device (expected a file of at most 64 KiB)";
  for (const std::string& file :
       {pipe, folder.path().string(), std::string("/dev/zero"), std::string("/dev/null")}) {
    EXPECT_EQ(password(file), "m.yaml:4:18: error: password_file = " + file + expected);
  }
  EXPECT_EQ(password(large), "m.yaml:4:18: error: password_file = " + large +
                                 " has 65537 bytes (expected a file of at most 64 KiB)");
  EXPECT_EQ(password(fits), "none");
  const std::string of_certificates =
      " is a folder, a pipe or a device (expected a file of at most 1024 KiB)";
  EXPECT_EQ(ErrorsOf(mqtt + "  tls:\n    ca_file: /dev/zero\n    certificate_file: " + pipe +
                     "\n    key_file: /tmp\n"),
            "m.yaml:5:14: error: ca_file = /dev/zero" + of_certificates +
                "\nm.yaml:6:23: error: certificate_file = " + pipe + of_certificates +
                "\nm.yaml:7:15: error: key_file = /tmp" + of_certificates);
  EXPECT_EQ(ErrorsOf(mqtt + "  outbox_file: " + pipe + "\n"),
            "m.yaml:4:16: error: outbox_file = " + pipe +
                " is a folder, a pipe or a device (expected a file, or a name for a new one)");
  EXPECT_EQ(ErrorsOf("monitor: 1\nsource:\n  address: replay:" + pipe + "\n"),
            "m.yaml:3:12: error: address = replay:" + pipe +
                " is a folder, a pipe or a device (expected a recorded file)");
}

TEST(MonitorSettings, AServerHasRoomForSoManyClientsAndSoMuchPatience) {
  const MonitorSettings settings = ParseMonitorSettings(
      "monitor: 1\nmodbus: {connections: 4, idle_after: 2 s}\nprometheus: {port: 1}\n", "m.yaml");
  EXPECT_EQ(settings.modbus->connections, 4U);
  EXPECT_EQ(settings.modbus->idle_after_ms, 2000);
  EXPECT_EQ(settings.prometheus->connections, 32U);
  EXPECT_EQ(settings.prometheus->idle_after_ms, 60'000);
  EXPECT_EQ(ErrorsOf("monitor: 1\nmodbus: {connections: 501}\n"),
            "m.yaml:2:23: error: connections = 501: out of range (expected a whole number from 1 to 500)");
}

TEST(MonitorSettings, OneMachineOfSeveralGetsHalfOfAServersConnections) {
  const auto of_one = [](const std::string& keys) {
    return ParseMonitorSettings("monitor: 1\nmodbus: {" + keys + "}\n", "m.yaml").modbus->of_one_network;
  };
  EXPECT_EQ(of_one("connections: 500"), 500U) << "all come from this one";
  EXPECT_EQ(of_one("connections: 500, address: localhost"), 500U);
  EXPECT_EQ(of_one("connections: 500, address: 0.0.0.0"), 250U);
  EXPECT_EQ(of_one("connections: 1, address: 192.0.2.7"), 1U);
}

TEST(MonitorSettings, TlsNeedsAnAuthorityAndBothHalvesOfACertificate) {
  const TestFolder folder;
  const std::string file = folder.path() / "file.pem";
  std::ofstream(file) << "\n";
  const std::string mqtt = "monitor: 1\nmqtt:\n  node: b\n  tls:\n";
  EXPECT_EQ(ErrorsOf(mqtt + "    certificate_file: " + file + "\n"),
            "m.yaml:4:3: error: missing key 'ca_file' (expected one line of 1 to 200 characters)\n"
            "m.yaml:5:23: error: certificate_file stands alone (expected certificate_file and key_file)");
  const MonitorSettings settings = ParseMonitorSettings(mqtt + "    ca_file: " + file + "\n", "m.yaml");
  EXPECT_EQ(settings.mqtt->port, 8883);
  EXPECT_EQ(settings.mqtt->tls.ca_file, file);
}

TEST(MonitorSettings, RefuseLimitsThatContradictEachOther) {
  EXPECT_EQ(ErrorsOf("monitor: 1\nthresholds:\n  - output: a\n    warning_above: 5\n    alarm_above: 4\n"),
            "m.yaml:5:18: error: alarm_above = 4 is below warning_above = 5 (expected the alarm beyond the "
            "warning)");
  EXPECT_EQ(ErrorsOf("monitor: 1\nthresholds:\n  - output: a\n    warning_below: 5\n    alarm_below: 6\n"),
            "m.yaml:5:18: error: alarm_below = 6 is above warning_below = 5 (expected the alarm beyond the "
            "warning)");
  EXPECT_EQ(
      ErrorsOf("monitor: 1\nthresholds:\n  - output: a\n"),
      "m.yaml:3:13: error: the threshold has no limit (expected warning_above, warning_below, alarm_above "
      "or alarm_below)");
  EXPECT_EQ(
      ErrorsOf("monitor: 1\nthresholds:\n  - output: a\n    warning_below: 1\n    warning_above: 2\n"
               "    hysteresis: 0.6\n"),
      "m.yaml:6:17: error: nothing is left between 1 and 2 (expected lower and upper limits further apart "
      "than twice the hysteresis)");
  EXPECT_EQ(
      ErrorsOf(
          "monitor: 1\nthresholds:\n  - {output: a, warning_above: 1}\n  - {output: a, alarm_above: 1}\n"),
      "m.yaml:4:14: error: output a has a threshold already (expected one for each output)");
}

TEST(MonitorSettings, ATriggerChannelNeedsItsLevel) {
  EXPECT_EQ(ErrorsOf("monitor: 1\nwindows:\n  trigger_channel: trigger_V\n"),
            "m.yaml:2:1: error: missing key 'trigger_level' (expected a number)");
  EXPECT_EQ(ErrorsOf("monitor: 1\nwindows:\n  by: revolution\n  trigger_channel: t\n  trigger_level: 1\n"),
            "m.yaml:4:20: error: trigger_channel has no meaning for windows by revolution (expected 'by: "
            "trigger')");
}

}  // namespace
}  // namespace strainwave::bench::monitor_settings_test
