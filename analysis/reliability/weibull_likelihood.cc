// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/weibull_likelihood.h"

#include <cmath>
#include <vector>

namespace strainwave::analysis::reliability {
namespace {

struct LogLife {
  double lower{};  // ln of it, −∞ of zero
  double upper{};
  double count{};
  double log_time{};  // ln t of an exact life, which makes the density one per unit of time
  enum class Kind { kExact, kSuspended, kBefore, kBetween } kind{};
};

std::vector<LogLife> LogLives(std::span<const Lifetime> lifetimes) {
  using Kind = LogLife::Kind;
  std::vector<LogLife> lives;
  lives.reserve(lifetimes.size());
  for (const Lifetime& life : lifetimes) {
    LogLife log{std::log(life.lower), std::log(life.upper), life.count, 0.0, Kind::kBetween};
    if (life.is_exact()) {
      log.kind = Kind::kExact;
      log.log_time = log.lower;
    } else if (!life.is_failure()) {
      log.kind = Kind::kSuspended;
    } else if (life.lower == 0.0) {
      log.kind = Kind::kBefore;
    }
    lives.push_back(log);
  }
  return lives;
}

// In location μ and λ = ln σ.
struct Sums {
  double value{};
  double of_mu{};
  double of_lambda{};
  double of_mu_mu{};
  double of_mu_lambda{};
  double of_lambda_lambda{};

  // A contribution through z = (ln t − μ)/σ alone, times σ and σ².
  void Add(double count, double z, double first, double second) {
    of_mu -= count * first;
    of_lambda -= count * first * z;
    of_mu_mu += count * second;
    of_mu_lambda += count * (first + second * z);
    of_lambda_lambda += count * (first + second * z) * z;
  }
};

void AddBefore(const LogLife& life, double z, Sums& sums) {
  const double u = std::exp(z);
  const double h = u < 1e-12 ? 1.0 : (u > 700.0 ? 0.0 : u / std::expm1(u));
  const double share = -std::expm1(-u);
  sums.value += life.count * (u < 1e-300 ? z : std::log(share));
  sums.Add(life.count, z, h, u < 1e-12 ? 0.0 : h * (1.0 - u / share));
}

void AddBetween(const LogLife& life, double z1, double z2, Sums& sums) {
  const double u1 = std::exp(z1);
  const double u2 = std::exp(z2);
  const double d = u2 - u1;
  const double q = -1.0 / std::expm1(-d);
  const double p = d > 700.0 ? 0.0 : 1.0 / std::expm1(d);
  const double u2p = p == 0.0 ? 0.0 : u2 * p;
  sums.value += life.count * (-u1 + std::log(-std::expm1(-d)));
  const double cross = u1 * u2p * q;
  sums.Add(life.count, z1, -u1 * q, -u1 * q - u1 * u1 * p * q);
  sums.Add(life.count, z2, u2p, u2p - u2p * u2 * q);
  sums.of_mu_mu += life.count * 2.0 * cross;
  sums.of_mu_lambda += life.count * cross * (z1 + z2);
  sums.of_lambda_lambda += life.count * 2.0 * cross * z1 * z2;
}

Sums SumsOver(const std::vector<LogLife>& lives, double mu, double lambda) {
  using Kind = LogLife::Kind;
  const double per_sigma = std::exp(-lambda);
  Sums sums;
  for (const LogLife& life : lives) {
    switch (life.kind) {
      case Kind::kExact: {
        const double z = (life.lower - mu) * per_sigma;
        const double u = std::exp(z);
        sums.value += life.count * (z - u - lambda - life.log_time);
        sums.of_lambda -= life.count;
        sums.Add(life.count, z, 1.0 - u, -u);
        break;
      }
      case Kind::kSuspended: {
        const double z = (life.lower - mu) * per_sigma;
        const double u = std::exp(z);
        sums.value -= life.count * u;
        sums.Add(life.count, z, -u, -u);
        break;
      }
      case Kind::kBefore:
        AddBefore(life, (life.upper - mu) * per_sigma, sums);
        break;
      case Kind::kBetween:
        AddBetween(life, (life.lower - mu) * per_sigma, (life.upper - mu) * per_sigma, sums);
        break;
    }
  }
  sums.of_mu *= per_sigma;
  sums.of_mu_mu *= per_sigma * per_sigma;
  sums.of_mu_lambda *= per_sigma;
  return sums;
}

// Where μ = location − σ ζ, and either of the two is the coordinate.
Evaluation InCoordinates(const std::vector<LogLife>& lives, double location, double zeta, double lambda,
                         bool of_location) {
  const double sigma = std::exp(lambda);
  const Sums s = SumsOver(lives, location - sigma * zeta, lambda);
  const double sz = sigma * zeta;
  Evaluation e{s.value, Eigen::VectorXd(2), Eigen::MatrixXd(2, 2)};
  const double by_lambda = s.of_lambda - sz * s.of_mu;
  const double by_lambda_lambda =
      s.of_lambda_lambda - 2.0 * sz * s.of_mu_lambda + sz * sz * s.of_mu_mu - sz * s.of_mu;
  const double mixed = s.of_mu_lambda - sz * s.of_mu_mu;
  if (of_location) {
    e.gradient << s.of_mu, by_lambda;
    e.hessian << s.of_mu_mu, mixed, mixed, by_lambda_lambda;
  } else {
    const double across = -sigma * (s.of_mu + mixed);
    e.gradient << -sigma * s.of_mu, by_lambda;
    e.hessian << sigma * sigma * s.of_mu_mu, across, across, by_lambda_lambda;
  }
  return e;
}

}  // namespace

double ExtremeValueQuantile(double share_failed) { return std::log(-std::log1p(-share_failed)); }

LogLikelihood WeibullOfQuantile(std::span<const Lifetime> lifetimes, double share_failed) {
  return [lives = LogLives(lifetimes), zeta = ExtremeValueQuantile(share_failed)](const Eigen::VectorXd& at) {
    return InCoordinates(lives, at(0), zeta, at(1), true);
  };
}

LogLikelihood WeibullOfSurvival(std::span<const Lifetime> lifetimes, double time) {
  return [lives = LogLives(lifetimes), location = std::log(time)](const Eigen::VectorXd& at) {
    return InCoordinates(lives, location, at(0), at(1), false);
  };
}

}  // namespace strainwave::analysis::reliability
