// SPDX-License-Identifier: Apache-2.0
// Any text as the table of labels of a folder.
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "bench/data_sets/labels.h"
#include "bench/errors/bench_error.h"

namespace {

// A folder in memory with the one record that a label may name.
struct Folder {
  Folder() {
    std::filesystem::create_directories(path);
    std::ofstream(path / "a.csv") << "x\n";
  }
  ~Folder() { std::filesystem::remove_all(path); }
  std::filesystem::path path{"/dev/shm/strainwave_fuzz_labels_" + std::to_string(::getpid())};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::bench;
  static const Folder folder;
  std::ofstream(folder.path / "labels.csv", std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    const Labels labels = ReadLabels(folder.path);
    for (const std::string& column : labels.columns()) {
      try {
        (void)labels.Numbers(column, 0.0, 1.0);
      } catch (const BenchError&) {
      }
    }
  } catch (const BenchError& error) {
    if (error.exit_code() != ExitCode::kWrongInput) std::abort();
  }
  return 0;
}
