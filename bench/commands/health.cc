// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <mutex>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/commands/commands.h"
#include "bench/commands/health_report.h"
#include "bench/commands/map_option.h"
#include "bench/commands/output.h"
#include "bench/commands/tell_warnings.h"
#include "bench/commands/terminal.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/health/assess_health.h"
#include "bench/health/health_json.h"
#include "bench/health/health_pictures.h"
#include "bench/health/train_health.h"
#include "daq/record.h"

namespace strainwave::bench {
namespace {

namespace health = analysis::health;
using HealthJson = nlohmann::ordered_json;

struct HealthTrainCommand {
  std::string folder;
  std::string out;
  HealthJob job;
  analysis::features::PacketRecipe recipe;
  std::optional<double> limit_rms;
  std::string plots;
  std::string map;
  bool json{};
};

int TrainHealthModel(const HealthTrainCommand& command) {
  DemandOutputFolder(command.out);
  if (!command.plots.empty()) DemandOutputFolder(command.plots);
  ShareLine line;
  std::mutex telling;
  const auto part = [&](double begin, double end) {
    return [&, begin, end](const std::string& step, double share) {
      const std::lock_guard lock(telling);
      line.Show(step, begin + (end - begin) * share);
    };
  };
  // Reading and features are about a fifth of the work.
  constexpr double kReading = 0.2;
  const HealthData data =
      ReadHealthData(RecordReader(command.map), command.folder, command.recipe, part(0.0, kReading));
  TellWarnings(data.warnings);
  HealthJob job = command.job;
  job.system.seed = job.seed;
  job.system.limit_rms = command.limit_rms;
  const HealthOutcome outcome = TrainHealth(data, job, part(kReading, 1.0));
  WriteHealthModel(command.out, data, job, outcome);
  std::vector<std::filesystem::path> pictures;
  if (!command.plots.empty()) {
    line.Show("pictures", 0.99);
    pictures = DrawHealthData(data, command.plots);
    for (std::filesystem::path& picture : DrawHealthTraining(data, outcome, command.plots))
      pictures.push_back(std::move(picture));
  }
  line.Clear();
  if (command.json) {
    ToStdout("{}\n", ReportOf(data, job, outcome).dump(2));
  } else {
    PrintHealthTraining(data, job, outcome);
    for (const auto& picture : pictures) ToStdout("picture: {}.svg (and .png)\n", picture.string());
    ToStdout("\nmodel: {}\nnext: strainwave health assess {} RECORD\n", command.out, command.out);
  }
  return static_cast<int>(ExitCode::kDone);
}

struct HealthAssessCommand {
  std::string model;
  std::vector<std::string> paths;
  std::string map;
  std::string interval{"measurement"};
  bool json{};
};

health::IntervalOf HealthIntervalOf(const std::string& name) {
  return name == "mean" ? health::IntervalOf::kMean : health::IntervalOf::kMeasurement;
}

HealthJson BoundedJson(const health::Bounded& bounded) {
  return {{"value", bounded.value}, {"low", bounded.low}, {"high", bounded.high}};
}

int AssessRecords(const HealthAssessCommand& command) {
  const HealthModel model = ReadHealthModel(command.model);
  const std::vector<std::filesystem::path> files = HealthPaths(command.paths);
  const RecordReader reader(command.map);
  HealthJson all = HealthJson::array();
  ShareLine line;
  for (std::size_t i = 0; i < files.size(); ++i) {
    line.Show("assessing " + files[i].filename().string(),
              static_cast<double>(i) / static_cast<double>(files.size()));
    const HealthAssessment assessment =
        AssessHealth(model, reader, files[i], HealthIntervalOf(command.interval));
    if (!command.json) {
      line.Clear();
      TellWarnings(assessment.warnings);
      PrintAssessment(model, assessment);
      continue;
    }
    HealthJson components;
    for (std::size_t c = 0; c < model.components.size(); ++c)
      components[model.components[c]] = BoundedJson(assessment.health[c]);
    all.push_back({{"file", assessment.file},
                   {"health", std::move(components)},
                   {"system", assessment.system ? BoundedJson(*assessment.system) : HealthJson(nullptr)},
                   {"interval_of_system", command.interval},
                   {"cycles", assessment.cycles},
                   {"distance", assessment.distance},
                   {"outside_training", assessment.outside_training},
                   {"extrapolated", assessment.extrapolated},
                   {"near_failed_condition", assessment.near_failed_condition},
                   {"warnings", WarningTexts(assessment.warnings)}});
  }
  line.Clear();
  if (command.json) ToStdout("{}\n", all.dump(2));
  return static_cast<int>(ExitCode::kDone);
}

struct HealthWhatIfCommand {
  std::string model;
  std::vector<std::string> state;
  std::string interval{"measurement"};
  std::string plots;
  bool json{};
};

Eigen::VectorXd HealthStateOf(const HealthWhatIfCommand& command, const HealthModel& model) {
  std::string expected = "each of";
  for (const std::string& name : model.components) expected += fmt::format(" {}=0…1", name);
  Eigen::VectorXd state = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(model.components.size()), -1.0);
  for (const std::string& text : command.state) {
    const std::size_t sign = text.find('=');
    const std::string name = text.substr(0, sign);
    const auto found = std::ranges::find(model.components, name);
    const auto value = sign == std::string::npos ? std::nullopt : daq::NumberFromText(text.substr(sign + 1));
    if (found == model.components.end())
      Refuse("--state", fmt::format("there is no component in '{}'", text), expected);
    if (!value || !(*value >= 0.0 && *value <= 1.0))
      Refuse("--state", fmt::format("'{}' has no number from 0 to 1", text), expected);
    double& place = state(found - model.components.begin());
    if (place >= 0.0) Refuse("--state", fmt::format("{} is there twice", name), expected);
    place = *value;
  }
  for (std::size_t c = 0; c < model.components.size(); ++c) {
    if (state(static_cast<Eigen::Index>(c)) < 0.0)
      Refuse("--state", fmt::format("{} is missing", model.components[c]), expected);
  }
  return state;
}

HealthJson WhatIfJson(const HealthModel& model, const Eigen::VectorXd& state, const health::WhatIf& answer,
                      const std::string& interval) {
  HealthJson restored;
  HealthJson shapley;
  HealthJson alone;
  HealthJson gain;
  HealthJson intervals_shapley;
  HealthJson intervals_alone;
  HealthJson given;
  for (std::size_t c = 0; c < model.components.size(); ++c) {
    const std::string& name = model.components[c];
    given[name] = state(static_cast<Eigen::Index>(c));
    restored[name] = BoundedJson(answer.restored[c].index);
    restored[name]["extrapolated"] = answer.restored[c].extrapolated;
    shapley[name] = answer.shapley[c].value;
    alone[name] = answer.alone[c].value;
    gain[name] = BoundedJson(answer.gain[c]);
    intervals_shapley[name] = BoundedJson(answer.shapley[c]);
    intervals_alone[name] = BoundedJson(answer.alone[c]);
  }
  HealthJson ranking = HealthJson::array();
  HealthJson ties = HealthJson::array();
  for (std::size_t place = 0; place < answer.ranking.size(); ++place) {
    ranking.push_back(model.components[answer.ranking[place]]);
    if (place < answer.tied_with_next.size() && answer.tied_with_next[place])
      ties.push_back({model.components[answer.ranking[place]], model.components[answer.ranking[place + 1]]});
  }
  return {{"state", std::move(given)},
          {"system", answer.system.index.value},
          {"restored", std::move(restored)},
          {"shares",
           {{"shapley", std::move(shapley)},
            {"alone", std::move(alone)},
            {"interaction", answer.interaction.value},
            {"baseline", answer.baseline.index.value}}},
          {"ranking", std::move(ranking)},
          {"ties", std::move(ties)},
          {"gain", std::move(gain)},
          {"intervals",
           {{"of", interval},
            {"system", BoundedJson(answer.system.index)},
            {"shapley", std::move(intervals_shapley)},
            {"alone", std::move(intervals_alone)},
            {"interaction", BoundedJson(answer.interaction)},
            {"baseline", BoundedJson(answer.baseline.index)}}},
          {"extrapolated", answer.extrapolated},
          {"system_extrapolated", answer.system.extrapolated},
          {"near_failed_condition", NearFailedCondition(model, state)}};
}

int AnswerWhatIf(const HealthWhatIfCommand& command) {
  if (!command.plots.empty()) DemandOutputFolder(command.plots);
  const HealthModel model = ReadHealthModel(command.model);
  if (!model.system)
    Refuse(command.model, "the model knows nothing of the system", "one that was trained with system_rms");
  const Eigen::VectorXd state = HealthStateOf(command, model);
  const health::WhatIf answer = health::AskWhatIf(model.system->surface, model.system->scale, state,
                                                  HealthIntervalOf(command.interval));
  if (!command.plots.empty())
    DrawWhatIf(model.components, state, answer, std::filesystem::path(command.plots) / "whatif");
  if (command.json) {
    ToStdout("{}\n", WhatIfJson(model, state, answer, command.interval).dump(2));
  } else {
    PrintWhatIf(model, state, answer, command.interval);
  }
  return static_cast<int>(ExitCode::kDone);
}

void AddSystemInterval(CLI::App* command, std::string& interval) {
  command
      ->add_option("--interval", interval,
                   "of the system: of its mean, or of a new measurement, which has the noise of one on top")
      ->check(CLI::IsMember({"mean", "measurement"}))
      ->capture_default_str();
}

void AddHealthTrain(CLI::App* parent, Action& action) {
  CLI::App* command = parent->add_subcommand("train",
                                             "Learn the health of components from motor records of known "
                                             "health, and the system's performance from it.\n"
                                             "Example: strainwave health train robots --out model");
  auto options = std::make_shared<HealthTrainCommand>();
  command
      ->add_option("DIR", options->folder,
                   "folder of motor records with labels.csv: file, unit, health_NAME (0 to 1), system_rms")
      ->required();
  command->add_option("--out", options->out, "folder of the model")->required();
  HealthJob& job = options->job;
  command
      ->add_option("--alpha", job.scores.alpha,
                   "share of the trend in a feature's score; the rest is Fisher's ratio")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_flag(
      "--magnitudes", job.scores.sum_of_magnitudes,
      "sum the magnitudes of trends over the other components' levels: opposite ones do not cancel");
  command
      ->add_option("--rounding", job.selection.rounding, "of scores, before the threshold is sought; 0: none")
      ->check(CLI::Range(0.0, 0.2))
      ->capture_default_str();
  command
      ->add_option("--correlation", job.selection.most_correlation,
                   "of two features alike to more than this, the lower score goes")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  command->add_option("--least-features", job.selection.least, "a component, also below the threshold")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_option("--most-features", job.selection.most, "a component")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--hidden-nodes", job.hidden_nodes, "of the network (default: searched for, 1 to 50)")
      ->check(CLI::Range(1, 1000));
  command->add_flag("--every-node-count", job.every_node_count, "search all of 1 to 50, not twelve of them");
  command->add_option("--epochs", job.epochs, "of the network")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--members", job.members, "networks in the ensemble")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_option("--coverage", job.coverage, "of the components' intervals")
      ->check(CLI::Range(0.5, 0.99))
      ->capture_default_str();
  command->add_option("--limit-rms", options->limit_rms,
                      "system_rms at which the system's index is 1 (default: the worst condition measured)");
  command->add_flag("--unit-means", job.system.unit_means,
                    "the system's surface through the means of units, in place of single recordings");
  command->add_option("--restarts", job.system.restarts, "of the search for the surface's parameters")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command->add_option("--wavelet", options->recipe.wavelet, "of the packets")->capture_default_str();
  command->add_option("--levels", options->recipe.levels, "of the packets: 2^levels bands")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  command->add_flag("--normalised-entropy", options->recipe.normalised_entropy,
                    "Shannon entropy of shares, which a gain of the sensor does not move");
  AddMapOption(*command, options->map);
  command->add_option("--plots", options->plots, "folder for pictures");
  command->add_option("--seed", job.seed, "of weights and the random split")->capture_default_str();
  command->add_flag("--json", options->json, "print the report as one JSON document");
  command->callback([options, &action] { action = [options] { return TrainHealthModel(*options); }; });
}

}  // namespace

void AddHealth(CLI::App& app, Action& action) {
  CLI::App* group = app.add_subcommand(
      "health",
      "Health of a robot's components from motor current and speed, and what replacing each would bring.");
  group->require_subcommand(1);
  AddHealthTrain(group, action);
  {
    CLI::App* command =
        group->add_subcommand("assess",
                              "The health of each component, and of the system, from motor records.\n"
                              "Example: strainwave health assess model robots/records/hd1_tb0_1_001.csv");
    auto options = std::make_shared<HealthAssessCommand>();
    command->add_option("MODEL", options->model, "folder that health train has written")->required();
    command->add_option("PATH", options->paths, "motor records, or folders of them")->required();
    AddSystemInterval(command, options->interval);
    AddMapOption(*command, options->map);
    command->add_flag("--json", options->json, "an array, one object a file");
    command->callback([options, &action] { action = [options] { return AssessRecords(*options); }; });
  }
  CLI::App* command =
      group->add_subcommand("whatif",
                            "What replacing each component would restore of the system's performance.\n"
                            "Example: strainwave health whatif model --state hd=0.5 tb=1");
  auto options = std::make_shared<HealthWhatIfCommand>();
  command->add_option("MODEL", options->model, "folder that health train has written")->required();
  command->add_option("--state", options->state, "NAME=HEALTH of every component, 0 (new) to 1")->required();
  AddSystemInterval(command, options->interval);
  command->add_option("--plots", options->plots, "folder for a picture");
  command->add_flag("--json", options->json, "the answer as one JSON document");
  command->callback([options, &action] { action = [options] { return AnswerWhatIf(*options); }; });
}

}  // namespace strainwave::bench
