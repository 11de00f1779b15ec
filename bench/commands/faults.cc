// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <mutex>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "analysis/units.h"
#include "bench/commands/commands.h"
#include "bench/commands/fault_report.h"
#include "bench/commands/map_option.h"
#include "bench/commands/output.h"
#include "bench/commands/tell_warnings.h"
#include "bench/commands/terminal.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/faults/fault_json.h"
#include "bench/faults/fault_model.h"
#include "bench/faults/fault_pictures.h"
#include "bench/faults/train_faults.h"
#include "bench/prediction/record_features.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

struct FaultTrainCommand {
  std::string folder;
  std::string out;
  std::vector<std::string> splits;
  std::vector<std::string> where;
  std::string features{"better"};
  std::string line{"ours"};
  std::string bearing;
  std::string plots;
  std::string map;
  bool multi_label{};
  analysis::features::DetailRecipe details;
  FaultJob job;
  bool json{};
};

struct FaultClassifyCommand {
  std::string model;
  std::vector<std::string> paths;
  std::optional<double> input_speed_rpm;
  std::string map;
  std::string bearing;
  bool json{};
};

constexpr const char* kBearingHelp =
    "N,d,D or N,d,D,angle: elements, diameters of an element and of the pitch circle in mm, contact angle in "
    "degrees; classify then shows how far its lines stand out of the envelope, at a steady speed";

FaultFeatures FaultFeaturesOf(const std::string& name) {
  if (name == "details") return FaultFeatures::kDetails;
  return name == "envelope_orders" ? FaultFeatures::kEnvelopeOrders : FaultFeatures::kBetter;
}

// Speeds that stand beside the records, under either name; none where they do not.
std::vector<double> SpeedsOf(const Labels& table) {
  constexpr double kFastest_rpm = 1e6;
  for (const char* column : {"input_speed_rpm", "speed_rpm"}) {
    if (table.Has(column)) return table.Numbers(column, -kFastest_rpm, kFastest_rpm);
  }
  return {};
}

// Of short and long filters, of each family.
const std::vector<std::string> kWaveletsToCompare{"haar", "db2", "db4", "db6", "db10", "sym4", "coif2"};

analysis::RollingBearing BearingOf(const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = text.find(',', begin);
    const auto number =
        daq::NumberFromText(text.substr(begin, comma == std::string::npos ? comma : comma - begin));
    if (!number) break;
    numbers.push_back(*number);
    if (comma == std::string::npos) break;
    begin = comma + 1;
  }
  const bool fits = (numbers.size() == 3 || numbers.size() == 4) && numbers[0] >= 1.0 &&
                    numbers[0] <= 1000.0 && numbers[0] == std::floor(numbers[0]);
  if (!fits || std::ranges::count(text, ',') + 1 != static_cast<std::ptrdiff_t>(numbers.size()))
    Refuse("--bearing", fmt::format("'{}'", text),
           "elements,element diameter in mm,pitch diameter in mm[,contact angle in degrees]");
  const analysis::RollingBearing bearing{
      .elements = static_cast<int>(numbers[0]),
      .element_diameter_m = 1e-3 * numbers[1],
      .pitch_diameter_m = 1e-3 * numbers[2],
      .contact_angle_rad = numbers.size() == 4 ? RadFromDeg(numbers[3]) : 0.0};
  try {
    analysis::BearingOrdersOf(bearing);
  } catch (const std::invalid_argument& error) {
    Refuse("--bearing", error.what(), "a bearing");
  }
  return bearing;
}

// The pictures, and of one record its details.
std::vector<fs::path> DrawAll(const FaultRecords& records, const FaultOutcome& outcome, const fs::path& data,
                              const RecordReader& reader, const fs::path& folder) {
  std::vector<fs::path> pictures = DrawFaults(records, outcome, folder);
  const std::vector<daq::Record> shown =
      ReadVibrationRecords(data / records.files.back(), MotorTorque::kAsRecorded, reader);
  pictures.push_back(DrawDetails(shown.front(), records.channels.front(), SampleRateOf_hz(shown.front()),
                                 records.tables.front().settings.details, folder / "details"));
  return pictures;
}

int TrainFaultModel(const FaultTrainCommand& command) {
  DemandOutputFolder(command.out);
  if (!command.plots.empty()) DemandOutputFolder(command.plots);
  std::vector<LabelFilter> filters;
  for (const std::string& text : command.where) filters.push_back(LabelFilterOf(text));
  const RecordReader reader(command.map);
  const Labels table = ReadLabels(command.folder);
  FaultLabels labels = FaultLabelsOf(
      table, filters, command.multi_label ? FaultTargets::kLabels : FaultTargets::kAsThere, command.splits);
  FaultJob job = command.job;
  job.network.line = analysis::faults::FaultLineOf(command.line);
  job.features = FaultFeaturesOf(command.features);
  if (!command.bearing.empty()) job.bearing = BearingOf(command.bearing);
  analysis::features::DetailRecipe details = command.details;
  // The study takes deviations as they are.
  details.logarithm = job.network.line == analysis::faults::FaultLine::kOurs;
  // Reading is some half of the work.
  constexpr double kShareOfReading = 0.5;
  ShareLine line;
  std::vector<std::string> wavelets = job.compare ? kWaveletsToCompare : std::vector<std::string>{};
  std::erase(wavelets, details.wavelet);
  const FaultRecords records =
      ReadFaultRecords(table, std::move(labels), details, wavelets, SpeedsOf(table), reader,
                       [&](std::size_t done, std::size_t all) {
                         line.Show(fmt::format("reading record {} of {}", done, all),
                                   kShareOfReading * static_cast<double>(done) / static_cast<double>(all));
                         return true;
                       });
  const FaultOutcome outcome =
      TrainFaults(command.folder, records, job, [&](const std::string& step, double share) {
        line.Show(step, kShareOfReading + (1.0 - kShareOfReading) * share);
        return true;
      });
  WriteFaultModel(command.out, outcome.model);
  std::vector<fs::path> pictures;
  if (!command.plots.empty()) pictures = DrawAll(records, outcome, command.folder, reader, command.plots);
  line.Clear();
  TellWarnings(records.warnings);
  if (command.json) {
    ToStdout("{}\n", FaultReport(command.folder, records, outcome).dump(2));
  } else {
    PrintFaultTraining(records, outcome);
    ToStdout("\nmodel: {}\n", command.out);
    for (const fs::path& picture : pictures) ToStdout("picture: {}.svg (and .png)\n", picture.string());
  }
  return static_cast<int>(ExitCode::kDone);
}

// Files as they are; of folders all records below, in the order of their names.
std::vector<fs::path> RecordFilesBelow(const std::vector<std::string>& paths) {
  std::vector<fs::path> files;
  for (const std::string& path : paths) {
    if (!fs::is_directory(path)) {
      files.emplace_back(path);
      continue;
    }
    std::vector<fs::path> within;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path)) {
      const std::string ending = entry.path().extension().string();
      const bool is_record = ending == ".csv" || ending == ".h5" || ending == ".hdf5";
      if (entry.is_regular_file() && is_record && entry.path().filename() != "labels.csv")
        within.push_back(entry.path());
    }
    if (within.empty()) Refuse(path, "has no record", "files .csv, .h5 or .hdf5");
    std::ranges::sort(within);
    files.insert(files.end(), within.begin(), within.end());
  }
  return files;
}

int ClassifyFaults(const FaultClassifyCommand& command) {
  FaultModel model = ReadFaultModel(command.model);
  if (!command.bearing.empty()) model.bearing = BearingOf(command.bearing);
  const RecordReader reader(command.map);
  const std::vector<fs::path> files = RecordFilesBelow(command.paths);
  nlohmann::ordered_json verdicts = nlohmann::ordered_json::array();
  ShareLine line;
  std::size_t undecided = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    line.Show("classifying " + FileText(files[i]),
              static_cast<double>(i) / static_cast<double>(files.size()));
    for (const daq::Record& record : ReadVibrationRecords(files[i], MotorTorque::kAsRecorded, reader)) {
      TellWarnings(WarningsOf(record));
      const FaultVerdict verdict = Judge(model, record, command.input_speed_rpm);
      if (verdict.undecided) ++undecided;
      verdicts.push_back(VerdictJson(model, verdict));
      if (!command.json) PrintFaultVerdict(model, verdict);
    }
  }
  line.Clear();
  if (command.json) {
    ToStdout("{}\n", verdicts.dump(2));
  } else if (verdicts.size() > 1) {
    ToStdout("{} records, {} undecided\n", verdicts.size(), undecided);
  }
  return static_cast<int>(ExitCode::kDone);
}

void AddFaultTrain(CLI::App& faults, Action& action) {
  CLI::App* command = faults.add_subcommand(
      "train",
      "Learn the faults of a folder of vibration records with labels.csv, and tell how well they are told on "
      "units, and on values of --split columns, that were not seen.\n"
      "Example: strainwave faults train joint --out joint_faults --split load_kg --split speed_percent");
  auto options = std::make_shared<FaultTrainCommand>();
  command
      ->add_option(
          "DIR", options->folder,
          "records of kind vibration beside labels.csv: file, unit, and class, or fault_NAME of 0 and 1")
      ->required();
  command->add_option("--out", options->out, "folder of the model")->required();
  command->add_option(
      "--split", options->splits,
      "a column of labels.csv, each of whose values is left out in turn; several times for more");
  command->add_option(
      "--where", options->where,
      "only rows of labels.csv with COLUMN=VALUE or COLUMN=VALUE,VALUE; several times for more");
  command->add_flag("--multi-label", options->multi_label,
                    "several faults at once, of the columns fault_NAME, also where there is a class");
  command
      ->add_option(
          "--features", options->features,
          "details (standard deviations of wavelet details), envelope_orders (orders of the envelope, "
          "where each record tells a steady speed), or the better of both on honest splits")
      ->capture_default_str()
      ->check(CLI::IsMember({"better", "details", "envelope_orders"}));
  command
      ->add_option("--wavelet", options->details.wavelet, "haar, db1 to db20, sym2 to sym20, coif1 to coif5")
      ->capture_default_str();
  command
      ->add_option("--levels", options->details.levels,
                   "of details, or as many as the shortest record allows")
      ->capture_default_str()
      ->check(CLI::Range(1, analysis::wavelets::kMostLevels));
  command
      ->add_option("--line", options->line,
                   "ours (softmax and cross-entropy), or that of the study (sigmoid, linear, squared error)")
      ->capture_default_str()
      ->check(CLI::IsMember({"ours", "study"}));
  command->add_option("--hidden", options->job.network.hidden, "neurons of the hidden layer")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->add_option("--epochs", options->job.network.epochs, "0: 300 of ours, 50000 of the study's at most")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000000));
  command
      ->add_option("--undecided-below", options->job.rule.least_probability,
                   "the most probable class must have this probability")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  command
      ->add_option("--undecided-margin", options->job.rule.least_margin,
                   "and lead the next one by this; a fault of several must be half of it off its threshold")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  command->add_flag("--compare", options->job.compare,
                    "also the accuracy over the levels that are kept, and by other wavelets");
  command->add_option("--bearing", options->bearing, kBearingHelp);
  command->add_option("--plots", options->plots, "folder for pictures");
  command->add_option("--seed", options->job.network.seed, "of start values and random folds")
      ->capture_default_str();
  AddMapOption(*command, options->map);
  command->add_flag("--json", options->json, "the report as JSON on standard output");
  command->callback([options, &action] { action = [options] { return TrainFaultModel(*options); }; });
}

void AddFaultClassify(CLI::App& faults, Action& action) {
  CLI::App* command = faults.add_subcommand(
      "classify",
      "Tell the class of vibration records, with probabilities, or that it is undecided, and why.\n"
      "Example: strainwave faults classify joint_faults joint/records/0001.h5");
  auto options = std::make_shared<FaultClassifyCommand>();
  command->add_option("MODEL", options->model, "folder that faults train has written")->required();
  command->add_option("PATH", options->paths, "vibration records (CSV, HDF5), or folders of them")
      ->required();
  command->add_option("--input-speed", options->input_speed_rpm,
                      "rpm of the shaft, where a record does not tell it (input_speed_rpm)");
  command->add_option("--bearing", options->bearing, kBearingHelp);
  AddMapOption(*command, options->map);
  command->add_flag("--json", options->json, "an array with an object a record, on standard output");
  command->callback([options, &action] { action = [options] { return ClassifyFaults(*options); }; });
}

}  // namespace

void AddFaults(CLI::App& app, Action& action) {
  CLI::App* faults = app.add_subcommand(
      "faults",
      "Faults of bearings from vibration: learn classes from labelled records, and classify others.\n"
      "Example: strainwave faults train joint --out joint_faults");
  faults->require_subcommand(1);
  AddFaultTrain(*faults, action);
  AddFaultClassify(*faults, action);
}

}  // namespace strainwave::bench
