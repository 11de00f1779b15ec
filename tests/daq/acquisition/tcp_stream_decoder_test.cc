// SPDX-License-Identifier: Apache-2.0
// Truth: messages put together here by hand, CRCs by zlib.
#include "daq/acquisition/sources/tcp_stream_decoder.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <random>

#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::acquisition::tcp_stream_decoder_test {
namespace {

void Append(std::string& bytes, std::uint64_t number, int width) {
  for (int i = 0; i < width; ++i) bytes.push_back(static_cast<char>(number >> (8 * i)));
}
std::uint32_t Crc(const std::string& bytes) {
  return static_cast<std::uint32_t>(
      ::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}
std::string Message(std::uint8_t type, const std::string& payload, std::uint8_t version = 1) {
  std::string bytes = "SWS1";
  Append(bytes, type, 1);
  Append(bytes, version, 1);
  Append(bytes, 0, 2);
  Append(bytes, payload.size(), 4);
  Append(bytes, Crc(bytes), 4);
  Append(bytes, Crc(payload), 4);
  return bytes + payload;
}
std::string Hello(
    const std::string& json = R"({"name": "dev", "type": "int32", "rate_hz": 51200, "counter_bits": 32,
    "most_samples_a_block": 100, "channels": [{"name": "a_V", "unit": "V", "sensor_serial": "0815",
    "calibration": {"calibration": "C1", "sensitivity": "2.5"}, "limits": {"least": -5, "saturation_high": 8388607, "noise": 40}},
    {"name": "b_V"}]})") {
  return Message(1, json);
}
std::string Block(std::uint64_t counter, std::uint32_t samples, std::uint32_t flags = 0) {
  std::string payload;
  Append(payload, counter, 8);
  Append(payload, counter * 1000, 8);
  Append(payload, samples, 4);
  Append(payload, flags, 4);
  for (std::uint32_t i = 0; i < samples; ++i) {
    Append(payload, counter + i, 4);
    Append(payload, static_cast<std::uint32_t>(-static_cast<int>(counter + i)), 4);
  }
  return Message(2, payload);
}

struct Decoded {
  std::vector<TcpStreamEvent> events;
  std::vector<BlockHeader> blocks;
  TcpStreamDamage damage;
  std::optional<SourceDescription> description;
  std::uint64_t keep_alive{};
};
// Feeds the bytes in pieces of at most this size.
Decoded Decode(const std::string& bytes, std::size_t piece = 1 << 20) {
  TcpStreamDecoder decoder;
  SampleBlock block(200);
  Decoded decoded;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::span<std::byte> room = decoder.Room();
    const std::size_t count = std::min({piece, room.size(), bytes.size() - at});
    std::memcpy(room.data(), bytes.data() + at, count);
    decoder.Received(count);
    at += count;
    for (TcpStreamEvent event; (event = decoder.Next(block)) != TcpStreamEvent::kNeedsMore;) {
      decoded.events.push_back(event);
      if (event != TcpStreamEvent::kBlock) continue;
      decoded.blocks.push_back(block.header);
      for (std::uint32_t i = 0; i < block.header.samples; ++i) {
        EXPECT_EQ(block.Value(i, 0), static_cast<double>(block.header.device_counter + i));
        EXPECT_EQ(block.Value(i, 1), -static_cast<double>(block.header.device_counter + i));
      }
    }
  }
  decoded.damage = decoder.damage();
  decoded.description = decoder.description();
  decoded.keep_alive = decoder.keep_alive_counter();
  return decoded;
}

using enum TcpStreamEvent;

TEST(TcpStreamDecoder, ReadsMessagesHoweverTheyAreCut) {
  std::string keep_alive;
  Append(keep_alive, 110, 8);
  Append(keep_alive, 7, 8);
  const std::string bytes =
      Hello() + Block(0, 100) + Block(100, 10, 1) + Message(3, keep_alive) + Message(4, "");
  for (const std::size_t piece : {1U, 2U, 7U, 19U, 20U, 21U, 800U, 100000U}) {
    const Decoded decoded = Decode(bytes, piece);
    EXPECT_EQ(decoded.events, (std::vector{kHello, kBlock, kBlock, kKeepAlive, kEnd})) << piece;
    EXPECT_EQ(decoded.damage.skipped_bytes + decoded.damage.left_out, 0U);
    EXPECT_EQ(decoded.keep_alive, 110U);
    ASSERT_EQ(decoded.blocks.size(), 2U);
    EXPECT_EQ(decoded.blocks[1].device_counter, 100U);
    EXPECT_EQ(decoded.blocks[1].device_time.count(), 100'000);
    EXPECT_EQ(decoded.blocks[1].flags, kDeviceOverrun);
    EXPECT_EQ(decoded.blocks[1].rate_hz, 51200);
  }
  const SourceDescription source = *Decode(bytes).description;
  EXPECT_EQ(source.counter_bits, 32U);
  EXPECT_EQ(source.channels[0].sensor_serial, "0815");
  EXPECT_EQ(source.channels[0].calibration.Apply(5), 2);
  EXPECT_EQ(source.channels[0].limits.least, -5);
  EXPECT_EQ(source.channels[0].limits.most, std::nullopt);
  EXPECT_EQ(source.channels[0].limits.noise, 40);
  EXPECT_EQ(source.channels[1].unit, "");
}

TEST(TcpStreamDecoder, FindsTheNextMessageBehindRubbish) {
  const std::string good = Block(100, 10);
  for (const std::string& rubbish :
       {std::string("hello"), std::string("SWS"), std::string("SWS1"),
        std::string("SSWSWS1SWS1xxxxxxxxxxxxxxxxxxxx"), std::string(5000, 'S'), good.substr(0, 50)}) {
    for (const std::size_t piece : {1U, 3U, 100000U}) {
      const Decoded decoded = Decode(Hello() + rubbish + good + Block(110, 10), piece);
      // A message that is cut takes the next bytes for its own; the one after it is found again.
      const std::size_t found = rubbish == good.substr(0, 50) ? 1 : 2;
      EXPECT_EQ(decoded.blocks.size(), found) << rubbish << " by " << piece;
      EXPECT_GT(decoded.damage.skipped_bytes + decoded.damage.left_out, 0U);
    }
  }
}

TEST(TcpStreamDecoder, NeverPassesOnABlockWithAFlippedBit) {
  const std::string before = Hello() + Block(0, 10);
  const std::string middle = Block(10, 10);
  for (std::size_t bit = 0; bit < 8 * middle.size(); ++bit) {
    std::string flipped = middle;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << (bit % 8)));
    const Decoded decoded = Decode(before + flipped + Block(20, 10));
    ASSERT_EQ(decoded.blocks.size(), 2U) << bit;
    ASSERT_EQ(decoded.blocks[1].device_counter, 20U);
    ASSERT_GT(decoded.damage.skipped_bytes + decoded.damage.left_out, 0U);
  }
}

TEST(TcpStreamDecoder, LeavesOutWhatItCannotTakeAndSaysWhy) {
  const auto last = [](const std::string& bytes) {
    const Decoded decoded = Decode(bytes + Block(50, 1));
    EXPECT_TRUE(decoded.blocks.empty() || decoded.blocks.back().device_counter == 50) << decoded.damage.last;
    return Decode(bytes).damage.last;
  };
  EXPECT_EQ(last(Block(0, 1)), "a block before the hello");
  EXPECT_EQ(last(Hello() + Hello()), "a second hello");
  EXPECT_EQ(last(Hello() + Block(0, 101)), "a block of 101 samples, 1 to 100 expected");
  EXPECT_EQ(last(Hello() + Block(0, 0)), "a block of 0 samples, 1 to 100 expected");
  EXPECT_EQ(last(Hello() + Message(2, "short")), "a block of 5 bytes");
  EXPECT_EQ(last(Hello() + Message(2, Block(0, 5).substr(20) + "x")),
            "a block of 5 samples in 65 bytes, 64 expected");
  EXPECT_EQ(last(Hello() + Message(3, "")), "a keep-alive of 0 bytes, 16 expected");
  EXPECT_EQ(last(Hello() + Message(9, "")), "a message of type 9, which is unknown");
  EXPECT_EQ(last(Hello() + Message(2, "", 2)), "a message of version 2, 1 expected");
  EXPECT_EQ(last(Message(1, std::string((1 << 20) + 1, ' '))), "a hello of 1048577 bytes, more than 1048576");
  std::string huge = Message(2, "").substr(0, 8);
  Append(huge, 4'194'305, 4);
  Append(huge, Crc(huge), 4);
  Append(huge, 0, 4);
  EXPECT_EQ(last(Hello() + huge), "a message of 4194305 bytes, more than 4194304");
}

TEST(TcpStreamDecoder, RefusesAHelloThatContradictsItself) {
  const auto why = [](const std::string& json) {
    const Decoded decoded = Decode(Hello(json));
    EXPECT_FALSE(decoded.description);
    return decoded.damage.last;
  };
  const auto with = [](const std::string& rest) { return R"({"name": "x", )" + rest + "}"; };
  const std::string channel = R"("channels": [{"name": "a"}])";
  EXPECT_EQ(why("{"), "hello: it is not a JSON object");
  EXPECT_EQ(Decode(Hello("{") + Block(0, 1)).damage.last, "hello: it is not a JSON object");
  EXPECT_EQ(why("[1]"), "hello: it is not a JSON object");
  EXPECT_EQ(why("{}"), "hello: name is not a text");
  EXPECT_EQ(why(with(R"("type": "int16")")), "hello: type is 'int16', neither int32 nor float32");
  EXPECT_EQ(why(with(R"("type": "int32", "rate_hz": 0)")),
            "hello: rate_hz is not a number from 1e-06 to 1000000000");
  EXPECT_EQ(why(with(R"("type": "int32", "rate_hz": 1, "counter_bits": 7)")),
            "hello: counter_bits is not a number from 8 to 64");
  EXPECT_EQ(why(with(R"("type": "int32", "rate_hz": 1)")), "hello: channels is not a list of 1 to 1024");
  EXPECT_EQ(why(with(R"("type": "int32", "rate_hz": 1, )" + channel)),
            "hello: most_samples_a_block is not a number from 1 to 1048570");
  const std::string head = R"("type": "int32", "rate_hz": 1, "most_samples_a_block": 9, "channels": )";
  EXPECT_EQ(why(with(head + R"([{"name": "a"}, {"name": "a"}])")), "hello: two channels have the name 'a'");
  EXPECT_EQ(why(with(head + R"([{"name": "a/b"}])")), "hello: 'a/b' cannot name a channel");
  EXPECT_EQ(why(with(head + R"([7])")), "hello: a channel is not an object");
  EXPECT_EQ(why(with(head + R"([{"name": "a", "calibration": {"sensitivity": "1e-200"}}])")),
            "hello: sensitivity = 1e-200 is not a number of a magnitude from 1e-15 to 1e+15");
  EXPECT_EQ(why(with(head + R"([{"name": "a", "calibration": {"zero": "x"}}])")),
            "hello: zero = 'x' is not a finite number");
  EXPECT_EQ(why(with(head + R"([{"name": "a", "limits": {"noise": -1}}])")),
            "hello: noise is not a number from 0 to 1e+30");
}

TEST(TcpStreamDecoder, LivesThroughAnyBytes) {
  std::mt19937_64 random(1);
  const std::string good = Hello() + Block(0, 100) + Block(100, 50) + Message(4, "");
  for (int run = 0; run < 2000; ++run) {
    std::string bytes = good;
    for (std::uint64_t edits = random() % 20; edits > 0; --edits) {
      const std::size_t at = random() % bytes.size();
      if (random() % 3 == 0) {
        bytes.insert(at, bytes.substr(random() % bytes.size(), random() % 100));
      } else if (random() % 2 == 0) {
        bytes.erase(at, random() % 100);
      } else {
        bytes[at] = static_cast<char>(random());
      }
      if (bytes.empty()) bytes.assign(1, 'S');
    }
    const Decoded whole = Decode(bytes);
    const Decoded cut = Decode(bytes, 1 + random() % 50);
    ASSERT_EQ(whole.events, cut.events);
    ASSERT_EQ(whole.damage.skipped_bytes, cut.damage.skipped_bytes);
    ASSERT_EQ(whole.damage.left_out, cut.damage.left_out);
  }
}

}  // namespace
}  // namespace strainwave::daq::acquisition::tcp_stream_decoder_test
