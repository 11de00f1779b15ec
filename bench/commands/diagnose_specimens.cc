// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "analysis/diagnosis/between_specimens.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/commands/diagnose_steps.h"
#include "bench/commands/output.h"
#include "bench/diagnosis/diagnosis_text.h"
#include "bench/diagnosis/power_report.h"
#include "bench/diagnosis/specimen_inputs.h"
#include "bench/diagnosis/specimens_report.h"
#include "bench/plots/gnuplot.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;

// Of the time, about: until all are diagnosed, and until they are compared; the rest are pictures.
constexpr double kShareOfDiagnoses = 0.75;
constexpr double kShareUntilCompared = 0.8;

struct FinishedSpecimen {
  std::string name;
  std::string folder;
  FinishedDiagnosis finished;
};

std::vector<diagnosis::SpecimenComparison> Compared(const std::vector<FinishedSpecimen>& specimens) {
  std::vector<diagnosis::DiagnosedSpecimen> diagnosed;
  for (const FinishedSpecimen& specimen : specimens)
    diagnosed.push_back({*specimen.finished.input.study, specimen.finished.result});
  diagnosis::CompareSpecimensOptions options;
  options.phases = PhasesHaveOneZero(specimens.front().finished.input.kind);
  options.parallel = OnAllProcessors;
  return diagnosis::CompareSpecimens(diagnosed, options);
}

// Folders of the specimens, and beside them what they share.
DiagnosisFiles WriteSpecimens(const std::vector<FinishedSpecimen>& specimens, const SpecimensReport& report,
                              const std::filesystem::path& folder, ShareLine& line) {
  DiagnosisFiles files;
  for (std::size_t k = 0; k < specimens.size(); ++k) {
    const DiagnosisFiles own =
        WriteDiagnosis(specimens[k].finished, folder / specimens[k].folder, [&](double share) {
          const double done = (static_cast<double>(k) + share) / static_cast<double>(specimens.size());
          line.Show(specimens[k].name + ": pictures",
                    kShareUntilCompared + (1.0 - kShareUntilCompared) * done);
        });
    files.text += Text("\n{:<13}{}", k == 0 ? "folders" : "", (folder / specimens[k].folder).string());
    if (!own.picture_trouble.empty()) files.picture_trouble = own.picture_trouble;
  }
  const std::filesystem::path together = folder / "specimens.json";
  daq::WriteFileAtomically(together, SpecimensJson(report).dump(2) + "\n");
  files.text += Text("\ntogether     {}\n", together.string());
  if (!HasSpecimensPicture(report)) return files;
  try {
    files.text +=
        Text("picture      {}.svg (and .png)\n", DrawSpecimens(report, folder / "specimens").string());
  } catch (const GnuplotError& error) {
    files.picture_trouble = error.what();
  }
  return files;
}

// What each specimen's own diagnosis would have printed, where it was asked for.
std::string OwnTexts(const std::vector<FinishedSpecimen>& specimens, const DiagnoseCommand& command) {
  std::string text;
  for (const FinishedSpecimen& specimen : specimens) {
    const DiagnosisReport report = specimen.finished.Report();
    const std::string power = PowerText(report, DurationText(specimen.finished.power_took_s));
    if (!command.details && power.empty()) continue;
    text +=
        Text("\n== {} ==\n{}{}", specimen.name, command.details ? DiagnosisText(report, true) : "", power);
  }
  return text;
}

}  // namespace

int RunBySpecimen(const DiagnoseCommand& command) {
  ShareLine line;
  line.Show("reading " + FileText(command.paths.front()), 0.0);
  RecordChoice choice = command.choice;
  choice.reader = RecordReader(command.map);
  std::vector<SpecimenInput> inputs = ReadSpecimenInputs(command.paths, choice);
  std::vector<FinishedSpecimen> specimens;
  for (SpecimenInput& input : inputs) {
    const auto done = static_cast<double>(specimens.size());
    FinishedDiagnosis finished = DiagnoseInput(
        std::move(input.input), input.name, command, line, [&](const std::string& step, double share) {
          line.Show(input.name + ": " + step,
                    kShareOfDiagnoses * (done + share) / static_cast<double>(inputs.size()));
        });
    specimens.push_back({input.name, input.folder, std::move(finished)});
  }
  line.Show("comparing the specimens", kShareOfDiagnoses);
  SpecimensReport report{{}, Compared(specimens)};
  for (const FinishedSpecimen& specimen : specimens)
    report.specimens.push_back({specimen.name, specimen.folder, specimen.finished.Report()});
  DiagnosisFiles files;
  if (!command.out.empty()) files = WriteSpecimens(specimens, report, command.out, line);
  line.Clear();
  command.json ? ToStdout("{}\n", SpecimensJson(report).dump(2))
               : ToStdout("{}{}{}", SpecimensText(report), OwnTexts(specimens, command), files.text);
  return CodeOfPictures(files.picture_trouble);
}

}  // namespace strainwave::bench
