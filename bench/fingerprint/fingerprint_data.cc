// SPDX-License-Identifier: Apache-2.0
#include "bench/fingerprint/fingerprint_data.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/data_sets/labels.h"
#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

namespace dynamics = analysis::joint_dynamics;

// A class of such a name is no fault.
constexpr std::array<std::string_view, 16> kHealthyNames{
    "healthy", "normal", "sound",     "ok",       "good", "none",      "nominal",   "intact",
    "nofault", "0",      "reference", "baseline", "new",  "faultless", "undamaged", "pass"};

std::string Plain(const std::string& name) {
  std::string plain;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return plain;
}

void RequireTexts(const Labels& labels, std::string_view column, const std::vector<std::string>& texts) {
  for (std::size_t row = 0; row < texts.size(); ++row) {
    if (texts[row].empty())
      labels.RefuseCell(row, column, fmt::format("{} is empty", column), "a name in every row");
  }
}

void RequireClasses(const Labels& labels, FingerprintData& data, const std::string& given) {
  const std::set<std::string> names(data.classes.begin(), data.classes.end());
  if (names.size() < 2)
    Refuse(labels.path(), fmt::format("every file is of the class '{}'", data.classes.front()),
           "two classes or more: what healthy units have can only be told beside faulty ones");
  std::string warning;
  data.healthy = given.empty() ? HealthyClassOf(data.classes, warning) : given;
  if (!names.contains(data.healthy))
    Refuse("--healthy", fmt::format("no file is of the class '{}'", data.healthy),
           fmt::format("{}", fmt::join(names, ", ")));
  if (!warning.empty()) data.warnings.push_back(warning);
  if (names.size() > 2)
    data.warnings.push_back(
        fmt::format("{} classes: all but '{}' count as faulty", names.size(), data.healthy));
}

void TellRates(FingerprintData& data) {
  const auto [low, high] = std::ranges::minmax_element(data.files, {}, &JointFile::sample_rate_hz);
  if (high->sample_rate_hz > 1.01 * low->sample_rate_hz)
    data.warnings.push_back(fmt::format(
        "sampling rates differ, from {:g} Hz ({}) to {:g} Hz ({}); the filter has the same length in "
        "seconds in all",
        low->sample_rate_hz, low->path.filename().string(), high->sample_rate_hz,
        high->path.filename().string()));
}

}  // namespace

std::string HealthyClassOf(const std::vector<std::string>& class_of_file, std::string& warning) {
  std::map<std::string, int> files;
  for (const std::string& name : class_of_file) ++files[name];
  for (const std::string_view healthy : kHealthyNames) {
    for (const auto& [name, count] : files) {
      if (Plain(name) == healthy) return name;
    }
  }
  for (const std::string_view healthy : {"healthy", "normal", "nofault"}) {
    for (const auto& [name, count] : files) {
      if (Plain(name).starts_with(healthy)) return name;
    }
  }
  const auto most = std::ranges::max_element(files, {}, [](const auto& entry) { return entry.second; });
  warning = fmt::format(
      "no class has a name such as healthy or normal; '{}', which most files have, is taken for it "
      "(--healthy NAME says which is)",
      most->first);
  return most->first;
}

FingerprintData ReadFingerprintData(const std::filesystem::path& folder,
                                    const FingerprintDataSettings& settings,
                                    const FingerprintProgress& progress) {
  const Labels labels = ReadLabels(folder);
  FingerprintData data;
  data.smoothing = settings.smoothing;
  data.classes = labels.Texts("class");
  RequireTexts(labels, "class", data.classes);
  data.units = labels.Units();
  if (labels.Has("origin")) {
    data.origins = labels.Texts("origin");
    RequireTexts(labels, "origin", data.origins);
  }
  RequireClasses(labels, data, settings.healthy);

  const std::size_t count = labels.rows().size();
  for (std::size_t i = 0; i < count; ++i) {
    const Labels::Row& row = labels.rows()[i];
    progress("reading " + row.name, static_cast<double>(i) / static_cast<double>(count));
    data.names.push_back(row.name);
    data.files.push_back(ReadJointFile(row.file, settings.smoothing, Acceleration::kAsThere));
    JointFile& file = data.files.back();
    if (file.motion.size() < dynamics::kFewestRows)
      Refuse(file.path, fmt::format("{} samples", file.motion.size()),
             fmt::format("{} or more", dynamics::kFewestRows));
    if (file.motion.joints() != data.joints())
      Refuse(file.path, fmt::format("has {} joints", file.motion.joints()),
             fmt::format("{}, as {} has", data.joints(), data.names.front()));
  }
  const auto measured = std::ranges::count_if(data.files, &JointFile::acceleration_measured);
  data.acceleration_measured = measured == static_cast<std::ptrdiff_t>(count);
  for (std::size_t i = 0; i < count; ++i) {
    JointFile& file = data.files[i];
    // A file whose acceleration came about in another way than the others' would be known by that.
    if (file.acceleration_measured && !data.acceleration_measured)
      file = ReadJointFile(file.path, settings.smoothing, Acceleration::kDerived);
    for (const std::string& warning : file.warnings)
      data.warnings.push_back(fmt::format("{}: {}", data.names[i], warning));
    file.motion = dynamics::RowsOf(file.motion, dynamics::EvenRows(file.motion.size(), settings.rows));
  }
  if (measured > 0 && !data.acceleration_measured)
    data.warnings.push_back(
        fmt::format("{} of {} files have accelerations; for all they were computed from the "
                    "velocities",
                    measured, count));
  TellRates(data);
  for (const std::string& name : data.classes) data.facts.faulty.push_back(name == data.healthy ? 0 : 1);
  data.facts.unit = NumbersOfGroups(data.units);
  data.facts.origin = data.origins.empty() ? std::vector<int>(count, 0) : NumbersOfGroups(data.origins);
  return data;
}

}  // namespace strainwave::bench
