// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/configuration/device_file.h"
#include "bench/configuration/drive_profile_draft.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "daq/whole_file.h"
#include "protocols/canopen/eds_file.h"
#include "protocols/canopen/type_limits.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;
using protocols::canopen::EdsFile;

struct DriveProfileOptions {
  std::string eds;
  std::string out;
  bool json{};
};

EdsFile ReadEds(const std::string& path) {
  const std::string text = TextOfFile<BenchFileError>(path, {"CANopen data sheet", "[FileInfo]"});
  try {
    return protocols::canopen::ParseEds(text, path);
  } catch (const std::runtime_error& error) {
    throw BenchError(ExitCode::kWrongInput, error.what());
  }
}

// Controlword and statusword make a drive; a file of another kind of device would make a profile full of
// holes. What a file gives for the device type is not always what the device tells: the drive itself is asked
// at a start.
void DemandDrive(const EdsFile& eds, const std::string& path, std::vector<std::string>& warnings) {
  constexpr std::int64_t kServoProfile = 402;
  const bool is_drive = eds.objects.contains({0x6040, 0}) && eds.objects.contains({0x6041, 0});
  const auto found = eds.objects.find({0x1000, 0});
  const auto type = found == eds.objects.end() ? std::nullopt
                                               : protocols::canopen::TypedEdsNumber(
                                                     found->second.default_value, 1, found->second.type);
  const bool is_told_otherwise = type && (*type & 0xFFFF) != kServoProfile;
  if (is_drive && !is_told_otherwise) return;
  const protocols::canopen::FilePlace at =
      is_told_otherwise ? found->second.default_place : protocols::canopen::FilePlace{1, 1};
  const std::string place = fmt::format("{}:{}:{}", path, at.line, at.column);
  const std::string what = is_told_otherwise
                               ? fmt::format("1000h tells a device of profile {}", *type & 0xFFFF)
                               : "there is no controlword or no statusword";
  if (!is_drive) {
    Refuse(place, what,
           is_told_otherwise ? fmt::format("{}, a drive by CiA 402", kServoProfile)
                             : "6040h and 6041h, a drive by CiA 402");
  }
  warnings.push_back(
      fmt::format("{}: warning: {} (expected {}; where the drive itself tells it, too, quirks: "
                  "{{absent_objects: [0x1000]}} "
                  "in the profile)",
                  place, what, kServoProfile));
}

// As a profile at `out` would name it; without one, as a profile in the current folder.
std::string EdsKey(const DriveProfileOptions& options) {
  const fs::path folder = options.out.empty() ? fs::current_path() : fs::absolute(options.out).parent_path();
  return fs::proximate(fs::absolute(options.eds), folder).string();
}

int WriteDraft(const DriveProfileOptions& options) {
  if (!options.out.empty()) DemandOutputFile(options.out);
  const EdsFile eds = ReadEds(options.eds);
  std::vector<std::string> warnings = eds.notes;
  DemandDrive(eds, options.eds, warnings);
  if (!options.out.empty() && fs::exists(options.out))
    Refuse(options.out, "is there already", "a new name, since a profile is filled in by hand");
  const DriveProfileDraft draft = DraftDriveProfile(eds, EdsKey(options));
  if (!options.out.empty()) daq::WriteFileAtomically(options.out, draft.text);
  for (const auto& finding : draft.findings)
    warnings.push_back(
        fmt::format("{}:{}:{}: warning: {}", options.eds, finding.line, finding.column, finding.what));
  constexpr std::size_t kMostWarnings = 1000;
  if (warnings.size() > kMostWarnings) {
    const std::size_t not_kept = warnings.size() - kMostWarnings;
    warnings.resize(kMostWarnings);
    warnings.push_back(fmt::format("{}: warning: {} more are not shown", options.eds, not_kept));
  }
  for (const std::string& warning : warnings) ToStderr("{}\n", warning);
  if (options.json) {
    nlohmann::ordered_json report{{"eds", options.eds}};
    if (options.out.empty()) {
      report["profile"] = draft.text;
    } else {
      report["out"] = options.out;
    }
    report["to_fill_in"] = draft.to_fill_in;
    report["warnings"] = warnings;
    ToStdout("{}\n", report.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  } else if (options.out.empty()) {
    ToStdout("{}", draft.text);
  } else {
    ToStdout("{}: {} values to fill in: {}\n", options.out, draft.to_fill_in.size(),
             fmt::join(draft.to_fill_in, ", "));
  }
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddDriveProfile(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "drive-profile",
      "A drive profile to start from, out of the EDS or DCF file of its maker; what no such file tells is "
      "left "
      "to be filled in.\n"
      "Example: strainwave drive-profile bench/devices/profiles/strainwave_drive.eds --out my_drive.yaml");
  auto options = std::make_shared<DriveProfileOptions>();
  command->add_option("EDS", options->eds, "EDS or DCF file of a drive on CANopen (CiA 306)")->required();
  command->add_option("--out", options->out, "profile to write, a new file; without it to standard output");
  command->add_flag("--json", options->json, "what was written and what is to be filled in, as JSON");
  command->callback([options, &action] { action = [options] { return WriteDraft(*options); }; });
}

}  // namespace strainwave::bench
