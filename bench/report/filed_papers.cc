// SPDX-License-Identifier: Apache-2.0
#include "bench/report/filed_papers.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"
#include "bench/json_text.h"
#include "bench/prediction/sealed_json.h"
#include "bench/report/number_text.h"

namespace strainwave::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kTripSheet = "the sheet that strainwave bench trip-test --out writes";

std::string Milliseconds(const Json& time_s) {
  return time_s.is_null() ? "–" : fmt::format("{:.0f}", 1e3 * time_s.get<double>());
}

std::string LimitWords(const Json& limit) {
  const auto key = limit.at("key").get<std::string>();
  if (limit.at("value").is_null()) return key;
  return fmt::format("{:g} {} ({})", limit.at("value").get<double>(), limit.at("unit").get<std::string>(),
                     key);
}

ReportSection TripSectionOf(const std::filesystem::path& file, const Json& sheet) {
  ReportSection section{"Fault and trip tests", {}};
  section.parts.emplace_back(fmt::format(
      "Each interlock tripped on purpose, on {} ({}), begun {} with {}: {} passed, {} failed, {} "
      "skipped. Limits: {}. From {}.",
      sheet.at("bench").get<std::string>(), sheet.at("simulated").get<bool>() ? "simulated" : "of metal",
      sheet.at("utc").get<std::string>(), sheet.at("software").get<std::string>(),
      sheet.at("passed").get<int>(), sheet.at("failed").get<int>(), sheet.at("skipped").get<int>(),
      sheet.at("schedule").is_null() ? "of no schedule" : sheet.at("schedule").get<std::string>(),
      file.string()));
  ReportTable table{"trip_test",
                    {"verdict", "signal", "limit", "safe within (ms)", "tripped after (ms)",
                     "safe after (ms)", "alarm", "action", "seen"},
                    {}};
  for (const Json& row : sheet.at("rows"))
    table.rows.push_back({row.at("verdict").get<std::string>(), row.at("signal").get<std::string>(),
                          LimitWords(row.at("limit")), Milliseconds(row.at("safe_within_s")),
                          Milliseconds(row.at("tripped_after_s")), Milliseconds(row.at("safe_after_s")),
                          row.at("latches").get<bool>() ? "latches" : "no",
                          row.at("action").get<std::string>(), row.at("seen").get<std::string>()});
  section.parts.emplace_back(std::move(table));
  return section;
}

void NumberFrom(std::size_t at, ReportSection& section) {
  if (at == 0) return;
  section.title += fmt::format(" {}", at + 1);
  for (ReportPart& part : section.parts) {
    if (auto* const table = std::get_if<ReportTable>(&part); table != nullptr)
      table->name += fmt::format("_{}", at + 1);
  }
}

void Append(const std::vector<std::filesystem::path>& papers,
            ReportSection (&section_of)(const std::filesystem::path&), std::vector<ReportSection>& sections) {
  for (std::size_t i = 0; i < papers.size(); ++i) {
    sections.push_back(section_of(papers[i]));
    NumberFrom(i, sections.back());
  }
}

}  // namespace

ReportSection SectionOfJson(const std::filesystem::path& file, const std::string& text,
                            const std::string& what, const std::string& expected,
                            const std::function<ReportSection(const nlohmann::ordered_json&)>& make) {
  try {
    return make(ParseJson(text));
  } catch (const nlohmann::json::parse_error&) {
    Refuse(file, "is no JSON", expected);
  } catch (const nlohmann::json::exception&) {
    Refuse(file, "is no " + what, expected);
  } catch (const std::invalid_argument&) {
    Refuse(file, "is no " + what, expected);
  }
}

FiledPapers PapersIn(const std::filesystem::path& campaign) {
  FiledPapers papers;
  std::error_code none;
  const auto take = [&](const char* name, std::vector<std::filesystem::path>& list) {
    if (std::filesystem::exists(campaign / name, none)) list.push_back(campaign / name);
  };
  take("diagnosis/diagnosis.json", papers.diagnoses);
  take("predictor", papers.predictors);
  take("trip_test.json", papers.trip_tests);
  return papers;
}

std::vector<ReportSection> FiledSections(const FiledPapers& papers) {
  std::vector<ReportSection> sections;
  const auto say_none = [&](const char* title, const char* words) {
    sections.push_back({title, {std::string(words)}});
  };
  if (papers.trip_tests.empty())
    say_none("Fault and trip tests", "No sheet of a trip test lies in the folder, and none was given.");
  Append(papers.trip_tests, TripTestSection, sections);
  if (papers.diagnoses.empty()) say_none("Diagnosis", "No diagnosis lies in the folder, and none was given.");
  Append(papers.diagnoses, DiagnosisSection, sections);
  if (papers.predictors.empty())
    say_none("Predictor", "No predictor lies in the folder, and none was given.");
  Append(papers.predictors, PredictorSection, sections);
  return sections;
}

ReportSection TripTestSection(const std::filesystem::path& file) {
  return SectionOfJson(file, ReadBounded(file, kTripSheet), "sheet of a trip test", kTripSheet,
                       [&](const nlohmann::ordered_json& sheet) { return TripSectionOf(file, sheet); });
}

}  // namespace strainwave::bench
