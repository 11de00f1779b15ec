// SPDX-License-Identifier: Apache-2.0
#include "bench/fleet/collect.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/fleet/fleet_status.h"
#include "bench/fleet/kept_results.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

using Document = nlohmann::ordered_json;
using Row = std::vector<std::pair<std::string, Document>>;

constexpr int kDocumentFormat = 1;

[[noreturn]] void TellMissing(const PlanFolder& folder, const FleetPlan& plan) {
  const FleetStatus status = StatusOf(folder, plan);
  throw BenchError(
      ExitCode::kEndedBadly,
      fmt::format("{}: error: {} of {} records have no result (expected all; strainwave fleet submit "
                  "--out {} computes what is missing)\n{}",
                  folder.root.string(), status.open.size(), status.inputs, folder.root.string(),
                  OpenText(status)));
}

// A command makes one report of a record, or an array of several.
std::vector<const Document*> ReportsOf(const Document& input) {
  std::vector<const Document*> reports;
  const Document& report = input.at("report");
  if (report.is_array()) {
    for (const Document& one : report) reports.push_back(&one);
  } else {
    reports.push_back(&report);
  }
  return reports;
}

Row RowOf(const Document& report) {
  Row row;
  if (!report.is_object()) return row;
  if (report.contains("names") && report.contains("values")) {
    for (std::size_t i = 0; i < report["names"].size() && i < report["values"].size(); ++i)
      row.emplace_back(report["names"][i].get<std::string>(), report["values"][i]);
  }
  for (const auto& [key, value] : report.items()) {
    if (value.is_primitive()) row.emplace_back(key, value);
    if (key != "causes" || !value.is_array()) continue;
    std::string names;
    for (const Document& cause : value)
      names += (names.empty() ? "" : " ") + cause.value("name", std::string());
    row.emplace_back(key, names);
  }
  return row;
}

// Mean and standard deviation of each number over the records.
class Sums {
 public:
  void Add(const Row& row) {
    for (const auto& [name, value] : row) {
      if (!value.is_number()) continue;
      const auto [at, is_new] = column_.emplace(name, values_.size());
      if (is_new) values_.emplace_back(name, std::vector<double>{});
      values_[at->second].second.push_back(value.get<double>());
    }
  }

  Document Json() const {
    Document json = Document::object();
    for (const auto& [name, values] : values_) {
      const auto n = static_cast<double>(values.size());
      double sum = 0.0;
      for (const double value : values) sum += value;
      const double mean = sum / n;
      double squares = 0.0;
      for (const double value : values) squares += (value - mean) * (value - mean);
      json.push_back({name,
                      {{"count", values.size()},
                       {"mean", mean},
                       {"standard_deviation",
                        values.size() > 1 ? Document(std::sqrt(squares / (n - 1.0))) : Document(nullptr)}}});
    }
    return json;
  }

 private:
  std::unordered_map<std::string, std::size_t> column_;
  std::vector<std::pair<std::string, std::vector<double>>> values_;
};

std::string CellOf(const Document& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  const auto& text = value.get_ref<const std::string&>();
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

void DemandTargets(const PlanFolder& folder, const FleetPlan& plan, const std::vector<fs::path>& targets) {
  const fs::path working = plan.working_folder;
  std::set<fs::path> rests_on;
  const auto add = [&](const PlannedFile& file) {
    rests_on.insert(fs::weakly_canonical(working / file.path));
  };
  for (const PlannedFile& file : plan.option_files) add(file);
  for (const PlannedInput& input : plan.inputs) {
    add(input.file);
    for (const PlannedFile& file : input.beside) add(file);
  }
  const fs::path root = fs::weakly_canonical(folder.root);
  std::set<fs::path> before;
  for (const fs::path& target : targets) {
    DemandOutputFile(target);
    const fs::path whole = fs::weakly_canonical(fs::absolute(target));
    if (!before.insert(whole).second) Refuse(target, "is named twice", "a file each for document and table");
    if (rests_on.contains(whole)) Refuse(target, "is a file that the plan reads", "another one to write");
    if (std::mismatch(root.begin(), root.end(), whole.begin(), whole.end()).first == root.end())
      Refuse(target, "lies in the plan's folder", "a file beside it");
  }
}

Collected CollectResults(const PlanFolder& folder, const FleetPlan& plan) {
  Collected all;
  Document inputs = Document::array();
  Sums sums;
  for (const PlannedInput& input : plan.inputs) {
    auto result = ReadResult(folder, input);
    if (!result) TellMissing(folder, plan);
    if (result->exit_code == 1) ++all.ended_badly;
    if (result->exit_code == 2) ++all.refused;
    Document one{{"path", input.file.path},
                 {"sha256", input.file.sha256},
                 {"exit_code", result->exit_code},
                 {"report", std::move(result->report)}};
    if (!result->words.empty()) one["error"] = result->words;
    for (const Document* report : ReportsOf(one)) sums.Add(RowOf(*report));
    inputs.push_back(std::move(one));
  }
  all.inputs = plan.inputs.size();
  all.document = {{"fleet", kDocumentFormat},
                  {"software", plan.program.software},
                  {"program_sha256", plan.program.sha256},
                  {"command", plan.command},
                  {"options", plan.options},
                  {"inputs", std::move(inputs)},
                  {"over_records", sums.Json()}};
  return all;
}

std::string CsvOf(const nlohmann::ordered_json& document) {
  std::vector<std::string> names{"path", "sha256", "exit_code", "error"};
  std::unordered_map<std::string, std::size_t> column;
  for (std::size_t i = 0; i < names.size(); ++i) column.emplace(names[i], i);
  std::vector<std::vector<std::string>> rows;
  for (const Document& input : document.at("inputs")) {
    for (const Document* report : ReportsOf(input)) {
      std::vector<std::string> cells{CellOf(input["path"]), CellOf(input["sha256"]),
                                     CellOf(input["exit_code"]), CellOf(input.value("error", ""))};
      for (const auto& [name, value] : RowOf(*report)) {
        const auto [at, is_new] = column.emplace(name, names.size());
        if (is_new) names.push_back(name);
        if (cells.size() <= at->second) cells.resize(at->second + 1);
        cells[at->second] = CellOf(value);
      }
      rows.push_back(std::move(cells));
    }
  }
  std::string csv;
  const auto add_line = [&](std::vector<std::string> cells) {
    cells.resize(names.size());
    for (std::size_t i = 0; i < cells.size(); ++i) csv += (i == 0 ? "" : ",") + cells[i];
    csv += "\n";
  };
  std::vector<std::string> head;
  for (const std::string& name : names) head.push_back(CellOf(name));
  add_line(head);
  for (auto& row : rows) add_line(std::move(row));
  return csv;
}

}  // namespace strainwave::bench
