// SPDX-License-Identifier: Apache-2.0
#include "daq/hdf5_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "daq/hdf5_attributes.h"
#include "daq/hdf5_column.h"
#include "daq/hdf5_handle.h"
#include "daq/record_error.h"
#include "daq/record_limits.h"
#include "daq/record_rules.h"
#include "daq/software.h"

namespace strainwave::daq {
namespace {

constexpr std::string_view kKindName = "kind";

void Demand(bool holds, std::string_view group_path, std::string_view rule) {
  if (!holds) throw std::invalid_argument(fmt::format("record '{}': {}", group_path, rule));
}

bool HasNul(std::string_view text) { return text.find('\0') != text.npos; }

void DemandWritable(const Record& record, const std::string& path) {
  Demand(path.starts_with('/') && !HasNul(path), path, "a group path starts with '/'");
  Demand(!record.kind.name().empty() && !HasNul(record.kind.name()), path, "the kind is empty");
  Demand(record.rows() > 0, path, "it has no rows");
  for (const auto& [key, value] : record.metadata) {
    Demand(!key.empty() && key != kKindName && !HasNul(key) && !HasNul(value), path,
           fmt::format("metadata key '{}' is empty, has a NUL in it or its value, or is taken", key));
  }
  for (const Column& column : record.columns) {
    Demand(!column.name.empty() && column.name != "." && column.name.find('/') == column.name.npos &&
               !HasNul(column.name),
           path, fmt::format("column name '{}' cannot name a dataset", column.name));
    Demand(record.FindColumn(column.name) == &column, path,
           fmt::format("column '{}' is doubled", column.name));
    Demand(column.size() == record.rows(), path,
           fmt::format("column '{}' has {} rows, not {}", column.name, column.size(), record.rows()));
  }
}

// Each group on the way is made here and not by the library, which would note the time of day in those
// between.
Hdf5Handle OpenOrCreateGroup(hid_t file, const std::string& path, std::size_t attributes) {
  const Hdf5Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  Check(H5Pset_link_creation_order(properties.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
  Check(H5Pset_attr_creation_order(properties.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
  Check(H5Pset_obj_track_times(properties.get(), false));
  for (std::size_t end = path.find('/', 1); end != path.npos; end = path.find('/', end + 1)) {
    const std::string above = path.substr(0, end);
    if (Check(H5Lexists(file, above.c_str(), H5P_DEFAULT)) > 0) continue;
    const Hdf5Handle made(H5Gcreate2(file, above.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                          H5Gclose);
  }
  KeepAttributesInHeader(properties.get(), attributes);
  if (path == "/") return {H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose};
  return {H5Gcreate2(file, path.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Gclose};
}

struct Child {
  std::string name;
  Hdf5Handle object;
  H5I_type_t type;
};

herr_t TakeHardLink(hid_t, const char* name, const H5L_info_t* link, void* names) {
  if (link->type == H5L_TYPE_HARD) static_cast<std::vector<std::string>*>(names)->push_back(name);
  return 0;
}

// Groups and datasets that the group holds itself; soft and external links lead elsewhere.
// @param wanted  names; empty: all.
std::vector<Child> ChildrenOf(hid_t group, std::span<const std::string_view> wanted = {}) {
  const Hdf5Handle properties(H5Gget_create_plist(group), H5Pclose);
  unsigned flags{};
  Check(H5Pget_link_creation_order(properties.get(), &flags));
  const H5_index_t index = IndexFor(flags);
  H5G_info_t info{};
  Check(H5Gget_info(group, &info));
  if (info.nlinks > kMostColumns) {
    throw Hdf5Error(fmt::format("a group has {} members (at most {})", info.nlinks, kMostColumns));
  }
  // In one walk: to find the n-th takes a walk each.
  std::vector<std::string> names;
  Check(H5Literate(group, index, H5_ITER_INC, nullptr, TakeHardLink, &names));
  std::vector<Child> children;
  for (std::string& name : names) {
    if (!wanted.empty() && std::ranges::find(wanted, name) == wanted.end()) continue;
    Hdf5Handle object(H5Oopen(group, name.c_str(), H5P_DEFAULT), H5Oclose);
    const H5I_type_t type = H5Iget_type(object.get());
    if (type == H5I_GROUP || type == H5I_DATASET)
      children.push_back({std::move(name), std::move(object), type});
  }
  return children;
}

void ListGroupsBelow(hid_t group, const std::string& path, bool nested, std::set<haddr_t>& visited,
                     std::vector<std::string>& found) {
  H5O_info_t info{};
  Check(H5Oget_info2(group, &info, H5O_INFO_BASIC));
  // A hard link may lead back up.
  if (!visited.insert(info.addr).second) return;
  if (visited.size() > kMostGroups)
    throw Hdf5Error(fmt::format("there are more than {} groups", kMostGroups));
  if (std::ranges::count(path, '/') > kDeepestGroup) {
    throw Hdf5Error(fmt::format("groups are in one another more than {} deep", kDeepestGroup));
  }
  if (Check(H5Aexists(group, kKindName.data())) > 0) {
    found.push_back(path);
    if (!nested) return;
  }
  for (const Child& child : ChildrenOf(group)) {
    if (child.type != H5I_GROUP) continue;
    ListGroupsBelow(child.object.get(), (path == "/" ? "" : path) + "/" + child.name, nested, visited, found);
  }
}

// One record while it is being read.
class GroupReader {
 public:
  GroupReader(const std::string& file_name, const std::string& path, Checking checking,
              std::span<const std::string_view> columns)
      : checking_(checking), columns_(columns) {
    record_.source.file = file_name;
    record_.source.group = path;
  }

  Record Read(hid_t group) {
    ReadGroupAttributes(group);
    for (const Child& child : ChildrenOf(group, columns_)) {
      if (child.type == H5I_DATASET) ReadDataset(child);
    }
    DropOddLengths();
    ReportTroubles();
    Report(checking_ == Checking::kRules ? CheckRecord(record_) : CheckBounds(record_));
    if (!findings_.empty()) throw RecordError(std::move(findings_));
    return std::move(record_);
  }

 private:
  void Add(const std::string& part, std::string_view what, std::string expected) {
    findings_.push_back({record_.source.file,
                         fmt::format("group '{}'{}: {}", record_.source.group, part, what),
                         std::move(expected)});
  }

  void ReadGroupAttributes(hid_t group) {
    std::vector<std::string> left_out;
    for (Hdf5Attribute& attribute : ReadAttributes(group, left_out)) {
      if (attribute.name == kKindName) {
        record_.kind = RecordKind::Named(attribute.text);
      } else {
        record_.metadata.emplace_back(std::move(attribute.name), std::move(attribute.text));
      }
    }
    for (const std::string& name : left_out) {
      record_.notes.push_back(
          {0, fmt::format("attribute '{}' is left out: it is not one text or number", name)});
    }
  }

  ColumnType TypeOf(const std::string& name) const {
    if (name == "direction" && IsKnownColumn(record_.kind, name)) return ColumnType::kDirection;
    return IsReadAsDoubles(record_.kind, name) ? ColumnType::kDouble : ColumnType::kFloatIfStoredSo;
  }

  void ReadDataset(const Child& child) {
    const hid_t dataset = child.object.get();
    const std::vector<std::string> members = MembersOf(dataset);
    for (const std::string& name : members.empty() ? std::vector{child.name} : members) {
      if (record_.FindColumn(name) != nullptr) {
        Add(fmt::format(", dataset '{}'", child.name), fmt::format("column '{}' is doubled", name),
            "each column once");
      } else {
        Take(members.empty() ? ReadColumn(dataset, name, TypeOf(name), columns_.empty())
                             : ReadMember(dataset, name, TypeOf(name)),
             child.name);
      }
    }
    const auto is_known = [this](const std::string& name) { return IsKnownColumn(record_.kind, name); };
    if (!members.empty() && std::ranges::none_of(members, is_known)) tables_.push_back(child.name);
  }

  void Take(ReadColumnResult result, const std::string& dataset) {
    const std::string name = result.column.name;
    if (result.troubles.empty()) {
      record_.columns.push_back(std::move(result.column));
      return;
    }
    // A bench's own file has nothing in it that does not belong there: what cannot be read is damaged.
    if (!IsKnownColumn(record_.kind, name) && !TakesFurtherChannels(record_.kind) &&
        checking_ == Checking::kRules) {
      record_.notes.push_back(
          {0, fmt::format("dataset '{}' is left out: {}", dataset, result.troubles.front().what)});
      return;
    }
    for (ColumnTrouble& trouble : result.troubles) {
      const auto same = std::ranges::find_if(troubles_, [&](const Trouble& other) {
        return !trouble.row && !other.trouble.row && other.trouble.what == trouble.what;
      });
      if (same == troubles_.end()) {
        troubles_.push_back({std::move(trouble), {dataset}});
      } else if (std::ranges::find(same->datasets, dataset) == same->datasets.end()) {
        same->datasets.push_back(dataset);
      }
    }
    // Named, so that it is not reported as missing as well.
    troubled_.insert(name);
  }

  // What keeps several datasets from being read, such as a compression, is said once.
  void ReportTroubles() {
    for (const Trouble& trouble : troubles_) {
      const bool is_one = trouble.datasets.size() == 1;
      Add(fmt::format(", {} '{}'{}", is_one ? "dataset" : "datasets", fmt::join(trouble.datasets, "', '"),
                      trouble.trouble.row ? fmt::format(", row {}", *trouble.trouble.row) : ""),
          trouble.trouble.what, trouble.trouble.expected);
    }
  }

  // A group may hold arrays beside the record's columns, such as a spectrum.
  void DropOddLengths() {
    if (TakesFurtherChannels(record_.kind)) return;
    const auto first_known =
        std::find_if(record_.columns.begin(), record_.columns.end(),
                     [&](const Column& column) { return IsKnownColumn(record_.kind, column.name); });
    if (first_known == record_.columns.end()) return;
    const std::size_t rows = first_known->size();
    std::erase_if(record_.columns, [&](const Column& column) {
      const bool drop = column.size() != rows && !IsKnownColumn(record_.kind, column.name);
      if (drop) {
        record_.notes.push_back({0, fmt::format("dataset '{}' is left out: it has {} rows, the record has {}",
                                                column.name, column.size(), rows)});
      }
      return drop;
    });
  }

  void Report(const std::vector<RuleBreak>& breaks) {
    const auto misses_a_column = [](const RuleBreak& found) { return found.what.ends_with("is missing"); };
    if (!tables_.empty() && std::ranges::any_of(breaks, misses_a_column)) {
      Add(fmt::format(", dataset '{}'", tables_.front()),
          "its rows hold several values, none with the name of a column",
          "a dataset for each column, or rows whose values have the names of columns, such as torque_Nm");
      return;
    }
    for (const RuleBreak& rule_break : breaks) {
      const RecordPart& part = rule_break.part;
      switch (part.level) {
        case RecordPart::Level::kRecord:
          if (IsAboutTroubledColumn(rule_break)) break;
          Add("", rule_break.what, rule_break.expected);
          break;
        case RecordPart::Level::kKind:
          Add(", attribute 'kind'", rule_break.what, rule_break.expected);
          break;
        case RecordPart::Level::kMetadata:
          Add(fmt::format(", attribute '{}'", part.name), rule_break.what, rule_break.expected);
          break;
        case RecordPart::Level::kColumn:
          Add(fmt::format(", dataset '{}'", part.name), rule_break.what, rule_break.expected);
          break;
        case RecordPart::Level::kCell:
          Add(fmt::format(", dataset '{}', row {}", part.name, part.row), rule_break.what,
              rule_break.expected);
          break;
      }
    }
  }

  bool IsAboutTroubledColumn(const RuleBreak& rule_break) const {
    if (rule_break.what == "no channel is there") return !troubled_.empty();
    return std::any_of(troubled_.begin(), troubled_.end(), [&](const std::string& name) {
      return rule_break.what == fmt::format("column '{}' is missing", name);
    });
  }

  Checking checking_;
  std::span<const std::string_view> columns_;  // empty: all
  struct Trouble {
    ColumnTrouble trouble;
    std::vector<std::string> datasets;  // that have it
  };

  Record record_;
  std::vector<Trouble> troubles_;
  std::vector<std::string> tables_;  // of rows in which no known column is
  std::set<std::string> troubled_;   // columns
  std::vector<Finding> findings_;
};

}  // namespace

void WriteRecordGroup(hid_t file, const std::string& group_path, const Record& record, Packing packing) {
  DemandWritable(record, group_path);
  const Hdf5Silence silence;
  const Hdf5Handle group = OpenOrCreateGroup(file, group_path, 1 + record.metadata.size());
  WriteTextAttribute(group.get(), std::string(kKindName), std::string(record.kind.name()));
  for (const auto& [key, value] : record.metadata) WriteAttribute(group.get(), key, value);
  for (const Column& column : record.columns)
    WriteColumn(group.get(), column, record.Metadata("sample_rate_hz"), packing);
}

std::vector<std::string> ListRecordGroups(hid_t file, bool nested) {
  const Hdf5Silence silence;
  const Hdf5Handle root(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose);
  std::set<haddr_t> visited;
  std::vector<std::string> found;
  ListGroupsBelow(root.get(), "/", nested, visited, found);
  return found;
}

Record ReadRecordGroup(hid_t file, const std::string& group_path, const std::string& file_name,
                       Checking checking, std::span<const std::string_view> columns) {
  const Hdf5Silence silence;
  const Hdf5Handle group(H5Gopen2(file, group_path.c_str(), H5P_DEFAULT), H5Gclose);
  return GroupReader(file_name, group_path, checking, columns).Read(group.get());
}

void WriteFileAttributes(hid_t file, const Attributes& attributes) {
  const Hdf5Silence silence;
  const Hdf5Handle root(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose);
  for (const auto& [name, text] : attributes) {
    Demand(!name.empty() && name != kKindName && name != kSoftwareName && !HasNul(name) && !HasNul(text), "/",
           fmt::format("file attribute '{}' is empty, has a NUL in it or its value, or is taken", name));
    WriteAttribute(root.get(), name, text);
  }
}

Attributes ReadFileAttributes(hid_t file) {
  const Hdf5Silence silence;
  const Hdf5Handle root(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose);
  std::vector<std::string> left_out;
  Attributes attributes;
  for (Hdf5Attribute& attribute : ReadAttributes(root.get(), left_out)) {
    if (attribute.name == kSoftwareName) continue;
    attributes.emplace_back(std::move(attribute.name), std::move(attribute.text));
  }
  return attributes;
}

}  // namespace strainwave::daq
