// SPDX-License-Identifier: Apache-2.0
// What waits for a broker, in its file, with any bytes changed: it is read, or refused in words.
// longest: 512
#include <cstdint>
#include <cstdlib>

#include "bench/errors/bench_error.h"
#include "bench/monitor/outbox_store.h"
#include "tests/fuzz/folder_in_memory.h"
#include "tests/fuzz/patched_file.h"

namespace {

using namespace strainwave::bench;

std::vector<std::byte> AnOutbox(const FolderInMemory& folder) {
  {
    OutboxStore store(folder.path() / "made.db");
    store.Make(
        {.added = {strainwave::protocols::EncodeMetrics({{.name = "Window", .value = std::int64_t{1}}})},
         .last_window = 1});
    store.KeepNextBirth(3);
  }
  return folder.Read("made.db");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FolderInMemory folder;
  static const std::vector<std::byte> outbox = AnOutbox(folder);
  for (const char* beside : {"any.db-wal", "any.db-shm", "any.db-journal"})
    std::filesystem::remove(folder.path() / beside);
  const auto file = folder.Write("any.db", Patched(outbox, {data, size}));
  try {
    OutboxStore store(file);
    (void)store.Entries();
    if (store.next_birth() < 0 || store.next_birth() > 255) std::abort();
    (void)store.last_window();
    (void)store.dropped();
  } catch (const DatabaseError&) {
  } catch (const BenchError&) {
  }
  return 0;
}
