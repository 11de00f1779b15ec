// SPDX-License-Identifier: Apache-2.0
#include <map>

#include <fmt/format.h>

#include "bench/report/number_text.h"
#include "bench/report/sections.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kHashShown = 12;

std::string TimesWords(std::size_t times) { return times == 1 ? "once" : fmt::format("{} times", times); }

std::string CutWords(const CutPhases& cut) {
  return fmt::format(
      "Cut were {} load run(s) and {} other phase(s). Of the load runs {} of load were kept and not run "
      "again; "
      "a phase without load is done again, whole. Of the {} cycle(s) in which that happened {} are complete.",
      cut.load_runs, cut.others, DurationWords(cut.kept_load_s), cut.cycles, cut.cycles_complete);
}

std::string FilesWords(const CampaignIntegrity& integrity) {
  int whole = 0;
  int lost = 0;
  for (const FileIntegrity& file : integrity.files) {
    if (!file.path.starts_with("cycles/")) continue;
    if (file.state == FileState::kWhole) ++whole;
    if (file.state == FileState::kDamaged || file.state == FileState::kMissing) ++lost;
  }
  return fmt::format("Of {} cycles, the preparation among them, {} raw files are whole{}.", integrity.cycles,
                     whole,
                     lost == 0 ? " and none is lost" : fmt::format("; {} are damaged or missing", lost));
}

std::string SamplesWords(const std::map<std::string, SampleCount>& samples) {
  double received = 0.0;
  double lost = 0.0;
  for (const auto& [source, count] : samples) {
    received += count.received;
    lost += count.lost;
  }
  return fmt::format("Of {:.0f} samples that the sources counted {:.0f} were lost.", received + lost, lost);
}

}  // namespace

ReportSection KeptSection(const CampaignSheet& sheet) {
  ReportSection section{"What could have been lost, and was not", {}};
  const bool was_cut = sheet.cut.load_runs + sheet.cut.others > 0;
  section.parts.emplace_back(
      sheet.holes.empty() ? "The program has watched the bench from the first cycle to the last event."
                          : fmt::format("The bench was out of the program's sight {}: see the interruptions.",
                                        TimesWords(sheet.holes.size())));
  section.parts.emplace_back(was_cut ? CutWords(sheet.cut) : "No phase was cut.");
  section.parts.emplace_back(FilesWords(sheet.integrity));
  if (!sheet.samples.empty()) section.parts.emplace_back(SamplesWords(sheet.samples));
  if (sheet.integrity.salvaged)
    section.parts.emplace_back("This campaign was " + Words(*sheet.integrity.salvaged) + ".");
  return section;
}

ReportSection TrailSection(const CampaignSheet& sheet) {
  ReportSection section{"Trail of acts, edits and notes", {}};
  const ChainReport& chain = sheet.integrity.journal.chain;
  if (!sheet.integrity.journal.has_chain) {
    section.parts.emplace_back(
        "The journal is of an earlier version and has no chain: whether a row was changed cannot be told.");
    return section;
  }
  section.parts.emplace_back(fmt::format(
      "Each row has a link: the SHA-256 of the link before it and of the row, as it was written. Changed, "
      "removed or put in later, it breaks the chain. {} Cycles and files have links, too, {} of them, and "
      "are not listed.",
      chain.IsWhole() ? fmt::format("The chain holds: {} links were computed again, the last is {}.",
                                    chain.links, chain.head)
                      : fmt::format("The chain does not hold: {} of {} links are broken.", chain.broken_links,
                                    chain.links),
      chain.links - static_cast<std::int64_t>(sheet.trail.size())));
  for (const auto& [kind, rows] : chain.unchained)
    section.parts.emplace_back(
        fmt::format("{} row(s) of the kind {} have no link: another program has added them.", rows, kind));
  std::map<std::int64_t, std::string> broken;
  for (const BrokenLink& link : chain.broken) broken[link.number] = link.why;
  ReportTable table{"trail", {"link", "UTC", "who", "kind", "what", "SHA-256", "holds"}, {}};
  for (const TrailEntry& entry : sheet.trail) {
    const auto found = broken.find(entry.link);
    table.rows.push_back({std::to_string(entry.link), entry.utc, entry.who.empty() ? "–" : entry.who,
                          entry.kind, entry.what, entry.sha256.substr(0, kHashShown),
                          found == broken.end() ? "yes" : "no: " + found->second});
  }
  section.parts.emplace_back(std::move(table));
  if (static_cast<std::int64_t>(chain.broken.size()) < chain.broken_links)
    section.parts.emplace_back(
        fmt::format("Of the broken links the first {} are marked; strainwave verify "
                    "--json has them.",
                    chain.broken.size()));
  return section;
}

}  // namespace strainwave::bench
