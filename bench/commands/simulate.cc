// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <optional>
#include <stdexcept>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/campaign/folder.h"
#include "bench/commands/commands.h"
#include "bench/commands/map_option.h"
#include "bench/commands/output.h"
#include "bench/commands/tell_warnings.h"
#include "bench/commands/terminal.h"
#include "bench/diagnosis/make_study.h"
#include "bench/diagnosis/simulate_record.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/records/look_at_samples.h"
#include "bench/records/record_reader.h"
#include "bench/records/write_record.h"
#include "bench/studies/studies.h"

namespace strainwave::bench {
namespace {

struct SimulateOptions {
  std::string model;
  std::string like;
  std::string out;
  std::string group;
  std::uint64_t seed{1};
  std::string study;
  std::optional<int> units;
  bool no_noise{};
  bool corrections{};
  std::string map;
  bool json{};
};

// The first record of the model's kind.
daq::Record ReadLike(const SimulateOptions& options, StudyKind kind) {
  for (daq::Record& record : RecordReader(options.map).Read(options.like)) {
    if (StudyKindOf(record.kind) != kind || record.source.group.find(options.group) == std::string::npos)
      continue;
    LookAtSamples(record);
    TellWarnings(WarningsOf(record));
    return std::move(record);
  }
  throw BenchError(ExitCode::kWrongInput,
                   fmt::format("{}: error: no record of kind {} (expected the kind of the model {})",
                               options.like, NameOf(kind), options.model));
}

int SimulateStudy(const SimulateOptions& options) {
  if (!options.model.empty())
    Refuse("simulate", fmt::format("both a model, {}, and --study are given", options.model), "one of them");
  DemandOutputFolder(options.out);
  ShareLine line;
  const auto progress = [&](std::size_t done, std::size_t all) {
    line.Show(fmt::format("record {} of {}", done, all),
              static_cast<double>(done) / static_cast<double>(all));
  };
  const StudySummary made = MakeStudy(options.study, {options.out, options.seed, options.units, progress});
  line.Clear();
  if (options.json) {
    ToStdout("{}\n", nlohmann::ordered_json{{"study", options.study},
                                            {"folder", options.out},
                                            {"files", made.files},
                                            {"units", made.units},
                                            {"labels", made.label_columns},
                                            {"seed", options.seed}}
                         .dump(2));
  } else {
    ToStdout("{}: {} records of {} units, seed {}; labels.csv says {}\n", options.out, made.files, made.units,
             options.seed, fmt::join(made.label_columns, ", "));
  }
  return static_cast<int>(ExitCode::kDone);
}

int Simulate(const SimulateOptions& options) {
  if (!options.study.empty()) return SimulateStudy(options);
  if (options.model.empty())
    Refuse("simulate", "neither MODEL nor --study is given",
           "a model, such as motion, or the name of a data set");
  DemandFolderOf(options.out);
  const RunnableModel model = ReadRunnableModel(options.model, options.corrections);
  const bool alike = !options.like.empty();
  const daq::Record like = alike ? ReadLike(options, model.kind) : ExcitationFor(model);
  daq::Record record;
  try {
    record = SimulateRecord(model, like, options.seed, !options.no_noise);
  } catch (const std::invalid_argument& error) {
    const std::string words =
        alike ? error.what()
              : fmt::format("{}; --like RECORD runs it on the excitation of a record", error.what());
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("{}: error: {}", alike ? options.like : options.model, words));
  }
  record.SetMetadata("simulated_model", options.model);
  record.SetMetadata("simulated_seed", std::to_string(options.seed));
  WriteRecords({&record, 1}, options.out);
  const std::string sha256 = Sha256(ReadText(options.out));
  if (options.json) {
    ToStdout("{}\n", nlohmann::ordered_json{{"record", options.out},
                                            {"kind", record.kind.name()},
                                            {"rows", record.rows()},
                                            {"seed", options.seed},
                                            {"noise", options.no_noise ? 0.0 : model.noise},
                                            {"sha256", sha256}}
                         .dump(2));
  } else {
    ToStdout("{}: {}, {} rows, seed {}\n", options.out, record.kind.name(), record.rows(), options.seed);
  }
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddSimulate(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "simulate",
      "Run a model and write the record that it would have measured.\n"
      "Example: strainwave simulate diagnosis/extended_model.yaml --like loop.csv --out simulated.csv");
  auto options = std::make_shared<SimulateOptions>();
  command->add_option(
      "MODEL", options->model,
      "an extended_model.yaml, or the nominal model of a kind: transmission_error, hysteresis, "
      "motion, vibration");
  std::string studies;
  for (const Study& study : Studies()) studies += fmt::format("\n{}: {}", study.name, study.what);
  command->add_option(
      "--study", options->study,
      "in place of MODEL: a data set of many records with labels.csv, in the folder --out" + studies);
  command->add_option("--units", options->units, "of a study: assemblies a condition");
  command->add_option("--like", options->like,
                      "record whose excitation the model runs on; without it, the usual one of its kind");
  AddMapOption(*command, options->map);
  command->add_option("--group", options->group, "of an HDF5 file: part of the name of the record's group");
  command->add_option("--out", options->out, "record to write: CSV, or HDF5 where the name ends in .h5")
      ->required();
  command->add_option("--seed", options->seed, "of the noise")->capture_default_str();
  command->add_flag("--no-noise", options->no_noise, "the response alone");
  command->add_flag("--corrections", options->corrections,
                    "with the model's corrections, which describe and are no physics");
  command->add_flag("--json", options->json, "what was written, as JSON on standard output");
  command->callback([options, &action] { action = [options] { return Simulate(*options); }; });
}

}  // namespace strainwave::bench
