// SPDX-License-Identifier: Apache-2.0
#include "daq/record_checks.h"

#include <fmt/core.h>

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <string_view>
#include <utility>

#include "daq/cycle_file.h"
#include "daq/hdf5_handle.h"
#include "daq/hdf5_image.h"
#include "daq/hdf5_record.h"
#include "daq/limited_process.h"
#include "daq/record_error.h"
#include "daq/record_pipe.h"
#include "daq/whole_file.h"

namespace strainwave::daq {
namespace {

void Send(int pipe, std::string_view text) { WriteToPipe(pipe, std::as_bytes(std::span(text))); }

// What a process of its own has said, text after text with a NUL after each, until it ended or died.
std::vector<std::string> TextsOf(const std::filesystem::path& path, const std::function<void(int pipe)>& work,
                                 std::string& end) {
  LimitedProcess process(LimitsForFile(path), work);
  std::string said;
  std::array<std::byte, 4096> block{};
  while (const std::size_t got = process.Read(block))
    said.append(reinterpret_cast<const char*>(block.data()), got);
  end = process.End();
  std::vector<std::string> texts;
  for (std::size_t from = 0; from < said.size();) {
    const std::size_t to = said.find('\0', from);
    if (to == said.npos) break;
    texts.push_back(said.substr(from, to - from));
    from = to + 1;
  }
  return texts;
}

std::vector<std::string> GroupsOf(const std::filesystem::path& path) {
  std::string end;
  auto texts = TextsOf(
      path,
      [&](int pipe) {
        const Hdf5Silence silence;
        try {
          const Hdf5Handle file = OpenHdf5ForReading(path);
          for (const std::string& group : ListRecordGroups(file.get())) Send(pipe, group + '\0');
          Send(pipe, std::string("whole") + '\0');
        } catch (const RecordError& error) {
          Send(pipe, error.findings().front().what + '\0');
        } catch (const Hdf5Error& error) {
          Send(pipe, fmt::format("HDF5 cannot read the file: {}", error.what()) + '\0');
        }
      },
      end);
  if (end.empty() && !texts.empty() && texts.back() == "whole") {
    texts.pop_back();
    return texts;
  }
  throw RecordError(path.string(),
                    !end.empty() || texts.empty() ? fmt::format("the HDF5 library cannot read it: it {}", end)
                                                  : texts.back(),
                    "the file as it was written");
}

std::string DamageOf(const Hdf5Handle& file, const std::string& group, const std::string& name) {
  try {
    ReadRecordGroup(file.get(), group, name, Checking::kNone);
    return {};
  } catch (const RecordError& error) {
    return error.findings().front().what;
  } catch (const Hdf5Error& error) {
    return error.what();
  }
}

}  // namespace

std::vector<RecordCheck> CheckRecords(const std::filesystem::path& path) {
  const std::vector<std::string> groups = GroupsOf(path);
  std::vector<RecordCheck> checks;
  // A record that the library dies of is passed over by the next process.
  while (checks.size() < groups.size()) {
    std::string end;
    const auto damages = TextsOf(
        path,
        [&](int pipe) {
          const Hdf5Silence silence;
          const Hdf5Handle file = OpenHdf5ForReading(path);
          for (std::size_t i = checks.size(); i < groups.size(); ++i) {
            Send(pipe, DamageOf(file, groups[i], path.string()) + '\0');
          }
        },
        end);
    for (const std::string& damage : damages) checks.push_back({groups[checks.size()], damage});
    if (checks.size() < groups.size()) {
      checks.push_back({groups[checks.size()], fmt::format("the HDF5 library cannot read it: it {}", end)});
    }
  }
  return checks;
}

void DemandReadable(const std::filesystem::path& path) {
  ReadInOwnProcess(path, LimitsForFile(path), [&] {
    ReadCycleFile(path, Checking::kNone);
    return std::vector<Record>();
  });
}

void CopyRecords(const std::filesystem::path& from, std::span<const std::string> groups,
                 const std::filesystem::path& to, const Attributes& attributes) {
  const Hdf5Silence silence;
  std::vector<std::byte> image;
  try {
    const Hdf5Handle source = OpenHdf5ForReading(from);
    const Hdf5Handle target = CreateHdf5InMemory();
    WriteFileAttributes(target.get(), WithFormat(attributes));
    const Hdf5Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    Check(H5Pset_create_intermediate_group(links.get(), 1));
    for (const std::string& group : groups) {
      Check(H5Ocopy(source.get(), group.c_str(), target.get(), group.c_str(), H5P_DEFAULT, links.get()));
    }
    image = ImageOfHdf5(target.get());
  } catch (const Hdf5Error& error) {
    throw RecordError(from.string(), fmt::format("HDF5 cannot copy its records: {}", error.what()),
                      "records that can be read");
  }
  WriteFileAtomically(to, image);
}

}  // namespace strainwave::daq
