// SPDX-License-Identifier: Apache-2.0
// What the sender's side writes, read by the receiver's side and held against bytes that Python made
// (struct.pack and zlib.crc32, as reference_sender.py does it).
#include "daq/acquisition/tcp_stream_encoder.h"

#include <algorithm>
#include <bit>
#include <string>

#include <gtest/gtest.h>

#include "daq/acquisition/sources/tcp_stream_decoder.h"

namespace strainwave::daq::acquisition::tcp_stream_encoder_test {
namespace {

SourceDescription TwoChannels() {
  SourceDescription source;
  source.name = "encoders";
  source.type = SampleType::kInt32;
  source.rate_hz = 1000.0;
  source.most_samples_a_block = 4;
  source.channels.resize(2);
  source.channels[0].name = "input_angle_deg";
  source.channels[0].unit = "deg";
  source.channels[0].sensor_serial = "E-1";
  source.channels[0].calibration.id = "C-1";
  source.channels[0].calibration.sensitivity = 1048576.0 / 360.0;
  source.channels[1].name = "torque_Nm";
  source.channels[1].unit = "Nm";
  source.channels[1].limits.saturation_high = 8388607.0;
  source.channels[1].limits.noise = 12.5;
  return source;
}

SampleBlock ThreeSamples() {
  SampleBlock block(8);
  block.header.channels = 2;
  block.header.samples = 3;
  block.header.type = SampleType::kInt32;
  block.header.device_counter = 0x1'0000'0002;
  block.header.device_time = std::chrono::nanoseconds(-5);
  for (int i = 0; i < 6; ++i)
    block.words()[static_cast<std::size_t>(i)] = std::bit_cast<std::uint32_t>(i - 3);
  return block;
}

void Feed(TcpStreamDecoder& decoder, std::span<const std::byte> bytes) {
  const std::span<std::byte> room = decoder.Room();
  ASSERT_GE(room.size(), bytes.size());
  std::copy(bytes.begin(), bytes.end(), room.begin());
  decoder.Received(bytes.size());
}

TEST(TcpStreamEncoder, IsUnderstoodByTheReceiver) {
  TcpStreamDecoder decoder;
  SampleBlock block(8);
  Feed(decoder, EncodeHello(TwoChannels()));
  ASSERT_EQ(decoder.Next(block), TcpStreamEvent::kHello) << decoder.damage().last;
  const SourceDescription& heard = *decoder.description();
  EXPECT_EQ(heard.name, "encoders");
  EXPECT_EQ(heard.rate_hz, 1000.0);
  EXPECT_EQ(heard.counter_bits, 64U);
  ASSERT_EQ(heard.channels.size(), 2U);
  EXPECT_EQ(heard.channels[0].calibration, TwoChannels().channels[0].calibration);
  EXPECT_EQ(heard.channels[0].sensor_serial, "E-1");
  EXPECT_EQ(heard.channels[1].limits.saturation_high, 8388607.0);
  EXPECT_EQ(heard.channels[1].limits.noise, 12.5);
  EXPECT_FALSE(heard.channels[1].limits.least);

  std::vector<std::byte> message;
  EncodeBlock(ThreeSamples(), message);
  Feed(decoder, message);
  ASSERT_EQ(decoder.Next(block), TcpStreamEvent::kBlock) << decoder.damage().last;
  EXPECT_EQ(block.header.device_counter, 0x1'0000'0002U);
  EXPECT_EQ(block.header.device_time.count(), -5);
  ASSERT_EQ(block.header.samples, 3U);
  EXPECT_TRUE(std::ranges::equal(block.words(), ThreeSamples().words()));

  Feed(decoder, EncodeKeepAlive(77, std::chrono::nanoseconds(1)));
  EXPECT_EQ(decoder.Next(block), TcpStreamEvent::kKeepAlive);
  EXPECT_EQ(decoder.keep_alive_counter(), 77U);
  EXPECT_EQ(decoder.damage().left_out, 0U);
  EXPECT_EQ(decoder.damage().skipped_bytes, 0U);
}

TEST(TcpStreamEncoder, WritesTheBytesThatPythonWrites) {
  // head = struct.pack("<4sBBHI", b"SWS1", 3, 1, 0, 16); payload = struct.pack("<Qq", 77, 1)
  const std::string expected = "53575331030100001000000026343d7268ff25074d000000000000000100000000000000";
  std::string written;
  for (const std::byte value : EncodeKeepAlive(77, std::chrono::nanoseconds(1))) {
    constexpr char kDigits[] = "0123456789abcdef";
    written += kDigits[std::to_integer<unsigned>(value) >> 4];
    written += kDigits[std::to_integer<unsigned>(value) & 15];
  }
  EXPECT_EQ(written, expected);
}

}  // namespace
}  // namespace strainwave::daq::acquisition::tcp_stream_encoder_test
