// SPDX-License-Identifier: Apache-2.0
// Any text as a schedule; one that is accepted is checked and planned.
// seeds: schedules/*.yaml
// longest: 16384
#include <cstdint>
#include <cstdlib>

#include "schedules/reader/plan.h"
#include "schedules/reader/read_schedule.h"
#include "schedules/reader/validate_schedule.h"
#include "tests/fuzz/text_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::schedules;
  return CheckText<ScheduleError>(data, size, [](const std::string& text) {
    const Schedule schedule = ParseSchedule(text, "any.yaml");
    if (ValidateSchedule(schedule).has_errors()) std::abort();
    const Plan plan = MakePlan(schedule, {});
    if (!(plan.wall_s >= 0.0)) std::abort();
  });
}
