// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/joint_dynamics/attribution.h"
#include "analysis/joint_dynamics/classification.h"
#include "analysis/joint_dynamics/dynamics.h"
#include "analysis/prediction/novelty.h"
#include "bench/fingerprint/fingerprint_data.h"

namespace strainwave::bench {

struct FingerprintJob {
  analysis::joint_dynamics::Fingerprint fingerprint{analysis::joint_dynamics::Fingerprint::kJoint};
  std::optional<analysis::joint_dynamics::Method> method;  // none: `DefaultMethod`
  std::size_t coalitions{};
  Eigen::Index samples{100};    // of a file, whose fingerprints are made
  Eigen::Index background{25};  // rows
  int folds{5};
  int epochs{150};  // of the networks of the dynamics, at most
  std::uint64_t seed{42};
};

/// A trained model: what `fingerprint classify` needs.
struct FingerprintModel {
  analysis::prediction::Ensemble nominal;     // states to torques, of healthy units
  analysis::prediction::Ensemble classifier;  // fingerprints to the probabilities of healthy and faulty
  Eigen::MatrixXd background;            // states of healthy files: what a joint is like that nobody knows
  Eigen::MatrixXd healthy_fingerprints;  // what the classifier's attributions are told from
  analysis::prediction::Novelty state_novelty;        // of scaled states
  analysis::prediction::Novelty fingerprint_novelty;  // of scaled fingerprints
  Eigen::RowVectorXd lowest;                          // of the states in training
  Eigen::RowVectorXd highest;
  analysis::joint_dynamics::AttributionSettings attribution;
  Eigen::Index samples{};
  Smoothing smoothing;
  bool acceleration_measured{};
  double sample_rate_hz{};  // of the first file
  double shortest_s{};      // of all records
  std::string healthy;
  std::string training_json;  // what `train --json` has printed

  Eigen::Index joints() const { return nominal.network.output_size(); }
};

/// How far joints change places by their mean attribution when another background is taken.
struct BackgroundRanking {
  std::string name;
  std::vector<double> importance;  // of each joint, summing to 1
  std::vector<int> order;          // of joints, the most important first, from 1
  double rank_correlation{};       // Spearman's, with that of the first
};

struct FileDynamics {
  analysis::joint_dynamics::TorqueErrors trained;   // on rows that the network learnt from
  analysis::joint_dynamics::TorqueErrors held_out;  // on the last tenth, which it has not seen
  Eigen::VectorXd quantity_share;                   // of q, q̇, q̈; empty for the fingerprint joint
};

struct FingerprintOutcome {
  std::optional<FingerprintModel> model;  // always there; its networks have no empty state
  std::vector<analysis::joint_dynamics::FileSplit> splits;
  analysis::joint_dynamics::ScoreTable raw;
  analysis::joint_dynamics::ScoreTable nominal;
  analysis::joint_dynamics::ScoreTable excess_friction;
  analysis::joint_dynamics::ScoreTable per_file;
  analysis::joint_dynamics::ScoreTable shuffled;  // forests on the files' own fingerprints, labels dealt anew
  std::map<std::string, std::string> impossible;  // by split
  std::vector<FileDynamics> dynamics;             // of each file
  std::vector<BackgroundRanking> rankings;
  Eigen::MatrixXd per_file_fingerprints;  // of all samples
  Eigen::MatrixXd nominal_fingerprints;   // by networks without the sample's unit
  std::vector<int> file_of_sample;
  std::size_t background_rows{};
  double worst_gap{};  // of all attributions: f(x) − mean f(background) less their sum
  double mean_standard_error{};
  int networks{};
  double explained_s{};  // what the explanations of the files' own networks took
  std::vector<std::string> warnings;
};

/// Trains the files' own networks and the nominal ones, makes fingerprints, scores all classifiers on all
/// splits, and fits the model on everything.
FingerprintOutcome TrainFingerprints(const FingerprintData& data, const FingerprintJob& job,
                                     const FingerprintProgress& progress);

}  // namespace strainwave::bench
