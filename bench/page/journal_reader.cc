// SPDX-License-Identifier: Apache-2.0
#include "bench/page/journal_reader.h"

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "bench/campaign/alarms_json.h"
#include "bench/campaign/campaign.h"
#include "bench/page/http_text.h"
#include "bench/page/live_channels.h"
#include "bench/page/measurements.h"
#include "bench/page/picture.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kAnswersKept = 8;

}  // namespace

bool JournalReader::Ask(std::function<std::string()> read, Done done) {
  return worker_.Post([this, read = std::move(read), done = std::move(done)] {
    try {
      done(200, read());
    } catch (const std::invalid_argument& error) {
      done(400, ErrorJson(error.what()));
    } catch (const std::exception& error) {
      answers_.clear();
      done(503,
           ErrorJson(fmt::format("the journal cannot be read: {} (expected the campaign's folder as it was)",
                                 error.what())));
    }
  });
}

bool JournalReader::AskCycles(const CyclesQuery& query, int cycles_complete, Done done) {
  return Ask([this, query, cycles_complete] { return ReadCycles(query, cycles_complete); }, std::move(done));
}

bool JournalReader::AskAlarms(bool all, Done done) {
  const auto read = [this, all] {
    const Journal journal = Journal::OpenAsRead(folder_.Journal());
    const auto rules = ReadFrozenInputs(folder_, journal).bench.alarms;
    return JsonText(AlarmListJson(journal, rules, all, Now())) + "\n";
  };
  return Ask(read, std::move(done));
}

bool JournalReader::AskMeasurements(int cycle, Done done) {
  return Ask([this, cycle] { return JsonText(ReadMeasurements(folder_, cycle)) + "\n"; }, std::move(done));
}

bool JournalReader::AskLive(Done done) {
  const auto read = [this] {
    const std::uint64_t campaign = Journal::OpenAsRead(folder_.Journal()).Identity();
    return JsonText(LiveChannelsJson(ReadLiveEnvelopes(folder_.Envelope(), campaign), Now())) + "\n";
  };
  return Ask(read, std::move(done));
}

bool JournalReader::AskPicture(const std::filesystem::path& file, Done done) {
  return Ask([file] { return ReadPicture(file); }, std::move(done));
}

std::string JournalReader::ReadCycles(const CyclesQuery& query, int cycles_complete) {
  const auto known = std::ranges::find_if(answers_, [&](const Answer& answer) {
    return answer.query == query && answer.cycles_complete >= cycles_complete;
  });
  if (known != answers_.end()) return known->json;
  // Opened for each reading: what has become of the folder since does not matter. Its pages are looked at as
  // they are read; all of them were when the page began.
  const Journal journal = Journal::OpenAsRead(folder_.Journal());
  const nlohmann::json read = CyclesJson(journal, query, ReadFrozenInputs(folder_, journal).schedule.stop);
  std::erase_if(answers_, [&](const Answer& answer) { return answer.query == query; });
  answers_.push_front({query, read["cycles_complete"], read.dump() + "\n"});
  if (answers_.size() > kAnswersKept) answers_.pop_back();
  return answers_.front().json;
}

}  // namespace strainwave::bench
