// SPDX-License-Identifier: Apache-2.0
// Any text as a file of users.
// seeds: tests/data/*users*.yaml
// longest: 16384
#include <cstdint>

#include "bench/accounts/users_file.h"
#include "tests/fuzz/text_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave;
  return CheckText<bench::UsersFileError>(
      data, size, [](const std::string& text) { (void)bench::ParseUsersFile(text, "any.yaml"); });
}
