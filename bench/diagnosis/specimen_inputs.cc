// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/specimen_inputs.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

// The records of one specimen, before they are looked at.
struct SpecimenRecords {
  std::string name;
  std::vector<daq::Record> records;
  std::vector<std::string> unnamed_files;
};

std::string SpecimenOf(const daq::Record& record) {
  return record.Metadata("specimen").value_or(record.source.specimen);
}

std::vector<SpecimenRecords> BySpecimen(std::vector<daq::Record> records) {
  std::vector<SpecimenRecords> specimens;
  std::map<std::pair<bool, std::string>, std::size_t> places;  // of a name, or of a file without one
  for (daq::Record& record : records) {
    const std::string name = SpecimenOf(record);
    const std::string& file = record.source.file;
    const auto [place, is_new] =
        places.try_emplace({!name.empty(), name.empty() ? file : name}, specimens.size());
    if (is_new) specimens.push_back({name, {}, {}});
    SpecimenRecords& specimen = specimens[place->second];
    if (name.empty() && specimen.unnamed_files.empty()) specimen.unnamed_files.push_back(file);
    specimen.records.push_back(std::move(record));
  }
  std::set<std::string> taken;
  for (const SpecimenRecords& specimen : specimens) taken.insert(specimen.name);
  for (SpecimenRecords& specimen : specimens) {
    if (!specimen.name.empty()) continue;
    const std::filesystem::path file = specimen.unnamed_files.front();
    specimen.name = taken.insert(file.stem().string()).second ? file.stem().string() : file.string();
  }
  return specimens;
}

std::string FolderOf(const std::string& name, std::set<std::string>& taken) {
  std::string plain;
  for (const char letter : name) {
    const bool kept = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                      (letter >= '0' && letter <= '9') || letter == '-' || letter == '.';
    plain += kept ? letter : '_';
  }
  if (plain.empty() || plain.front() == '.') plain.insert(0, "_");
  std::string folder = plain;
  for (int number = 2; !taken.insert(folder).second; ++number) folder = fmt::format("{}_{}", plain, number);
  return folder;
}

// Two specimens with one record would share even its noise.
void RefuseRecordsOfTwo(const std::vector<SpecimenInput>& specimens) {
  std::map<std::pair<std::string, std::string>, std::string> files;  // by content and group
  for (const SpecimenInput& specimen : specimens) {
    for (const RecordIdentity& record : specimen.input.records) {
      const auto [before, is_new] = files.try_emplace({record.sha256, record.group}, record.file);
      if (!is_new)
        Refuse(record.file, fmt::format("holds the same record as {} before it", before->second),
               "each record once");
    }
  }
}

}  // namespace

std::vector<SpecimenInput> ReadSpecimenInputs(const std::vector<std::string>& paths,
                                              const RecordChoice& choice) {
  for (const std::string& path : paths) {
    if (std::filesystem::is_directory(path))
      Refuse(path, "a folder beside --by-specimen", "the record files of two or more specimens");
  }
  std::vector<SpecimenRecords> by_specimen = BySpecimen(ReadChosenRecords(paths, choice));
  if (by_specimen.size() < 2) {
    Refuse(paths.front(), fmt::format("one specimen alone, {}", by_specimen.front().name),
           "records of two or more, told apart by the metadata 'specimen'; for one leave out --by-specimen");
  }
  std::vector<SpecimenInput> specimens;
  std::set<std::string> folders;
  for (SpecimenRecords& specimen : by_specimen) {
    StudyInput input = StudyInputOf(std::move(specimen.records), choice);
    for (const std::string& file : specimen.unnamed_files) {
      input.warnings.push_back(
          {file, 0,
           fmt::format("names no specimen (metadata 'specimen'): taken for one of its own, {}",
                       specimen.name)});
    }
    specimens.push_back({specimen.name, FolderOf(specimen.name, folders), std::move(input)});
  }
  RefuseRecordsOfTwo(specimens);
  return specimens;
}

}  // namespace strainwave::bench
