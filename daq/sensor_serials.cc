// SPDX-License-Identifier: Apache-2.0
#include "daq/sensor_serials.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "daq/hdf5_attributes.h"
#include "daq/hdf5_handle.h"
#include "daq/hdf5_record.h"
#include "daq/record_error.h"

namespace strainwave::daq {
namespace {

std::vector<std::string> LinkNames(hid_t group) {
  H5G_info_t info{};
  Check(H5Gget_info(group, &info));
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const ssize_t length =
        Check(H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT));
    std::string name(static_cast<std::size_t>(length), '\0');
    Check(H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size() + 1,
                             H5P_DEFAULT));
    names.push_back(std::move(name));
  }
  return names;
}

void AddSerials(hid_t file, const std::string& path, std::set<std::string>& serials) {
  const Hdf5Handle group(H5Gopen2(file, path.c_str(), H5P_DEFAULT), H5Gclose);
  for (const std::string& name : LinkNames(group.get())) {
    const Hdf5Handle object(H5Oopen(group.get(), name.c_str(), H5P_DEFAULT), H5Oclose);
    if (H5Iget_type(object.get()) != H5I_DATASET) continue;
    std::vector<std::string> left_out;
    for (const Hdf5Attribute& attribute : ReadAttributes(object.get(), left_out)) {
      if (attribute.name == "sensor_serial") serials.insert(fmt::format("{}={}", name, attribute.text));
    }
  }
}

}  // namespace

std::vector<std::string> ReadSensorSerials(const std::filesystem::path& path) {
  const Hdf5Silence silence;
  const Hdf5Handle file = OpenHdf5ForReading(path);
  std::set<std::string> serials;
  try {
    for (const std::string& group : ListRecordGroups(file.get())) AddSerials(file.get(), group, serials);
  } catch (const Hdf5Error& error) {
    throw RecordError(path.string(), fmt::format("HDF5 cannot read the file: {}", error.what()),
                      "the file as it was written");
  }
  return {serials.begin(), serials.end()};
}

}  // namespace strainwave::daq
