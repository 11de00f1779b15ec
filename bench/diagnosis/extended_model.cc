// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/extended_model.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"
#include "daq/record.h"
#include "schedules/reader/yaml_map.h"
#include "schedules/reader/yaml_node.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;
using diagnosis::CauseRule;
using diagnosis::ParameterValue;
using schedules::Bound;
using schedules::Presence;
using schedules::YamlMap;

constexpr schedules::FileKind kModelFile{"model", "plant: 1"};

// A text between double quotes reads the same in JSON and in YAML.
std::string QuotedForYaml(const std::string& text) { return nlohmann::json(text).dump(); }

std::string NumberText(double value) { return daq::ShortestText(std::isfinite(value) ? value : 0.0); }

void AddParameters(const std::vector<ParameterValue>& parameters, std::string_view indent,
                   std::string& text) {
  for (const ParameterValue& parameter : parameters) {
    text += fmt::format("{}- {{parameter: {}, value: {}", indent, QuotedForYaml(parameter.name),
                        NumberText(parameter.value));
    if (std::isfinite(parameter.standard_error)) {
      text += fmt::format(", se: {}", NumberText(parameter.standard_error));
    }
    if (!parameter.unit.empty()) text += fmt::format(", unit: {}", QuotedForYaml(parameter.unit));
    text += std::isfinite(parameter.standard_error) ? "}\n" : "}  # the records leave it open\n";
  }
}

void AddEffects(std::string_view section, std::string_view key, const std::vector<ModelEffect>& effects,
                std::string& text) {
  text += fmt::format("  {}:{}\n", section, effects.empty() ? " []" : "");
  for (const ModelEffect& effect : effects) {
    text += fmt::format("    - {}: {}\n      where: {}\n      parameters:\n", key, QuotedForYaml(effect.name),
                        effect.where);
    AddParameters(effect.parameters, "        ", text);
  }
}

void AddTerms(const PlantMapping& plant, std::string& text) {
  for (const std::string& sentence : plant.not_run) text += fmt::format("# {}\n", sentence);
  text += plant.terms.empty() ? "terms: []\n" : "terms:\n";
  for (const TermDescription& term : plant.terms) {
    text += fmt::format("  - term: {}\n", term.name);
    if (!term.enabled) text += "    enabled: false\n";
    if (term.parameters.empty()) continue;
    text += "    parameters:\n";
    for (const auto& [name, value] : term.parameters) {
      text += fmt::format("      {}: {}\n", name, NumberText(value));
    }
  }
}

std::vector<ParameterValue> ReadParameters(std::vector<YamlMap> maps) {
  std::vector<ParameterValue> parameters;
  for (YamlMap& map : maps) {
    ParameterValue parameter;
    parameter.name = map.Text("parameter");
    parameter.value = map.Number("value", Bound::kAny);
    parameter.standard_error = map.Number("se", Bound::kNotNegative, "0");
    parameter.unit = map.Text("unit", "");
    map.Finish();
    parameters.push_back(std::move(parameter));
  }
  return parameters;
}

std::vector<ModelEffect> ReadEffects(std::vector<YamlMap> maps, std::string_view key) {
  std::vector<ModelEffect> effects;
  for (YamlMap& map : maps) {
    ModelEffect effect;
    effect.name = map.Text(key);
    effect.where = map.Text("where", "undecided");
    effect.parameters = ReadParameters(map.MapList("parameters", Presence::kRequired));
    map.Finish();
    effects.push_back(std::move(effect));
  }
  return effects;
}

ExtendedModel ReadDiagnosisSection(YamlMap map) {
  ExtendedModel model;
  model.kind = map.Choice<StudyKind>("kind", {{"transmission_error", StudyKind::kTransmissionError},
                                              {"hysteresis", StudyKind::kHysteresis},
                                              {"motion", StudyKind::kMotion},
                                              {"vibration", StudyKind::kVibration},
                                              {"campaign", StudyKind::kCampaign}});
  model.date = map.Text("date", "");
  model.unit = map.Text("unit", "");
  model.noise_floor = map.Number("noise_floor", Bound::kNotNegative, "0");
  map.MapList("records", Presence::kOptional);
  model.nominal = ReadParameters(map.MapList("nominal", Presence::kOptional));
  model.causes = ReadEffects(map.MapList("causes", Presence::kOptional), "cause");
  model.nuisance_terms = ReadEffects(map.MapList("corrections", Presence::kOptional), "correction");
  map.Finish();
  return model;
}

}  // namespace

std::string WhereText(diagnosis::Where where) {
  switch (where) {
    case diagnosis::Where::kBench:
      return "bench";
    case diagnosis::Where::kUnit:
      return "unit";
    case diagnosis::Where::kUndecided:
      return "undecided";
  }
  return {};
}

ExtendedModel ExtendedModelOf(const StudyInput& input, const diagnosis::Diagnosis& result,
                              const std::string& date) {
  const diagnosis::Study& study = *input.study;
  ExtendedModel model;
  model.kind = input.kind;
  model.date = date;
  model.records = input.records;
  model.unit = study.unit();
  model.noise_floor = result.noise_floor * study.unit_per_si();
  model.nominal = result.extended.nominal;
  for (std::size_t i = 0; i < result.extended.causes.size(); ++i) {
    const CauseRule& rule = study.causes()[result.extended.causes[i]];
    ModelEffect effect{rule.name, WhereText(rule.where), result.extended.cause_parameters[i]};
    (rule.named ? model.causes : model.nuisance_terms).push_back(std::move(effect));
  }
  return model;
}

std::string ExtendedModelText(const ExtendedModel& model) {
  std::string text =
      "# A model that strainwave diagnose has fitted. `strainwave simulate` runs it; a bench file takes it\n"
      "# as its plant_file, and the simulated bench then runs `terms` on top of its own plant.\n"
      "plant: 1\n";
  AddTerms(model.plant, text);
  text +=
      fmt::format("diagnosis:\n  kind: {}\n  date: {}\n  unit: {}\n  noise_floor: {}\n", NameOf(model.kind),
                  QuotedForYaml(model.date), QuotedForYaml(model.unit), NumberText(model.noise_floor));
  text += fmt::format("  records:{}\n", model.records.empty() ? " []" : "");
  for (const RecordIdentity& record : model.records) {
    text += fmt::format("    - {{file: {}, group: {}, sha256: {}, rows: {}}}\n",
                        QuotedForYaml(std::filesystem::path(record.file).filename().string()),
                        QuotedForYaml(record.group), record.sha256, record.rows);
  }
  text += fmt::format("  nominal:{}\n", model.nominal.empty() ? " []" : "");
  AddParameters(model.nominal, "    ", text);
  AddEffects("causes", "cause", model.causes, text);
  if (!model.nuisance_terms.empty()) {
    text +=
        "  # No knowledge of physics: shapes that describe what was left, and hold for this unit on this\n"
        "  # bench as it was measured. `simulate --corrections` runs them, the bench does not.\n";
  }
  AddEffects("corrections", "correction", model.nuisance_terms, text);
  return text;
}

ExtendedModel ReadExtendedModel(const std::filesystem::path& path) {
  schedules::ReadContext context;
  const std::optional<std::string> text = schedules::ReadInputFile(path, kModelFile, context.findings);
  if (!text) throw ModelFileError(path.string(), context.findings);
  const std::optional<schedules::YamlNode> root = schedules::ParseYaml(*text, kModelFile, context.findings);
  if (!root) throw ModelFileError(path.string(), context.findings);
  YamlMap map(*root, context);
  map.Version("plant");
  map.MapList("terms", Presence::kOptional);
  ExtendedModel model = ReadDiagnosisSection(map.Map("diagnosis", Presence::kRequired));
  map.Finish();
  if (context.findings.has_errors()) throw ModelFileError(path.string(), context.findings);
  return model;
}

std::vector<diagnosis::Study::NamedCause> NamedCausesOf(const ExtendedModel& model,
                                                        bool with_nuisance_terms) {
  std::vector<diagnosis::Study::NamedCause> causes;
  for (const ModelEffect& cause : model.causes) causes.push_back({cause.name, cause.parameters});
  if (!with_nuisance_terms) return causes;
  for (const ModelEffect& nuisance_term : model.nuisance_terms) {
    causes.push_back({nuisance_term.name, nuisance_term.parameters});
  }
  return causes;
}

std::vector<std::size_t> GivenCauses(const ExtendedModel& model, const diagnosis::Study& study,
                                     const std::string& file) {
  std::vector<std::size_t> given;
  const std::vector<CauseRule>& rules = study.causes();
  for (const ModelEffect& cause : model.causes) {
    // A cause may come in two forms (a drift by time, or by temperature): the parameters tell which.
    const auto rule = std::ranges::find_if(rules, [&](const CauseRule& candidate) {
      return candidate.named && candidate.name == cause.name &&
             std::ranges::all_of(candidate.parameters, [&](const diagnosis::ParameterRule& parameter) {
               return std::ranges::find(cause.parameters, parameter.name, &ParameterValue::name) !=
                      cause.parameters.end();
             });
    });
    if (rule == rules.end()) {
      throw BenchError(ExitCode::kWrongInput,
                       fmt::format("{}: error: the cause '{}' of the model cannot be fitted to these "
                                   "records (expected records that excite it, as those it was found in)",
                                   file, cause.name));
    }
    given.push_back(static_cast<std::size_t>(rule - rules.begin()));
  }
  std::ranges::sort(given);
  return given;
}

}  // namespace strainwave::bench
