// SPDX-License-Identifier: Apache-2.0
#include "bench/studies/studies.h"

#include <algorithm>
#include <array>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/errors/bench_error.h"
#include "bench/studies/arm.h"
#include "bench/studies/joint_bearing.h"
#include "bench/studies/wafer_robot.h"
#include "daq/data_file_error.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

// One row a study; the folder has a file for each.
constexpr std::array kStudies{
    Study{"arm", "joints of robot arms with dragging brakes and worn reducers, for `fingerprint`",
          MakeArmStudy},
    Study{"joint_bearing",
          "a robot's joint to and fro, three accelerometers; faults of a bearing, for `faults`",
          MakeJointBearing},
    Study{"wafer_robot",
          "motor records of a robot's axis with a worn harmonic drive and timing belt, for `health`",
          MakeWaferRobot},
    Study{"wafer_robot_slow", "the same with slower moves", MakeSlowWaferRobot},
};

}  // namespace

std::span<const Study> Studies() { return kStudies; }

StudySummary MakeStudy(std::string_view name, const StudySettings& settings) {
  const auto found = std::ranges::find(Studies(), name, &Study::name);
  if (found == Studies().end()) {
    std::vector<std::string_view> names;
    for (const Study& study : Studies()) names.push_back(study.name);
    Refuse("--study", fmt::format("'{}' is no study", name), fmt::format("{}", fmt::join(names, ", ")));
  }
  if (settings.units && *settings.units < 1) Refuse("--units", std::to_string(*settings.units), "1 or more");
  std::error_code none;
  if (std::filesystem::exists(settings.out, none) && !std::filesystem::is_empty(settings.out, none))
    Refuse(settings.out, "holds files already", "a new folder");
  std::filesystem::create_directories(settings.out);
  return found->make(settings);
}

void LabelsWriter::Add(const std::string& file, const std::string& unit,
                       const std::vector<std::string>& values) {
  std::vector<std::string> row{file, unit};
  row.insert(row.end(), values.begin(), values.end());
  rows_.push_back(std::move(row));
}

StudySummary LabelsWriter::Write(const std::filesystem::path& folder) const {
  std::string text = fmt::format("file,unit{}{}\n", columns_.empty() ? "" : ",", fmt::join(columns_, ","));
  std::set<std::string> units;
  for (const std::vector<std::string>& row : rows_) {
    text += fmt::format("{}\n", fmt::join(row, ","));
    units.insert(row[1]);
  }
  try {
    daq::WriteFileAtomically(folder / "labels.csv", text);
  } catch (const daq::DataFileError& error) {
    throw BenchError(ExitCode::kMachineFailed, error.what());
  }
  return {rows_.size(), units.size(), columns_};
}

}  // namespace strainwave::bench
