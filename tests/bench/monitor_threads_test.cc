// SPDX-License-Identifier: Apache-2.0
// The threads of a monitor at work beside one another; worth most under the preset `tsan`.
#include <arpa/inet.h>
#include <modbus.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <bit>
#include <memory>
#include <thread>

#include <gtest/gtest.h>
#include <httplib.h>

#include "bench/monitor/board.h"
#include "bench/monitor/modbus_registers.h"
#include "bench/monitor/modbus_server.h"
#include "bench/monitor/mqtt_publisher.h"
#include "bench/monitor/prometheus_server.h"
#include "bench/monitor/sparkplug_metrics.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::monitor_threads_test {
namespace {

constexpr int kReadings = 200;
constexpr std::int64_t kLeastWindows = 2000;

// Window n says n in each of its values.
MonitorResult Window(std::int64_t number) {
  const auto value = static_cast<double>(number);
  return {.number = number,
          .begin_ms = number,
          .end_ms = number,
          .origin = "here",
          .fault = {},
          .distance = 0.5,
          .outputs = {{value, value, value}, {value, value, value}},
          .alarms = {AlarmLevel::kOk, AlarmLevel::kOk},
          .alarm = AlarmLevel::kOk};
}

// A port that takes connections and never says a word: a broker that hangs.
class SilentPort {
 public:
  SilentPort() : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address));
    ::listen(socket_, 8);
    socklen_t size = sizeof(address);
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  SilentPort(const SilentPort&) = delete;
  SilentPort& operator=(const SilentPort&) = delete;
  ~SilentPort() { ::close(socket_); }
  int port() const { return port_; }

 private:
  int socket_;
  int port_{};
};

double FloatAt(const std::uint16_t* registers, std::size_t at) {
  return std::bit_cast<float>((std::uint32_t{registers[at]} << 16) | registers[at + 1]);
}

// @return readings whose values are not all of one window.
int TornReadingsOfAPlc(int port) {
  modbus_t* const plc = modbus_new_tcp("127.0.0.1", port);
  EXPECT_EQ(modbus_connect(plc), 0);
  int torn = 0;
  for (int i = 0; i < kReadings; ++i) {
    std::uint16_t registers[36]{};
    EXPECT_EQ(modbus_read_input_registers(plc, 0, 36, registers), 36);
    if (registers[1] != static_cast<int>(ValueStatus::kGood)) continue;
    const double number = (registers[4] << 16) | registers[5];
    for (const std::size_t at : {20U, 22U, 24U, 28U, 30U, 32U}) torn += FloatAt(registers, at) != number;
  }
  modbus_close(plc);
  modbus_free(plc);
  return torn;
}

int TornPages(int port) {
  const std::string name = "strainwave_predicted{output=\"";
  int torn = 0;
  for (int i = 0; i < kReadings / 10; ++i) {
    httplib::Client client("127.0.0.1", port);
    const auto page = client.Get("/metrics");
    EXPECT_TRUE(page);
    if (!page) return 1;
    const auto value = [&](const std::string& output) {
      const std::size_t at = page->body.find("\n" + name + output + "\"} ");
      return at == std::string::npos ? std::string()
                                     : page->body.substr(at + 4 + name.size() + output.size(), 8);
    };
    torn += value("a").substr(0, value("a").find('\n')) != value("b").substr(0, value("b").find('\n'));
  }
  return torn;
}

TEST(MonitorThreads, EachReaderSeesOneWindowWhileABrokerHangsAndAllIsKept) {
  const daq::ScratchFolder folder;
  const SilentPort silent;
  std::atomic<std::int64_t> now_ms{0};
  Board board({{"a", "b"}, 0.9, 1'000'000, false}, [&] { return now_ms.load(); });
  ModbusServer modbus({"127.0.0.1", 0}, board);
  PrometheusServer prometheus({"127.0.0.1", 0}, board);
  MqttSettings settings;
  settings.host = "127.0.0.1";
  settings.port = silent.port();
  settings.group = settings.node = "n";
  settings.outbox_file = folder / "outbox.db";
  settings.keep.windows = 50;
  std::atomic<int> torn{0};
  std::int64_t number = 0;
  std::size_t left = 0;
  {
    MqttPublisher mqtt(
        settings, board, [](const std::string&) {}, std::make_unique<OutboxStore>(settings.outbox_file));
    std::atomic<int> reading{2};
    std::thread plc([&] {
      torn += TornReadingsOfAPlc(modbus.port());
      --reading;
    });
    std::thread scraper([&] {
      torn += TornPages(prometheus.port());
      --reading;
    });
    while (reading > 0 || number < kLeastWindows) {
      now_ms = ++number;
      board.Show(Window(number));
      if (number % 20 == 0) mqtt.Publish(SparkplugMetrics(board.State(), board.frame(), number));
    }
    plc.join();
    scraper.join();
    left = mqtt.Finish(std::chrono::milliseconds(0)).waiting;
  }
  EXPECT_EQ(torn, 0);
  EXPECT_EQ(left, 50U);
  const OutboxStore store(settings.outbox_file);
  EXPECT_EQ(store.Entries().size(), 50U);
  EXPECT_EQ(store.last_window(), number - number % 20);
  EXPECT_EQ(store.dropped(), static_cast<std::uint64_t>(number / 20 - 50));
}

}  // namespace
}  // namespace strainwave::bench::monitor_threads_test
