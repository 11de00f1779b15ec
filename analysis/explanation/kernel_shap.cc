// SPDX-License-Identifier: Apache-2.0
#include "analysis/explanation/kernel_shap.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "analysis/shuffle.h"

namespace strainwave::analysis::explanation {
namespace {

// Solutions of parts of the draws are compared for the standard errors.
constexpr std::size_t kParts = 10;

double Binomial(std::size_t n, std::size_t k) {
  double count = 1.0;
  for (std::size_t i = 0; i < k; ++i) count *= static_cast<double>(n - i) / static_cast<double>(i + 1);
  return std::round(count);
}

// Of all coalitions of one size together: (n − 1) / (s (n − s)).
double SizeWeight(std::size_t players, std::size_t size) {
  return static_cast<double>(players - 1) / (static_cast<double>(size) * static_cast<double>(players - size));
}

PlayerSet Everybody(std::size_t players) {
  return players == kMostPlayers ? ~PlayerSet{0} : (PlayerSet{1} << players) - 1;
}

// The sums that the regression needs of some coalitions, the last player eliminated by what the shares sum
// to.
struct NormalEquations {
  Eigen::MatrixXd square;  // (players − 1)²
  Eigen::MatrixXd right;   // (players − 1) × outputs

  NormalEquations(std::size_t players, std::size_t outputs)
      : square(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(players) - 1,
                                     static_cast<Eigen::Index>(players) - 1)),
        right(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(players) - 1,
                                    static_cast<Eigen::Index>(outputs))) {}

  void Add(const NormalEquations& other, double factor) {
    square += factor * other.square;
    right += factor * other.right;
  }
};

class Regression {
 public:
  Regression(std::size_t players, std::size_t outputs, const std::function<void(PlayerSet, double*)>& value)
      : players_(players),
        value_(value),
        none_(static_cast<Eigen::Index>(outputs)),
        gain_(none_),
        worth_(none_) {
    value_(0, none_.data());
    value_(Everybody(players), gain_.data());
    gain_ -= none_;
  }

  void Take(PlayerSet coalition, double weight, NormalEquations& sums) {
    value_(coalition, worth_.data());
    ++taken_;
    const auto free = static_cast<Eigen::Index>(players_) - 1;
    const double last = Member(coalition, players_ - 1);
    Eigen::VectorXd members(free);
    for (Eigen::Index p = 0; p < free; ++p)
      members(p) = Member(coalition, static_cast<std::size_t>(p)) - last;
    const Eigen::VectorXd rest = worth_ - none_ - last * gain_;
    sums.square.noalias() += weight * members * members.transpose();
    sums.right.noalias() += weight * members * rest.transpose();
  }

  // players × outputs.
  Eigen::MatrixXd Solve(const NormalEquations& sums) const {
    const Eigen::Index free = sums.square.rows();
    Eigen::MatrixXd shares(free + 1, none_.size());
    if (free > 0) shares.topRows(free) = sums.square.ldlt().solve(sums.right);
    shares.row(free) = gain_.transpose();
    if (free > 0) shares.row(free) -= shares.topRows(free).colwise().sum();
    return shares;
  }

  std::size_t taken() const { return taken_; }

 private:
  static double Member(PlayerSet coalition, std::size_t p) {
    return static_cast<double>((coalition >> p) & 1U);
  }

  std::size_t players_;
  const std::function<void(PlayerSet, double*)>& value_;
  Eigen::VectorXd none_;
  Eigen::VectorXd gain_;  // v(all) − v(none)
  Eigen::VectorXd worth_;
  std::size_t taken_{};
};

// All coalitions of one size, in their order as numbers.
template <typename Task>
void OverSize(std::size_t players, std::size_t size, const Task& task) {
  std::vector<std::size_t> chosen(size);
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  while (true) {
    PlayerSet coalition = 0;
    for (const std::size_t p : chosen) coalition |= PlayerSet{1} << p;
    task(coalition);
    std::size_t at = size;
    while (at > 0 && chosen[at - 1] == players - size + at - 1) --at;
    if (at == 0) return;
    ++chosen[at - 1];
    for (std::size_t i = at; i < size; ++i) chosen[i] = chosen[i - 1] + 1;
  }
}

PlayerSet DrawOfSize(std::vector<std::size_t>& order, std::size_t size, std::mt19937_64& random) {
  Shuffle(order, random);
  PlayerSet coalition = 0;
  for (std::size_t i = 0; i < size; ++i) coalition |= PlayerSet{1} << order[i];
  return coalition;
}

std::size_t DrawSize(const std::vector<double>& weight_of_size, std::size_t first, std::mt19937_64& random) {
  const double all = std::accumulate(weight_of_size.begin(), weight_of_size.end(), 0.0);
  constexpr double kSteps = 9007199254740992.0;  // 2⁵³: the same draws with every standard library
  double at = static_cast<double>(random() >> 11U) / kSteps * all;
  std::size_t i = 0;
  while (i + 1 < weight_of_size.size() && at >= weight_of_size[i]) at -= weight_of_size[i++];
  return first + i;
}

}  // namespace

KernelShapValues KernelShap(std::size_t players, std::size_t outputs,
                            const std::function<void(PlayerSet, double*)>& value,
                            const KernelShapSettings& settings) {
  if (players < 1 || players > kMostPlayers)
    throw std::invalid_argument("Kernel SHAP of " + std::to_string(players) + " players (expected 1 to 64)");
  const std::size_t budget = settings.coalitions != 0 ? settings.coalitions : 2 * players + 2048;
  Regression regression(players, outputs, value);
  NormalEquations whole(players, outputs);
  double left = static_cast<double>(budget);
  std::size_t size = 1;  // with its complement's
  for (; 2 * size <= players; ++size) {
    const bool middle = 2 * size == players;
    const double count = Binomial(players, size) * (middle ? 1.0 : 2.0);
    if (count > left) break;
    left -= count;
    const double weight = SizeWeight(players, size) / Binomial(players, size);
    OverSize(players, size, [&](PlayerSet coalition) { regression.Take(coalition, weight, whole); });
    if (!middle)
      OverSize(players, players - size,
               [&](PlayerSet coalition) { regression.Take(coalition, weight, whole); });
  }
  KernelShapValues result;
  result.all_coalitions = 2 * size > players;
  Eigen::MatrixXd errors =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(players), static_cast<Eigen::Index>(outputs));
  NormalEquations sums = whole;
  if (!result.all_coalitions) {
    std::vector<double> weight_of_size;  // of a size and its complement's
    for (std::size_t s = size; 2 * s <= players; ++s)
      weight_of_size.push_back(SizeWeight(players, s) * (2 * s == players ? 1.0 : 2.0));
    const double all = std::accumulate(weight_of_size.begin(), weight_of_size.end(), 0.0);
    const std::size_t pairs = std::max(kParts, static_cast<std::size_t>(left) / 2);
    std::mt19937_64 random(settings.seed);
    std::vector<std::size_t> order(players);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::vector<NormalEquations> parts(kParts, NormalEquations(players, outputs));
    std::vector<double> pairs_in(kParts, 0.0);
    for (std::size_t k = 0; k < pairs; ++k) {
      const PlayerSet drawn = DrawOfSize(order, DrawSize(weight_of_size, size, random), random);
      regression.Take(drawn, 0.5, parts[k % kParts]);
      regression.Take(Everybody(players) ^ drawn, 0.5, parts[k % kParts]);
      pairs_in[k % kParts] += 1.0;
    }
    for (const NormalEquations& part : parts) sums.Add(part, all / static_cast<double>(pairs));
    Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(errors.rows(), errors.cols());
    std::vector<Eigen::MatrixXd> solutions;
    for (std::size_t part = 0; part < kParts; ++part) {
      NormalEquations alone = whole;
      alone.Add(parts[part], all / pairs_in[part]);
      solutions.push_back(regression.Solve(alone));
      mean += solutions.back() / static_cast<double>(kParts);
    }
    for (const Eigen::MatrixXd& solution : solutions) errors.array() += (solution - mean).array().square();
    errors = (errors / static_cast<double>(kParts * (kParts - 1))).cwiseSqrt();
  }
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const RowMajor shares = regression.Solve(sums);
  const RowMajor of_errors = errors;
  result.shares.assign(shares.data(), shares.data() + shares.size());
  result.standard_errors.assign(of_errors.data(), of_errors.data() + of_errors.size());
  result.coalitions = regression.taken();
  return result;
}

}  // namespace strainwave::analysis::explanation
