// SPDX-License-Identifier: Apache-2.0
// The values of a map that are lists or maps themselves.
#include <fmt/format.h>

#include <stdexcept>

#include "schedules/reader/yaml_expectation.h"
#include "schedules/reader/yaml_map.h"
#include "schedules/reader/yaml_text.h"

namespace strainwave::schedules {
namespace {

constexpr std::size_t kMostItems = 200;

}  // namespace

std::vector<double> YamlMap::QuantityList(std::string_view key, Dimension dimension, Bound bound,
                                          std::optional<std::string_view> default_text) {
  const Entry* entry = Find(key);
  if (entry == nullptr || entry->value->type != YamlNode::Type::kSequence) {
    return {Quantity(key, dimension, bound, default_text)};
  }
  known_.emplace_back(key);
  const YamlNode& list = *entry->value;
  const std::string expectation = Expectation(dimension, bound);
  context_->origins[PathOf(key)] = {list.line, list.column, {}, false};
  if (list.children.empty() || list.children.size() > kMostItems) {
    Wrong(key, list,
          fmt::format("{} has {} items (expected 1 to {})", key, list.children.size(), kMostItems));
    return {1.0};
  }
  std::vector<double> values;
  for (const YamlNode& item : list.children) {
    const std::string item_key = fmt::format("{}[{}]", key, values.size());
    values.push_back(1.0);
    if (item.type != YamlNode::Type::kScalar) {
      Wrong(item_key, item,
            fmt::format("{} is {} (expected {})", item_key, TypeText(item.type), expectation));
      MarkWrong(key);
      continue;
    }
    try {
      const double value = Bounded(ParseQuantity(item.text, dimension), bound, expectation);
      context_->origins[PathOf(item_key)] = {item.line, item.column, Shortened(item.text), false};
      if (IsBeyond(item_key, item, dimension, value)) {
        MarkWrong(key);
      } else {
        values.back() = value;
      }
    } catch (const std::invalid_argument& error) {
      Wrong(item_key, item, fmt::format("{} = {}: {}", item_key, Shortened(item.text), error.what()));
      MarkWrong(key);
    }
  }
  return values;
}

std::vector<std::string> YamlMap::TextList(std::string_view key) {
  const Entry* entry = Find(key);
  if (entry == nullptr) {
    known_.emplace_back(key);
    return {};
  }
  if (entry->value->type != YamlNode::Type::kSequence) return {Text(key)};
  known_.emplace_back(key);
  const YamlNode& list = *entry->value;
  context_->origins[PathOf(key)] = {list.line, list.column, {}, false};
  std::vector<std::string> texts;
  for (const YamlNode& item : list.children) {
    if (item.type != YamlNode::Type::kScalar || item.text.empty()) {
      Wrong(key, item,
            fmt::format("{}[{}] is {} (expected one line of text)", key, texts.size(), TypeText(item.type)));
      return {};
    }
    texts.push_back(item.text);
  }
  return texts;
}

YamlMap YamlMap::Map(std::string_view key, Presence presence) {
  const std::string expectation = "a section with keys of its own";
  const Entry* entry = Ask(key, expectation, presence == Presence::kRequired);
  if (entry == nullptr) {
    return {nullptr, PathOf(key), line_, column_, presence == Presence::kRequired, *context_};
  }
  const YamlNode& value = *entry->value;
  context_->origins[PathOf(key)] = {entry->key->line, entry->key->column, {}, false};
  const bool is_map = value.type == YamlNode::Type::kMap;
  const bool is_empty = value.type == YamlNode::Type::kNull;  // a section with nothing in it
  if (!is_map && !is_empty) {
    Wrong(key, value, fmt::format("{} is {} (expected {})", key, TypeText(value.type), expectation));
  }
  return {is_map ? &value : nullptr, PathOf(key),          entry->key->line,
          entry->key->column,        !is_map && !is_empty, *context_};
}

std::vector<YamlMap> YamlMap::MapList(std::string_view key, Presence presence) {
  const std::string expectation = "a list whose items begin with '- '";
  const Entry* entry = Ask(key, expectation, presence == Presence::kRequired);
  if (entry == nullptr) return {};
  const YamlNode& list = *entry->value;
  context_->origins[PathOf(key)] = {entry->key->line, entry->key->column, {}, false};
  if (list.type == YamlNode::Type::kNull && presence == Presence::kOptional) return {};
  if (list.type != YamlNode::Type::kSequence) {
    const bool is_null = list.type == YamlNode::Type::kNull;
    Wrong(
        key, is_null ? *entry->key : list,
        fmt::format("{} {} {} (expected {})", key, is_null ? "has" : "is", TypeText(list.type), expectation));
    return {};
  }
  const std::size_t least = presence == Presence::kRequired ? 1 : 0;
  if (list.children.size() < least || list.children.size() > kMostItems) {
    Wrong(key, list,
          fmt::format("{} has {} items (expected {} to {})", key, list.children.size(), least, kMostItems));
    return {};
  }
  std::vector<YamlMap> maps;
  for (const YamlNode& item : list.children) {
    if (item.type != YamlNode::Type::kMap) {
      Wrong(key, item,
            fmt::format("an item of {} is {} (expected keys with values)", key, TypeText(item.type)));
      continue;
    }
    const std::string item_key = fmt::format("{}[{}]", key, maps.size());
    context_->origins[PathOf(item_key)] = {item.line, item.column, {}, false};
    maps.push_back(YamlMap(&item, PathOf(item_key), item.line, item.column, false, *context_));
  }
  return maps;
}

std::vector<std::pair<std::string, YamlMap>> YamlMap::NamedMaps(std::string_view key, Presence presence) {
  YamlMap map = Map(key, presence);
  std::vector<std::pair<std::string, YamlMap>> maps;
  for (const Entry& entry : map.entries_)
    maps.emplace_back(entry.key->text, map.Map(entry.key->text, Presence::kRequired));
  map.Finish();
  return maps;
}

std::vector<std::pair<std::string, std::string>> YamlMap::TextMap(std::string_view key) {
  YamlMap map = Map(key, Presence::kOptional);
  std::vector<std::pair<std::string, std::string>> texts;
  for (const Entry& entry : map.entries_) texts.emplace_back(entry.key->text, map.Text(entry.key->text));
  map.Finish();
  return texts;
}

std::vector<std::pair<std::string, double>> YamlMap::NumberMap(std::string_view key) {
  YamlMap map = Map(key, Presence::kOptional);
  std::vector<std::pair<std::string, double>> numbers;
  for (const Entry& entry : map.entries_) {
    numbers.emplace_back(entry.key->text, map.Number(entry.key->text, Bound::kAny));
  }
  map.Finish();
  return numbers;
}

}  // namespace strainwave::schedules
