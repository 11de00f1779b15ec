// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"
#include "bench/campaign/resume_point.h"
#include "bench/configuration/bench_description.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// The inputs of a campaign: the two files as text, to be frozen, and what they say.
struct CampaignInputs {
  std::string schedule_text;
  std::string bench_text;
  std::string plant_text;  // of the plant file that the bench file names; empty without one
  schedules::Schedule schedule;
  BenchDescription bench;
  std::filesystem::path bench_folder{};  // where files that the bench file names are looked for; absolute
};

/// Reads both files and checks them against each other; without a bench file, the embedded simulated bench.
/// @throws schedules::ScheduleError with all findings.
CampaignInputs ReadInputs(const std::filesystem::path& schedule,
                          const std::optional<std::filesystem::path>& bench);

/// What is allowed but should be known before the start: the schedule's own warnings, those that it has on
/// this bench, and a stiffness that would include the bench's compliance because nothing measures that.
schedules::FindingList WarningsOf(const CampaignInputs& inputs);

/// The inputs frozen in a folder that OpenCampaign has looked at, with the cycles that it was extended to.
CampaignInputs ReadFrozenInputs(const CampaignFolder& folder, const Journal& journal);

/// The journal of a campaign, to read or to go on with; every command that reads a campaign comes through
/// here.
/// @throws BenchError when the folder is not a campaign, a frozen file is not the one that the campaign was
///   started with, or the checkpoint is of another campaign or further on than the journal (which then has
///   lost its last rows); DatabaseError when the journal is damaged.
Journal OpenCampaign(const CampaignFolder& folder, Database::Mode mode,
                     PagesChecked checked = PagesChecked::kAll);

/// What is allowed but uncertain about the files of a campaign, each with the file: parts of the journal
/// that no checksum covers, a damaged state in the checkpoint.
std::vector<std::string> WarningsAbout(const CampaignFolder& folder, const Journal& journal);

/// The bench of a campaign that goes on: the frozen one, with the files of its devices where they were at the
/// start.
/// @throws BenchError when one of those has changed since, or is gone.
BenchDescription BenchToResume(const CampaignFolder& folder, const Journal& journal);

/// Makes the folder with the frozen inputs and an empty journal. What fails leaves nothing behind.
/// @throws BenchError when the folder holds a campaign already, or something else.
Journal CreateCampaign(const CampaignFolder& folder, const CampaignInputs& inputs);

/// What the journal and the checkpoint say of an interrupted campaign, after the journal has been put in
/// order: phases that were running are closed as interrupted with the load they had served, and the time
/// since is a hole. Doing it twice changes nothing. Bench time goes on from the later of the two: a power cut
/// may leave a checkpoint that is older than the journal.
/// @param given  the schedule on the command line; it must be the frozen one, with the campaign's cycles.
/// @throws BenchError: not a campaign, a changed schedule (with the difference), finished already, a pause
///   longer than the schedule allows or not known without `accept_pause`, a journal without its checkpoint.
std::optional<ResumePoint> PrepareResume(const CampaignFolder& folder, const CampaignInputs& given,
                                         Journal& journal, const ResumeOrder& order);

/// More cycles for a campaign, complete or not; the journal has them, and a line of it. The frozen schedule
/// stays as it was.
/// @param given  the schedule on the command line: the frozen one, but for a higher number of cycles.
/// @return what was done, in words.
/// @throws BenchError for any other schedule.
std::string ExtendCampaign(const CampaignFolder& folder, const CampaignInputs& given, Journal& journal);

/// Lines that differ, as "-old" and "+new" with line numbers; empty when equal.
std::string Difference(const std::string& before, const std::string& after);

}  // namespace strainwave::bench
