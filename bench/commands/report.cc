// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/campaign/disk_room.h"
#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/commands/server_option.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/report/csv_tables.h"
#include "bench/report/document.h"
#include "bench/report/filed_papers.h"
#include "bench/report/html.h"
#include "bench/report/pdf.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

constexpr double kForecastLevel = 0.95;

struct ReportOptions {
  std::vector<std::string> folders;
  FromServer from;
  std::string out;
  std::string csv;
  std::string pdf;
  std::vector<std::string> diagnoses;
  std::vector<std::string> predictors;
  std::vector<std::string> trip_tests;
  bool json{};
};

// What lies in the folder of a campaign, then what was given; each once.
FiledPapers PapersOf(const ReportOptions& options) {
  FiledPapers papers;
  const auto take = [](const auto& from, std::vector<std::filesystem::path>& to) {
    for (const auto& name : from) {
      const std::filesystem::path path(name);
      const auto same = [&](const std::filesystem::path& other) {
        return std::filesystem::weakly_canonical(other) == std::filesystem::weakly_canonical(path);
      };
      if (std::ranges::none_of(to, same)) to.push_back(path);
    }
  };
  for (const std::string& folder : options.folders) {
    const FiledPapers here = PapersIn(folder);
    take(here.diagnoses, papers.diagnoses);
    take(here.predictors, papers.predictors);
    take(here.trip_tests, papers.trip_tests);
  }
  take(options.diagnoses, papers.diagnoses);
  take(options.predictors, papers.predictors);
  take(options.trip_tests, papers.trip_tests);
  return papers;
}

// The page itself is there whether it can be printed or not.
std::string PrintedOrWhyNot(const std::string& html, const std::string& pdf) {
  try {
    WritePdf(html, pdf);
    return {};
  } catch (const PdfError& error) {
    return error.what();
  }
}

int WriteReport(const ReportOptions& given) {
  DemandOutputFile(given.out);
  if (!given.csv.empty()) DemandOutputFolder(given.csv);
  if (!given.pdf.empty()) DemandOutputFile(given.pdf);
  const CampaignFolders folders(given.folders, given.from);
  ReportOptions options = given;
  options.folders = folders.paths();
  std::vector<std::string> warnings;
  const std::vector<ReportSection> filed = FiledSections(PapersOf(options));
  std::vector<CampaignSheet> sheets;
  for (const std::string& folder : options.folders)
    sheets.push_back(ReadCampaignSheet(folder, kForecastLevel, warnings));
  const ReportDocument document = ReportDocumentOf(sheets, filed, warnings);
  for (const std::string& warning : warnings) ToStderr("{}\n", warning);
  warnings.insert(warnings.begin(), folders.warnings().begin(), folders.warnings().end());
  const std::string html = HtmlOf(document);
  daq::WriteFileAtomically(options.out, html);
  const int files = options.csv.empty() ? 0 : WriteCsvTables(document, sheets, options.csv);
  const std::string no_pdf = options.pdf.empty() ? "" : PrintedOrWhyNot(html, options.pdf);
  const bool printed = !options.pdf.empty() && no_pdf.empty();
  if (options.json) {
    nlohmann::ordered_json written{{"folders", options.folders},
                                   {"out", options.out},
                                   {"bytes", html.size()},
                                   {"csv_files", files},
                                   {"warnings", warnings}};
    if (printed) written["pdf"] = options.pdf;
    ToStdout("{}\n", written.dump(2));
  } else {
    ToStdout("{}: {} campaign{}, {} sections, {}\n", options.out, sheets.size(),
             sheets.size() == 1 ? "" : "s", document.sections.size(),
             BytesText(static_cast<double>(html.size())));
    if (files > 0) ToStdout("{}: {} tables as CSV\n", options.csv, files);
    if (printed) ToStdout("{}: the page on paper\n", options.pdf);
  }
  if (no_pdf.empty()) return static_cast<int>(ExitCode::kDone);
  ToStderr("error: no PDF: {}\n", no_pdf);
  return static_cast<int>(ExitCode::kMachineFailed);
}

}  // namespace

void AddReport(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("report",
                         "One page of a campaign, or of several beside each other, to keep and to print: "
                         "what was tested, how it went, "
                         "what has changed with 95 % intervals, when stop criteria will be met, and whether "
                         "all of it is still what was "
                         "written. It loads nothing from elsewhere.\n"
                         "Example: strainwave report campaigns/first --out first.html --csv first_tables");
  auto options = std::make_shared<ReportOptions>();
  CLI::Option* const folders = command->add_option("DIR", options->folders, "folders of campaigns");
  AddFromServer(*command, options->from, folders);
  command->add_option("--out", options->out, "HTML file to write; one of that name is replaced")->required();
  command->add_option("--csv", options->csv,
                      "folder for the same numbers as CSV; files of the same names are replaced");
  command->add_option("--pdf", options->pdf,
                      "the page as PDF on A4 besides, printed by Chromium where that is installed; one of "
                      "that name is replaced");
  command
      ->add_option(
          "--trip-test", options->trip_tests,
          "sheet of bench trip-test --out to show, beside trip_test.json of a campaign's folder; may "
          "be given several times")
      ->allow_extra_args(false);
  command
      ->add_option("--diagnosis", options->diagnoses,
                   "diagnosis.json to show, beside diagnosis/diagnosis.json of a campaign's folder; may be "
                   "given several times")
      ->allow_extra_args(false);
  command
      ->add_option("--predictor", options->predictors,
                   "folder of train or export whose card to show, beside predictor/ of a campaign's folder; "
                   "may be given several times")
      ->allow_extra_args(false);
  command->add_flag("--json", options->json, "what was written, as JSON on standard output");
  command->callback([options, &action] { action = [options] { return WriteReport(*options); }; });
}

}  // namespace strainwave::bench
