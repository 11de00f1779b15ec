// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "analysis/diagnosis/records.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/diagnosis/vibration/drawn_term.h"
#include "analysis/diagnosis/vibration/families.h"
#include "analysis/diagnosis/vibration/gear_mesh.h"
#include "analysis/diagnosis/vibration/parameters.h"
#include "analysis/diagnosis/vibration/resonances.h"
#include "analysis/diagnosis/vibration/rules.h"
#include "analysis/diagnosis/vibration/samples.h"
#include "analysis/diagnosis/vibration/searches.h"
#include "analysis/diagnosis/vibration/shared_noise.h"
#include "analysis/diagnosis/vibration/slipping.h"
#include "analysis/diagnosis/vibration/solver.h"
#include "analysis/diagnosis/vibration/starts.h"
#include "analysis/diagnosis/vibration/transients.h"
#include "analysis/noise_level.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kImpactsInACell = 20.0;  // as many as make p < 0.004 in four of a thousand clean records

/// Accelerations over time and shaft angle. The response is all channels one after the other, scaled to equal
/// noise; the nominal model has a constant and the shaft's lines at 1 and 2 per turn in each. Lines and
/// ringing impulses are predicted as they are; a resonance that noise drives is predicted from one sample to
/// the next, so that a model with one has its RMSE over one sample ahead.
class VibrationStudy final : public Study {
 public:
  VibrationStudy(std::span<const VibrationData> records, ParallelFor parallel)
      : samples_(PrepareVibration(records)), parallel_(std::move(parallel)), searches_(parallel_) {
    rules_ = RulesFor(samples_);
    for (const VibrationRun& run : samples_.runs) block_length_ = std::max(block_length_, BlockOf(run));
    MakeRegressors();
    LookAtNominal();
  }
  /// Of another response of the same records, in turn.
  VibrationStudy(VibrationSamples samples, const VibrationStudy& other)
      : samples_(std::move(samples)),
        rules_(other.rules_),
        parallel_(InTurn),
        searches_(InTurn),
        regressors_(other.regressors_),
        block_length_(other.block_length_) {
    LookAtNominal();
  }

  std::span<const double> measured() const override { return samples_.measured; }
  std::span<const std::size_t> segments() const override { return samples_.segments; }
  const std::vector<CauseRule>& causes() const override { return rules_.rules; }
  const std::vector<Regressor>& regressors() const override { return regressors_; }
  std::string unit() const override { return UnitOfChannel(samples_.runs.front().channels.front().name); }
  double unit_per_si() const override { return 1.0; }
  double NoiseFloor() const override { return samples_.noise_floor; }
  std::size_t BlockLength() const override { return block_length_; }
  // A higher order would be a resonance.
  int LargestNoiseOrder() const override { return 1; }
  std::span<const std::size_t> NoiseSeries() const override { return samples_.channel_starts; }
  std::vector<double> Decorrelated(std::vector<double> residual,
                                   std::span<const double> weights) const override {
    Decorrelate(samples_, weights, residual);
    return residual;
  }
  bool SpikesAreOutliers() const override { return spikes_are_outliers_; }
  bool CachesSearches() const override { return true; }
  const std::vector<std::string>& warnings() const override { return samples_.warnings; }

  std::vector<UserQuantity> Quantities(const Eigen::VectorXd& predicted) const override {
    std::vector<UserQuantity> quantities;
    for (const VibrationRun& run : samples_.runs) {
      for (const VibrationSegment& channel : run.channels) {
        const auto rms = [&](const double* values) {
          const Eigen::Map<const Eigen::VectorXd> own(values + channel.first,
                                                      static_cast<Eigen::Index>(run.size()));
          return std::sqrt((own.array() - own.mean()).square().mean()) / channel.scale;
        };
        quantities.push_back({"rms_" + channel.name, rms(samples_.measured.data()), rms(predicted.data())});
      }
    }
    return quantities;
  }

  ModelFit Fit(std::span<const std::size_t> cause_indices, std::span<const double> weights,
               const ModelFit* start, FitPurpose purpose) const override {
    std::vector<VibrationTerm> known;
    if (start != nullptr && start->usable) {
      for (VibrationTerm& term : UnpackTerms(start->state)) {
        if (std::ranges::find(cause_indices, term.cause) != cause_indices.end())
          known.push_back(std::move(term));
      }
    }
    std::vector<std::size_t> missing;
    for (const std::size_t cause : cause_indices) {
      if (std::ranges::find(known, cause, &VibrationTerm::cause) == known.end()) missing.push_back(cause);
    }
    if (missing.empty()) {
      const VibrationSolver solver(samples_, weights, parallel_);
      VibrationSolution solution = solver.Solve(std::move(known));
      // The fit of the same terms was at its best but for the weights.
      const int rounds = start != nullptr && start->causes.size() == cause_indices.size() ? 1 : 4;
      if (!solution.terms.empty()) solution = solver.Refine(std::move(solution), rounds);
      return Describe(cause_indices, solver, std::move(solution), purpose);
    }
    const std::shared_ptr<VibrationBase> base = searches_.BaseOf(samples_, weights, known);
    std::optional<VibrationSolution> solution = searches_.Find(*base, rules_.kinds[missing[0]], missing[0]);
    for (std::size_t m = 1; m < missing.size() && solution; ++m) {
      const VibrationResidual residual(samples_, base->solver, *solution);
      std::optional<VibrationSolution> more = Beside(residual, rules_.kinds[missing[m]], missing[m]);
      solution = std::move(more);
    }
    if (!solution) return Unusable(cause_indices);
    return Describe(cause_indices, base->solver, std::move(*solution), purpose);
  }

  Eigen::VectorXd Predict(std::span<const ParameterValue> nominal,
                          std::span<const NamedCause> causes) const override {
    Eigen::VectorXd predicted;
    if (nominal.empty()) {
      const std::vector<double> ones(samples_.measured.size(), 1.0);
      const ModelFit fit = Fit({}, ones, nullptr, FitPurpose::kReport);
      predicted = PredictNominal(samples_, fit.nominal);
    } else {
      predicted = PredictNominal(samples_, nominal);
    }
    for (const NamedCause& cause : causes) {
      const auto rule = std::ranges::find(rules_.rules, cause.name, &CauseRule::name);
      if (rule == rules_.rules.end()) {
        throw std::invalid_argument(fmt::format("{} is no cause that this record can have", cause.name));
      }
      predicted += PredictTerm(samples_, rules_.kinds[static_cast<std::size_t>(rule - rules_.rules.begin())],
                               cause.name, cause.parameters);
    }
    return predicted;
  }

  std::unique_ptr<Study> WithResponse(std::span<const double> measured) const override {
    VibrationSamples samples = samples_;
    if (measured.size() != samples.measured.size()) {
      throw std::invalid_argument(fmt::format("a response of {} samples for records of {} (expected as many)",
                                              measured.size(), samples.measured.size()));
    }
    samples.measured.assign(measured.begin(), measured.end());
    return std::make_unique<VibrationStudy>(std::move(samples), *this);
  }

  std::optional<DrawnEffect> DrawEffect(std::size_t cause, const ModelFit& /*beside*/,
                                        std::uint64_t draw) const override {
    return DrawVibrationEffect(samples_, rules_.kinds[cause], draw);
  }

 private:
  // A turn of the shaft, but no fewer than ten blocks a record.
  static std::size_t BlockOf(const VibrationRun& run) {
    const double most = static_cast<double>(run.size()) / 10.0;
    const double turn = run.angle_rad.empty() ? most : static_cast<double>(run.size()) / run.turns;
    return static_cast<std::size_t>(std::clamp(turn, 25.0, most));
  }

  void MakeRegressors() {
    Regressor angle{"input_angle", "input angle / deg", DegFromRad(1.0), {}, true};
    Regressor output{"output_angle", "output angle / deg", DegFromRad(1.0), {}, true};
    Regressor time{"time", "time / s", 1.0, {}, false};
    Regressor speed{"speed", "input speed / rpm", RpmFromRadPerS(1.0), {}, false};
    bool changing = false;
    for (const VibrationRun& run : samples_.runs) {
      changing = changing || run.speed_spread > 0.01;
      for (std::size_t c = 0; c < run.channels.size(); ++c) {
        time.values.insert(time.values.end(), run.time_s.begin(), run.time_s.end());
        angle.values.insert(angle.values.end(), run.angle_rad.begin(), run.angle_rad.end());
        speed.values.insert(speed.values.end(), run.speed_rad_per_s.begin(), run.speed_rad_per_s.end());
      }
    }
    if (samples_.angle_known()) {
      for (const double value : angle.values) output.values.push_back(value / samples_.ratio);
      const double output_turns = samples_.shortest_turns() / std::abs(samples_.ratio);
      regressors_.push_back(std::move(angle));
      if (output_turns > 1.0) regressors_.push_back(std::move(output));
      if (changing) regressors_.push_back(std::move(speed));
    }
    regressors_.push_back(std::move(time));
  }

  // Single samples that stand off are disturbances; where they come in flocks they ring, and belong to the
  // record.
  void LookAtNominal() {
    const std::vector<double> ones(samples_.measured.size(), 1.0);
    const VibrationSolver solver(samples_, ones, parallel_);
    const Eigen::VectorXd residual = solver.Residual(solver.Solve({}));
    std::size_t alone = 0;
    std::size_t in_company = 0;
    for (const VibrationRun& run : samples_.runs) {
      for (const VibrationSegment& channel : run.channels) {
        const std::span<const double> own(residual.data() + channel.first, run.size());
        const double usual = RobustStandardDeviation(own);
        for (const std::size_t spike : FindSpikes(own, EstimateNoise(own))) {
          bool company = false;
          for (std::size_t i = spike > 6 ? spike - 6 : 0; i < std::min(run.size(), spike + 7); ++i) {
            const std::size_t away = i > spike ? i - spike : spike - i;
            company = company || (away > 1 && std::abs(own[i]) > 5.0 * usual);
          }
          ++(company ? in_company : alone);
        }
      }
    }
    spikes_are_outliers_ = in_company * 4 < alone;
  }

  static ModelFit Unusable(std::span<const std::size_t> cause_indices) {
    ModelFit fit;
    fit.causes.assign(cause_indices.begin(), cause_indices.end());
    return fit;
  }

  ModelFit Describe(std::span<const std::size_t> cause_indices, const VibrationSolver& solver,
                    VibrationSolution solution, FitPurpose purpose) const {
    ModelFit fit = Unusable(cause_indices);
    if (HasResonanceOfATrain(solution.terms)) return fit;
    Eigen::MatrixXd nonlinear_parameters;
    if (purpose != FitPurpose::kCompare) nonlinear_parameters = solver.NonlinearParameterCovariance(solution);
    fit.nominal = DescribeNominal(samples_, solution);
    for (const std::size_t cause : cause_indices) {
      const auto term = static_cast<std::size_t>(
          std::ranges::find(solution.terms, cause, &VibrationTerm::cause) - solution.terms.begin());
      fit.cause_parameters.push_back(
          DescribeTerm(samples_, solution, term, rules_.kinds[cause], nonlinear_parameters));
    }
    const Eigen::Map<const Eigen::VectorXd> measured(samples_.measured.data(),
                                                     static_cast<Eigen::Index>(samples_.measured.size()));
    fit.predicted = measured - solver.Residual(solution);
    fit.free_parameters = solution.free_parameters;
    for (const VibrationTerm& term : solution.terms) {
      fit.log_search_locations += LogSearchLocationsOf(term);
      fit.location_parameters += static_cast<int>(ImpactCount(term));
    }
    fit.state = PackTerms(solution.terms);
    fit.usable = fit.predicted.allFinite();
    return fit;
  }

  // The cells that the rule of a resonance counts are a band's; in each an impact may begin with either sign
  // and die away in several ways. Those beside the first may be at any time, to half a period of what rings;
  // which one is the first does not matter.
  double LogSearchLocationsOf(const VibrationTerm& term) const {
    const VibrationCause kind = rules_.kinds[term.cause];
    if (kind == VibrationCause::kGearMesh) return LogChoicesOfMesh(samples_, term);
    if (kind == VibrationCause::kBearingDefect) {
      return LogSearchLocationsOfTrain(samples_, term) + LogSearchLocationsOfSlips(samples_, term);
    }
    if (kind == VibrationCause::kFlexsplineCrack) return LogSearchLocationsOfCrack(samples_, term);
    if (kind == VibrationCause::kLineOverAngle)
      return LogSearchLocationsOfLine(term.nonlinear_parameters[0], 1.0 / samples_.shortest_turns(),
                                      samples_.highest_order());
    if (kind == VibrationCause::kLineOverTime)
      return LogSearchLocationsOfLine(term.nonlinear_parameters[0], 1.0 / samples_.runs.front().span_s(),
                                      samples_.highest_Hz());
    if (term.form != VibrationForm::kTransients) return 0.0;
    const double further = static_cast<double>(ImpactCount(term)) - 1.0;
    const double times = 2.0 * term.nonlinear_parameters[0] * samples_.runs.front().span_s();
    return std::log(kImpactsInACell) +
           std::max(0.0, further * std::log(std::max(1.0, times)) - std::lgamma(further + 1.0));
  }

  VibrationSamples samples_;
  VibrationRules rules_;
  ParallelFor parallel_;
  mutable VibrationSearches searches_;
  std::vector<Regressor> regressors_;
  std::size_t block_length_{1};
  bool spikes_are_outliers_{true};
};

}  // namespace

std::unique_ptr<Study> MakeVibrationStudy(std::span<const VibrationData> records) {
  return MakeVibrationStudy(records, InTurn);
}

std::unique_ptr<Study> MakeVibrationStudy(std::span<const VibrationData> records, ParallelFor parallel) {
  return std::make_unique<VibrationStudy>(records, std::move(parallel));
}

}  // namespace strainwave::analysis::diagnosis
