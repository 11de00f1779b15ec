// SPDX-License-Identifier: Apache-2.0
#include "bench/page/cycles_reader.h"

#include <algorithm>
#include <exception>

#include <fmt/core.h>

#include "bench/page/http_text.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kAnswersKept = 8;

}  // namespace

CyclesReader::CyclesReader(const CampaignFolder& folder) : folder_(folder), thread_([this] { Work(); }) {}

CyclesReader::~CyclesReader() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  asked_.notify_all();
  thread_.join();
}

bool CyclesReader::Ask(const CyclesQuery& query, int cycles_complete, Done done) {
  {
    const std::lock_guard lock(mutex_);
    if (questions_.size() >= kMostWaiting) return false;
    questions_.push_back({query, cycles_complete, std::move(done)});
  }
  asked_.notify_one();
  return true;
}

std::string CyclesReader::Read(const Question& question) {
  const auto known = std::ranges::find_if(answers_, [&](const Answer& answer) {
    return answer.query == question.query && answer.cycles_complete >= question.cycles_complete;
  });
  if (known != answers_.end()) return known->json;
  // Opened for each reading: what has become of the folder since does not matter. Its pages are looked at as
  // they are read; all of them were when the page began.
  const nlohmann::json read = CyclesJson(Journal::OpenChecked(folder_.Journal()), question.query);
  std::erase_if(answers_, [&](const Answer& answer) { return answer.query == question.query; });
  answers_.push_front({question.query, read["cycles_complete"], read.dump() + "\n"});
  if (answers_.size() > kAnswersKept) answers_.pop_back();
  return answers_.front().json;
}

void CyclesReader::Work() {
  std::unique_lock lock(mutex_);
  while (true) {
    asked_.wait(lock, [this] { return stop_ || !questions_.empty(); });
    if (stop_) return;
    const Question question = std::move(questions_.front());
    questions_.pop_front();
    lock.unlock();
    int status = 200;
    std::string json;
    try {
      json = Read(question);
    } catch (const std::exception& error) {
      answers_.clear();
      status = 503;
      json = ErrorJson(fmt::format(
          "the journal cannot be read: {} (expected the campaign's folder as it was)", error.what()));
    }
    question.done(status, std::move(json));
    lock.lock();
  }
}

}  // namespace strainwave::bench
