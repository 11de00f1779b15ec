// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "daq/csv_text.h"
#include "daq/import/foreign_file.h"
#include "daq/record_error.h"
#include "daq/record_limits.h"
#include "daq/whole_file.h"

// Universal files: data sets between lines that are -1 alone. Read are sets 58 and 58b, functions at a node.
// Source: docs/sources.md#uff.
namespace strainwave::daq {
namespace {

constexpr std::string_view kBorder = "    -1";

std::string_view Field(std::string_view line, std::size_t first, std::size_t width) {
  return first < line.size() ? Trim(line.substr(first, width)) : std::string_view();
}

// Of a fixed field; Fortran's D is an exponent, and so is none at all: 1.5-103.
std::optional<double> NumberOf(std::string_view text) {
  text = Trim(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  std::string plain(text);
  std::ranges::replace_if(
      plain, [](char c) { return c == 'D' || c == 'd'; }, 'e');
  const std::size_t sign = plain.find_first_of("+-", 1);
  if (sign != plain.npos && plain[sign - 1] != 'e' && plain[sign - 1] != 'E') plain.insert(sign, "e");
  if (const std::size_t plus = plain.find("e+"); plus != plain.npos) plain.erase(plus + 1, 1);
  double value{};
  const auto [end, error] = std::from_chars(plain.data(), plain.data() + plain.size(), value);
  if (error != std::errc() || end != plain.data() + plain.size()) return std::nullopt;
  return value;
}

// The step is written with six digits: of the rates that it may be of, the whole one.
double RateOf_hz(double step_s) {
  const double whole_hz = std::round(1.0 / step_s);
  const bool fits = whole_hz > 0.0 && fmt::format("{:.5E}", 1.0 / whole_hz) == fmt::format("{:.5E}", step_s);
  return fits ? whole_hz : 1.0 / step_s;
}

struct Header {
  std::string name;
  std::string unit;
  int function{};
  int ordinate{};  // 2, 4: real single, double; 5, 6: complex
  std::size_t count{};
  bool even{};
  double first{};
  double step{};
  int abscissa{};
};

class UffReader {
 public:
  explicit UffReader(const std::filesystem::path& path)
      : path_(path.string()), text_(ReadWholeFile(path)), rest_(text_) {}

  ForeignFile Read() {
    file_.format = "UFF 58";
    while (const std::optional<std::string_view> line = NextLine()) {
      if (Trim(*line).empty()) continue;
      if (Trim(*line) != "-1")
        Refuse(fmt::format("{} stands between data sets", Quoted(*line)), "a line that is -1 alone");
      const std::optional<std::string_view> type = NextLine();
      if (!type) break;  // a border too many at the end
      const std::string_view set = Trim(type->substr(0, std::min<std::size_t>(type->size(), 6)));
      if (set == "58") {
        const bool binary = type->size() > 6 && (*type)[6] == 'b';
        ReadSet(binary ? std::optional<std::string>(*type) : std::nullopt);
      } else {
        Skip(set);
      }
    }
    if (file_.channels.empty())
      throw RecordError(path_, "holds no data set 58", "one at least; these were met: " + Skipped());
    if (!skipped_.empty()) file_.notes.push_back(fmt::format("data sets that are not read: {}", Skipped()));
    return std::move(file_);
  }

 private:
  [[noreturn]] void Refuse(const std::string& what, const std::string& expected) const {
    throw RecordError(fmt::format("{}:{}", path_, line_), what, expected + Whole());
  }
  // Where the file breaks off: what came before it.
  std::string Whole() const {
    return fmt::format("; before it {} {} whole", file_.channels.size(),
                       file_.channels.size() == 1 ? "function is" : "functions are");
  }
  std::string Skipped() const { return skipped_.empty() ? "none" : skipped_; }

  std::optional<std::string_view> NextLine() {
    if (rest_.empty()) return std::nullopt;
    ++line_;
    return TakeLine(rest_).text;
  }
  std::string_view NeedLine() {
    const std::optional<std::string_view> line = NextLine();
    if (!line) Refuse("the file is cut off", "the rest of data set 58");
    return *line;
  }

  void Skip(std::string_view set) {
    const std::string name(set);
    if (skipped_.find(name) == skipped_.npos) skipped_ += (skipped_.empty() ? "" : ", ") + name;
    while (const std::optional<std::string_view> line = NextLine()) {
      if (Trim(*line) == "-1") return;
    }
    Refuse(fmt::format("data set {} has no end", set), "a line that is -1 alone");
  }

  int WholeNumber(std::string_view line, std::size_t first, std::size_t width, std::string_view what) const {
    const std::optional<double> number = NumberOf(Field(line, first, width));
    if (!number || *number != std::floor(*number) || std::abs(*number) > 2e9)
      Refuse(fmt::format("{} is {}", what, Quoted(Field(line, first, width))), "a whole number");
    return static_cast<int>(*number);
  }

  Header ReadHeader() {
    Header header;
    std::array<std::string_view, 5> ids;
    for (std::string_view& id : ids) id = NeedLine();
    const std::string_view place = NeedLine();
    const std::string_view form = NeedLine();
    const std::string_view abscissa = NeedLine();
    const std::string_view ordinate = NeedLine();
    NeedLine();  // of a denominator
    NeedLine();  // of a third axis
    header.function = WholeNumber(place, 0, 5, "the type of function");
    const std::string_view id = Trim(ids[0]);
    const std::string node(Field(place, 41, 10));
    header.name = id.empty() || id == "NONE"
                      ? fmt::format("{}:{}:{}", Field(place, 31, 10), node, Field(place, 51, 4))
                      : std::string(id);
    header.ordinate = WholeNumber(form, 0, 10, "the form of the numbers");
    const int count = WholeNumber(form, 10, 10, "the number of values");
    if (count < 1) Refuse(fmt::format("the number of values is {}", count), "1 or more");
    header.count = static_cast<std::size_t>(count);
    header.even = WholeNumber(form, 20, 10, "the spacing") == 1;
    header.first = NumberOf(Field(form, 30, 13)).value_or(0.0);
    header.step = NumberOf(Field(form, 43, 13)).value_or(0.0);
    header.abscissa = WholeNumber(abscissa, 0, 10, "the quantity of the abscissa");
    header.unit = std::string(Field(ordinate, 47, 20));
    if (header.unit == "NONE") header.unit.clear();
    if (header.even && !(header.step > 0.0))
      Refuse(fmt::format("the abscissa goes on by {}", header.step), "more than 0");
    if (header.count > kMostValues - values_)
      Refuse(fmt::format("{} values", header.count), fmt::format("{} in the file at most", kMostValues));
    return header;
  }

  void ReadSet(const std::optional<std::string>& binary) {
    const int first_line = line_;
    const Header header = ReadHeader();
    const bool complex = header.ordinate == 5 || header.ordinate == 6;
    const bool wide = header.ordinate == 4 || header.ordinate == 6;
    if (!complex && !wide && header.ordinate != 2)
      Refuse(fmt::format("the form of the numbers is {}", header.ordinate), "2, 4, 5 or 6");
    // Numbers of a value: its abscissa where they are uneven, its real and imaginary part.
    const std::size_t each = (header.even ? 1U : 2U) + (complex ? 1U : 0U);
    const std::vector<double> numbers =
        binary ? Binary(*binary, header.count * each, wide, header) : Text(header, each, wide);
    if (header.function != 1 || complex || (header.abscissa != 17 && header.abscissa != 0)) {
      file_.notes.push_back(fmt::format("line {}: function '{}' is left out: it is no {}", first_line,
                                        header.name, complex ? "real series" : "response over time"));
      return;
    }
    values_ += header.count;
    ForeignChannel channel{.name = header.name, .unit = header.unit, .values = {}, .words = {}};
    if (header.even) {
      channel.values = numbers;
      channel.sample_rate_hz = RateOf_hz(header.step);
      channel.start_s = header.first;
    } else {
      ForeignChannel time{.name = header.name + " time", .unit = "s", .values = {}, .words = {}};
      for (std::size_t i = 0; i < header.count; ++i) {
        time.values.push_back(numbers[2 * i]);
        channel.values.push_back(numbers[2 * i + 1]);
      }
      file_.channels.push_back(std::move(time));
    }
    file_.channels.push_back(std::move(channel));
  }

  // Fields of 13 letters, or 20 where numbers are double; an abscissa has 13 in either case.
  std::vector<double> Text(const Header& header, std::size_t each, bool wide) {
    std::vector<double> numbers;
    const std::size_t count = header.count * each;
    while (numbers.size() < count) {
      const std::string_view line = NeedLine();
      if (Trim(line) == "-1")
        Refuse(fmt::format("the function ends after {} of {} values", numbers.size() / each, header.count),
               "all of them");
      for (std::size_t at = 0; at < line.size() && numbers.size() < count;) {
        const bool abscissa = !header.even && numbers.size() % each == 0;
        const std::size_t width = wide && !abscissa ? 20 : 13;
        const std::string_view field = Trim(line.substr(at, width));
        at += width;
        if (field.empty()) continue;
        const std::optional<double> number = NumberOf(field);
        if (!number || !std::isfinite(*number)) Refuse(Quoted(field) + " is no number", "a finite number");
        numbers.push_back(*number);
      }
    }
    if (Trim(NeedLine()) != "-1")
      Refuse(fmt::format("more than {} values", header.count), "a line that is -1 alone");
    return numbers;
  }

  std::vector<double> Binary(const std::string& type, std::size_t count, bool wide, const Header& header) {
    const int order = WholeNumber(type, 7, 6, "the order of bytes");
    const int form = WholeNumber(type, 13, 6, "the form of binary numbers");
    if (form != 2) Refuse(fmt::format("the form of binary numbers is {}", form), "2, IEEE 754");
    if (order != 1 && order != 2) Refuse(fmt::format("the order of bytes is {}", order), "1 or 2");
    file_.format = "UFF 58b";
    const std::size_t width = wide ? 8 : 4;
    const bool uneven_wide = wide && !header.even;  // then the abscissa is single
    const std::size_t each = header.even ? 1 : 2;
    const std::size_t bytes = uneven_wide ? count / each * (4 + width * (each - 1)) : count * width;
    if (rest_.size() < bytes)
      Refuse(fmt::format("the file is cut off: {} of {} bytes of values are there", rest_.size(), bytes),
             "a whole file");
    const std::optional<double> said = NumberOf(Field(type, 31, 12));
    if (said && *said != static_cast<double>(bytes))
      file_.notes.push_back(fmt::format("line {}: the file says {:g} bytes of values; {} values take {}",
                                        line_, *said, header.count, bytes));
    std::vector<double> numbers;
    const char* at = rest_.data();
    const bool swap = (order == 2) == (std::endian::native == std::endian::little);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t here = uneven_wide && i % each == 0 ? 4 : width;
      std::array<char, 8> raw{};
      std::memcpy(raw.data(), at, here);
      if (swap) std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(here));
      at += here;
      if (here == 8) {
        numbers.push_back(std::bit_cast<double>(raw));
      } else {
        std::array<char, 4> narrow{};
        std::memcpy(narrow.data(), raw.data(), narrow.size());
        numbers.push_back(static_cast<double>(std::bit_cast<float>(narrow)));
      }
    }
    rest_.remove_prefix(bytes);
    // Some writers put a line end between the values and the border.
    std::size_t ends = 0;
    while (ends < rest_.size() && (rest_[ends] == '\r' || rest_[ends] == '\n')) ++ends;
    rest_.remove_prefix(ends);
    if (!rest_.starts_with(kBorder) && !Trim(rest_.substr(0, rest_.find('\n'))).starts_with("-1"))
      Refuse("the values are not followed by a line that is -1 alone", "as many bytes as the header says");
    NextLine();
    return numbers;
  }

  std::string path_;
  std::string text_;
  std::string_view rest_;
  int line_{};
  std::size_t values_{};
  std::string skipped_;
  ForeignFile file_;
};

}  // namespace

ForeignFile ReadUffFile(const std::filesystem::path& path) { return UffReader(path).Read(); }

}  // namespace strainwave::daq
