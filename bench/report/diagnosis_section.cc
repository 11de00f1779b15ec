// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "bench/prediction/sealed_json.h"
#include "bench/report/filed_papers.h"
#include "bench/report/number_text.h"

namespace strainwave::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kDiagnosis = "diagnosis.json, as strainwave diagnose --out or --json writes it";

double NumberOrNone(const Json& value) { return value.is_null() ? NAN : value.get<double>(); }

// "amplitude 0.41 ± 0.02 arcmin, phase 12.0 ± 1.5 deg".
std::string ParametersWords(const Json& parameters) {
  std::string words;
  for (const auto& [name, value] : parameters.items()) {
    const auto unit = value.at("unit").get<std::string>();
    words += fmt::format("{}{} {}{}", words.empty() ? "" : ", ", name,
                         With95({NumberOrNone(value.at("value")), NumberOrNone(value.at("se"))}),
                         unit.empty() || unit == "1" ? "" : " " + unit);
  }
  return words.empty() ? "–" : words;
}

std::string ListWords(const Json& names) {
  std::string words;
  for (const Json& name : names) words += (words.empty() ? "" : ", ") + name.get<std::string>();
  return words.empty() ? "–" : words;
}

ReportTable CausesTable(const Json& causes) {
  ReportTable table{"diagnosis",
                    {"cause", "where", "parameters (± 95 %)", "share of what can be explained (%)",
                     "BIC gained", "p", "cannot be told from", "in words"},
                    {}};
  for (const Json& cause : causes) {
    const Json& evidence = cause.at("evidence");
    table.rows.push_back({cause.at("name").get<std::string>(), cause.at("where").get<std::string>(),
                          ParametersWords(cause.at("parameters")),
                          Fixed(100.0 * cause.at("share_of_explainable_variance").get<double>(), 1),
                          Fixed(evidence.at("delta_bic").get<double>(), 1),
                          fmt::format("{:.2g}", evidence.at("p_value").get<double>()),
                          ListWords(cause.at("indistinguishable_from")),
                          cause.at("sentence").get<std::string>()});
  }
  return table;
}

// "0.24 (0.20 to 0.30)"; without an upper end "0.24 (0.20 and up)".
std::string FromWords(const Json& from) {
  if (from.is_null()) return "never so often";
  const std::string end =
      from.at("high").is_null() ? " and up" : fmt::format(" to {:.2g}", from.at("high").get<double>());
  return fmt::format("{:.3g} ({:.2g}{})", from.at("value").get<double>(), from.at("low").get<double>(), end);
}

std::string CountsWords(const Json& counts) {
  std::string words;
  for (const auto& [name, count] : counts.items())
    words += fmt::format("{}{} {}", words.empty() ? "" : ", ", name, count.get<int>());
  return words.empty() ? "–" : words;
}

void AppendPower(const Json& power, ReportSection& section) {
  if (power.contains("refusal")) {
    section.parts.emplace_back("What would have been found was not measured: " +
                               power.at("refusal").get<std::string>());
    return;
  }
  section.parts.emplace_back(fmt::format(
      "What would have been found in these records with a probability of {:.2g}: effects of growing size "
      "planted into them and searched for, {} records in all. A diagnosis can be trusted for effects from "
      "these sizes on.",
      power.at("probability").get<double>(), power.at("records_searched").get<int>()));
  ReportTable table{"diagnosis_power",
                    {"cause", "parameter", "unit", "found from (95 %)", "in standard errors (95 %)", "found",
                     "planted", "other names given", "why not"},
                    {}};
  for (const Json& cause : power.at("causes")) {
    const auto objection = cause.at("objection").get<std::string>();
    table.rows.push_back({cause.at("name").get<std::string>(), cause.at("parameter").get<std::string>(),
                          cause.at("unit").get<std::string>(), FromWords(cause.at("size")),
                          FromWords(cause.at("sigma")), std::to_string(cause.at("found").get<int>()),
                          std::to_string(cause.at("trials").size()), CountsWords(cause.at("other_names")),
                          objection.empty() ? "–" : objection});
  }
  section.parts.emplace_back(std::move(table));
  const Json& without = power.at("without_effect");
  section.parts.emplace_back(fmt::format(
      "Of {} records without a planted effect {} got a name that they do not have. Not shown by these "
      "records at any size: {}.",
      without.at("records").get<int>(), without.at("with_other_names").get<int>(),
      ListWords(power.at("not_shown"))));
}

std::string ResultWords(const std::string& result) {
  return result == "too_few_samples" ? "too few samples" : result;
}

// Neighbouring ranges in which both models do as well are one row.
void AppendRegions(const Json& over, ReportTable& table) {
  const auto title = over.at("title").get<std::string>();
  for (const Json& range : over.at("ranges")) {
    const Json& nominal = range.at("nominal");
    const Json& extended = range.at("extended");
    const std::string as_it_is = ResultWords(nominal.at("result").get<std::string>());
    const std::string as_found = ResultWords(extended.at("result").get<std::string>());
    const std::string from = fmt::format("{:.4g}", range.at("low").get<double>());
    const std::string to = fmt::format("{:.4g}", range.at("high").get<double>());
    std::vector<std::string>* const last = table.rows.empty() ? nullptr : &table.rows.back();
    if (last != nullptr && (*last)[0] == title && (*last)[2] == from && (*last)[4] == as_it_is &&
        (*last)[6] == as_found) {
      (*last)[2] = to;
      const auto larger = [](std::string& text, double value) {
        if (value > std::stod(text)) text = fmt::format("{:.3g}", value);
      };
      larger((*last)[3], nominal.at("rmse").get<double>());
      larger((*last)[5], extended.at("rmse").get<double>());
      continue;
    }
    table.rows.push_back({title, from, to, fmt::format("{:.3g}", nominal.at("rmse").get<double>()), as_it_is,
                          fmt::format("{:.3g}", extended.at("rmse").get<double>()), as_found});
  }
}

void AppendTrustedRegions(const Json& diagnosis, ReportSection& section) {
  if (!diagnosis.contains("trusted_regions")) {
    section.parts.emplace_back(
        "Where the simulation may be trusted is not in this file: an older program wrote it.");
    return;
  }
  const Json& trusted = diagnosis.at("trusted_regions");
  const auto unit = trusted.at("unit").get<std::string>();
  section.parts.emplace_back(
      fmt::format("Where the simulation may be trusted: by ranges of what was measured, the largest error on "
                  "held-out data, as it "
                  "is and with the causes found, beside the noise of {:.3g} {}. It holds where the upper 95 "
                  "% bound of the error is "
                  "at most {:g} times the noise, and fails where the error is more than noise explains. "
                  "Beyond these ranges "
                  "nothing was measured.",
                  trusted.at("noise").get<double>(), unit, trusted.at("tolerated_excess").get<double>()));
  ReportTable table{"diagnosis_trusted_regions",
                    {"over", "from", "to", fmt::format("as it is ({})", unit), "as it is",
                     fmt::format("with what was found ({})", unit), "with what was found"},
                    {}};
  for (const Json& over : trusted.at("over")) AppendRegions(over, table);
  section.parts.emplace_back(std::move(table));
}

// In three sentences; files of older programs have none.
void AppendPlainWords(const Json& diagnosis, ReportSection& section) {
  if (!diagnosis.contains("plain_words")) return;
  const Json& words = diagnosis.at("plain_words");
  const auto missing = words.at("what_is_missing").get<std::string>();
  section.parts.emplace_back(
      fmt::format("{}How sure: {}. What to do: {}.",
                  missing.empty() ? "" : "What the simulation lacks: " + missing + ". ",
                  words.at("how_sure").get<std::string>(), words.at("what_to_do").get<std::string>()));
}

// Measurements that would settle what is open: their comment lines as words, their phases as the schedule has
// them.
void AppendMeasurements(const Json& to_settle, ReportSection& section) {
  for (const Json& measurement : to_settle) {
    std::string words;
    std::string phases;
    std::istringstream lines(measurement.get<std::string>());
    for (std::string line; std::getline(lines, line);) {
      const bool comment = line.starts_with("# ");
      std::string& text = comment ? words : phases;
      text += (text.empty() ? "" : " ") + (comment ? line.substr(2) : line);
    }
    section.parts.emplace_back(
        fmt::format("To settle what is open: {}. As phases of a schedule: {}", words, phases));
  }
}

ReportSection DiagnosisOf(const std::filesystem::path& file, const Json& diagnosis) {
  ReportSection section{"Diagnosis", {}};
  const Json& records = diagnosis.at("records");
  std::string of_records;
  for (const Json& record : records)
    of_records +=
        fmt::format("{}{} (SHA-256 {})", of_records.empty() ? "" : ", ", record.at("file").get<std::string>(),
                    record.at("sha256").get<std::string>().substr(0, 12));
  section.parts.emplace_back(
      fmt::format("Verdict: {}. Kind: {}. By {}, from {}. Records: {}.",
                  diagnosis.at("verdict").get<std::string>(), diagnosis.at("kind").get<std::string>(),
                  diagnosis.at("software").get<std::string>(), file.string(), of_records));
  AppendPlainWords(diagnosis, section);
  if (diagnosis.at("causes").empty()) {
    section.parts.emplace_back("No cause is named.");
  } else {
    section.parts.emplace_back(CausesTable(diagnosis.at("causes")));
  }
  const Json& gain = diagnosis.at("gain");
  const auto signature = diagnosis.at("unexplained").at("signature").get<std::string>();
  const Json& ci95 = gain.at("ci95");
  section.parts.emplace_back(fmt::format(
      "Error on held-out data falls by {} % (95 %: {} to {} %). Of the residual's variance {} % stays "
      "unexplained{}.",
      Fixed(100.0 * gain.at("heldout_rmse_reduction").get<double>(), 1),
      Fixed(100.0 * ci95.at(0).get<double>(), 1), Fixed(100.0 * ci95.at(1).get<double>(), 1),
      Fixed(100.0 * diagnosis.at("unexplained").at("share_of_residual_variance").get<double>(), 1),
      signature.empty() ? "" : ": " + signature));
  AppendMeasurements(diagnosis.at("to_settle"), section);
  AppendTrustedRegions(diagnosis, section);
  if (diagnosis.contains("power")) {
    AppendPower(diagnosis.at("power"), section);
  } else {
    section.parts.emplace_back(
        "How large an effect has to be to be found was not measured (strainwave diagnose --power).");
  }
  return section;
}

}  // namespace

ReportSection DiagnosisSection(const std::filesystem::path& file) {
  return SectionOfJson(file, ReadBounded(file, kDiagnosis), "diagnosis", kDiagnosis,
                       [&](const nlohmann::ordered_json& diagnosis) { return DiagnosisOf(file, diagnosis); });
}

}  // namespace strainwave::bench
