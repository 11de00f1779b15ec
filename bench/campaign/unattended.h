// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"
#include "bench/campaign/pause.h"
#include "bench/campaign/resume_point.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// A person's order that a service may run the campaign with nobody at its terminal. It is used up by the run
/// that begins; after ten minutes, or in another boot of the machine, it counts no more: whoever gave it may
/// have left the bench.
struct RunOrder {
  Moment given;
  std::string by;
  bool accept_pause{};
};
void KeepRunOrder(Journal& journal, const RunOrder& order);

/// Decides whether a run may begin with nobody at its terminal, and on whose word: by an order, else after a
/// run that was cut (power cut, kill, watchdog) where the schedule's `resume.unattended` leaves one. Not
/// after a fault, a stop that was asked for, or an error that has ended the program.
/// @throws BenchError with what a person has to do.
ResumeOrder DemandUnattendedStart(const CampaignFolder& folder, const Journal& journal,
                                  const schedules::ResumeRules& rules, const Moment& now);

/// A run begins: an order is used up, and until `NoteRunEnded` the run counts as cut.
/// @param restart  of the ResumeOrder; 0 for a run that a person has begun.
void NoteRunBegins(Journal& journal, int restart);
/// @param how  in words: of a fault, a stop, an error.
void NoteRunEnded(Journal& journal, const std::string& how);

/// Runs that have begun without a person since a person's last.
int UnattendedRestarts(const Journal& journal);

}  // namespace strainwave::bench
