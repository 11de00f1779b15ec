// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/yaml_map.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <stdexcept>

#include "schedules/reader/wording.h"
#include "schedules/reader/yaml_expectation.h"
#include "schedules/reader/yaml_text.h"

namespace strainwave::schedules {
namespace {

constexpr std::size_t kLongestLine = 200;
constexpr const char* kOneLine = "one line of 1 to 200 characters";

bool IsOneLine(const std::string& text) {
  return !text.empty() && text.size() <= kLongestLine && text.find('\n') == std::string::npos;
}

}  // namespace

YamlMap::YamlMap(const YamlNode& root, ReadContext& context)
    : YamlMap(&root, {}, root.line, root.column, false, context) {}

YamlMap::YamlMap(const YamlNode* node, std::string path, int line, int column, bool quiet,
                 ReadContext& context)
    : path_(std::move(path)), line_(line), column_(column), quiet_(quiet), context_(&context) {
  if (node == nullptr) return;
  std::map<std::string_view, int> lines;
  for (std::size_t i = 0; i + 1 < node->children.size(); i += 2) {
    const YamlNode& key = node->children[i];
    if (key.type != YamlNode::Type::kScalar) {
      context.findings.AddError(key.line, key.column,
                                fmt::format("a key is {} (expected a word)", TypeText(key.type)));
      continue;
    }
    const auto [first, is_new] = lines.emplace(key.text, key.line);
    if (!is_new) {
      context.findings.AddError(
          key.line, key.column,
          fmt::format("key '{}' is there twice (expected once; it is already on line {})",
                      Shortened(key.text), first->second));
      continue;
    }
    entries_.push_back({&key, &node->children[i + 1]});
  }
}

std::string YamlMap::PathOf(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

bool YamlMap::is_wrong(std::string_view key) const {
  const auto origin = context_->origins.find(PathOf(key));
  return origin != context_->origins.end() && origin->second.wrong;
}

void YamlMap::AddError(std::string_view key, std::string message) {
  if (is_wrong(key)) return;
  const Origin& origin = context_->origins[PathOf(key)];
  context_->findings.AddError(origin.line, origin.column, std::move(message));
}

const YamlMap::Entry* YamlMap::Find(std::string_view key) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const Entry& entry) { return entry.key->text == key; });
  return found == entries_.end() ? nullptr : &*found;
}

const YamlMap::Entry* YamlMap::Ask(std::string_view key, std::string expectation, bool required) {
  known_.emplace_back(key);
  const Entry* entry = Find(key);
  if (entry == nullptr && required) {
    missing_.emplace_back(key, std::move(expectation));
    MarkWrong(key);
  }
  return entry;
}

void YamlMap::MarkWrong(std::string_view key) {
  Origin& origin = context_->origins[PathOf(key)];
  if (origin.line == 0) origin = {line_, column_, {}, true};
  origin.wrong = true;
}

void YamlMap::Wrong(std::string_view key, const YamlNode& at, std::string message) {
  context_->findings.AddError(at.line, at.column, std::move(message));
  context_->origins[PathOf(key)] = {at.line, at.column, Shortened(at.text), true};
}

std::optional<std::string> YamlMap::Scalar(std::string_view key, const std::string& expectation,
                                           std::optional<std::string_view> default_text) {
  const Entry* entry = Ask(key, expectation, !default_text);
  if (entry == nullptr) {
    if (!default_text) return std::nullopt;
    context_->origins[PathOf(key)] = {0, 0, std::string(*default_text), false};
    return std::string(*default_text);
  }
  const YamlNode& value = *entry->value;
  if (value.type != YamlNode::Type::kScalar) {
    const bool is_null = value.type == YamlNode::Type::kNull;
    Wrong(key, is_null ? *entry->key : value,
          fmt::format("{} {} {} (expected {})", key, is_null ? "has" : "is", TypeText(value.type),
                      expectation));
    return std::nullopt;
  }
  context_->origins[PathOf(key)] = {value.line, value.column, Shortened(value.text), false};
  return value.text;
}

template <typename Value, typename Parse>
Value YamlMap::Read(std::string_view key, const std::string& expectation,
                    std::optional<std::string_view> default_text, Value stand_in, Parse parse) {
  const std::optional<std::string> text = Scalar(key, expectation, default_text);
  if (!text) return stand_in;
  try {
    return parse(*text);
  } catch (const std::invalid_argument& error) {
    const Entry* entry = Find(key);
    if (entry == nullptr) throw;  // a default that does not parse is this program's mistake
    Wrong(key, *entry->value, fmt::format("{} = {}: {}", key, Shortened(*text), error.what()));
    return stand_in;
  }
}

bool YamlMap::IsBeyond(std::string_view key, const YamlNode& at, std::optional<Dimension> dimension,
                       double value) {
  const std::string beyond = BeyondBound(context_->bounds, PathOf(key), dimension, value);
  if (beyond.empty()) return false;
  Wrong(key, at, fmt::format("{} = {} {}", key, Shortened(at.text), beyond));
  return true;
}

// A default is this program's own.
double YamlMap::WithinBound(std::string_view key, std::optional<Dimension> dimension, double value) {
  const Entry* entry = Find(key);
  const bool beyond = entry != nullptr && !is_wrong(key) && IsBeyond(key, *entry->value, dimension, value);
  return beyond ? 1.0 : value;
}

double YamlMap::Quantity(std::string_view key, Dimension dimension, Bound bound,
                         std::optional<std::string_view> default_text) {
  const std::string expectation = Expectation(dimension, bound);
  const double value = Read(key, expectation, default_text, 1.0, [&](const std::string& text) {
    return Bounded(ParseQuantity(text, dimension), bound, expectation);
  });
  return WithinBound(key, dimension, value);
}

std::optional<double> YamlMap::OptionalQuantity(std::string_view key, Dimension dimension, Bound bound) {
  if (Find(key) == nullptr) {
    known_.emplace_back(key);
    return std::nullopt;
  }
  return Quantity(key, dimension, bound);
}

double YamlMap::Number(std::string_view key, Bound bound, std::optional<std::string_view> default_text) {
  const std::string expectation = fmt::format("a number{}", BoundText(bound));
  const double value = Read(key, expectation, default_text, 1.0, [&](const std::string& text) {
    return Bounded(ParseNumber(text), bound, expectation);
  });
  return WithinBound(key, std::nullopt, value);
}

int YamlMap::Count(std::string_view key, int least, int most, std::optional<std::string_view> default_text) {
  const std::string expectation = fmt::format("a whole number from {} to {}", least, most);
  return Read(key, expectation, default_text, least, [&](const std::string& text) {
    const double value = ParseNumber(text);
    if (value != std::floor(value))
      throw std::invalid_argument(fmt::format("not whole (expected {})", expectation));
    if (value < least || value > most) {
      throw std::invalid_argument(fmt::format("out of range (expected {})", expectation));
    }
    return static_cast<int>(value);
  });
}

std::int64_t YamlMap::Integer(std::string_view key, std::int64_t least, std::int64_t most,
                              std::optional<std::string_view> default_text) {
  const std::string expectation =
      fmt::format("a whole number from {} to {}, decimal or 0x and hexadecimal digits", least, most);
  return Read(key, expectation, default_text, least, [&](const std::string& text) {
    const bool is_hex = text.starts_with("0x") || text.starts_with("0X");
    const char* const end = text.data() + text.size();
    std::int64_t value{};
    const auto [read_to, error] =
        std::from_chars(text.data() + (is_hex ? 2 : 0), end, value, is_hex ? 16 : 10);
    if (error == std::errc::invalid_argument || read_to != end) {
      throw std::invalid_argument(fmt::format("not whole (expected {})", expectation));
    }
    if (error != std::errc() || value < least || value > most) {
      throw std::invalid_argument(fmt::format("out of range (expected {})", expectation));
    }
    return value;
  });
}

bool YamlMap::Flag(std::string_view key, std::optional<std::string_view> default_text) {
  return Choice<bool>(key, {{"true", true}, {"false", false}}, default_text);
}

std::string YamlMap::Text(std::string_view key, std::optional<std::string_view> default_text) {
  return Read(key, kOneLine, default_text, std::string(), [&](const std::string& text) {
    const bool from_file = Find(key) != nullptr;
    if (from_file && !IsOneLine(text)) {
      throw std::invalid_argument(fmt::format("not usable (expected {})", kOneLine));
    }
    return text;
  });
}

std::string YamlMap::Secret(std::string_view key, std::optional<std::string_view> default_text) {
  const std::optional<std::string> text = Scalar(key, kOneLine, default_text);
  if (!text || Find(key) == nullptr) return text.value_or("");
  context_->origins[PathOf(key)].text.clear();
  if (IsOneLine(*text)) return *text;
  AddError(key,
           fmt::format("{} is not usable (expected {}; it may be secret and is not shown)", key, kOneLine));
  MarkWrong(key);
  return {};
}

std::string YamlMap::Identifier(std::string_view key, std::optional<std::string_view> default_text) {
  const std::string expectation = "1 to 64 letters, digits, '-' and '_'";
  return Read(key, expectation, default_text, std::string(), [&](const std::string& text) {
    const bool plain = std::all_of(text.begin(), text.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
             c == '_';
    });
    if (text.empty() || text.size() > 64 || !plain) {
      throw std::invalid_argument(fmt::format("not usable as a name (expected {})", expectation));
    }
    return text;
  });
}

std::size_t YamlMap::ChoiceIndex(std::string_view key, std::span<const std::string_view> words,
                                 std::optional<std::string_view> default_text) {
  const std::string expectation = Alternatives(words);
  return Read(key, expectation, default_text, std::size_t{0}, [&](const std::string& text) {
    const auto found = std::find(words.begin(), words.end(), text);
    if (found == words.end()) {
      const std::optional<std::string> near = NearestWord(text, words);
      throw std::invalid_argument(
          near ? fmt::format("not known; did you mean '{}'? (expected {})", *near, expectation)
               : fmt::format("not known (expected {})", expectation));
    }
    return static_cast<std::size_t>(found - words.begin());
  });
}

void YamlMap::Version(std::string_view key) {
  const std::string expectation = fmt::format("'{}: 1', the version of the format", key);
  Read(key, expectation, std::nullopt, 1, [&](const std::string& text) {
    if (text != "1")
      throw std::invalid_argument(fmt::format("not a known version (expected {})", expectation));
    return 1;
  });
}

void YamlMap::Finish(OtherKeys others) {
  const std::vector<std::string_view> known(known_.begin(), known_.end());
  for (const Entry& entry : entries_) {
    const std::string& key = entry.key->text;
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const std::optional<std::string> near = NearestWord(key, known);
    if (!near && others == OtherKeys::kUncertain) continue;
    context_->findings.AddError(
        entry.key->line, entry.key->column,
        near ? fmt::format("unknown key '{}', did you mean '{}'? (expected {})", Shortened(key), *near,
                           fmt::join(known, ", "))
             : fmt::format("unknown key '{}' (expected {})", Shortened(key), fmt::join(known, ", ")));
    // A misspelt key is one mistake, not two.
    std::erase_if(missing_, [&](const auto& missing) { return near && missing.first == *near; });
  }
  if (quiet_) return;
  for (const auto& [key, expectation] : missing_) {
    context_->findings.AddError(line_, column_,
                                fmt::format("missing key '{}' (expected {})", key, expectation));
  }
}

}  // namespace strainwave::schedules
