// SPDX-License-Identifier: Apache-2.0
#include "bench/json_text.h"

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace strainwave::bench {
namespace {

// Counts while the text is read and nothing is kept; what is no JSON is left to the reading that follows.
class Counter : public nlohmann::json_sax<nlohmann::json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return Open(); }
  bool start_array(std::size_t) override { return Open(); }
  bool end_object() override { return Close(); }
  bool end_array() override { return Close(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }
  bool key(string_t&) override {
    constexpr std::size_t kMostOfOneObject = 10'000;
    constexpr std::size_t kMostInAll = 1'000'000;
    if (++keys_.back() > kMostOfOneObject) {
      throw std::invalid_argument(fmt::format("an object has more than {} keys", kMostOfOneObject));
    }
    if (++keys_in_all_ > kMostInAll) {
      throw std::invalid_argument(fmt::format("it has more than {} keys", kMostInAll));
    }
    return true;
  }

 private:
  bool Open() {
    constexpr std::size_t kDeepest = 100;
    if (keys_.size() == kDeepest) {
      throw std::invalid_argument(fmt::format("it is nested more than {} levels deep", kDeepest));
    }
    keys_.push_back(0);
    return true;
  }
  bool Close() {
    keys_.pop_back();
    return true;
  }

  std::vector<std::size_t> keys_;  // of each object that is open, and a zero for each array
  std::size_t keys_in_all_{};
};

void RequireBounds(std::string_view text) {
  constexpr std::size_t kMostText_bytes = std::size_t{64} << 20U;
  if (text.size() > kMostText_bytes) {
    throw std::invalid_argument(
        fmt::format("{} bytes of JSON are too many, at most 64 MiB are read", text.size()));
  }
  Counter counter;
  nlohmann::json::sax_parse(text, &counter);
}

}  // namespace

nlohmann::ordered_json ParseJson(std::string_view text) {
  RequireBounds(text);
  return nlohmann::ordered_json::parse(text);
}

nlohmann::json ParseUnorderedJson(std::string_view text) {
  RequireBounds(text);
  return nlohmann::json::parse(text);
}

std::string ShortText(const nlohmann::ordered_json& value) {
  constexpr std::size_t kLongest = 60;
  std::string text = value.dump(-1, ' ', true);  // in ASCII, to be cut anywhere
  if (text.size() > kLongest) text.replace(kLongest, std::string::npos, "...");
  return text;
}

}  // namespace strainwave::bench
