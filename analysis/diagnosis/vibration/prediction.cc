// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>

#include "analysis/diagnosis/vibration/narrowband.h"
#include "analysis/diagnosis/vibration/parameters.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::optional<double> Find(std::span<const ParameterValue> parameters, const std::string& name) {
  const auto found = std::ranges::find(parameters, name, &ParameterValue::name);
  if (found == parameters.end()) return std::nullopt;
  return found->value;
}

double Need(std::span<const ParameterValue> parameters, const std::string& name, const std::string& whose) {
  const std::optional<double> value = Find(parameters, name);
  if (!value) throw std::invalid_argument(fmt::format("{}: parameter {} is missing", whose, name));
  return *value;
}

// Standard normal numbers, the same on every machine.
class Draw {
 public:
  double operator()() {
    const double u = (static_cast<double>(random_() >> 11) + 0.5) * 0x1p-53;
    const double v = static_cast<double>(random_() >> 11) * 0x1p-53;
    return std::sqrt(-2.0 * std::log(u)) * std::cos(kTwoPi * v);
  }

 private:
  std::mt19937_64 random_{20240229};
};

VectorXd DrawNarrowband(const VibrationRun& run, double frequency_Hz, double damping, double deviation) {
  const InnovationFilter filter = FilterOf({frequency_Hz, damping, 0.0}, run.period_s);
  const double gain = (1.0 + filter.a2) /
                      ((1.0 - filter.a2) * ((1.0 + filter.a2) * (1.0 + filter.a2) - filter.a1 * filter.a1));
  Draw draw;
  VectorXd values(static_cast<Index>(run.size()));
  double y1 = 0.0;
  double y2 = 0.0;
  // A few hundred periods before the record begins, so that it starts in full swing.
  const auto lead = static_cast<Index>(std::min(1e6, 5.0 / (damping * kTwoPi * frequency_Hz * run.period_s)));
  for (Index i = -lead; i < values.size(); ++i) {
    const double y = deviation / std::sqrt(gain) * draw() - filter.a1 * y1 - filter.a2 * y2;
    y2 = y1;
    y1 = y;
    if (i >= 0) values(i) = y;
  }
  return values;
}

// The term that these parameters describe, without its coefficients.
VibrationTerm TermOf(const VibrationSamples& samples, VibrationCause cause, const std::string& name,
                     std::span<const ParameterValue> parameters) {
  VibrationTerm term;
  const auto need = [&](const std::string& parameter) { return Need(parameters, parameter, name); };
  for (int l = 1;; ++l) {
    const std::optional<double> order = Find(parameters, fmt::format("line_{}", l));
    if (!order) break;
    const std::optional<double> power = Find(parameters, fmt::format("line_{}_speed_power", l));
    term.lines.push_back({0.0, *order, power ? static_cast<int>(*power) : 0});
  }
  const auto add_modulation_and_places = [&] {
    if (const auto modulation = Find(parameters, "modulated_per_turn")) {
      term.lines.push_back({0.0, *modulation});
      term.nonlinear_parameters.insert(term.nonlinear_parameters.end(),
                                       {need("modulation_cosine"), need("modulation_sine")});
    }
    for (std::size_t r = 0; r < samples.runs.size(); ++r)
      term.nonlinear_parameters.push_back(need(fmt::format("place_{}_turns", r + 1)));
  };
  if (Find(parameters, "ring_Hz")) {
    term.form = VibrationForm::kImpulseTrain;
    term.nonlinear_parameters = {
        need(cause == VibrationCause::kBearingDefect ? "defect_order" : "crack_order"), need("ring_Hz"),
        need("ring_decay_ratio")};
    add_modulation_and_places();
  } else if (Find(parameters, "pulse_width")) {
    term.form = VibrationForm::kPulses;
    term.lines = {{0.0, need("crack_order")}};
    term.nonlinear_parameters = {need("pulse_width")};
    add_modulation_and_places();
  } else if (cause == VibrationCause::kImbalance) {
    term.form = VibrationForm::kGrowth;
  } else if (Find(parameters, "knock_1_s")) {
    term.form = VibrationForm::kTransients;
    term.nonlinear_parameters = {need("frequency_Hz"), need("damping_ratio"), need("knock_1_s")};
    for (int k = 2; Find(parameters, fmt::format("knock_{}_s", k)); ++k) {
      term.nonlinear_parameters.insert(
          term.nonlinear_parameters.end(),
          {need(fmt::format("knock_{}_s", k)), need(fmt::format("knock_{}_height", k))});
    }
  } else if (Find(parameters, "damping_ratio")) {
    term.form = term.lines.empty() ? VibrationForm::kNarrowband : VibrationForm::kDriven;
    term.nonlinear_parameters = {need("frequency_Hz"), need("damping_ratio")};
    for (LineOrder& line : term.lines) line = {line.offset, 0.0};
  } else if (Find(parameters, "centre_s")) {
    term.form = VibrationForm::kBurst;
    term.nonlinear_parameters = {need("frequency_Hz"), need("centre_s"), need("width_s")};
  } else if (cause == VibrationCause::kSlowChange) {
    term.form = VibrationForm::kLevels;
  } else if (cause == VibrationCause::kLineOverTime) {
    term.form = VibrationForm::kTones;
    term.lines = {{1.0, 0.0}};
    term.nonlinear_parameters = {need("frequency_Hz")};
  } else if (term.lines.empty()) {
    term.lines = {{0.0, need("order_per_input_turn")}};
  }
  return term;
}

}  // namespace

VectorXd PredictNominal(const VibrationSamples& samples, std::span<const ParameterValue> nominal) {
  VectorXd predicted(static_cast<Index>(samples.measured.size()));
  for (const VibrationRun& run : samples.runs) {
    for (const VibrationSegment& channel : run.channels) {
      VectorXd coefficients = VectorXd::Zero(run.nominal.cols());
      coefficients(0) = Need(nominal, "mean_" + channel.name, "nominal");
      for (const Index first : {Index{1}, Index{3}}) {
        if (run.nominal.cols() < 5) break;
        const char* which = first == 1 ? "first" : "second";
        const double amplitude =
            Need(nominal, fmt::format("{}_amplitude_{}", which, channel.name), "nominal");
        const double phase =
            RadFromDeg(Need(nominal, fmt::format("{}_phase_deg_{}", which, channel.name), "nominal"));
        coefficients(first) = amplitude * std::cos(phase);
        coefficients(first + 1) = amplitude * std::sin(phase);
      }
      predicted.segment(static_cast<Index>(channel.first), static_cast<Index>(run.size())) =
          run.nominal * coefficients;
    }
  }
  return predicted;
}

VectorXd PredictTerm(const VibrationSamples& samples, VibrationCause cause, const std::string& name,
                     std::span<const ParameterValue> parameters) {
  const VibrationTerm term = TermOf(samples, cause, name, parameters);
  VectorXd predicted = VectorXd::Zero(static_cast<Index>(samples.measured.size()));
  for (std::size_t r = 0; r < samples.runs.size(); ++r) {
    const VibrationRun& run = samples.runs[r];
    const Eigen::MatrixXd columns = FillTerm(samples, r, term);
    for (const VibrationSegment& channel : run.channels) {
      auto own = predicted.segment(static_cast<Index>(channel.first), static_cast<Index>(run.size()));
      if (term.form == VibrationForm::kNarrowband) {
        const double deviation = Find(parameters, "deviation_" + channel.name).value_or(0.0);
        // One unrest drives all channels: those with the other sign move against the rest.
        if (deviation != 0.0)
          own += DrawNarrowband(run, term.nonlinear_parameters[0], term.nonlinear_parameters[1], deviation);
        continue;
      }
      for (Index k = 0; k < columns.cols(); ++k) {
        // A channel in which the term is not observable has no coefficients.
        own += Find(parameters, CoefficientName(term, k, channel.name)).value_or(0.0) * columns.col(k);
      }
    }
  }
  return predicted;
}

}  // namespace strainwave::analysis::diagnosis
