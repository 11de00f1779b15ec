// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/unattended.h"

#include <optional>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/json_property.h"
#include "bench/campaign/run_begun.h"
#include "bench/errors/bench_error.h"

namespace strainwave::bench {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Moment, utc_ms, since_boot_ms, boot)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RunOrder, given, by, accept_pause)

namespace {

constexpr const char* kUnattended = "unattended";
constexpr double kOrderLasts_s = 600.0;  // to type one more command, and not to leave the room

struct State {
  int restarts{};
  std::string ended;            // of the last run; empty: it was cut
  std::vector<RunOrder> order;  // at most one
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(State, restarts, ended, order)

State StateOf(const Journal& journal) {
  State state;
  ReadJsonProperty(journal, kUnattended, [&](const nlohmann::json& kept) { state = kept.get<State>(); });
  return state;
}

void Keep(Journal& journal, const State& state) {
  // Words of devices and names of files may be no UTF-8.
  journal.SetProperty(kUnattended,
                      nlohmann::json(state).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

bool IsFresh(const RunOrder& order, const Moment& now) {
  const auto age_s = PauseBetween(order.given, now).length_s;
  return order.given.boot == now.boot && age_s && *age_s <= kOrderLasts_s;
}

// Empty where nothing speaks against it.
std::string WhyNotByItself(const State& state, const Journal& journal, const schedules::ResumeRules& rules) {
  if (rules.unattended == 0) return "resume.unattended of its schedule is 0";
  if (!journal.Property(kRunBegun)) return "it has not begun yet";
  if (!state.ended.empty()) return fmt::format("its last run was not cut, but has ended ({})", state.ended);
  if (const std::vector<Event> alarms = journal.OpenAlarms(); !alarms.empty()) {
    return fmt::format("its last run has ended with an alarm ({})", alarms.front().text);
  }
  if (state.restarts < rules.unattended) return "";
  return fmt::format("it has done so {} times since a person began it, as often as resume.unattended allows",
                     state.restarts);
}

}  // namespace

void KeepRunOrder(Journal& journal, const RunOrder& order) {
  State state = StateOf(journal);
  state.order = {order};
  Keep(journal, state);
}

ResumeOrder DemandUnattendedStart(const CampaignFolder& folder, const Journal& journal,
                                  const schedules::ResumeRules& rules, const Moment& now) {
  const State state = StateOf(journal);
  const bool ordered = !state.order.empty();
  if (ordered && IsFresh(state.order.front(), now)) {
    return {state.order.front().by, state.order.front().accept_pause, 0};
  }
  const std::string why = WhyNotByItself(state, journal, rules);
  if (why.empty()) return {"", false, state.restarts + 1};
  Refuse(folder.root,
         "the campaign does not go on without a person: " +
             (ordered ? fmt::format("what {} has ordered is too old", state.order.front().by) : why),
         fmt::format("one at the bench to order it, within {:.0f} minutes: strainwave run --out {} --resume "
                     "--by-service",
                     kOrderLasts_s / 60.0, folder.root.string()));
}

void NoteRunBegins(Journal& journal, int restart) { Keep(journal, {restart, "", {}}); }

void NoteRunEnded(Journal& journal, const std::string& how) {
  State state = StateOf(journal);
  state.ended = how;
  Keep(journal, state);
}

int UnattendedRestarts(const Journal& journal) { return StateOf(journal).restarts; }

}  // namespace strainwave::bench
