// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/campaign/disk_room.h"
#include "bench/commands/alarm_report.h"
#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/commands/terminal.h"
#include "bench/errors/bench_error.h"
#include "bench/escaped.h"
#include "bench/integrity/campaign_integrity.h"
#include "bench/integrity/salvage.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kFilesShown = 20;

struct VerifyOptions {
  std::string folder;
  std::string salvage;  // folder; empty: nothing is written
  bool json{};
};

nlohmann::json JournalJson(const JournalIntegrity& journal) {
  return {{"state", Name(journal.state)},     {"reason", journal.reason},
          {"pages", journal.pages},           {"damaged_pages", journal.damaged_pages},
          {"log_frames", journal.log.frames}, {"log_damage", journal.log.damage}};
}

nlohmann::json ChainJson(const JournalIntegrity& journal) {
  if (!journal.has_chain) return {{"state", "none"}};
  nlohmann::json broken = nlohmann::json::array();
  for (const BrokenLink& link : journal.chain.broken) {
    broken.push_back({{"link", link.number}, {"what", link.what}, {"why", link.why}});
  }
  return {{"state", journal.chain.IsWhole() ? "whole" : "broken"},
          {"links", journal.chain.links},
          {"head", journal.chain.head},
          {"broken_links", journal.chain.broken_links},
          {"broken", std::move(broken)},
          {"unchained", journal.chain.unchained}};
}

nlohmann::json FileJson(const FileIntegrity& file) {
  nlohmann::json records = nlohmann::json::array();
  for (const daq::RecordCheck& record : file.records) {
    records.push_back({{"record", record.group},
                       {"state", record.damage.empty() ? "whole" : "damaged"},
                       {"reason", record.damage}});
  }
  return {{"path", file.path},         {"cycle", file.cycle ? nlohmann::json(*file.cycle) : nlohmann::json()},
          {"state", Name(file.state)}, {"bytes", file.bytes},
          {"reason", file.reason},     {"records", std::move(records)}};
}

nlohmann::json Json(const CampaignFolder& folder, const CampaignIntegrity& integrity) {
  nlohmann::json files = nlohmann::json::array();
  for (const FileIntegrity& file : integrity.files) files.push_back(FileJson(file));
  nlohmann::json counts;
  for (const FileState state :
       {FileState::kWhole, FileState::kDamaged, FileState::kMissing, FileState::kUnregistered}) {
    counts[std::string(Name(state))] = integrity.Count(state);
  }
  return {{"folder", folder.root.string()},
          {"state", Name(integrity.verdict())},
          {"cycles_complete", integrity.cycles},
          {"bytes_read", integrity.bytes},
          {"running", integrity.process > 0},
          {"journal", JournalJson(integrity.journal)},
          {"chain", ChainJson(integrity.journal)},
          {"counts", std::move(counts)},
          {"files", std::move(files)}};
}

void PrintJournal(const JournalIntegrity& journal) {
  ToStdout("  journal      {}{}\n", Name(journal.state),
           journal.reason.empty()
               ? fmt::format(": {} pages, {} frames of its log", journal.pages, journal.log.frames)
               : ": " + journal.reason);
  if (!journal.log.damage.empty()) ToStdout("  log          damaged: {}\n", journal.log.damage);
  if (!journal.has_chain) {
    if (journal.state == FileState::kWhole)
      ToStdout("  chain        none: the journal is of an earlier version\n");
    return;
  }
  ToStdout("  chain        {}: {} links, head {}\n", journal.chain.IsWhole() ? "whole" : "broken",
           journal.chain.links, journal.chain.head);
  for (const BrokenLink& link : journal.chain.broken) {
    ToStdout("    link {}, {}: {}\n", link.number, Escaped(link.what), link.why);
  }
  const auto more = journal.chain.broken_links - static_cast<std::int64_t>(journal.chain.broken.size());
  if (more > 0) ToStdout("    and {} more\n", more);
  for (const auto& [kind, count] : journal.chain.unchained) {
    ToStdout(
        "    {} row(s) of kind {} have no link: they were not written by this program, or by one before it\n",
        count, kind);
  }
}

void PrintFile(const FileIntegrity& file) {
  ToStdout("  {:12} {}{}: {}\n", Name(file.state), file.path,
           file.cycle ? fmt::format(" (cycle {})", *file.cycle) : "", file.reason);
  for (const daq::RecordCheck& record : file.records) {
    ToStdout("    {}: {}\n", record.group, record.damage.empty() ? "whole" : record.damage);
  }
}

void Print(const CampaignFolder& folder, const CampaignIntegrity& integrity) {
  ToStdout("{}: {}{}\n", folder.root.string(), Name(integrity.verdict()),
           integrity.process > 0 ? fmt::format(" so far; running in process {}", integrity.process) : "");
  ToStdout("  read         {}, {} complete cycles\n", BytesText(static_cast<double>(integrity.bytes)),
           integrity.cycles);
  if (integrity.salvaged) ToStdout("  {}\n", Words(*integrity.salvaged));
  PrintJournal(integrity.journal);
  ToStdout("  files        {} whole, {} damaged, {} missing, {} unregistered\n",
           integrity.Count(FileState::kWhole), integrity.Count(FileState::kDamaged),
           integrity.Count(FileState::kMissing), integrity.Count(FileState::kUnregistered));
  std::size_t shown = 0;
  for (const FileIntegrity& file : integrity.files) {
    if (file.state != FileState::kDamaged && file.state != FileState::kMissing) continue;
    if (shown++ < kFilesShown) PrintFile(file);
  }
  if (shown > kFilesShown) ToStdout("  and {} more: --json has all of them\n", shown - kFilesShown);
}

ExitCode CodeOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::kWhole:
      return ExitCode::kDone;
    case Verdict::kDamaged:
      return ExitCode::kEndedBadly;
    case Verdict::kNothing:
      return ExitCode::kWrongInput;
  }
  return ExitCode::kWrongInput;
}

nlohmann::json SalvageJson(const std::string& out, const SalvageNote& note) {
  nlohmann::json json = Json(note);
  json["out"] = out;
  return json;
}

void PrintSalvage(const std::string& out, const SalvageNote& note) {
  ToStdout("salvaged to {}\n  files        {} recovered, {} lost\n", out, note.files_recovered,
           note.files_lost.size());
  for (const std::string& file : note.files_lost) ToStdout("    lost: {}\n", file);
  ToStdout("  records      {} recovered of damaged files, {} lost\n", note.records_recovered,
           note.records_lost.size());
  for (const std::string& record : note.records_lost) ToStdout("    lost: {}\n", record);
  for (const auto& [table, recovered] : note.rows_recovered) {
    const auto lost = note.rows_lost.find(table);
    ToStdout("  rows         {:15} {} recovered, {} lost\n", table, recovered,
             lost == note.rows_lost.end() ? 0 : lost->second);
  }
  if (!note.cycles_incomplete.empty()) {
    ToStdout("  incomplete   cycles {}\n", fmt::join(note.cycles_incomplete, ", "));
  }
  ToStdout("it opens with status, recompute, table, diagnose and train\n");
}

int Verify(const VerifyOptions& options) {
  const CampaignFolder folder{options.folder};
  if (!options.salvage.empty()) DemandPlaceToSalvage(folder, options.salvage);
  ShareLine line;
  const CampaignIntegrity integrity = VerifyCampaign(folder, [&](std::uint64_t done, std::uint64_t all) {
    line.Show("reading", all == 0 ? 1.0 : static_cast<double>(done) / static_cast<double>(all));
  });
  line.Clear();
  std::optional<SalvageNote> salvaged;
  if (!options.salvage.empty() && integrity.verdict() != Verdict::kNothing) {
    salvaged = Salvage(folder, integrity, options.salvage);
  }
  if (options.json) {
    nlohmann::json document = Json(folder, integrity);
    if (salvaged) document["salvage"] = SalvageJson(options.salvage, *salvaged);
    ToStdout("{}\n", DocumentOf(document));
  } else {
    Print(folder, integrity);
    if (salvaged) PrintSalvage(options.salvage, *salvaged);
  }
  return static_cast<int>(CodeOf(integrity.verdict()));
}

}  // namespace

void AddVerify(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "verify",
      "Read every byte of a campaign, running or not, and say what is whole, damaged or missing, by cycle "
      "and "
      "record: the journal's pages and tables, the chain of hashes over cycles, events, notes and alarms, "
      "and "
      "every file against the digest that it was stored with. Exit code 0: whole; 1: something is damaged or "
      "missing; 2: nothing can be read, or it is no campaign.\n"
      "Example: strainwave verify campaigns/first\n"
      "         strainwave verify campaigns/first --salvage campaigns/first_saved");
  auto options = std::make_shared<VerifyOptions>();
  command->add_option("DIR", options->folder, "the campaign's folder")->required();
  command->add_option(
      "--salvage", options->salvage,
      "a new or empty folder: what is whole is written there as a campaign for analysis, and what is "
      "lost is counted; a damaged file of records gives those that are whole, a damaged journal the "
      "rows that can be read. DIR is left as it is");
  command->add_flag("--json", options->json, "JSON on standard output, with every file");
  command->callback([options, &action] { action = [options] { return Verify(*options); }; });
}

}  // namespace strainwave::bench
