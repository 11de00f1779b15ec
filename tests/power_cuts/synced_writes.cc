// SPDX-License-Identifier: Apache-2.0
// synced_writes checkpoint|rows FILE COUNT: opens a checkpoint, or makes a file of growing records, and gives
// it COUNT more states or blocks, each synced. Says which it held ("holds N"), which are synced ("synced N"),
// and what went wrong.
#include <cstddef>
#include <cstdio>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "daq/checkpoint_file.h"
#include "daq/growing_file.h"

namespace strainwave::daq {
namespace {

void WriteEach(std::uint64_t held, int count, const std::function<void(std::uint64_t)>& write) {
  std::printf("holds %lu\n", held);
  for (int i = 1; i <= count; ++i) {
    const std::uint64_t number = held + static_cast<std::uint64_t>(i);
    try {
      write(number);
      std::printf("synced %lu\n", number);
    } catch (const std::exception& error) {
      std::printf("%s\n", error.what());
    }
    // What was said before the power goes is said.
    std::fflush(stdout);
  }
}

void WriteStates(const char* path, int count) {
  CheckpointFile file(path);
  const auto held = file.ReadLatest();
  WriteEach(held ? held->sequence : 0, count, [&file](std::uint64_t number) {
    file.Write(std::vector<std::byte>(3000, static_cast<std::byte>(number)));
    file.Sync();
  });
}

void WriteRows(const char* path, int count) {
  GrowingFile file(path, {});
  NamedRecord named{.group = "load_run", .record = {}};
  named.record.kind = RecordKind::Named("load_run");
  Column column;
  column.name = "time_s";
  std::vector<double> values(1);
  WriteEach(0, count, [&](std::uint64_t number) {
    values.push_back(static_cast<double>(number));
    column.values = values;
    named.record.columns = {column};
    file.Append({&named, 1});
  });
}

}  // namespace
}  // namespace strainwave::daq

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  try {
    const auto write =
        std::string(argv[1]) == "rows" ? strainwave::daq::WriteRows : strainwave::daq::WriteStates;
    write(argv[2], std::stoi(argv[3]));
  } catch (const std::exception& error) {
    std::printf("%s\n", error.what());
    return 3;
  }
  return 0;
}
