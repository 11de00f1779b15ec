// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "schedules/reader/bounds.h"
#include "schedules/reader/findings.h"
#include "schedules/reader/quantity.h"
#include "schedules/reader/yaml_node.h"

namespace strainwave::schedules {

/// What the reading of one file gathers, and how far its values may go where that is narrower than the widest
/// that a bench can have.
struct ReadContext {
  FindingList findings;
  Origins origins;
  std::span<const QuantityBound> bounds;
};

enum class Bound { kAny, kNotZero, kNotNegative, kPositive };

enum class Presence { kRequired, kOptional };

/// What becomes of keys that nobody asked for: `kUncertain` where it cannot be known which belong to the map,
/// and only those are reported that look like a misspelt one.
enum class OtherKeys { kRefused, kUncertain };

/// Reads one map of a file key by key. Every mistake becomes a finding and a stand-in value, so that one
/// reading finds all of them; the stand-in's origin is marked wrong. A value without a default is required.
///
/// Defaults are given as the text that a file would hold ("0.1 s").
/// `Finish` must be called once when every key has been asked for: it reports those that nobody asked for,
/// and the missing ones.
class YamlMap {
 public:
  /// The top of a file.
  YamlMap(const YamlNode& root, ReadContext& context);

  double Quantity(std::string_view key, Dimension dimension, Bound bound,
                  std::optional<std::string_view> default_text = {});
  std::optional<double> OptionalQuantity(std::string_view key, Dimension dimension, Bound bound);
  /// A list of quantities, or a single one.
  std::vector<double> QuantityList(std::string_view key, Dimension dimension, Bound bound,
                                   std::optional<std::string_view> default_text = {});
  double Number(std::string_view key, Bound bound, std::optional<std::string_view> default_text = {});
  /// A whole number from `least` to `most`.
  int Count(std::string_view key, int least, int most, std::optional<std::string_view> default_text = {});
  /// The same for numbers as a wire has them: up to 64 bits, decimal or hexadecimal (0x1018).
  std::int64_t Integer(std::string_view key, std::int64_t least, std::int64_t most,
                       std::optional<std::string_view> default_text = {});
  bool Flag(std::string_view key, std::optional<std::string_view> default_text = {});
  /// One line of 1 to 200 characters; a default may be empty.
  std::string Text(std::string_view key, std::optional<std::string_view> default_text = {});
  /// The same of what only some may know: no message repeats it.
  std::string Secret(std::string_view key, std::optional<std::string_view> default_text = {});
  /// A list of such lines, or a single one; an absent one is empty.
  std::vector<std::string> TextList(std::string_view key);
  /// Letters, digits, '-' and '_': what may name a folder or a group.
  std::string Identifier(std::string_view key, std::optional<std::string_view> default_text = {});

  template <typename Enum>
  Enum Choice(std::string_view key, std::initializer_list<std::pair<std::string_view, Enum>> choices,
              std::optional<std::string_view> default_text = {}) {
    std::vector<std::string_view> words;
    for (const auto& [word, value] : choices) words.push_back(word);
    return std::data(choices)[ChoiceIndex(key, words, default_text)].second;
  }

  /// The version of the format, which must be 1.
  void Version(std::string_view key);

  /// A section. An absent optional one answers every question with its default.
  YamlMap Map(std::string_view key, Presence presence);
  /// A list of maps, at most 200.
  std::vector<YamlMap> MapList(std::string_view key, Presence presence);
  /// Names that the file may choose freely, each with a section, a text or a number, in file order.
  std::vector<std::pair<std::string, YamlMap>> NamedMaps(std::string_view key, Presence presence);
  std::vector<std::pair<std::string, std::string>> TextMap(std::string_view key);
  std::vector<std::pair<std::string, double>> NumberMap(std::string_view key);

  void Finish(OtherKeys others = OtherKeys::kRefused);

  bool has(std::string_view key) const { return Find(key) != nullptr; }
  /// True when the key was asked for and a stand-in was given.
  bool is_wrong(std::string_view key) const;
  /// A finding of the caller's own about a key; none where the key has one already.
  void AddError(std::string_view key, std::string message);
  int line() const { return line_; }
  int column() const { return column_; }
  /// Of a key in the context's origins: "limits.output_torque".
  std::string PathOf(std::string_view key) const;

 private:
  struct Entry {
    const YamlNode* key;
    const YamlNode* value;
  };

  YamlMap(const YamlNode* node, std::string path, int line, int column, bool quiet, ReadContext& context);

  const Entry* Find(std::string_view key) const;
  /// Notes that `key` is known, and the expectation for the message when it is missing.
  const Entry* Ask(std::string_view key, std::string expectation, bool required);
  std::size_t ChoiceIndex(std::string_view key, std::span<const std::string_view> words,
                          std::optional<std::string_view> default_text);
  /// The scalar text of a key, or its default, with its origin noted; nothing after a finding.
  std::optional<std::string> Scalar(std::string_view key, const std::string& expectation,
                                    std::optional<std::string_view> default_text);
  /// The value that `parse` makes of a scalar; `stand_in` after a finding.
  template <typename Value, typename Parse>
  Value Read(std::string_view key, const std::string& expectation,
             std::optional<std::string_view> default_text, Value stand_in, Parse parse);
  /// Whether the file has a value at `at` that lies beyond its bound; that is a finding.
  bool IsBeyond(std::string_view key, const YamlNode& at, std::optional<Dimension> dimension, double value);
  double WithinBound(std::string_view key, std::optional<Dimension> dimension, double value);
  void Wrong(std::string_view key, const YamlNode& at, std::string message);
  void MarkWrong(std::string_view key);

  std::vector<Entry> entries_;
  std::string path_;
  int line_{};
  int column_{};
  bool quiet_{};  // the map itself is wrong: its keys are not reported as missing
  std::vector<std::string> known_;
  std::vector<std::pair<std::string, std::string>> missing_;  // key, expectation
  ReadContext* context_;
};

}  // namespace strainwave::schedules
