// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <stdexcept>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/campaign/folder.h"
#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/commands/tell_warnings.h"
#include "bench/diagnosis/make_study.h"
#include "bench/diagnosis/simulate_record.h"
#include "bench/errors/bench_error.h"
#include "bench/records/look_at_samples.h"
#include "daq/csv_record.h"
#include "daq/cycle_file.h"
#include "daq/read_records.h"

namespace strainwave::bench {
namespace {

struct SimulateOptions {
  std::string model;
  std::string like;
  std::string out;
  std::string group;
  std::uint64_t seed{1};
  bool no_noise{};
  bool corrections{};
  bool json{};
};

// The first record of the model's kind.
daq::Record ReadLike(const SimulateOptions& options, StudyKind kind) {
  for (daq::Record& record : daq::ReadRecords(options.like)) {
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

void Write(const daq::Record& record, const std::filesystem::path& path) {
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
  const std::string ending = path.extension().string();
  if (ending == ".h5" || ending == ".hdf5") {
    const daq::NamedRecord named{std::string(record.kind.name()), record};
    daq::WriteRecordsAtomically(path, {&named, 1});
  } else {
    daq::WriteCsvRecord(record, path);
  }
}

int Simulate(const SimulateOptions& options) {
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
  Write(record, options.out);
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
  command
      ->add_option("MODEL", options->model,
                   "an extended_model.yaml, or the nominal model of a kind: transmission_error, hysteresis, "
                   "motion, vibration")
      ->required();
  command->add_option("--like", options->like,
                      "record whose excitation the model runs on; without it, the usual one of its kind");
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
