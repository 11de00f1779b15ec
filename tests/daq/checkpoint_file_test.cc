// SPDX-License-Identifier: Apache-2.0
#include "daq/checkpoint_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <stdexcept>
#include <string>

#include "daq/data_file_error.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::checkpoint_file_test {
namespace {

std::span<const std::byte> Bytes(const std::string& text) { return std::as_bytes(std::span(text)); }

std::string TextOf(const std::optional<Checkpoint>& checkpoint) {
  if (!checkpoint) return "nothing";
  return {reinterpret_cast<const char*>(checkpoint->payload.data()), checkpoint->payload.size()};
}

class CheckpointFileTest : public testing::Test {
 protected:
  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "state";
};

TEST_F(CheckpointFileTest, HoldsNothingWhenNew) {
  CheckpointFile file(path_);
  EXPECT_EQ(file.ReadLatest(), std::nullopt);
  EXPECT_EQ(ReadCheckpoint(path_), std::nullopt);
}

TEST_F(CheckpointFileTest, ReadsTheNewestWrite) {
  CheckpointFile file(path_);
  for (int i = 1; i <= 10; ++i) {
    file.Write(Bytes("state " + std::to_string(i)));
    ASSERT_EQ(TextOf(file.ReadLatest()), "state " + std::to_string(i));
    ASSERT_EQ(file.ReadLatest()->sequence, static_cast<std::uint64_t>(i));
    if (i % 3 == 0) file.Sync();
  }
  EXPECT_EQ(file.ReadLatest()->damaged_slots, 0);
}

TEST_F(CheckpointFileTest, TakesAnEmptyAndAFullPayload) {
  CheckpointFile file(path_);
  file.Write({});
  EXPECT_EQ(TextOf(file.ReadLatest()), "");
  const std::string full(CheckpointFile::kCapacity_bytes, 'x');
  file.Write(Bytes(full));
  EXPECT_EQ(TextOf(file.ReadLatest()), full);
  EXPECT_EQ(MessageOf<std::invalid_argument>([&] { file.Write(Bytes(full + "x")); }),
            "payload of 16353 bytes is longer than the 16352 of a slot");
}

// Bit by bit, as the standard defines it.
std::uint32_t Crc32BitByBit(const std::string& text) {
  std::uint32_t crc = 0xFFFFFFFF;
  for (const char c : text) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc % 2 == 1 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

TEST_F(CheckpointFileTest, HasTheLayoutOfTheDocument) {
  { CheckpointFile(path_).Write(Bytes("payload")); }
  const std::string file = BytesOf(path_);
  ASSERT_EQ(file.size(), 3U * 16384U);
  const std::size_t slot = file.find("swcheck1");
  EXPECT_EQ(slot % 16384, 0U);
  using namespace std::string_literals;
  const std::string before = "swcheck1\1\0\0\0\0\0\0\0\7\0\0\0\0\0\0\0\0\0\0\0"s;
  EXPECT_EQ(file.substr(slot, 28), before);
  const std::uint32_t crc = Crc32BitByBit(before + "payload");
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(static_cast<unsigned char>(file[slot + 28 + i]), (crc >> (8 * i)) & 0xFF);
  }
  EXPECT_EQ(file.substr(slot + 32, 7), "payload");
}

TEST_F(CheckpointFileTest, GoesOnCountingAfterAReopen) {
  { CheckpointFile(path_).Write(Bytes("one")); }
  CheckpointFile file(path_);
  EXPECT_EQ(TextOf(file.ReadLatest()), "one");
  file.Write(Bytes("two"));
  EXPECT_EQ(ReadCheckpoint(path_)->sequence, 2U);
}

TEST_F(CheckpointFileTest, IgnoresTheRestOfALongerPayloadInTheSlot) {
  CheckpointFile file(path_);
  for (int i = 0; i < 3; ++i) file.Write(Bytes(std::string(500, 'x')));
  file.Write(Bytes("short"));
  EXPECT_EQ(TextOf(ReadCheckpoint(path_)), "short");
}

TEST_F(CheckpointFileTest, FallsBackOneWriteWhenAnyByteOfTheNewestIsDamaged) {
  {
    CheckpointFile file(path_);
    file.Write(Bytes("before"));
    file.Write(Bytes("newest"));
  }
  const std::string whole = BytesOf(path_);
  const std::size_t slot = whole.find("newest") - CheckpointFile::kHeader_bytes;
  for (std::size_t at = slot; at < slot + CheckpointFile::kHeader_bytes + 6; ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << bit));
      WriteBytes(path_, damaged);
      const std::optional<Checkpoint> read = ReadCheckpoint(path_);
      ASSERT_EQ(TextOf(read), "before") << at - slot;
      ASSERT_EQ(read->damaged_slots, 1);
    }
  }
}

TEST_F(CheckpointFileTest, FallsBackOneWriteWhenTheNewestIsTornAnywhere) {
  CheckpointFile file(path_);
  file.Write(Bytes("first"));
  file.Write(Bytes("second"));
  const std::string before = BytesOf(path_);
  file.Write(Bytes("third, a little longer"));
  const std::string after = BytesOf(path_);
  const std::size_t slot = after.find("third") - CheckpointFile::kHeader_bytes;
  const std::size_t length = CheckpointFile::kHeader_bytes + 22;
  for (std::size_t torn = 1; torn < length; ++torn) {
    WriteBytes(path_, before.substr(0, slot) + after.substr(slot, torn) + before.substr(slot + torn));
    ASSERT_EQ(TextOf(ReadCheckpoint(path_)), "second") << torn;
  }
}

// A power cut may leave any part of what was written since the last sync, in any order.
TEST_F(CheckpointFileTest, NeverTouchesTheSyncedStateHoweverManyWritesFollow) {
  CheckpointFile file(path_);
  file.Write(Bytes("warm up"));
  file.Write(Bytes("synced"));
  file.Sync();
  const std::string synced = BytesOf(path_);
  const std::size_t slot = synced.find("synced") - CheckpointFile::kHeader_bytes;
  for (int i = 0; i < 9; ++i) {
    file.Write(Bytes("later " + std::to_string(i)));
    const std::string now = BytesOf(path_);
    ASSERT_EQ(
        now.compare(slot, CheckpointFile::kSlotStride_bytes, synced, slot, CheckpointFile::kSlotStride_bytes),
        0);
  }
  // Both other slots are lost.
  std::string lost = BytesOf(path_);
  for (std::size_t i = 0; i < lost.size(); ++i) {
    if (i / CheckpointFile::kSlotStride_bytes != slot / CheckpointFile::kSlotStride_bytes) lost[i] = 'z';
  }
  WriteBytes(path_, lost);
  EXPECT_EQ(TextOf(ReadCheckpoint(path_)), "synced");
  EXPECT_EQ(ReadCheckpoint(path_)->damaged_slots, 2);
}

TEST_F(CheckpointFileTest, WritesOnOverADamagedSlot) {
  {
    CheckpointFile file(path_);
    for (const char* text : {"one", "two", "three"}) file.Write(Bytes(text));
  }
  std::string bytes = BytesOf(path_);
  bytes[bytes.find("three")] = 'T';
  WriteBytes(path_, bytes);
  CheckpointFile file(path_);
  EXPECT_EQ(TextOf(file.ReadLatest()), "two");
  for (int i = 0; i < 3; ++i) file.Write(Bytes("four"));
  EXPECT_EQ(TextOf(file.ReadLatest()), "four");
  EXPECT_EQ(file.ReadLatest()->sequence, 5U);
}

TEST_F(CheckpointFileTest, RefusesAStateOfWhichNothingIsGood) {
  { CheckpointFile(path_).Write(Bytes("only")); }
  std::string bytes = BytesOf(path_);
  bytes[bytes.find("only")] = 'O';
  WriteBytes(path_, bytes);
  const std::string message = "no good slot in the checkpoint '" + path_.string() + "': Bad message";
  EXPECT_EQ(MessageOf<DataFileError>([&] { ReadCheckpoint(path_); }), message);
  EXPECT_EQ(MessageOf<DataFileError>([&] { CheckpointFile file(path_); }), message);
}

TEST_F(CheckpointFileTest, RefusesAFileOfAnotherSize) {
  WriteBytes(path_, std::string(1000, 'x'));
  EXPECT_EQ(MessageOf<DataFileError>([&] { CheckpointFile file(path_); }),
            "not a checkpoint of 49152 bytes but one of 1000: '" + path_.string() + "': Bad message");
  EXPECT_EQ(MessageOf<DataFileError>([&] { ReadCheckpoint(folder_ / "none"); }),
            "cannot open the checkpoint '" + (folder_ / "none").string() + "': No such file or directory");
}

TEST_F(CheckpointFileTest, LosesAtMostTheWriteThatAKillInterrupts) {
  { CheckpointFile file(path_); }
  std::uint64_t last_known = 0;
  for (int round = 0; round < 30; ++round) {
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      CheckpointFile file(path_);
      std::vector<std::byte> payload(9000);
      while (true) {
        const std::uint64_t next = file.ReadLatest() ? file.ReadLatest()->sequence + 1 : 1;
        for (std::uint64_t i = next; i < next + 1000; ++i) {
          for (std::size_t at = 0; at < payload.size(); at += sizeof i)
            std::memcpy(&payload[at], &i, sizeof i);
          file.Write(payload);
          // Told outside only after the write returned: the ledger of the test.
          if (::write(ends[1], &i, sizeof i) != sizeof i) ::_exit(1);
        }
      }
    }
    ::close(ends[1]);
    std::uint64_t told{};
    for (int i = 0; i < 5 + round * 7; ++i) ASSERT_EQ(::read(ends[0], &told, sizeof told), 8);
    ::kill(child, SIGKILL);
    while (::read(ends[0], &told, sizeof told) == 8) {
    }
    ::close(ends[0]);
    ::waitpid(child, nullptr, 0);
    const std::optional<Checkpoint> left = ReadCheckpoint(path_);
    ASSERT_TRUE(left.has_value());
    ASSERT_GE(left->sequence, told);
    ASSERT_LE(left->sequence, told + 1);
    ASSERT_GT(left->sequence, last_known);
    std::uint64_t held{};
    std::memcpy(&held, left->payload.data() + 8992, sizeof held);
    ASSERT_EQ(held, left->sequence);
    last_known = left->sequence;
  }
}

}  // namespace
}  // namespace strainwave::daq::checkpoint_file_test
