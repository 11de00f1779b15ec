// SPDX-License-Identifier: Apache-2.0
#include "bench/fingerprint/train_fingerprints.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <numeric>

#include <fmt/format.h>

#include "bench/campaign/on_all_processors.h"
#include "bench/fingerprint/nominal_folds.h"

namespace strainwave::bench {
namespace {

namespace dynamics = analysis::joint_dynamics;
namespace prediction = analysis::prediction;
using Eigen::Index;

// What each part takes of the whole, roughly, for the time left.
constexpr double kShareOfFiles = 0.3;
constexpr double kShareOfNominal = 0.4;

dynamics::AttributionSettings AttributionOf(const FingerprintJob& job, Index joints) {
  return {.fingerprint = job.fingerprint,
          .method = job.method.value_or(dynamics::DefaultMethod(job.fingerprint, joints)),
          .coalitions = job.coalitions,
          .seed = job.seed};
}

std::vector<Index> FirstShare(Index rows, double share) {
  std::vector<Index> chosen(
      static_cast<std::size_t>(std::max<double>(1.0, share * static_cast<double>(rows))));
  std::iota(chosen.begin(), chosen.end(), Index{0});
  return chosen;
}

// Each file's own network, as the published study has it.
void TrainOwnNetworks(const FingerprintData& data, const std::vector<dynamics::JointMotion>& samples,
                      const FingerprintJob& job, const FingerprintProgress& progress,
                      FingerprintOutcome& outcome) {
  constexpr double kTrained = 0.9;
  const std::size_t files = data.files.size();
  const dynamics::AttributionSettings settings = AttributionOf(job, data.joints());
  std::vector<std::optional<prediction::Ensemble>> networks(files);
  outcome.dynamics.resize(files);
  std::atomic<std::size_t> done{0};
  OnAllProcessors(files, [&](std::size_t f) {
    const dynamics::JointMotion& motion = data.files[f].motion;
    const std::vector<Index> seen = FirstShare(motion.size(), kTrained);
    const dynamics::JointMotion trained = dynamics::RowsOf(motion, seen);
    const std::vector<int> part(seen.size(), 0);
    networks[f].emplace(dynamics::TrainDynamics(trained, part, {.epochs = job.epochs, .seed = job.seed}));
    std::vector<Index> rest;
    for (auto row = static_cast<Index>(seen.size()); row < motion.size(); ++row) rest.push_back(row);
    outcome.dynamics[f].trained = dynamics::ErrorsOf(*networks[f], trained);
    outcome.dynamics[f].held_out = rest.empty()
                                       ? outcome.dynamics[f].trained
                                       : dynamics::ErrorsOf(*networks[f], dynamics::RowsOf(motion, rest));
    progress("each file's own network",
             kShareOfFiles * static_cast<double>(++done) / static_cast<double>(files));
  });
  std::vector<Index> begin{0};
  for (const dynamics::JointMotion& of_file : samples) begin.push_back(begin.back() + of_file.size());
  outcome.per_file_fingerprints.resize(begin.back(), dynamics::SizeOf(job.fingerprint, data.joints()));
  std::vector<double> gaps(files);
  std::vector<double> errors(files);
  const auto start = std::chrono::steady_clock::now();
  OnAllProcessors(files, [&](std::size_t f) {
    std::vector<dynamics::JointMotion> own{data.files[f].motion};
    const dynamics::Attributions attributions = dynamics::Attribute(
        *networks[f], samples[f].states, BackgroundOf(own, {0}, job.background), settings);
    outcome.per_file_fingerprints.middleRows(begin[f], samples[f].size()) = attributions.fingerprints;
    outcome.dynamics[f].quantity_share = attributions.quantity_share;
    gaps[f] = attributions.worst_gap;
    errors[f] = attributions.mean_standard_error;
  });
  outcome.explained_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  outcome.worst_gap = *std::ranges::max_element(gaps);
  outcome.mean_standard_error = *std::ranges::max_element(errors);
}

Eigen::MatrixXd RawSignals(const std::vector<dynamics::JointMotion>& samples) {
  const dynamics::JointMotion all = dynamics::Stacked(samples);
  Eigen::MatrixXd raw(all.size(), all.states.cols() + all.joints());
  raw << all.states, all.torques_Nm;
  return raw;
}

std::vector<int> OrderOf(const std::vector<double>& importance) {
  std::vector<int> order(importance.size());
  std::iota(order.begin(), order.end(), 1);
  std::ranges::stable_sort(order, std::greater<>(),
                           [&](int joint) { return importance[static_cast<std::size_t>(joint) - 1]; });
  return order;
}

double RankCorrelation(const std::vector<int>& one, const std::vector<int>& other) {
  const auto joints = static_cast<double>(one.size());
  if (one.size() < 2) return 1.0;
  double squares = 0.0;
  for (std::size_t place = 0; place < one.size(); ++place) {
    const auto there = std::ranges::find(other, one[place]) - other.begin();
    const double apart = static_cast<double>(place) - static_cast<double>(there);
    squares += apart * apart;
  }
  return 1.0 - 6.0 * squares / (joints * (joints * joints - 1.0));
}

// The same attributions told from other backgrounds.
std::vector<BackgroundRanking> RankBackgrounds(const FingerprintData& data,
                                               const std::vector<dynamics::JointMotion>& samples,
                                               const FingerprintModel& model) {
  constexpr Index kSamplesOfFile = 10;
  std::vector<std::size_t> all(data.files.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::vector<dynamics::JointMotion> motion;
  for (const JointFile& file : data.files) motion.push_back(file.motion);
  const std::pair<const char*, Eigen::MatrixXd> backgrounds[] = {
      {"healthy", model.background},
      {"all", BackgroundOf(motion, all, model.background.rows())},
      {"mean", model.background.colwise().mean()},
      {"one_row", model.background.row(model.background.rows() / 2)}};
  const Eigen::MatrixXd states = BackgroundOf(samples, all, kSamplesOfFile * static_cast<Index>(all.size()));
  dynamics::AttributionSettings settings = model.attribution;
  settings.fingerprint = dynamics::Fingerprint::kJoint;
  settings.method = dynamics::DefaultMethod(settings.fingerprint, data.joints());
  std::vector<BackgroundRanking> rankings;
  for (const auto& [name, background] : backgrounds) {
    const Eigen::RowVectorXd mean =
        dynamics::Attribute(model.nominal, states, background, settings, OnAllProcessors)
            .fingerprints.colwise()
            .mean();
    BackgroundRanking ranking{name, {}, {}, 1.0};
    for (const double value : mean) ranking.importance.push_back(value / std::max(mean.sum(), 1e-300));
    ranking.order = OrderOf(ranking.importance);
    if (!rankings.empty()) ranking.rank_correlation = RankCorrelation(rankings.front().order, ranking.order);
    rankings.push_back(std::move(ranking));
  }
  return rankings;
}

// Fingerprints by networks that have not seen the sample's unit; where that cannot be, those of one that has.
Eigen::MatrixXd HonestFingerprints(const NominalFolds& folds, const std::vector<dynamics::FileSplit>& splits,
                                   const std::vector<int>& file) {
  for (const std::string_view name : {dynamics::kUnitSplit, dynamics::kFileSplit}) {
    const auto found = folds.features.find(std::string(name));
    if (found == folds.features.end()) continue;
    const dynamics::FileSplit& split = *std::ranges::find(splits, name, &dynamics::FileSplit::name);
    Eigen::MatrixXd honest(static_cast<Index>(file.size()), found->second.of_fold.front().cols());
    for (std::size_t i = 0; i < file.size(); ++i) {
      const auto row = static_cast<Index>(i);
      honest.row(row) = found->second.For(split.fold[static_cast<std::size_t>(file[i])]).row(row);
    }
    return honest;
  }
  return folds.features.at(std::string(dynamics::kRandomSplit)).of_fold.front();
}

// Every other row tells how far the rest lie from the middle.
prediction::Novelty NoveltyOf(const Eigen::MatrixXd& scaled) {
  constexpr Index kMostRows = 4000;
  constexpr double kInside = 0.99;
  std::vector<Index> one;
  std::vector<Index> other;
  for (const Index row : dynamics::EvenRows(scaled.rows(), kMostRows))
    (one.size() > other.size() ? other : one).push_back(row);
  return prediction::FitNovelty(scaled(one, Eigen::all), scaled(other, Eigen::all), kInside);
}

FingerprintModel ModelOf(const FingerprintData& data, const FingerprintJob& job, const NominalFolds& folds,
                         const std::vector<int>& file, const Eigen::MatrixXd& honest,
                         const Eigen::MatrixXd& states) {
  constexpr Index kHealthyRows = 60;
  std::vector<int> actual;
  std::vector<Index> healthy;
  for (std::size_t i = 0; i < file.size(); ++i) {
    actual.push_back(data.facts.faulty[static_cast<std::size_t>(file[i])]);
    if (actual.back() == 0) healthy.push_back(static_cast<Index>(i));
  }
  std::vector<Index> chosen;
  for (const Index i : dynamics::EvenRows(static_cast<Index>(healthy.size()), kHealthyRows))
    chosen.push_back(healthy[static_cast<std::size_t>(i)]);
  Smoothing smoothing = data.smoothing;
  smoothing.as_given = false;
  prediction::Ensemble classifier = prediction::TrainBinaryNetwork(honest, actual, {.seed = job.seed});
  prediction::Novelty of_states = NoveltyOf(folds.nominal->input.Apply(states));
  prediction::Novelty of_fingerprints = NoveltyOf(classifier.input.Apply(honest));
  return {.nominal = *folds.nominal,
          .classifier = std::move(classifier),
          .background = folds.background,
          .healthy_fingerprints = honest(chosen, Eigen::all),
          .state_novelty = std::move(of_states),
          .fingerprint_novelty = std::move(of_fingerprints),
          .lowest = states.colwise().minCoeff(),
          .highest = states.colwise().maxCoeff(),
          .attribution = AttributionOf(job, data.joints()),
          .samples = job.samples,
          .smoothing = smoothing,
          .acceleration_measured = data.acceleration_measured,
          .sample_rate_hz = data.files.front().sample_rate_hz,
          .shortest_s = std::ranges::min(data.files, {}, &JointFile::duration_s).duration_s,
          .healthy = data.healthy,
          .training_json = {}};
}

// Forests on the files' own fingerprints, where labels are dealt anew among files: what they still reach is
// the files' identity.
dynamics::ScoreTable ScoreShuffled(const FingerprintData& data, const FingerprintJob& job,
                                   const FingerprintOutcome& outcome) {
  dynamics::FileFacts facts = data.facts;
  facts.faulty = dynamics::ShuffledLabels(facts.faulty, job.seed);
  return dynamics::ScoreSplits(dynamics::SplitsOfFiles(facts, job.folds, job.seed),
                               {{"", {{outcome.per_file_fingerprints}}}}, outcome.file_of_sample,
                               facts.faulty, {prediction::BinaryKind::kForest}, {.seed = job.seed},
                               OnAllProcessors);
}

}  // namespace

FingerprintOutcome TrainFingerprints(const FingerprintData& data, const FingerprintJob& job,
                                     const FingerprintProgress& progress) {
  FingerprintOutcome outcome;
  outcome.splits = dynamics::SplitsOfFiles(data.facts, job.folds, job.seed);
  std::vector<dynamics::JointMotion> motion;
  std::vector<dynamics::JointMotion> samples;
  for (const JointFile& one : data.files) {
    motion.push_back(one.motion);
    samples.push_back(dynamics::RowsOf(one.motion, dynamics::EvenRows(one.motion.size(), job.samples)));
    outcome.file_of_sample.insert(outcome.file_of_sample.end(),
                                  static_cast<std::size_t>(samples.back().size()),
                                  static_cast<int>(samples.size()) - 1);
  }
  TrainOwnNetworks(data, samples, job, progress, outcome);
  NominalSettings settings;
  settings.training = {.epochs = job.epochs, .seed = job.seed};
  settings.attribution = AttributionOf(job, data.joints());
  settings.background = job.background;
  const NominalFolds folds = MakeNominalFolds(
      outcome.splits, data.facts, motion, samples, settings, OnAllProcessors, [&](double share) {
        progress("nominal networks without what is tested", kShareOfFiles + kShareOfNominal * share);
      });
  outcome.networks = folds.networks;
  outcome.worst_gap = std::max(outcome.worst_gap, folds.worst_gap);
  outcome.mean_standard_error = std::max(outcome.mean_standard_error, folds.mean_standard_error);
  for (const dynamics::FileSplit& split : outcome.splits) {
    if (!split.impossible.empty()) outcome.impossible[split.name] = split.impossible;
  }
  if (data.origins.empty())
    outcome.impossible[std::string(dynamics::kOriginSplit)] = "labels.csv has no column origin";

  const std::vector<prediction::BinaryKind> kinds(std::begin(prediction::kBinaryKinds),
                                                  std::end(prediction::kBinaryKinds));
  const auto score = [&](const std::map<std::string, dynamics::SampleFeatures>& features, int part) {
    constexpr double kParts = 4.0;
    progress("classifiers on every split",
             kShareOfFiles + kShareOfNominal + (1.0 - kShareOfFiles - kShareOfNominal) * part / kParts);
    return dynamics::ScoreSplits(outcome.splits, features, outcome.file_of_sample, data.facts.faulty, kinds,
                                 {.seed = job.seed}, OnAllProcessors);
  };
  outcome.raw = score({{"", {{RawSignals(samples)}}}}, 0);
  outcome.per_file = score({{"", {{outcome.per_file_fingerprints}}}}, 1);
  outcome.nominal = score(folds.features, 2);
  outcome.excess_friction = dynamics::ScoreExcessFriction(
      outcome.splits, folds.features, outcome.file_of_sample, data.facts.faulty, data.joints());
  progress("labels dealt anew", 1.0 - (1.0 - kShareOfFiles - kShareOfNominal) / 4.0);
  outcome.shuffled = ScoreShuffled(data, job, outcome);
  outcome.nominal_fingerprints = HonestFingerprints(folds, outcome.splits, outcome.file_of_sample);
  if (!folds.features.contains(std::string(dynamics::kUnitSplit)) &&
      !folds.features.contains(std::string(dynamics::kFileSplit)))
    outcome.warnings.push_back(
        "too few healthy files to leave one out: the classifier has learnt from fingerprints of files that "
        "the "
        "nominal network has seen, and will find faults where there are none");
  outcome.model.emplace(ModelOf(data, job, folds, outcome.file_of_sample, outcome.nominal_fingerprints,
                                dynamics::Stacked(motion).states));
  outcome.background_rows = static_cast<std::size_t>(folds.background.rows());
  outcome.rankings = RankBackgrounds(data, samples, *outcome.model);
  return outcome;
}

}  // namespace strainwave::bench
