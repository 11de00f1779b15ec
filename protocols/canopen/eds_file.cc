// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/eds_file.h"

#include <algorithm>
#include <charconv>
#include <set>
#include <stdexcept>
#include <tuple>

#include <fmt/format.h>

#include "protocols/canopen/ini_text.h"
#include "protocols/canopen/type_limits.h"

namespace strainwave::protocols::canopen {
namespace {

constexpr std::int64_t kMostSubindex = 254;  // 255 tells the structure of an object
constexpr std::uint8_t kAnyNode = 1;         // where only the form of a number is asked for

enum class ObjectKind : std::uint8_t { kDomain = 0x2, kVariable = 0x7, kArray = 0x8, kRecord = 0x9 };

template <typename Number>
std::optional<Number> HexOf(std::string_view digits) {
  Number number{};
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number, 16);
  if (error != std::errc() || end != digits.data() + digits.size() || digits.empty()) return std::nullopt;
  return number;
}

struct SectionAddress {
  ObjectAddress address;
  bool has_subindex{};
};

// "1018" and "1018sub1" in lower case; nothing for sections of another kind.
std::optional<SectionAddress> AddressOf(std::string_view section) {
  if (section.size() < 4) return std::nullopt;
  const auto index = HexOf<std::uint16_t>(section.substr(0, 4));
  if (!index) return std::nullopt;
  std::string_view rest = section.substr(4);
  if (rest.empty()) return SectionAddress{{*index, 0}, false};
  if (!rest.starts_with("sub")) return std::nullopt;
  const auto subindex = HexOf<std::uint8_t>(rest.substr(3));
  if (!subindex) return std::nullopt;
  return SectionAddress{{*index, *subindex}, true};
}

// "0x1F ; mask": CiA 306 knows comments at the beginning of a line alone, makers write them behind values.
std::string WithoutComment(std::string_view text) {
  text = text.substr(0, text.find(';'));
  const std::size_t end = text.find_last_not_of(" \t");
  return std::string(text.substr(0, end == std::string_view::npos ? 0 : end + 1));
}

// Some are not in UTF-8.
std::string Printable(std::string text) {
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return text;
}

class EdsReader {
 public:
  EdsReader(std::string_view text, std::string_view file_name)
      : file_name_(file_name), sections_(ParseIni(text, notes_)) {}

  EdsFile Read() {
    ReadDevice();
    std::set<std::uint16_t> listed = ReadLists();
    for (const auto& [name, section] : sections_) {
      const std::optional<SectionAddress> place = AddressOf(name);
      if (!place) continue;
      if (listed.insert(place->address.index).second) {
        Note(section, fmt::format("object {:04X} is in none of the lists (expected it in [MandatoryObjects], "
                                  "[OptionalObjects] or [ManufacturerObjects])",
                                  place->address.index));
      }
      if (place->has_subindex) {
        ReadSub(section, *place);
      } else {
        ReadObject(section, place->address);
      }
    }
    if (file_.objects.empty()) {
      throw std::runtime_error(fmt::format(
          "{}:1:1: error: no object is described (expected an electronic data sheet, as in CiA 306)",
          file_name_));
    }
    std::stable_sort(notes_.begin(), notes_.end(), [](const FileNote& a, const FileNote& b) {
      return std::tie(a.line, a.column) < std::tie(b.line, b.column);
    });
    for (const FileNote& note : notes_) {
      file_.notes.push_back(
          fmt::format("{}:{}:{}: note: {}", file_name_, note.line, note.column, Printable(note.what)));
    }
    return std::move(file_);
  }

 private:
  const IniSection* Section(const std::string& name) const {
    const auto found = sections_.find(LowerCase(name));
    return found == sections_.end() ? nullptr : &found->second;
  }
  void Note(const IniSection& section, std::string what) {
    notes_.push_back({section.line, section.column, std::move(what)});
  }
  void Note(const IniValue& value, std::string what) {
    notes_.push_back({value.line, value.column, std::move(what)});
  }

  // Of the value of a key; of the section where there is none.
  static FilePlace PlaceOf(const IniSection& section, std::string_view key) {
    const IniValue* value = section.Find(LowerCase(key));
    return value == nullptr ? FilePlace{section.line, section.column} : FilePlace{value->line, value->column};
  }

  const IniSection* Demand(const std::string& name) {
    const IniSection* section = Section(name);
    if (section == nullptr)
      notes_.push_back({1, 1, fmt::format("there is no section [{}] (expected one)", name)});
    return section;
  }
  const IniValue* Demand(const IniSection& section, std::string_view key) {
    const IniValue* value = section.Find(LowerCase(key));
    if (value == nullptr) Note(section, fmt::format("[{}] has no {} (expected one)", section.name, key));
    return value;
  }

  // A number from 0 to `most`; nothing with a note.
  std::optional<std::uint32_t> Unsigned(const IniValue& value, std::string_view key, std::int64_t most) {
    const std::optional<std::int64_t> number = EdsNumber(WithoutComment(value.text), kAnyNode);
    if (number && *number >= 0 && *number <= most) return static_cast<std::uint32_t>(*number);
    Note(value, fmt::format("{} '{}' (expected a number from 0 to {})", key, value.text, most));
    return std::nullopt;
  }
  std::optional<std::uint32_t> Optional(const IniSection& section, std::string_view key, std::int64_t most) {
    const IniValue* value = section.Find(LowerCase(key));
    if (value == nullptr || value->text.empty()) return std::nullopt;
    return Unsigned(*value, key, most);
  }

  void ReadDevice() {
    Demand("FileInfo");
    const IniSection* device = Demand("DeviceInfo");
    if (device == nullptr) return;
    const auto text = [&](std::string_view key, std::string& target) {
      if (const IniValue* value = Demand(*device, key)) target = value->text;
    };
    const auto number = [&](std::string_view key, std::optional<std::uint32_t>& target, FilePlace& place) {
      const IniValue* value = Demand(*device, key);
      if (value != nullptr) target = Unsigned(*value, key, 0xFFFFFFFF);
      place = PlaceOf(*device, key);
    };
    text("VendorName", file_.vendor_name);
    text("ProductName", file_.product_name);
    number("VendorNumber", file_.vendor_number, file_.vendor_place);
    number("ProductNumber", file_.product_number, file_.product_place);
    number("RevisionNumber", file_.revision_number, file_.revision_place);
  }

  std::set<std::uint16_t> ReadLists() {
    std::set<std::uint16_t> listed;
    const auto read = [&](const IniSection* section) {
      if (section == nullptr) return;
      const IniValue* count = Demand(*section, "SupportedObjects");
      const std::uint32_t entries =
          count == nullptr ? 0 : Unsigned(*count, "SupportedObjects", 0xFFFF).value_or(0);
      for (std::uint32_t i = 1;; ++i) {
        const IniValue* value = section->Find(std::to_string(i));
        if (value == nullptr) {
          if (i > entries) break;
          Note(*count, fmt::format("[{}] has no entry {} (expected 1 to {})", section->name, i, entries));
          break;
        }
        const auto index = Unsigned(*value, "object", 0xFFFF);
        if (!index) continue;
        if (!listed.insert(static_cast<std::uint16_t>(*index)).second) {
          Note(*value, fmt::format("object {:04X} is listed twice (expected once)", *index));
        } else if (Section(fmt::format("{:04x}", *index)) == nullptr) {
          Note(*value, fmt::format("object {:04X} has no section (expected [{:04X}])", *index, *index));
        }
      }
    };
    read(Demand("MandatoryObjects"));
    read(Section("OptionalObjects"));
    read(Section("ManufacturerObjects"));
    return listed;
  }

  void ReadObject(const IniSection& section, ObjectAddress address) {
    Demand(section, "ParameterName");
    const std::uint32_t kind = Optional(section, "ObjectType", 0xFF).value_or(0x7);
    switch (static_cast<ObjectKind>(kind)) {
      case ObjectKind::kDomain:
      case ObjectKind::kVariable:
        file_.objects[address] = ReadValue(section, kind == 0x2);
        return;
      case ObjectKind::kArray:
      case ObjectKind::kRecord:
        break;
    }
    if (kind != 0x8 && kind != 0x9) {
      Note(*section.Find("objecttype"),
           fmt::format("ObjectType 0x{:X} (expected 0x2 domain, 0x7 variable, 0x8 array or 0x9 record)",
                       kind));
      if (section.Find("datatype") != nullptr) file_.objects[address] = ReadValue(section, false);
      return;
    }
    if (const auto compact = Optional(section, "CompactSubObj", kMostSubindex); compact && *compact > 0) {
      ReadCompact(section, address.index, static_cast<std::uint8_t>(*compact));
      return;
    }
    const IniValue* number = Demand(section, "SubNumber");
    if (number == nullptr) return;
    const auto expected = Unsigned(*number, "SubNumber", kMostSubindex + 1);
    if (!expected) return;
    std::uint32_t subs = 0;
    for (int subindex = 0; subindex <= 0xFF; ++subindex) {
      if (Section(fmt::format("{:04x}sub{:x}", address.index, subindex)) != nullptr) ++subs;
    }
    if (subs != *expected) {
      Note(*number, fmt::format("SubNumber {} of object {:04X}, which has {} sub-objects (expected {})",
                                *expected, address.index, subs, subs));
    }
  }

  void ReadSub(const IniSection& section, SectionAddress place) {
    Demand(section, "ParameterName");
    file_.objects[place.address] = ReadValue(section, false);
  }

  // One description for all sub-objects (CiA 306, 4.6.3): names and values differ in sections of their own.
  void ReadCompact(const IniSection& section, std::uint16_t index, std::uint8_t count) {
    EdsObject& entries = file_.objects[{index, 0}];
    entries = {"number of entries",
               DataType::kUnsigned8,
               AccessType::kReadOnly,
               false,
               std::to_string(count),
               "",
               ""};
    entries.section_place = entries.type_place = entries.access_place = entries.mapping_place =
        FilePlace{section.line, section.column};
    entries.default_place = PlaceOf(section, "CompactSubObj");
    const EdsObject common = ReadValue(section, false);
    const IniSection* names = Section(fmt::format("{:04x}name", index));
    const IniSection* values = Section(fmt::format("{:04x}value", index));
    for (int i = 1; i <= count; ++i) {
      EdsObject object = common;
      object.name = common.name + std::to_string(i);
      const std::string key = std::to_string(i);
      if (const IniValue* name = names == nullptr ? nullptr : names->Find(key)) object.name = name->text;
      if (const IniValue* value = values == nullptr ? nullptr : values->Find(key)) {
        object.default_value = value->text;
        object.default_place = {value->line, value->column};
        CheckNumber(*value, "value", object.type);
      }
      file_.objects[{index, static_cast<std::uint8_t>(i)}] = object;
    }
  }

  EdsObject ReadValue(const IniSection& section, bool domain) {
    EdsObject object;
    object.section_place = {section.line, section.column};
    object.type_place = PlaceOf(section, "DataType");
    object.access_place = PlaceOf(section, "AccessType");
    object.mapping_place = PlaceOf(section, "PDOMapping");
    object.default_place = PlaceOf(section, "DefaultValue");
    object.low_place = PlaceOf(section, "LowLimit");
    object.high_place = PlaceOf(section, "HighLimit");
    if (const IniValue* name = section.Find("parametername")) object.name = Printable(name->text);
    ReadType(section, domain, object);
    ReadAccess(section, domain, object);
    const IniValue* mapping = section.Find("pdomapping");
    object.mappable =
        mapping != nullptr && !mapping->text.empty() && Optional(section, "PDOMapping", 1) != 0U;
    const auto number = [&](std::string_view key, std::string& target) {
      const IniValue* value = section.Find(LowerCase(key));
      if (value == nullptr) return std::optional<std::int64_t>();
      target = IsIntegerType(object.type) ? WithoutComment(value->text) : value->text;
      return CheckNumber(*value, key, object.type);
    };
    auto initial = number("DefaultValue", object.default_value);
    // A DCF file says with it what this one node is set to; empty, the default stands.
    const IniValue* own = section.Find("parametervalue");
    if (own != nullptr && !own->text.empty()) {
      initial = number("ParameterValue", object.default_value);
      object.is_set_for_node = !object.default_value.empty();
      object.default_place = {own->line, own->column};
    }
    const auto low = number("LowLimit", object.low_limit);
    const auto high = number("HighLimit", object.high_limit);
    bool is_contradiction = false;
    if (low && high && *low > *high) {
      is_contradiction = true;
      Note(*section.Find("highlimit"),
           fmt::format(
               "HighLimit {} is below LowLimit {} (expected not below; the object's limits are not used)",
               object.high_limit, object.low_limit));
    } else if (initial && ((low && *initial < *low) || (high && *initial > *high))) {
      is_contradiction = true;
      Note(object.is_set_for_node ? *own : *section.Find("defaultvalue"),
           fmt::format("value {} is not within the object's limits (expected {} to {}; they are not used)",
                       object.default_value, low ? object.low_limit : "any",
                       high ? object.high_limit : "any"));
    }
    if (is_contradiction || (!low && IsIntegerType(object.type))) object.low_limit.clear();
    if (is_contradiction || (!high && IsIntegerType(object.type))) object.high_limit.clear();
    return object;
  }

  void ReadType(const IniSection& section, bool domain, EdsObject& object) {
    object.type = domain ? DataType::kDomain : DataType::kUnsigned8;
    if (domain && section.Find("datatype") == nullptr) return;
    const IniValue* value = Demand(section, "DataType");
    const auto type = value == nullptr ? std::nullopt : Unsigned(*value, "DataType", 0xFFFF);
    if (type && IsKnownType(static_cast<DataType>(*type))) {
      object.type = static_cast<DataType>(*type);
      return;
    }
    object.unclear = "no DataType that is known here";
    object.unclear_place = object.type_place;
    // Bytes without a meaning: no number in the section can be judged.
    object.type = DataType::kDomain;
    if (type)
      Note(*value, fmt::format("DataType '{}' (expected a type of CiA 301 that is used here)", value->text));
  }

  void ReadAccess(const IniSection& section, bool domain, EdsObject& object) {
    object.access = AccessType::kReadWrite;
    if (domain && section.Find("accesstype") == nullptr) return;
    const IniValue* value = Demand(section, "AccessType");
    const std::string access = value == nullptr ? "" : LowerCase(WithoutComment(value->text));
    if (access == "ro") {
      object.access = AccessType::kReadOnly;
    } else if (access == "wo") {
      object.access = AccessType::kWriteOnly;
    } else if (access == "const") {
      object.access = AccessType::kConstant;
    } else if (access != "rw" && access != "rwr" && access != "rww") {
      object.unclear = "no AccessType that is known here";
      object.unclear_place = object.access_place;
      if (value != nullptr) {
        Note(*value, fmt::format("AccessType '{}' (expected ro, wo, rw, rwr, rww or const)", value->text));
      }
    }
  }

  // The number as a value of `type`; nothing of an empty text and of types that are no integers.
  std::optional<std::int64_t> CheckNumber(const IniValue& value, std::string_view key, DataType type) {
    if (value.text.empty() || !IsIntegerType(type)) return std::nullopt;
    const std::optional<std::int64_t> typed = TypedEdsNumber(WithoutComment(value.text), kAnyNode, type);
    if (!typed) {
      Note(value, fmt::format("{} '{}' (expected {})", key, value.text, RangeWords(type)));
    }
    return typed;
  }

  std::string file_name_;
  std::vector<FileNote> notes_;
  std::map<std::string, IniSection> sections_;
  EdsFile file_;
};

}  // namespace

EdsFile ParseEds(std::string_view text, std::string_view file_name) {
  return EdsReader(text, file_name).Read();
}

}  // namespace strainwave::protocols::canopen
