// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/json_property.h"

#include <stdexcept>

#include <fmt/core.h>
#include <sqlite3.h>
#include <nlohmann/json.hpp>

#include "bench/json_text.h"

namespace strainwave::bench {
namespace {

[[noreturn]] void Refuse(const Journal& journal, const char* key) {
  throw DatabaseError(
      journal.database().file(), SQLITE_CORRUPT,
      fmt::format("the property '{}' cannot be read (expected it as the program has kept it)", key));
}

}  // namespace

bool ReadJsonProperty(const Journal& journal, const char* key,
                      const std::function<void(const nlohmann::json&)>& take) {
  const auto text = journal.Property(key);
  if (!text) return false;
  try {
    take(ParseUnorderedJson(*text));
  } catch (const nlohmann::json::exception&) {
    Refuse(journal, key);
  } catch (const std::invalid_argument&) {
    Refuse(journal, key);
  }
  return true;
}

}  // namespace strainwave::bench
