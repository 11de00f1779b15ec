// SPDX-License-Identifier: Apache-2.0
#include "analysis/joint_dynamics/attribution.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "analysis/explanation/expected_gradients.h"
#include "analysis/explanation/kernel_shap.h"
#include "analysis/explanation/network_game.h"
#include "analysis/explanation/shapley.h"

namespace strainwave::analysis::joint_dynamics {
namespace {

using Eigen::Index;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Groups = std::vector<std::vector<Index>>;

Groups GroupsOf(Fingerprint fingerprint, Index joints) {
  Groups groups;
  if (fingerprint == Fingerprint::kJoint) {
    for (Index j = 0; j < joints; ++j) groups.push_back({j, joints + j, 2 * joints + j});
  } else {
    for (Index i = 0; i < 3 * joints; ++i) groups.push_back({i});
  }
  return groups;
}

// Players × torques, and the mean standard error.
struct Shares {
  RowMajor of_player;
  double standard_error{};
};

Shares SharesOf(explanation::NetworkGame& game, const AttributionSettings& settings) {
  const auto players = static_cast<Index>(game.players());
  const auto outputs = static_cast<Index>(game.outputs());
  const auto matrix_of = [&](const std::vector<double>& values) {
    return RowMajor(Eigen::Map<const RowMajor>(values.data(), players, outputs));
  };
  if (settings.method == Method::kExact) {
    return {matrix_of(explanation::ShapleyValues(
                game.players(), game.outputs(),
                [&](explanation::Coalition coalition, double* out) { game.Value(coalition, out); })),
            0.0};
  }
  const explanation::KernelShapValues values = explanation::KernelShap(
      game.players(), game.outputs(),
      [&](explanation::PlayerSet coalition, double* out) { game.Value(coalition, out); },
      {.coalitions = settings.coalitions, .seed = settings.seed});
  return {matrix_of(values.shares), matrix_of(values.standard_errors).mean()};
}

// f(x) − mean f(background) less what the shares sum to, the greatest of all torques.
double GapOf(explanation::NetworkGame& game, const Shares& shares) {
  std::vector<double> none(game.outputs());
  std::vector<double> all(game.outputs());
  game.Value(0, none.data());
  const std::size_t players = game.players();
  game.Value(players == explanation::kMostPlayers ? ~explanation::PlayerSet{0}
                                                  : (explanation::PlayerSet{1} << players) - 1,
             all.data());
  double worst = 0.0;
  for (std::size_t o = 0; o < none.size(); ++o)
    worst = std::max(worst, std::abs(all[o] - none[o] - shares.of_player.col(static_cast<Index>(o)).sum()));
  return worst;
}

Eigen::RowVectorXd FingerprintOf(const RowMajor& shares, Fingerprint fingerprint) {
  if (fingerprint == Fingerprint::kTensor)
    return Eigen::Map<const Eigen::RowVectorXd>(shares.data(), shares.size());
  return shares.cwiseAbs().rowwise().sum().transpose();
}

}  // namespace

std::string_view NameOf(Fingerprint fingerprint) {
  switch (fingerprint) {
    case Fingerprint::kJoint:
      return "joint";
    case Fingerprint::kGroup:
      return "group";
    case Fingerprint::kTensor:
      return "tensor";
  }
  return "";
}

std::string_view NameOf(Method method) {
  switch (method) {
    case Method::kExact:
      return "exact";
    case Method::kKernel:
      return "kernel";
    case Method::kGradients:
      return "gradients";
  }
  return "";
}

Method DefaultMethod(Fingerprint fingerprint, Index joints) {
  const Index players = fingerprint == Fingerprint::kJoint ? joints : 3 * joints;
  if (players <= kMostExactByDefault) return Method::kExact;
  return players <= static_cast<Index>(explanation::kMostPlayers) ? Method::kKernel : Method::kGradients;
}

Index SizeOf(Fingerprint fingerprint, Index joints) {
  switch (fingerprint) {
    case Fingerprint::kJoint:
      return joints;
    case Fingerprint::kGroup:
      return 3 * joints;
    case Fingerprint::kTensor:
      return 3 * joints * joints;
  }
  return 0;
}

std::vector<std::string> NamesOf(Fingerprint fingerprint, Index joints) {
  std::vector<std::string> names;
  if (fingerprint == Fingerprint::kJoint) {
    for (Index j = 1; j <= joints; ++j) names.push_back(fmt::format("joint{}", j));
    return names;
  }
  for (const char* quantity : {"q", "qd", "qdd"}) {
    for (Index j = 1; j <= joints; ++j) {
      const std::string input = fmt::format("{}{}", quantity, j);
      if (fingerprint == Fingerprint::kGroup) {
        names.push_back(input);
        continue;
      }
      for (Index t = 1; t <= joints; ++t) names.push_back(fmt::format("{}_on_tau{}", input, t));
    }
  }
  return names;
}

Attributions Attribute(const prediction::Ensemble& dynamics, const Eigen::MatrixXd& states,
                       const Eigen::MatrixXd& background, const AttributionSettings& settings,
                       const ParallelFor& parallel) {
  const Index joints = dynamics.network.output_size();
  const bool by_input = settings.fingerprint != Fingerprint::kJoint;
  if (settings.method == Method::kGradients && !by_input)
    throw std::invalid_argument(
        "expected gradients are of single inputs (expected the fingerprint group or tensor)");
  const networks::Vector<double>& parameters = dynamics.members.front();
  const Eigen::MatrixXd scaled = dynamics.input.Apply(states).transpose();
  const Eigen::MatrixXd scaled_background = dynamics.input.Apply(background).transpose();
  Attributions result{Eigen::MatrixXd(states.rows(), SizeOf(settings.fingerprint, joints)), {}, 0.0, 0.0};
  // A task has a game of its own, for some samples in a row.
  constexpr Index kSamplesOfTask = 50;
  const auto tasks = static_cast<std::size_t>((states.rows() + kSamplesOfTask - 1) / kSamplesOfTask);
  std::vector<double> gaps(tasks, 0.0);
  std::vector<double> errors(tasks, 0.0);
  std::vector<Eigen::VectorXd> quantities(tasks, Eigen::VectorXd::Zero(3));
  parallel(tasks, [&](std::size_t task) {
    explanation::NetworkGame game(dynamics.network, parameters, GroupsOf(settings.fingerprint, joints),
                                  scaled_background);
    const Index begin = static_cast<Index>(task) * kSamplesOfTask;
    const Index end = std::min(begin + kSamplesOfTask, states.rows());
    for (Index row = begin; row < end; ++row) {
      Shares shares;
      if (settings.method == Method::kGradients) {
        const explanation::ExpectedGradients gradients = explanation::ExpectedGradientsOf(
            dynamics.network, parameters, scaled.col(row), scaled_background, settings.draws, settings.seed);
        shares = {gradients.shares, gradients.standard_errors.mean()};
        gaps[task] = std::max(gaps[task], gradients.gap.cwiseAbs().maxCoeff());
      } else {
        game.SetSample(scaled.col(row));
        shares = SharesOf(game, settings);
        gaps[task] = std::max(gaps[task], GapOf(game, shares));
      }
      errors[task] += shares.standard_error;
      result.fingerprints.row(row) = FingerprintOf(shares.of_player, settings.fingerprint);
      if (by_input) {
        for (Index quantity = 0; quantity < 3; ++quantity)
          quantities[task](quantity) +=
              shares.of_player.middleRows(quantity * joints, joints).cwiseAbs().sum();
      }
    }
  });
  Eigen::VectorXd of_quantity = Eigen::VectorXd::Zero(3);
  for (std::size_t task = 0; task < tasks; ++task) {
    result.worst_gap = std::max(result.worst_gap, gaps[task]);
    result.mean_standard_error += errors[task] / static_cast<double>(std::max<Index>(1, states.rows()));
    of_quantity += quantities[task];
  }
  if (by_input && of_quantity.sum() > 0.0) result.quantity_share = of_quantity / of_quantity.sum();
  return result;
}

}  // namespace strainwave::analysis::joint_dynamics
