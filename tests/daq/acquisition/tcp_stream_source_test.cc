// SPDX-License-Identifier: Apache-2.0
// Against the reference sender, in another language and process.
#include "daq/acquisition/sources/tcp_stream_source.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>

#include "daq/acquisition/gap_ledger.h"
#include "tests/checkout.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::acquisition::tcp_stream_source_test {
namespace {

constexpr std::chrono::nanoseconds kPatience = std::chrono::seconds(5);

class Sender {
 public:
  explicit Sender(const std::string& arguments)
      : pipe_(::popen(("exec /usr/bin/python3 '" + SourceFolder() + "/daq/acquisition/reference_sender.py' " +
                       arguments)
                          .c_str(),
                      "r")) {
    if (pipe_ == nullptr || std::fscanf(pipe_, "%hu", &port_) != 1) throw std::runtime_error("no sender");
  }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;
  ~Sender() { ::pclose(pipe_); }
  std::uint16_t port() const { return port_; }

 private:
  std::FILE* pipe_;
  std::uint16_t port_{};
};

struct Received {
  GapTotals totals;
  std::vector<Gap> gaps;
  std::vector<std::string> troubles;
};
Received ReceiveAll(TcpStreamSource& source) {
  source.Start();
  GapLedger ledger({.bits = source.description().counter_bits}, source.description().rate_hz);
  SampleBlock block(source.description().channels.size() * source.description().most_samples_a_block);
  Received received;
  for (NextResult result; (result = source.Next(block, kPatience)) != NextResult::kEnded;) {
    if (result == NextResult::kFailed) received.troubles.push_back(source.trouble());
    if (result != NextResult::kBlock) continue;
    if (const std::optional<Gap> gap = ledger.Admit(block)) received.gaps.push_back(*gap);
    for (std::uint32_t i = 0; i < block.header.samples; ++i) {
      EXPECT_EQ(block.Value(i, 2), static_cast<double>(block.header.device_counter + i + 2));
    }
  }
  received.totals = ledger.totals();
  return received;
}

TEST(TcpStreamSource, ReceivesEverySample) {
  const Sender sender("--channels 3 --samples 100 --blocks 500 --fast");
  TcpStreamSource source({.host = "127.0.0.1", .port = sender.port(), .source = 9});
  const Received received = ReceiveAll(source);
  EXPECT_EQ(received.totals, (GapTotals{.received = 50000}));
  EXPECT_EQ(source.description().channels[1].sensor_serial, "S1");
  EXPECT_EQ(source.description().source, 9U);
  EXPECT_EQ(source.damage().left_out + source.damage().skipped_bytes, 0U);
}

TEST(TcpStreamSource, ReportsLostDamagedAndInterruptedBlocksAsGaps) {
  const Sender sender(
      "--channels 3 --samples 100 --blocks 100 --rate 1e6 --drop 10,11,40 --corrupt 60 --garbage 70 "
      "--disconnect 80");
  TcpStreamSource source(
      {.host = "localhost", .port = sender.port(), .between_connections = std::chrono::milliseconds(10)});
  const Received received = ReceiveAll(source);
  ASSERT_GE(received.gaps.size(), 3U);
  EXPECT_EQ(received.gaps[0].first_lost, 1000U);
  EXPECT_EQ(received.gaps[0].lost, 200U);
  EXPECT_EQ(received.gaps[1].first_lost, 4000U);
  EXPECT_EQ(received.gaps[2].first_lost, 6000U);
  EXPECT_EQ(received.gaps[2].lost, 100U);
  // The device waits for the next connection between two blocks, so that none is lost by it.
  EXPECT_EQ(received.totals, (GapTotals{.received = 9600, .lost = 400, .gaps = 3}));
  EXPECT_EQ(source.damage().left_out, 1U);
  EXPECT_EQ(source.damage().skipped_bytes, 40U);
  EXPECT_EQ(source.connections(), 2U);
  EXPECT_EQ(received.troubles,
            std::vector{"localhost:" + std::to_string(sender.port()) + ": the connection was closed"});
}

TEST(TcpStreamSource, SaysWhoDoesNotAnswer) {
  // A port that was free a moment ago.
  std::uint16_t port{};
  {
    const Sender sender("--blocks 0");
    port = sender.port();
    TcpStreamSource({.host = "127.0.0.1", .port = port}).Start();
  }
  TcpStreamSource source({.host = "127.0.0.1", .port = port});
  EXPECT_EQ(MessageOf<std::system_error>([&] { source.Start(); }),
            "cannot connect to 127.0.0.1:" + std::to_string(port) + ": Connection refused");
}

}  // namespace
}  // namespace strainwave::daq::acquisition::tcp_stream_source_test
