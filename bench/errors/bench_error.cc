// SPDX-License-Identifier: Apache-2.0
#include "bench/errors/bench_error.h"

#include <fmt/format.h>

namespace strainwave::bench {

void Refuse(const std::filesystem::path& where, const std::string& what, const std::string& expected) {
  throw BenchError(ExitCode::kWrongInput,
                   fmt::format("{}: error: {} (expected {})", where.string(), what, expected));
}

}  // namespace strainwave::bench
