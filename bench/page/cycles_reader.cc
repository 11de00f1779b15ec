// SPDX-License-Identifier: Apache-2.0
#include "bench/page/cycles_reader.h"

#include <algorithm>
#include <exception>
#include <utility>

#include <fmt/core.h>

#include "bench/page/http_text.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kAnswersKept = 8;

}  // namespace

bool CyclesReader::Ask(const CyclesQuery& query, int cycles_complete, Done done) {
  return worker_.Post([this, query, cycles_complete, done = std::move(done)] {
    int status = 200;
    std::string json;
    try {
      json = Read(query, cycles_complete);
    } catch (const std::exception& error) {
      answers_.clear();
      status = 503;
      json = ErrorJson(fmt::format(
          "the journal cannot be read: {} (expected the campaign's folder as it was)", error.what()));
    }
    done(status, std::move(json));
  });
}

std::string CyclesReader::Read(const CyclesQuery& query, int cycles_complete) {
  const auto known = std::ranges::find_if(answers_, [&](const Answer& answer) {
    return answer.query == query && answer.cycles_complete >= cycles_complete;
  });
  if (known != answers_.end()) return known->json;
  // Opened for each reading: what has become of the folder since does not matter. Its pages are looked at as
  // they are read; all of them were when the page began.
  const nlohmann::json read = CyclesJson(Journal::OpenChecked(folder_.Journal()), query);
  std::erase_if(answers_, [&](const Answer& answer) { return answer.query == query; });
  answers_.push_front({query, read["cycles_complete"], read.dump() + "\n"});
  if (answers_.size() > kAnswersKept) answers_.pop_back();
  return answers_.front().json;
}

}  // namespace strainwave::bench
