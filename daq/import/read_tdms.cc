// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "daq/csv_text.h"
#include "daq/import/foreign_file.h"
#include "daq/import/mapped_file.h"
#include "daq/import/tdms_types.h"
#include "daq/import/tdms_values.h"
#include "daq/large_memory.h"
#include "daq/record.h"
#include "daq/record_error.h"
#include "daq/record_limits.h"

// Segments, each with what is new in it and then numbers. Source: docs/sources.md#tdms.
namespace strainwave::daq {
namespace {

using namespace tdms;
using Property = std::variant<double, std::string>;

struct Object {
  std::string path;
  std::uint32_t type{};
  std::uint64_t count{};  // of values in a chunk
  bool has_index{};
  bool is_in_order{};  // its values are in a chunk
  std::map<std::string, Property> properties;
  std::vector<double> values;
};

class TdmsReader {
 public:
  explicit TdmsReader(const std::filesystem::path& path)
      : path_(path.string()), mapped_(path), bytes_(mapped_.text()) {}

  ForeignFile Read() {
    file_.format = "TDMS";
    while (at_ < bytes_.size()) ReadSegment();
    for (Object& object : objects_) TakeObject(object);
    if (file_.channels.empty())
      throw RecordError(path_, "holds no series of numbers", "one channel at least");
    return std::move(file_);
  }

 private:
  [[noreturn]] void Refuse(const std::string& what, const std::string& expected) const {
    throw RecordError(fmt::format("{}: byte {}", path_, at_), what, expected);
  }
  [[noreturn]] void RefuseCutOff() const {
    std::size_t least = kMostValues;
    for (const Object& object : objects_)
      if (object.type != 0) least = std::min(least, object.values.size());
    Refuse(fmt::format("the file is cut off within segment {}; {} values of each channel before it are whole",
                       segments_, objects_.empty() || least == kMostValues ? 0 : least),
           "a whole file");
  }

  template <typename Number>
  Number Take() {
    if (bytes_.size() - at_ < sizeof(Number)) RefuseCutOff();
    std::array<char, sizeof(Number)> raw{};
    std::memcpy(raw.data(), bytes_.data() + at_, raw.size());
    if (big_endian_ != (std::endian::native == std::endian::big)) std::ranges::reverse(raw);
    at_ += raw.size();
    return std::bit_cast<Number>(raw);
  }
  std::string TakeText() {
    const auto length = Take<std::uint32_t>();
    if (bytes_.size() - at_ < length) RefuseCutOff();
    std::string text(bytes_.substr(at_, length));
    at_ += length;
    return text;
  }
  double TakeNumber(std::uint32_t type) {
    const std::size_t width = WidthOf(type);
    if (width == 0)
      Refuse(fmt::format("a number of type {}", type), "an integer, a float, a boolean or a time");
    if (bytes_.size() - at_ < width) RefuseCutOff();
    std::vector<double> number;
    AppendNumbers(type, big_endian_, bytes_.data() + at_, width, 1, number);
    at_ += width;
    return number.front();
  }

  void ReadSegment() {
    ++segments_;
    const std::size_t lead = at_;
    big_endian_ = false;
    if (bytes_.size() - at_ < 28) RefuseCutOff();
    if (bytes_.substr(at_, 4) != "TDSm") Refuse("no segment begins here", "TDSm");
    at_ += 4;
    const auto contents = Take<std::uint32_t>();
    const auto bit = [contents](unsigned n) { return (contents >> n & 1U) != 0; };
    big_endian_ = bit(6);
    const auto version = Take<std::uint32_t>();
    if (version != 4712 && version != 4713) Refuse(fmt::format("version {}", version), "4712 or 4713");
    const auto next = Take<std::uint64_t>();
    const auto raw = Take<std::uint64_t>();
    const std::size_t body = at_;
    constexpr std::uint64_t kUnfinished = ~std::uint64_t{0};
    const bool unfinished = next == kUnfinished;
    if (!unfinished && next > bytes_.size() - body) RefuseCutOff();
    const std::size_t end = unfinished ? bytes_.size() : body + static_cast<std::size_t>(next);
    if (raw > end - body) Refuse("the values begin behind the segment's end", "within it");
    if (unfinished)
      file_.notes.push_back(
          fmt::format("segment {} at byte {} was not finished by its writer; its whole values are taken",
                      segments_, lead));
    if (bit(7)) RefuseDaqmx();
    if (bit(2)) {
      for (const std::size_t o : order_) objects_[o].is_in_order = false;
      order_.clear();
    }
    if (bit(1)) ReadObjects();
    at_ = body + static_cast<std::size_t>(raw);
    if (bit(3)) ReadValues(end, bit(5), unfinished);
    at_ = end;
  }

  [[noreturn]] void RefuseDaqmx() const {
    Refuse("the values are raw DAQmx data, whose scaling is not published",
           "plain values: export them with DIAdem or LabVIEW, or record without raw DAQmx data");
  }

  void ReadObjects() {
    const auto count = Take<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::string path = TakeText();
      const std::size_t o = ObjectOf(path);
      const auto index = Take<std::uint32_t>();
      constexpr std::uint32_t kNone = 0xFFFFFFFF;
      constexpr std::uint32_t kSame = 0;
      constexpr std::uint32_t kDaqmx = 0x1269;
      constexpr std::uint32_t kDigital = 0x1369;
      if (index == kDaqmx || index == kDigital) RefuseDaqmx();
      if (index == kSame) {
        if (!objects_[o].has_index)
          Refuse(fmt::format("{} has values as before, but had none", PlainPath(path)),
                 "a description of them");
        PutInOrder(o);
      } else if (index != kNone) {
        objects_[o].type = Take<std::uint32_t>();
        const auto dimensions = Take<std::uint32_t>();
        objects_[o].count = Take<std::uint64_t>();
        if (objects_[o].type == kString) Take<std::uint64_t>();
        if (dimensions != 1) Refuse(fmt::format("{} dimensions", dimensions), "1");
        if (objects_[o].type != kString && WidthOf(objects_[o].type) == 0)
          Refuse(fmt::format("{} has values of type {:#x}", PlainPath(path), objects_[o].type),
                 "integers, floats, booleans or times");
        if (objects_[o].type == kString) Refuse(fmt::format("{} holds texts", PlainPath(path)), "numbers");
        objects_[o].has_index = true;
        PutInOrder(o);
      }
      ReadProperties(objects_[o]);
    }
  }

  void ReadProperties(Object& object) {
    const auto count = Take<std::uint32_t>();
    for (std::uint32_t p = 0; p < count; ++p) {
      const std::string name = TakeText();
      const auto type = Take<std::uint32_t>();
      object.properties[name] = type == kString ? Property(TakeText()) : Property(TakeNumber(type));
    }
  }

  std::size_t ObjectOf(const std::string& path) {
    const auto [found, is_new] = by_path_.try_emplace(path, objects_.size());
    if (is_new) objects_.emplace_back().path = path;
    return found->second;
  }
  void PutInOrder(std::size_t object) {
    if (std::exchange(objects_[object].is_in_order, true)) return;
    order_.push_back(object);
  }

  // Chunks until the end of the segment, each with the values of all channels one after the other, or in
  // turn.
  void ReadValues(std::size_t end, bool interleaved, bool unfinished) {
    std::uint64_t chunk = 0;
    for (const std::size_t o : order_) {
      if (objects_[o].count > kMostValues)
        Refuse(fmt::format("{} values of a channel", objects_[o].count),
               fmt::format("{} at most", kMostValues));
      chunk += objects_[o].count * WidthOf(objects_[o].type);
      if (interleaved && objects_[o].count != objects_[order_.front()].count)
        Refuse(fmt::format("channels with {} and {} values in turn", objects_[order_.front()].count,
                           objects_[o].count),
               "channels of one length");
    }
    if (chunk == 0) return;
    for (const std::size_t o : order_) {
      const std::size_t chunks = (end - at_) / static_cast<std::size_t>(chunk);
      ReserveLarge(objects_[o].values,
                   objects_[o].values.size() + chunks * static_cast<std::size_t>(objects_[o].count));
    }
    while (at_ < end) {
      if (end - at_ < chunk) {
        if (interleaved) ReadInterleaved((end - at_) / RowBytes());
        if (!unfinished || !interleaved) {
          if (!unfinished) Refuse(fmt::format("{} bytes of a chunk of {}", end - at_, chunk), "whole chunks");
          file_.notes.push_back(
              fmt::format("{} bytes of an unfinished chunk at byte {} are left out", end - at_, at_));
        }
        return;
      }
      if (interleaved) {
        ReadInterleaved(static_cast<std::size_t>(objects_[order_.front()].count));
        continue;
      }
      for (const std::size_t o : order_) Append(objects_[o]);
    }
  }

  std::size_t RowBytes() const {
    std::size_t bytes = 0;
    for (const std::size_t o : order_) bytes += WidthOf(objects_[o].type);
    return bytes;
  }

  void CountValues(std::uint64_t count) {
    values_ += static_cast<std::size_t>(count);
    if (values_ > kMostValues) Refuse("too many values", fmt::format("{} in the file at most", kMostValues));
  }

  void ReadInterleaved(std::size_t rows) {
    CountValues(rows * order_.size());
    const std::size_t row_bytes = RowBytes();
    std::size_t first = at_;
    for (const std::size_t o : order_) {
      AppendNumbers(objects_[o].type, big_endian_, bytes_.data() + first, row_bytes, rows,
                    objects_[o].values);
      first += WidthOf(objects_[o].type);
    }
    at_ += rows * row_bytes;
  }

  void Append(Object& object) {
    CountValues(object.count);
    const std::size_t width = WidthOf(object.type);
    const auto count = static_cast<std::size_t>(object.count);
    AppendNumbers(object.type, big_endian_, bytes_.data() + at_, width, count, object.values);
    at_ += count * width;
  }

  const double* Number(const Object& object, const std::string& name) const {
    const auto found = object.properties.find(name);
    return found == object.properties.end() ? nullptr : std::get_if<double>(&found->second);
  }
  std::string Text(const Object& object, const std::string& name) const {
    const auto found = object.properties.find(name);
    const auto* const text =
        found == object.properties.end() ? nullptr : std::get_if<std::string>(&found->second);
    return text == nullptr ? "" : *text;
  }

  // What the writer says is still to be done to the values.
  void Scale(Object& object) const {
    const double* const scales = Number(object, "NI_Number_Of_Scales");
    if (scales == nullptr || Text(object, "NI_Scaling_Status") == "scaled") return;
    for (int s = 0; s < static_cast<int>(std::min(*scales, 100.0)); ++s) {
      const std::string prefix = fmt::format("NI_Scale[{}]_", s);
      const std::string type = Text(object, prefix + "Scale_Type");
      if (type == "Linear") {
        const double* const slope = Number(object, prefix + "Linear_Slope");
        const double* const intercept = Number(object, prefix + "Linear_Y_Intercept");
        for (double& value : object.values)
          value = (slope == nullptr ? 1.0 : *slope) * value + (intercept == nullptr ? 0.0 : *intercept);
      } else if (type == "Polynomial") {
        std::vector<double> coefficients;
        while (const double* const c =
                   Number(object, fmt::format("{}Polynomial_Coefficients[{}]", prefix, coefficients.size())))
          coefficients.push_back(*c);
        for (double& value : object.values) {
          double sum = 0.0;
          for (std::size_t c = coefficients.size(); c-- > 0;) sum = sum * value + coefficients[c];
          value = sum;
        }
      } else {
        throw RecordError(path_, fmt::format("{} is to be scaled by '{}'", PlainPath(object.path), type),
                          "Linear or Polynomial");
      }
    }
  }

  void TakeObject(Object& object) {
    const std::string name = PlainPath(object.path);
    if (object.values.empty()) {
      for (const auto& [key, value] : object.properties)
        file_.metadata.emplace_back(name.empty() ? key : fmt::format("{}.{}", name, key),
                                    std::holds_alternative<double>(value)
                                        ? ShortestText(std::get<double>(value))
                                        : std::get<std::string>(value));
      return;
    }
    Scale(object);
    ForeignChannel channel{
        .name = name, .unit = Text(object, "unit_string"), .values = std::move(object.values), .words = {}};
    const double* const step = Number(object, "wf_increment");
    if (step != nullptr && *step > 0.0) {
      channel.sample_rate_hz = 1.0 / *step;
      if (const double* const start = Number(object, "wf_start_offset")) channel.start_s = *start;
    }
    file_.channels.push_back(std::move(channel));
  }

  std::string path_;
  MappedFile mapped_;
  std::string_view bytes_;
  std::size_t at_{};
  bool big_endian_{};
  int segments_{};
  std::size_t values_{};
  std::vector<Object> objects_;
  std::unordered_map<std::string, std::size_t> by_path_;  // of objects
  std::vector<std::size_t> order_;                        // of the objects in a chunk
  ForeignFile file_;
};

}  // namespace

ForeignFile ReadTdmsFile(const std::filesystem::path& path) { return TdmsReader(path).Read(); }

}  // namespace strainwave::daq
