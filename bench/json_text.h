// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace strainwave::bench {

/// Reads JSON that may come from anywhere. The library reads any depth, and then copies and writes it by
/// calls as deep; it looks for a key of an ordered object in all that came before.
/// @throws nlohmann's exception for what is no JSON; std::invalid_argument for more than 64 MiB of text,
///   100 levels, 10000 keys of one object, or a million of all.
nlohmann::ordered_json ParseJson(std::string_view text);
/// The same, keys by name.
nlohmann::json ParseUnorderedJson(std::string_view text);

/// A value for a message: its text, of a long one the first 60 bytes.
std::string ShortText(const nlohmann::ordered_json& value);

}  // namespace strainwave::bench
