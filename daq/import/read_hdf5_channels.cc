// SPDX-License-Identifier: Apache-2.0
#include <hdf5.h>

#include <algorithm>

#include <fmt/format.h>

#include "daq/hdf5_attributes.h"
#include "daq/hdf5_column.h"
#include "daq/hdf5_handle.h"
#include "daq/import/foreign_file.h"
#include "daq/record_error.h"
#include "daq/record_limits.h"

namespace strainwave::daq {
namespace {

class Hdf5Reader {
 public:
  explicit Hdf5Reader(const std::filesystem::path& path) : path_(path.string()) {}

  ForeignFile Read() {
    const Hdf5Silence silence;
    try {
      const Hdf5Handle file = OpenHdf5ForReading(path_);
      file_.format = "HDF5";
      const Hdf5Handle root(H5Gopen2(file.get(), "/", H5P_DEFAULT), H5Gclose);
      ReadGroup(root.get(), "", 0);
    } catch (const Hdf5Error& error) {
      throw RecordError(path_, fmt::format("HDF5 cannot read it: {}", error.what()), "a whole file");
    }
    if (file_.channels.empty())
      throw RecordError(path_, "holds no series of numbers", "one dataset at least");
    return std::move(file_);
  }

 private:
  void ReadGroup(hid_t group, const std::string& prefix, int depth) {
    if (depth > kDeepestGroup)
      throw RecordError(path_, fmt::format("groups lie {} deep in one another", depth),
                        fmt::format("{} at most", kDeepestGroup));
    TakeAttributes(group, prefix);
    std::vector<std::string> names;
    Check(H5Literate(
        group, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr,
        [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
          static_cast<std::vector<std::string>*>(out)->emplace_back(name);
          return 0;
        },
        &names));
    for (const std::string& name : names) {
      const std::string full = prefix.empty() ? name : prefix + "/" + name;
      const hid_t id = H5Oopen(group, name.c_str(), H5P_DEFAULT);
      if (id < 0) {
        file_.notes.push_back(fmt::format("{} is left out: its link leads nowhere", full));
        continue;
      }
      const Hdf5Handle object(id, H5Oclose);
      if (++objects_ > kMostGroups)
        throw RecordError(path_, fmt::format("more than {} objects", kMostGroups), "fewer");
      if (H5Iget_type(id) == H5I_GROUP) {
        ReadGroup(id, full, depth + 1);
      } else if (H5Iget_type(id) == H5I_DATASET) {
        ReadDataset(id, full);
      }
    }
  }

  void TakeAttributes(hid_t object, const std::string& prefix) {
    for (const Hdf5Attribute& attribute : ReadAttributes(object, file_.notes))
      file_.metadata.emplace_back(prefix.empty() ? attribute.name : prefix + "." + attribute.name,
                                  attribute.text);
  }

  std::string UnitOfDataset(hid_t dataset) {
    std::vector<std::string> left_out;
    for (const Hdf5Attribute& attribute : ReadAttributes(dataset, left_out)) {
      if (attribute.name == "unit" || attribute.name == "units" || attribute.name == "Unit" ||
          attribute.name == "Units")
        return attribute.text;
    }
    return "";
  }

  void ReadDataset(hid_t dataset, const std::string& name) {
    const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
    const int rank = Check(H5Sget_simple_extent_ndims(space.get()));
    const std::string unit = UnitOfDataset(dataset);
    if (rank == 1) {
      const std::vector<std::string> members = MembersOf(dataset);
      if (members.empty()) return Take(ReadColumn(dataset, name, ColumnType::kDouble), name, unit);
      for (const std::string& member : members)
        Take(ReadMember(dataset, member, ColumnType::kDouble), fmt::format("{}.{}", name, member), "");
    } else if (rank == 2) {
      TakeMatrix(dataset, space.get(), name, unit);
    } else {
      file_.notes.push_back(fmt::format("dataset {} is left out: it has {} dimensions", name, rank));
    }
  }

  void Count(std::size_t values) {
    values_ += values;
    if (values_ > kMostValues)
      throw RecordError(path_, "too many values", fmt::format("{} in the file at most", kMostValues));
  }

  void Take(ReadColumnResult read, const std::string& name, const std::string& unit) {
    auto* const values = std::get_if<std::vector<double>>(&read.column.values);
    const auto whole = std::ranges::find_if(read.troubles, [](const ColumnTrouble& t) { return !t.row; });
    if (values == nullptr || whole != read.troubles.end()) {
      file_.notes.push_back(fmt::format("dataset {} is left out: {}", name,
                                        whole != read.troubles.end() ? whole->what : "it holds no numbers"));
      return;
    }
    Count(values->size());
    ForeignChannel channel{.name = name, .unit = unit, .values = std::move(*values), .words = {}};
    if (!read.troubles.empty())
      channel.trouble = fmt::format("{}: dataset {}: {}", path_, name, read.troubles.front().what);
    file_.channels.push_back(std::move(channel));
  }

  void TakeMatrix(hid_t dataset, hid_t space, const std::string& name, const std::string& unit) {
    hsize_t size[2]{};
    Check(H5Sget_simple_extent_dims(space, size, nullptr));
    const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
    const H5T_class_t sort = H5Tget_class(type.get());
    if ((sort != H5T_INTEGER && sort != H5T_FLOAT) || size[0] == 0 || size[1] == 0) {
      file_.notes.push_back(fmt::format("dataset {} is left out: it holds no numbers", name));
      return;
    }
    if (size[0] > kMostValues || size[1] > kMostValues / size[0]) Count(kMostValues + 1);
    Count(size[0] * size[1]);
    std::vector<double> all(size[0] * size[1]);
    Check(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()));
    const bool down = size[0] >= size[1];  // one series a column, or a row where these are longer
    const std::size_t series = down ? size[1] : size[0];
    const std::size_t length = down ? size[0] : size[1];
    for (std::size_t s = 0; s < series; ++s) {
      ForeignChannel channel{
          .name = down ? fmt::format("{}[:,{}]", name, s) : fmt::format("{}[{},:]", name, s),
          .unit = unit,
          .values = std::vector<double>(length),
          .words = {}};
      for (std::size_t i = 0; i < length; ++i)
        channel.values[i] = down ? all[i * size[1] + s] : all[s * size[1] + i];
      file_.channels.push_back(std::move(channel));
    }
  }

  std::string path_;
  ForeignFile file_;
  std::size_t objects_{};
  std::size_t values_{};
};

}  // namespace

ForeignFile ReadHdf5Channels(const std::filesystem::path& path) { return Hdf5Reader(path).Read(); }

}  // namespace strainwave::daq
