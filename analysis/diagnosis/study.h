// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace strainwave::analysis::diagnosis {

/// Where a cause lies. Undecided where the record's kind cannot tell (an encoder's eccentricity and the
/// output's own look the same).
enum class Where { kBench, kUnit, kUndecided };

/// What the names of a free curve's coefficients begin with: numbers that tell nobody anything.
inline constexpr std::string_view kCurvePart = "part_";

/// A number of a model as people read it, in the unit that its name ends in.
struct ParameterValue {
  std::string name;  // "amplitude_arcmin"
  std::string unit;  // "arcmin"
  double value{};
  /// Infinite where the records leave the number open: the value is then one of those that explain them.
  double standard_error{};
  /// True for what belongs to the record that it was fitted to: taken as zero for another one without it.
  bool of_record{};
};

/// Bound of a parameter that may be as large as it likes.
inline constexpr double kUnlimited = std::numeric_limits<double>::max();

/// What is known of a parameter before the data: a fitted value outside is a wrong number, or another effect.
struct ParameterRule {
  std::string name;
  std::string unit;
  double low{};
  double high{};
  /// True for a size that is zero where the effect is not there: it has to be away from zero by its error.
  bool amount{};
  /// Magnitude that a value below zero has to have: less is what the record's own sampling leaves open.
  double least_below_zero{};
};

/// One way in which the nominal model may fall short.
struct CauseRule {
  std::string name{};  // of docs/contract.md; of a nuisance term what makes it ("line over output angle")
  std::string what_to_do{};  // for a technician: the next step, without a capital and a full stop
  std::string sentence{};    // for a technician: what it is and what usually makes it
  Where where{Where::kUndecided};
  std::string effect{};  // a row of docs/effects.md, "E4"; or empty
  std::vector<ParameterRule> parameters{};
  int degrees_of_freedom{1};  // parameters that it adds
  /// True where all of its numbers are known as sharply as the effect is large: phases, locations and shares
  /// of one amplitude, which BIC else charges as if all samples spoke of each (DeltaBic).
  bool known_by_size{};
  /// How many of these are locations that the search looked for (an order, a window's two ends): they are
  /// charged by the search locations there are, not by the samples. Of the ordinates of a curve all but one:
  /// they have one size in common, and each is known as sharply as the curve is strong.
  int location_parameters{};
  /// How many independent locations (orders, windows) its search covers: multiplies the p-value. Where they
  /// overlap or the likelihood ratio is no χ², as many as make p < 0.05 in one of twenty clean records
  /// (checked on 480 of tests/blind).
  double trials_factor{1.0};
  /// BIC that a nuisance term has to bring; by default somewhat less than nothing will do (judge.cc). Below
  /// zero it holds beside another one, too: for one whose p-value says all. A named cause has to bring more
  /// than none, always.
  std::optional<double> least_bic{};
  /// Of the sum of squares that it takes away, what may be left since nature's shape is not quite ours: what
  /// else is found beside it has to be more. By default nothing for a cause, and for a nuisance term what a
  /// rough nuisance term may leave (refinement.cc).
  std::optional<double> misfit_share{};
  /// Of the sum of squares that all causes take away together, what it has to bring beside another one: for a
  /// shape that takes whatever is left somewhere, which may be the misfit of the others' formulae.
  double least_share{};
  /// Stays within a short segment of the record, so that it is held out in short blocks.
  bool local{};
  /// May lie within a few samples that were taken one by one: where it does, those of one block cannot be
  /// predicted from the others, and that they are not is nothing against it.
  bool of_few_samples{};
  /// False for a nuisance term: a shape without a physical cause, which competes with the causes so that none
  /// of them has to stand in for it. Never reported as a cause.
  bool named{true};
  /// Of those: a number that the record itself states and that may be wrong. It competes with the causes as
  /// an equal, and where nothing else is found nothing is missing in the simulation.
  bool stated_number{};
  /// What the record cannot tell from it although it is no cause of the list ("line at 40.00 per output
  /// turn").
  std::vector<std::string> aliases{};
  /// A measurement that would separate it from its rivals or from bench and unit: a comment line, and below
  /// it phases of a schedule as `run` takes them (YAML). Empty where there is none.
  std::string to_settle{};
};

/// A shape that explains anything that looks like it, and so has to explain more than a cause does.
inline bool IsNuisanceTerm(const CauseRule& rule) { return !rule.named && !rule.stated_number; }

/// One quantity that the response may depend on, sample by sample, in SI; for the residual's views and tests.
struct Regressor {
  std::string name;   // "output_angle", "input_angle", "speed", "torque", "temperature", "time", "direction"
  std::string title;  // with the unit of the picture's axis, "output angle / deg"
  double per_unit{1.0};  // SI times this is what the axis shows
  std::vector<double> values;
  bool angle{};  // counted in turns of 2π: orders per turn make sense
};

/// The model with a set of causes, fitted.
struct ModelFit {
  std::vector<std::size_t> causes;  // indices into Study::causes(), ascending
  std::vector<ParameterValue> nominal;
  std::vector<std::vector<ParameterValue>> cause_parameters;  // one list a cause, in the order of `causes`
  /// In words, which of these the records leave open, or know in one sum only.
  std::vector<std::string> open;
  Eigen::VectorXd predicted;  // all samples, those without weight, too
  int free_parameters{};
  /// Of these, as many as are not charged for: what the record says of them is no more than was known before.
  double known_before{};
  /// Logarithm of how many search locations the fit chose from over those that the rules of its causes count:
  /// of each further one of several impacts, its time; below 0 for a window that is wider than the narrowest.
  double log_search_locations{};
  /// Of the free parameters, those that give such a location: `log_search_locations` charges for them.
  int location_parameters{};
  std::vector<double> state;  // the fit's own numbers, to start the next one from; its layout is the study's
  bool usable{};              // false: no solution inside the hard bounds; everything else is then void

  double charged_parameters() const { return static_cast<double>(free_parameters) - known_before; }
};

/// What a fit is for: candidates are compared by their likelihood alone; to judge one its numbers need
/// errors; what is reported has errors over all that the record leaves open, other forms of an effect
/// included.
enum class FitPurpose { kCompare, kJudge, kReport };

/// One draw of what a cause may be: its nonlinear parameters within their prior ranges, its linear ones in
/// one direction, at a size that can be chosen.
struct DrawnEffect {
  std::string amount;                 // the parameter that says how large it is, "amplitude_arcmin"
  std::string unit;                   // of the amount
  double largest_amount{kUnlimited};  // within its prior range
  /// What it adds to the response, SI, one a sample, at an amount above 0 in `unit`.
  std::function<Eigen::VectorXd(double amount)> added;
};

/// A quantity that users care for, as the record has it and as a model predicts it.
struct UserQuantity {
  std::string name;  // "e_max_arcmin"
  double measured{};
  double predicted{};
};

/// Records of one kind that are to be explained together: the measured response, the nominal model, the
/// causes that may be missing in it. One class a kind; the engine (diagnose.h) knows no kind.
class Study {
 public:
  virtual ~Study() = default;

  /// Response, one value a sample, in SI; the samples of several records one after the other in time order.
  virtual std::span<const double> measured() const = 0;
  /// First sample of each segment without a gap (records, directions), ascending from 0.
  virtual std::span<const std::size_t> segments() const = 0;
  virtual const std::vector<CauseRule>& causes() const = 0;
  virtual const std::vector<Regressor>& regressors() const = 0;

  /// Unit of the response for people and how many of it make one SI unit ("arcmin", 3437.7).
  virtual std::string unit() const = 0;
  virtual double unit_per_si() const = 0;

  /// Fits nominal parameters and the causes with these indices (ascending) together.
  /// @param weights  one a sample, ≥ 0; zero keeps a sample out of the fit (held out, or an outlier).
  /// @param start    a fit of the same or another set of causes to start from, or null.
  /// Several threads may fit at once.
  virtual ModelFit Fit(std::span<const std::size_t> cause_indices, std::span<const double> weights,
                       const ModelFit* start, FitPurpose purpose) const = 0;

  /// True where the study caches what it searched for, so that what a fit of causes that `start` lacks comes
  /// to may depend on what was asked for before it.
  virtual bool CachesSearches() const { return false; }

  /// What the response that a fit predicts may be wrong by, sample by sample (SI, a standard deviation up to
  /// a common factor), where it depends on more than any fit can know: when an inertia behind backlash
  /// strikes after several impacts. Empty: nowhere.
  virtual std::vector<double> ModelUncertainty(const ModelFit& /*fit*/) const { return {}; }

  /// Standard deviation of the noise without a model, SI: from repeats at equal position where the record has
  /// them, else from what changes fastest. 0 where the record cannot tell.
  virtual double NoiseFloor() const = 0;

  /// Standard deviation of what rounding to steps does to a response that stands on steps, SI; 0 for one that
  /// does not.
  virtual double Rounding() const { return 0.0; }

  /// Weight of each sample from the start, above 0: the noise's variance over the variance that is expected
  /// there, where the study knows of errors that come and go, or of noise that is larger in one part than in
  /// another. Empty: all count alike.
  virtual std::span<const double> Weights() const { return {}; }

  /// Variance of the noise, SI², that a low-pass of the study's own took from the response: added again to
  /// all that is reported as RMSE or noise, so that these are the record's.
  virtual double FilteredOutVariance() const { return 0.0; }

  /// Samples in a block that is held out in one piece: a turn, a loop, a time in which the noise has
  /// forgotten.
  virtual std::size_t BlockLength() const = 0;

  /// Largest order of the autoregressive noise that candidates are judged under; 0 takes it as white.
  virtual int LargestNoiseOrder() const { return 4; }

  /// A residual whose noise is independent from segment to segment, for likelihoods: where several channels
  /// share noise, what they have in common is taken apart. Samples without weight count as zero there.
  virtual std::vector<double> Decorrelated(std::vector<double> residual,
                                           std::span<const double> /*weights*/) const {
    return residual;
  }

  /// First samples of what, decorrelated, has a spectrum of its own (FitNoise); empty: one for all.
  virtual std::span<const std::size_t> NoiseSeries() const { return {}; }

  /// True where a sample that stands off its neighbours is a disturbance of the measurement, and is left out.
  virtual bool SpikesAreOutliers() const { return true; }

  /// Angle at which each sample was taken, where a record comes by one and the same angle several times and
  /// what it shows there comes again; empty where it does not.
  virtual std::span<const double> AnglesOnTurn() const { return {}; }

  /// Quantities that users care for, of this record and of a model's prediction of it; empty where none.
  virtual std::vector<UserQuantity> Quantities(const Eigen::VectorXd& predicted) const = 0;

  /// What was noticed about the record itself ("ratio looks like 100, file says 80"): sentences.
  virtual const std::vector<std::string>& warnings() const = 0;

  /// Response of the model with parameters by name, as a ModelFit reported them; for simulating. `causes` by
  /// name with their parameters.
  struct NamedCause {
    std::string name;
    std::vector<ParameterValue> parameters;
  };
  /// @throws std::invalid_argument naming an unknown cause, or a parameter that is unknown or missing.
  virtual Eigen::VectorXd Predict(std::span<const ParameterValue> nominal,
                                  std::span<const NamedCause> causes) const = 0;

  /// The same records with another response (SI, one a sample): what they are made of besides stays. Null
  /// where a kind cannot.
  virtual std::unique_ptr<Study> WithResponse(std::span<const double> /*measured*/) const { return nullptr; }

  /// A cause drawn at random beside a fit of these records; the same for the same draw. Nothing where the
  /// kind, or the record, has none.
  virtual std::optional<DrawnEffect> DrawEffect(std::size_t /*cause*/, const ModelFit& /*beside*/,
                                                std::uint64_t /*draw*/) const {
    return std::nullopt;
  }
};

}  // namespace strainwave::analysis::diagnosis
