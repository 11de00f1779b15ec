// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/hysteresis/checks.h"
#include "analysis/diagnosis/hysteresis/drawn_effect.h"
#include "analysis/diagnosis/hysteresis/model.h"
#include "analysis/diagnosis/hysteresis/quantities.h"
#include "analysis/diagnosis/hysteresis/regressors.h"
#include "analysis/diagnosis/hysteresis/search.h"
#include "analysis/diagnosis/hysteresis/torque_noise.h"
#include "analysis/diagnosis/hysteresis/unpenalised_parameters.h"
#include "analysis/diagnosis/noise_likelihood.h"
#include "analysis/diagnosis/open_numbers.h"
#include "analysis/diagnosis/records.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

// Comparisons are made on means of a few samples where there are more than this.
constexpr std::size_t kComparisonPoints = 2000;

// Hysteresis of one or several records: twist as the response to the measured torque.
class HysteresisStudy final : public Study {
 public:
  explicit HysteresisStudy(std::span<const HysteresisData> data)
      : data_(data.begin(), data.end()), records_(PrepareLoopRecords(data)) {
    AppendGearEffects(records_, effects_);
    AppendAddedEffects(records_, effects_);
    AppendNuisanceTerms(records_, effects_);
    for (const auto& effect : effects_) rules_.push_back(effect->rule);
    segments_.assign(records_.samples.starts.begin(), records_.samples.starts.end() - 1);
    NominalLocalMinima local_minima = FindNominal(records_);
    nominal_start_ = std::move(local_minima.best);
    other_local_minimum_ = std::move(local_minima.other);
    TakeFromNominal();
    warnings_ = records_.warnings;
    const GearLaw law = LoopModel(records_, {}).LawOf(nominal_start_);
    const double k[] = {law.spring.k1_Nm_per_rad, law.spring.k2_Nm_per_rad, law.spring.k3_Nm_per_rad};
    const std::string common = CommonStiffnessChange(k, records_.t1_Nm, records_.t2_Nm);
    if (!common.empty()) warnings_.push_back(common);
    if (std::string differ = DifferentStiffnesses(records_); !differ.empty()) warnings_.push_back(differ);
    regressors_ = RegressorsOf(records_);
  }

  std::span<const double> measured() const override { return records_.measured_rad; }
  std::span<const std::size_t> segments() const override { return segments_; }
  const std::vector<CauseRule>& causes() const override { return rules_; }
  const std::vector<Regressor>& regressors() const override { return regressors_; }
  std::string unit() const override { return "arcmin"; }
  double unit_per_si() const override { return ArcminFromRad(1.0); }
  double NoiseFloor() const override { return records_.noise_floor_rad; }
  double Rounding() const override { return records_.rounding_rad; }
  std::span<const double> Weights() const override { return weights_; }
  std::size_t BlockLength() const override { return records_.block_length; }
  const std::vector<std::string>& warnings() const override { return warnings_; }

  ModelFit Fit(std::span<const std::size_t> cause_indices, std::span<const double> weights,
               const ModelFit* start, FitPurpose purpose) const override;
  std::vector<UserQuantity> Quantities(const Eigen::VectorXd& predicted) const override {
    return QuantitiesOfLoops(records_, predicted);
  }
  Eigen::VectorXd Predict(std::span<const ParameterValue> nominal,
                          std::span<const NamedCause> causes) const override;
  std::unique_ptr<Study> WithResponse(std::span<const double> measured) const override {
    return std::make_unique<HysteresisStudy>(WithAngles(data_, measured));
  }
  std::optional<DrawnEffect> DrawEffect(std::size_t cause, const ModelFit& beside,
                                        std::uint64_t draw) const override {
    return DrawLoopEffect(records_, effects_, cause, beside, draw);
  }

 private:
  LoopModel ModelOf(std::span<const std::size_t> causes) const;
  std::vector<bool> UnseenStarts(std::span<const double> weights) const;
  LoopGrid GridOf(const LoopModel& model, std::span<const double> weights) const;
  LoopSolution Search(std::span<const std::size_t> causes, std::span<const double> weights,
                      const ModelFit* start) const;
  std::vector<ParameterValue> DescribeNominal(const Eigen::VectorXd& x,
                                              const std::vector<double>& errors) const;
  NoiseFit NoiseOf(const Eigen::VectorXd& predicted, std::span<const double> weights) const;
  FitErrors ErrorsAt(const LoopModel& model, const Eigen::VectorXd& numbers, const LoopGrid& all) const;
  void WidenByAlternatives(const LoopModel& model, std::size_t effect, const Eigen::VectorXd& numbers,
                           const LoopGrid& all, const Eigen::MatrixXd& covariance,
                           std::vector<ParameterValue>& described) const;
  Eigen::VectorXd AboutZero(Eigen::VectorXd about_centres) const;
  void TakeFromNominal();

  std::vector<HysteresisData> data_;
  LoopRecords records_;
  LoopEffects effects_;
  std::vector<CauseRule> rules_;
  std::vector<std::size_t> segments_;
  std::vector<Regressor> regressors_;
  std::vector<std::string> warnings_;
  Eigen::VectorXd nominal_start_;
  Eigen::VectorXd other_local_minimum_;  // empty where there is none
  Eigen::VectorXd noise_response_rad_;   // what the torque's noise would have turned the gear by
  std::vector<double> weights_;
};

// What the nominal model says of the record itself: where the output was on its way, without the angle's own
// noise, which a line over the measured angle follows where the noise is autocorrelated; and the torque's
// noise.
void HysteresisStudy::TakeFromNominal() {
  LoopGrid& samples = records_.samples;
  const LoopModel nominal(records_, {});
  const Eigen::VectorXd position_rad = nominal.Predict(nominal_start_, samples);
  samples.position_rad.assign(position_rad.begin(), position_rad.end());
  Eigen::VectorXd gear;
  FillTwist(nominal.LawOf(nominal_start_), samples, gear);
  const std::vector<double> compliances_rad_per_Nm = CompliancesOf(records_, gear);
  noise_response_rad_ = ResponseToTorqueNoise(records_, compliances_rad_per_Nm);
  weights_ = WeightsByTorqueNoise(records_, compliances_rad_per_Nm);
  for (Index i = 0; i < gear.size(); ++i)
    samples.twist_rad[static_cast<std::size_t>(i)] -= noise_response_rad_(i);
}

LoopModel HysteresisStudy::ModelOf(std::span<const std::size_t> causes) const {
  std::vector<const LoopEffect*> effects;
  for (const std::size_t cause : causes) effects.push_back(effects_.at(cause).get());
  return {records_, std::move(effects)};
}

LoopGrid HysteresisStudy::GridOf(const LoopModel& model, std::span<const double> weights) const {
  return Condense(records_, weights, model.NeedsAllSamples() ? 0 : kComparisonPoints);
}

// Records whose first sample has no weight: of those behind it, few if any depend on the state that their
// friction starts in. It is a condition of the record and not of the model: a fit that does not see it keeps
// what it was given.
std::vector<bool> HysteresisStudy::UnseenStarts(std::span<const double> weights) const {
  std::vector<bool> unseen;
  for (const std::size_t first : segments_) unseen.push_back(weights[first] == 0.0);
  return unseen;
}

// Starts from what `start` has, and adds what it lacks, one after the other.
LoopSolution HysteresisStudy::Search(std::span<const std::size_t> causes, std::span<const double> weights,
                                     const ModelFit* start) const {
  std::vector<std::size_t> present;
  Eigen::VectorXd x = nominal_start_;
  if (start != nullptr && start->usable) {
    const LoopModel before = ModelOf(start->causes);
    const Eigen::VectorXd old =
        Eigen::Map<const Eigen::VectorXd>(start->state.data(), static_cast<Index>(start->state.size()));
    x = old.head(before.nominal_size());
    for (std::size_t e = 0; e < start->causes.size(); ++e) {
      if (!std::binary_search(causes.begin(), causes.end(), start->causes[e])) continue;
      present.push_back(start->causes[e]);
      const std::span<const double> own = before.Of(e, old);
      const Index size = x.size();
      x.conservativeResize(size + static_cast<Index>(own.size()));
      std::copy(own.begin(), own.end(), x.data() + size);
    }
  }
  const bool fitted = start != nullptr && start->usable && start->causes == present;
  LoopSolution solution{x, std::numeric_limits<double>::infinity()};
  if (!fitted || present.size() == causes.size()) {
    LoopModel model = ModelOf(present);
    model.KeepStarts(UnseenStarts(weights));
    solution = SolveLoop(model, GridOf(model, weights), x, kMostIterations);
  }
  for (const std::size_t cause : causes) {
    if (std::binary_search(present.begin(), present.end(), cause)) continue;
    const auto place = std::upper_bound(present.begin(), present.end(), cause);
    const auto effect = static_cast<std::size_t>(place - present.begin());
    present.insert(place, cause);
    const LoopModel model = ModelOf(present);
    Eigen::VectorXd wider = Eigen::VectorXd::Zero(model.size());
    const auto first = static_cast<Index>(model.Of(effect, std::as_const(wider)).data() - wider.data());
    wider.head(first) = solution.numbers.head(first);
    wider.tail(solution.numbers.size() - first) = solution.numbers.tail(solution.numbers.size() - first);
    const LoopGrid grid = GridOf(model, weights);
    solution = FitWithNewEffect(records_, model, effect, grid, wider);
    if (present.size() == 1 && other_local_minimum_.size() > 0) {
      wider.setZero();
      wider.head(first) = other_local_minimum_;
      LoopSolution from_other = FitWithNewEffect(records_, model, effect, grid, wider);
      if (PenalisedCost(model, grid, from_other) < PenalisedCost(model, grid, solution))
        solution = std::move(from_other);
    }
    if (!std::isfinite(solution.cost)) return solution;
  }
  return solution;
}

ModelFit HysteresisStudy::Fit(std::span<const std::size_t> cause_indices, std::span<const double> weights,
                              const ModelFit* start, FitPurpose purpose) const {
  ModelFit fit;
  fit.causes.assign(cause_indices.begin(), cause_indices.end());
  const LoopModel model = ModelOf(cause_indices);
  LoopSolution solution = Search(cause_indices, weights, start);
  if (!std::isfinite(solution.cost) || !solution.numbers.allFinite()) return fit;
  FitErrors errors{Eigen::MatrixXd::Zero(model.size(), model.size()), {}};
  const bool judges = purpose != FitPurpose::kCompare;
  const LoopGrid all = judges ? Condense(records_, weights, 0) : LoopGrid();
  if (judges) {
    solution = SolveLoop(model, all, solution.numbers, kMostIterations);
    errors = ErrorsAt(model, solution.numbers, all);
  }
  fit.predicted = AboutZero(model.Predict(solution.numbers, records_.samples));
  OpenNumbers open(errors.open);
  fit.nominal = DescribeNominal(solution.numbers, ErrorsOf(errors.covariance));
  open.Mark(
      solution.numbers, 0,
      [&](const Eigen::VectorXd& moved) { return DescribeNominal(moved, ErrorsOf(errors.covariance)); },
      fit.nominal);
  for (std::size_t e = 0; e < fit.causes.size(); ++e) {
    std::vector<ParameterValue> described = DescribeEffect(model, e, solution.numbers, errors.covariance);
    open.Mark(
        solution.numbers, 0,
        [&](const Eigen::VectorXd& moved) { return DescribeEffect(model, e, moved, errors.covariance); },
        described);
    if (purpose == FitPurpose::kReport)
      WidenByAlternatives(model, e, solution.numbers, all, errors.covariance, described);
    fit.cause_parameters.push_back(std::move(described));
  }
  fit.open = open.Words();
  fit.log_search_locations = model.LogSearchLocations(solution.numbers);
  fit.free_parameters = model.FreeParameters(solution.numbers);
  fit.known_before = UnpenalisedParameters(model, solution, judges ? all : GridOf(model, weights));
  fit.state.assign(solution.numbers.data(), solution.numbers.data() + solution.numbers.size());
  fit.usable = fit.predicted.allFinite();
  return fit;
}

NoiseFit HysteresisStudy::NoiseOf(const Eigen::VectorXd& predicted, std::span<const double> weights) const {
  std::vector<double> residual(records_.samples.twist_rad);
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] -= predicted(static_cast<Index>(i));
  return FitNoise(residual, weights, segments_, LargestNoiseOrder(), records_.twist_range_rad);
}

// What an effect's nonlinear parameters are, and the state in which friction starts, lies in a range that is
// known before.
FitErrors HysteresisStudy::ErrorsAt(const LoopModel& model, const Eigen::VectorXd& numbers,
                                    const LoopGrid& all) const {
  constexpr double kOfState = 1.0 / 3.0;  // variance of anything from −1 to 1
  Eigen::MatrixXd derivatives;
  const Eigen::VectorXd predicted = model.Predict(numbers, all, derivatives);
  FitErrors errors = ErrorsOfFit(derivatives, all.twist_rad, predicted, all.weight, segments_,
                                 LargestNoiseOrder(), Eigen::VectorXd::Zero(model.size()));
  for (Index state = kFirstOfRecord + 1; state < model.nominal_size(); state += kNumbersOfRecord) {
    if (!errors.open.row(state).isZero(0.0)) errors.covariance(state, state) = kOfState;
    errors.open.row(state).setZero();
  }
  const std::vector<bool> held = model.Held(numbers);
  Index next = model.nominal_size();
  for (const LoopEffect* effect : model.effects()) {
    for (const FitNumber& number : effect->numbers) {
      if (!number.amount || held[static_cast<std::size_t>(next)]) errors.open.row(next).setZero();
      ++next;
    }
  }
  return errors;
}

// In which form an effect goes (a brake that slips at one speed, or the faster the more it is loaded) is
// often more than the record can tell, and so is from which torque on or how soon: the errors are those over
// all that it leaves open, each with its likelihood.
void HysteresisStudy::WidenByAlternatives(const LoopModel& model, std::size_t effect,
                                          const Eigen::VectorXd& numbers, const LoopGrid& all,
                                          const Eigen::MatrixXd& covariance,
                                          std::vector<ParameterValue>& described) const {
  constexpr double kNegligible = -14.0;  // of BIC: a thousandth
  // Whether there is anything is judged by an amount beside its error in the best fit: to be larger in
  // another one does not make it less.
  const auto is_amount = [&](const ParameterValue& parameter) {
    return std::ranges::any_of(model.effects()[effect]->rule.parameters, [&](const ParameterRule& rule) {
      return rule.amount && rule.name == parameter.name;
    });
  };
  std::vector<OtherModel> others;
  const NoiseFit own = NoiseOf(model.Predict(numbers, all), all.weight);
  const LoopGrid grid = GridOf(model, all.weight);
  for (const Alternative& other : FitAlternatives(records_, model, effect, grid, numbers)) {
    const NoiseFit noise = NoiseOf(model.Predict(other.numbers, all), all.weight);
    const int more = model.FreeParameters(other.numbers) - model.FreeParameters(numbers);
    const double ahead = LikelihoodRatio(noise, own) - more * std::log(static_cast<double>(own.samples));
    if (!(ahead > kNegligible)) continue;
    double likelihood = std::exp(0.5 * std::min(ahead, 0.0));
    Eigen::MatrixXd errors = covariance;
    if (other.nonlinear_parameter_range > 0.0) {
      // A piece of the integral over the shape, beside the peak's: √2π of its standard errors.
      const auto nonlinear_parameter = static_cast<Index>(model.Of(effect, numbers).data() - numbers.data()) +
                                       model.effects()[effect]->NonlinearParameter();
      const double peak = std::sqrt(kTwoPi * covariance(nonlinear_parameter, nonlinear_parameter));
      likelihood *= std::min(1.0, other.nonlinear_parameter_range / std::max(peak, 1e-6));
      // The other numbers have the errors that they have at a given shape.
      if (errors(nonlinear_parameter, nonlinear_parameter) > 0.0) {
        const Eigen::VectorXd with_nonlinear_parameter = covariance.col(nonlinear_parameter);
        errors -= with_nonlinear_parameter * with_nonlinear_parameter.transpose() /
                  covariance(nonlinear_parameter, nonlinear_parameter);
      }
    } else {
      errors = ErrorsAt(model, other.numbers, all).covariance;
    }
    others.push_back({likelihood, DescribeEffect(model, effect, other.numbers, errors)});
    std::erase_if(others.back().numbers, is_amount);
  }
  WidenErrors(others, described);
}

std::vector<ParameterValue> HysteresisStudy::DescribeNominal(const Eigen::VectorXd& x,
                                                             const std::vector<double>& errors) const {
  std::vector<ParameterValue> described;
  const auto logarithm = [&](const char* name, const char* unit, int k) {
    const double value = std::exp(x[k]);
    described.push_back({name, unit, value, value * errors[static_cast<std::size_t>(k)]});
  };
  logarithm("k1_Nm_per_rad", "Nm/rad", kLnK1);
  logarithm("k2_Nm_per_rad", "Nm/rad", kLnK2);
  logarithm("k3_Nm_per_rad", "Nm/rad", kLnK3);
  logarithm("friction_torque_Nm", "Nm", kLnFriction);
  logarithm("yield_twist_arcmin", "arcmin", kLnYield);
  for (std::size_t r = 0; r < records_.samples.records(); ++r) {
    const int own = kFirstOfRecord + kNumbersOfRecord * static_cast<int>(r);
    described.push_back({OfRecord("offset_arcmin", r), "arcmin",
                         x[own] + ArcminFromRad(records_.centre_rad[r]),
                         errors[static_cast<std::size_t>(own)]});
    described.push_back(
        {OfRecord("start_share", r), "1", x[own + 1], errors[static_cast<std::size_t>(own) + 1]});
  }
  return described;
}

Eigen::VectorXd HysteresisStudy::AboutZero(Eigen::VectorXd about_centres) const {
  const std::vector<std::size_t>& starts = records_.samples.starts;
  for (std::size_t r = 0; r + 1 < starts.size(); ++r) {
    about_centres.segment(static_cast<Index>(starts[r]), static_cast<Index>(starts[r + 1] - starts[r]))
        .array() += records_.centre_rad[r];
  }
  return about_centres + noise_response_rad_;
}

Eigen::VectorXd HysteresisStudy::Predict(std::span<const ParameterValue> nominal,
                                         std::span<const NamedCause> causes) const {
  const CauseRule whole{.name = "the nominal hysteresis model"};
  std::vector<std::size_t> indices;
  for (const NamedCause& cause : causes) {
    const auto found = std::find_if(rules_.begin(), rules_.end(),
                                    [&](const CauseRule& rule) { return rule.name == cause.name; });
    if (found == rules_.end()) {
      throw std::invalid_argument(fmt::format("{} is no cause of a hysteresis record", cause.name));
    }
    indices.push_back(static_cast<std::size_t>(found - rules_.begin()));
  }
  const LoopModel model = ModelOf(indices);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(model.size());
  const auto logarithm = [&](const char* name) {
    const double value = RequireParameter(whole, nominal, name);
    if (!(value > 0.0))
      throw std::invalid_argument(fmt::format("{} = {} is not a positive number", name, value));
    return std::log(value);
  };
  x[kLnK1] = logarithm("k1_Nm_per_rad");
  x[kLnK2] = logarithm("k2_Nm_per_rad");
  x[kLnK3] = FindParameter(nominal, "k3_Nm_per_rad") == nullptr ? x[kLnK2] : logarithm("k3_Nm_per_rad");
  x[kLnFriction] = logarithm("friction_torque_Nm");
  x[kLnYield] = logarithm("yield_twist_arcmin");
  for (std::size_t r = 0; r < records_.samples.records(); ++r) {
    // A record that the model has no numbers for starts as the first one does.
    const int own = kFirstOfRecord + kNumbersOfRecord * static_cast<int>(r);
    const double* offset = FindParameter(nominal, OfRecord("offset_arcmin", r));
    const double* share = FindParameter(nominal, OfRecord("start_share", r));
    if (share == nullptr) share = FindParameter(nominal, "start_share");
    x[own] = (offset == nullptr ? RequireParameter(whole, nominal, "offset_arcmin") : *offset) -
             ArcminFromRad(records_.centre_rad[r]);
    x[own + 1] = share == nullptr ? 0.0 : *share;
  }
  for (std::size_t e = 0; e < indices.size(); ++e) {
    const std::vector<double> own = effects_[indices[e]]->Restore(causes[e].parameters);
    std::copy(own.begin(), own.end(), model.Of(e, x).begin());
  }
  return AboutZero(model.Predict(x, records_.samples));
}

}  // namespace

std::unique_ptr<Study> MakeHysteresisStudy(std::span<const HysteresisData> records) {
  return std::make_unique<HysteresisStudy>(records);
}

}  // namespace strainwave::analysis::diagnosis
