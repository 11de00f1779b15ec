// SPDX-License-Identifier: Apache-2.0

#include <malloc.h>

#include <memory>

#include <CLI/CLI.hpp>

#include "bench/campaign/folder.h"
#include "bench/commands/commands.h"
#include "bench/commands/diagnose_steps.h"
#include "bench/commands/map_option.h"
#include "bench/commands/output.h"
#include "bench/commands/terminal.h"
#include "bench/diagnosis/diagnosis_json.h"
#include "bench/diagnosis/diagnosis_text.h"
#include "bench/diagnosis/power_report.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"

namespace strainwave::bench {
namespace {

// What the diagnosis itself takes of the time; the rest are pictures.
constexpr double kShareOfFits = 0.8;

// Fits take and leave arrays of the record's length all the time: given back to the system each time, they
// cost a quarter of the diagnosis in pages that have to be cleared again.
void KeepFreedMemory() {
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  mallopt(M_TOP_PAD, 16 << 20);
}

// Each of some hundred records would be judged by up to 19 more.
void RefusePowerOfSimulation(const DiagnoseCommand& command) {
  if (command.power && command.choice.simulated)
    Refuse(command.paths.front(), "--power beside --judge-by-simulation", "one of the two");
}

int Run(const DiagnoseCommand& command) {
  RefusePowerOfSimulation(command);
  if (!command.out.empty()) DemandOutputFolder(command.out);
  KeepFreedMemory();
  if (command.by_specimen) return RunBySpecimen(command);
  ShareLine line;
  line.Show("reading " + FileText(command.paths.front()), 0.0);
  RecordChoice choice = command.choice;
  choice.reader = RecordReader(command.map);
  const double of_fits = command.out.empty() ? 1.0 : kShareOfFits;
  const FinishedDiagnosis finished =
      DiagnoseInput(ReadStudyInput(command.paths, choice), {}, command, line,
                    [&](const std::string& step, double share) { line.Show(step, share * of_fits); });
  DiagnosisFiles files;
  if (!command.out.empty()) {
    files = WriteDiagnosis(finished, command.out, [&](double share) {
      line.Show("pictures", kShareOfFits + (1.0 - kShareOfFits) * share);
    });
  }
  line.Clear();
  const DiagnosisReport report = finished.Report();
  command.json ? ToStdout("{}\n", DiagnosisJson(report).dump(2))
               : ToStdout("{}{}{}", DiagnosisText(report, command.details),
                          PowerText(report, DurationText(finished.power_took_s)), files.text);
  return CodeOfPictures(files.picture_trouble);
}

}  // namespace

void AddDiagnose(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "diagnose",
      "Show what the simulation gets wrong about measured records of one kind, name the cause, write the "
      "extended model, and measure the gain.\n"
      "Example: strainwave diagnose loop.csv --out diagnosis");
  auto options = std::make_shared<DiagnoseCommand>();
  command
      ->add_option(
          "RECORD", options->paths,
          "record files (CSV, HDF5), fitted together; or one campaign folder: its results cycle by cycle")
      ->required();
  command->add_option("--model", options->model,
                      "extended_model.yaml to go on from: its causes count as known");
  command->add_option("--out", options->out,
                      "folder for extended_model.yaml, diagnosis.json and the pictures (SVG and PNG)");
  command->add_option("--kind", options->choice.kind, "of files with records of several kinds: the one meant")
      ->check(CLI::IsMember({"transmission_error", "hysteresis", "motion", "vibration"}));
  command->add_option("--group", options->choice.group,
                      "of HDF5 files: only records with this in the name of their group");
  command->add_flag("--by-specimen", options->by_specimen,
                    "records of several specimens: each is diagnosed by itself, then what they share (the "
                    "bench) and what is one's own (the unit)");
  command->add_option("--seed", options->seed, "of the bootstrap")->capture_default_str();
  command->add_flag("--details", options->details, "with the numbers of every line and every channel");
  command->add_flag(
      "--judge-by-simulation", options->choice.simulated,
      "of motion: a cause is named only if records of an axis in closed loop, simulated without it, "
      "do not show as much; takes up to 20 times as long");
  command->add_flag("--power", options->power,
                    "how large each effect has to be in these records to be found nine times of ten: each is "
                    "planted into them at growing size, and searched for; takes some hundred times as long");
  AddMapOption(*command, options->map);
  command->add_flag("--json", options->json, "the diagnosis as JSON on standard output");
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

}  // namespace strainwave::bench
