// SPDX-License-Identifier: Apache-2.0
#include "bench/page/page_questions.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/core.h>

namespace strainwave::bench {
namespace {

constexpr std::string_view kJsonType = "application/json";
constexpr std::array<std::string_view, 6> kPaths{"/api/v1/cycles",       "/api/v1/alarms",
                                                 "/api/v1/measurements", "/api/v1/prediction",
                                                 "/api/v1/live",         "/api/v1/picture"};

// What a page may ask for and this one does not have.
struct NotHere : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Of a request; its first value, as it is given once at most where it matters.
std::string ParameterOf(const PageQuestions::Parameters& parameters, const std::string& name,
                        const std::string& otherwise) {
  const auto found = parameters.find(name);
  return found == parameters.end() ? otherwise : found->second;
}

int CycleAskedFor(const PageQuestions::Parameters& parameters) {
  return WholeNumber("cycle", ParameterOf(parameters, "cycle", "0"), 0, kLastCycle);
}

}  // namespace

PageQuestions::PageQuestions(const CampaignFolder& folder, const std::filesystem::path& predictor,
                             const std::filesystem::path& baseline)
    : reader_(folder) {
  if (!predictor.empty()) predictor_.emplace(folder, predictor, baseline);
}

std::optional<PageQuestions::Taken> PageQuestions::Ask(const std::string& path, const Parameters& parameters,
                                                       const CampaignSnapshot& snapshot,
                                                       const Answer& answer) {
  if (std::ranges::find(kPaths, path) == kPaths.end()) return std::nullopt;
  try {
    if (Put(path, parameters, snapshot, answer)) return Taken{200};
    return Taken{503, "too many ask at once (expected: ask again later)"};
  } catch (const std::invalid_argument& error) {
    return Taken{400, error.what()};
  } catch (const NotHere& error) {
    return Taken{404, error.what()};
  }
}

bool PageQuestions::Put(const std::string& path, const Parameters& parameters,
                        const CampaignSnapshot& snapshot, const Answer& answer) {
  const auto as_json = [answer](int status, const std::string& body) { answer(status, kJsonType, body); };
  if (path == "/api/v1/cycles") {
    return reader_.AskCycles(ParseCyclesQuery(parameters), snapshot.progress.complete, as_json);
  }
  if (path == "/api/v1/alarms") {
    const std::string all = ParameterOf(parameters, "all", "0");
    if (!all.empty() && all != "0" && all != "1") {
      throw std::invalid_argument(fmt::format("all = {:.40} (expected 0, or 1 for cleared ones, too)", all));
    }
    return reader_.AskAlarms(all == "1", as_json);
  }
  if (path == "/api/v1/measurements") return reader_.AskMeasurements(CycleAskedFor(parameters), as_json);
  if (path == "/api/v1/live") return reader_.AskLive(as_json);
  if (path == "/api/v1/prediction") {
    if (!predictor_) throw NotHere("the page has no predictor (expected: strainwave serve DIR --predictor)");
    return predictor_->Ask(CycleAskedFor(parameters), as_json);
  }
  // The newest, whatever the request says of it: no path comes from outside.
  if (!snapshot.picture) throw NotHere("there is no picture (expected a camera that has given one)");
  return reader_.AskPicture(snapshot.picture->file, [answer](int status, const std::string& body) {
    answer(status, status == 200 ? "image/jpeg" : kJsonType, body);
  });
}

}  // namespace strainwave::bench
