// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/terms.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "analysis/diagnosis/phasors.h"
#include "analysis/diagnosis/vibration/impulse_train.h"
#include "analysis/diagnosis/vibration/pulses.h"
#include "analysis/model/vibration_orders.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Of the speed, from −1 at the slowest of all runs to 1 at the fastest.
Eigen::VectorXd LegendreOfSpeed(const VibrationSamples& samples, const VibrationRun& run, int degree) {
  double slowest = run.speed_rad_per_s.front();
  double fastest = slowest;
  for (const VibrationRun& other : samples.runs) {
    const auto [low, high] = std::ranges::minmax(other.speed_rad_per_s);
    slowest = std::min(slowest, low);
    fastest = std::max(fastest, high);
  }
  Eigen::VectorXd values(static_cast<Index>(run.size()));
  for (Index i = 0; i < values.size(); ++i) {
    const double x =
        2.0 * (run.speed_rad_per_s[static_cast<std::size_t>(i)] - slowest) / (fastest - slowest) - 1.0;
    values(i) = std::legendre(static_cast<unsigned>(degree), std::clamp(x, -1.0, 1.0));
  }
  return values;
}

void FillLines(const std::vector<double>& angle, const VibrationTerm& term, MatrixXd& columns) {
  const double base = term.nonlinear_parameters.empty() ? 1.0 : term.nonlinear_parameters[0];
  for (std::size_t l = 0; l < term.lines.size(); ++l) {
    const double order = term.lines[l].harmonic * base + term.lines[l].offset;
    const auto pair = static_cast<Index>(2 * l);
    ForEachPhasor(angle, order, [&](std::size_t i, std::complex<double> phasor) {
      columns(static_cast<Index>(i), pair) = phasor.real();
      columns(static_cast<Index>(i), pair + 1) = phasor.imag();
    });
  }
}

void FillDriven(const VibrationRun& run, const VibrationTerm& term, MatrixXd& columns) {
  for (std::size_t l = 0; l < term.lines.size(); ++l) {
    const double order = term.lines[l].harmonic;
    const auto pair = static_cast<Index>(2 * l);
    for (std::size_t i = 0; i < run.size(); ++i) {
      const std::complex<double> gain =
          model::ResonantGain(order * run.speed_rad_per_s[i], kTwoPi * term.nonlinear_parameters[0],
                              term.nonlinear_parameters[1]);
      const std::complex<double> line = gain * std::polar(1.0, order * run.angle_rad[i]);
      columns(static_cast<Index>(i), pair) = line.real();
      columns(static_cast<Index>(i), pair + 1) = line.imag();
    }
  }
}

void FillBurst(const VibrationRun& run, const VibrationTerm& term, MatrixXd& columns) {
  columns.setZero();
  for (std::size_t i = 0; i < run.size(); ++i) {
    const double off = (run.time_s[i] - term.nonlinear_parameters[1]) / term.nonlinear_parameters[2];
    if (std::abs(off) > 5.0) continue;
    const double bell = std::exp(-0.5 * off * off);
    const double angle =
        term.nonlinear_parameters[0] * (run.time_2pi[i] - kTwoPi * term.nonlinear_parameters[1]);
    columns(static_cast<Index>(i), 0) = bell * std::cos(angle);
    columns(static_cast<Index>(i), 1) = bell * std::sin(angle);
  }
}

}  // namespace

std::vector<VibrationNonlinearParameter> NonlinearParametersOf(const VibrationSamples& samples,
                                                               const VibrationTerm& term) {
  std::vector<VibrationNonlinearParameter> nonlinear_parameters;
  double turns = 0.0;
  double span_s = 0.0;
  for (const VibrationRun& run : samples.runs) {
    turns = std::max(turns, run.turns);
    span_s = std::max(span_s, run.span_s());
  }
  const double top_Hz = 0.98 * samples.highest_Hz();
  switch (term.form) {
    case VibrationForm::kLines: {
      if (term.nonlinear_parameters.empty()) break;
      double harmonic = 1.0;
      for (const LineOrder& line : term.lines) harmonic = std::max(harmonic, std::abs(line.harmonic));
      // A search has found the cell; a fit does not leave it.
      const double cell = 1.0 / (turns * harmonic);
      nonlinear_parameters.push_back(
          {term.nonlinear_parameters[0] - cell, term.nonlinear_parameters[0] + cell, 0.05 * cell});
      break;
    }
    case VibrationForm::kTones: {
      const double cell = 1.0 / span_s;
      nonlinear_parameters.push_back(
          {term.nonlinear_parameters[0] - cell, term.nonlinear_parameters[0] + cell, 0.05 * cell});
      break;
    }
    case VibrationForm::kImpulseTrain: {
      const double lines =
          std::max(1.0, term.nonlinear_parameters[1] * span_s / turns / term.nonlinear_parameters[0]);
      const double cell = 1.0 / (turns * lines);
      nonlinear_parameters.push_back({term.nonlinear_parameters[0] - 2.0 * cell,
                                      term.nonlinear_parameters[0] + 2.0 * cell, 0.05 * cell});
      nonlinear_parameters.push_back({0.7 * term.nonlinear_parameters[1],
                                      std::min(top_Hz, 1.4 * term.nonlinear_parameters[1]),
                                      0.005 * term.nonlinear_parameters[1]});
      // Towards one the response becomes a single smooth bump; and it dies away before the next begins.
      nonlinear_parameters.push_back(
          {std::max(0.006, kLeastDecay / (kTwoPi * lines)), 0.95, 0.05 * term.nonlinear_parameters[2]});
      for (std::size_t m = 0; m < 2 * term.lines.size(); ++m)
        nonlinear_parameters.push_back({-2.0, 2.0, 0.05});
      for (std::size_t s = nonlinear_parameters.size(); s < term.nonlinear_parameters.size(); ++s) {
        nonlinear_parameters.push_back(
            {term.nonlinear_parameters[s] - 0.5, term.nonlinear_parameters[s] + 0.5, 0.02 / lines});
      }
      break;
    }
    case VibrationForm::kPulses: {
      const bool free = WidthIsNonlinearParameter(term);
      const double width = free ? term.nonlinear_parameters[0] : term.lines[0].harmonic;
      if (free) nonlinear_parameters.push_back({0.01, 0.3, 0.05 * width});
      for (std::size_t m = 2; m < 2 * term.lines.size(); ++m)
        nonlinear_parameters.push_back({-2.0, 2.0, 0.05});
      for (std::size_t s = nonlinear_parameters.size(); s < term.nonlinear_parameters.size(); ++s) {
        nonlinear_parameters.push_back(
            {term.nonlinear_parameters[s] - 0.5, term.nonlinear_parameters[s] + 0.5, 0.05 * width});
      }
      break;
    }
    case VibrationForm::kDriven:
      nonlinear_parameters.push_back({1.0, top_Hz, 0.01 * term.nonlinear_parameters[0]});
      nonlinear_parameters.push_back({0.002, 0.5, 0.05 * term.nonlinear_parameters[1]});
      break;
    case VibrationForm::kNarrowband:
      nonlinear_parameters.push_back({0.8 * term.nonlinear_parameters[0],
                                      std::min(top_Hz, 1.25 * term.nonlinear_parameters[0]),
                                      0.003 * term.nonlinear_parameters[0]});
      nonlinear_parameters.push_back({5e-4, 0.5, 0.05 * term.nonlinear_parameters[1]});
      for (std::size_t s = 2; s < term.nonlinear_parameters.size(); ++s) {
        const auto sizes = Eigen::Map<const Eigen::VectorXd>(
            term.nonlinear_parameters.data() + 2, static_cast<Index>(term.nonlinear_parameters.size() - 2));
        nonlinear_parameters.push_back({-1e3, 1e3, 0.025 * std::max(1e-3, sizes.norm())});
      }
      break;
    case VibrationForm::kTransients:
      nonlinear_parameters.push_back({0.8 * term.nonlinear_parameters[0],
                                      std::min(top_Hz, 1.25 * term.nonlinear_parameters[0]),
                                      0.003 * term.nonlinear_parameters[0]});
      nonlinear_parameters.push_back({5e-4, 0.5, 0.05 * term.nonlinear_parameters[1]});
      for (std::size_t k = 2; k < term.nonlinear_parameters.size(); ++k) {
        const double period_s = 1.0 / term.nonlinear_parameters[0];
        const bool time = k == 2 || k % 2 == 1;
        nonlinear_parameters.push_back(
            time ? VibrationNonlinearParameter{term.nonlinear_parameters[k] - period_s,
                                               term.nonlinear_parameters[k] + period_s, 0.02 * period_s}
                 : VibrationNonlinearParameter{-100.0, 100.0, 0.05});
      }
      break;
    case VibrationForm::kBurst:
      nonlinear_parameters.push_back({std::max(0.5, 0.7 * term.nonlinear_parameters[0]),
                                      std::min(top_Hz, 1.4 * term.nonlinear_parameters[0]),
                                      0.02 / term.nonlinear_parameters[2]});
      nonlinear_parameters.push_back({0.0, span_s, 0.1 * term.nonlinear_parameters[2]});
      nonlinear_parameters.push_back({0.2 * term.nonlinear_parameters[2], 5.0 * term.nonlinear_parameters[2],
                                      0.05 * term.nonlinear_parameters[2]});
      break;
    case VibrationForm::kGrowth:
    case VibrationForm::kLevels:
      break;
  }
  return nonlinear_parameters;
}

Index ColumnsOf(const VibrationTerm& term) {
  switch (term.form) {
    case VibrationForm::kLines:
    case VibrationForm::kTones:
    case VibrationForm::kDriven:
      return static_cast<Index>(2 * term.lines.size());
    case VibrationForm::kImpulseTrain:
    case VibrationForm::kPulses:
    case VibrationForm::kTransients:
      return 1;
    case VibrationForm::kGrowth:
    case VibrationForm::kBurst:
      return 2;
    case VibrationForm::kLevels:
      return 3;
    case VibrationForm::kNarrowband:
      break;
  }
  return 0;
}

ImpulseTrain TrainOf(const VibrationTerm& term, std::size_t run) {
  ImpulseTrain train{term.nonlinear_parameters[0],
                     term.nonlinear_parameters[1],
                     term.nonlinear_parameters[2],
                     0.0,
                     {},
                     term.slips};
  std::size_t s = 3;
  for (const LineOrder& line : term.lines) {
    train.modulations.push_back(
        {line.offset, term.nonlinear_parameters[s], term.nonlinear_parameters[s + 1]});
    s += 2;
  }
  train.phase = term.nonlinear_parameters[s + run];
  return train;
}

bool HasPairs(VibrationForm form) {
  return form != VibrationForm::kImpulseTrain && form != VibrationForm::kPulses &&
         form != VibrationForm::kTransients && form != VibrationForm::kLevels;
}

MatrixXd FillTerm(const VibrationSamples& samples, std::size_t which, const VibrationTerm& term) {
  const VibrationRun& run = samples.runs[which];
  const auto n = static_cast<Index>(run.size());
  MatrixXd columns(n, ColumnsOf(term));
  switch (term.form) {
    case VibrationForm::kLines:
      FillLines(run.angle_rad, term, columns);
      for (std::size_t l = 0; l < term.lines.size(); ++l) {
        if (term.lines[l].speed_power == 0) continue;
        const Eigen::VectorXd gain = LegendreOfSpeed(samples, run, term.lines[l].speed_power);
        columns.middleCols(static_cast<Index>(2 * l), 2).array().colwise() *= gain.array();
      }
      break;
    case VibrationForm::kTones:
      FillLines(run.time_2pi, term, columns);
      break;
    case VibrationForm::kImpulseTrain:
      columns = ImpulseTrainColumn(run, TrainOf(term, which));
      break;
    case VibrationForm::kPulses: {
      std::size_t s = WidthIsNonlinearParameter(term) ? 1 : 0;
      PulseTrain train{term.lines[0].offset,
                       s > 0 ? term.nonlinear_parameters[0] : term.lines[0].harmonic,
                       0.0,
                       0.0,
                       0.0,
                       0.0};
      if (term.lines.size() > 1) {
        train.slow_order = term.lines[1].offset;
        train.cosine = term.nonlinear_parameters[s];
        train.sine = term.nonlinear_parameters[s + 1];
        s += 2;
      }
      train.phase = term.nonlinear_parameters[s + which];
      columns = PulseColumn(run, train, samples.highest_order());
      break;
    }
    case VibrationForm::kTransients:
      columns.setZero();
      AddTransient(run, term.nonlinear_parameters[0], term.nonlinear_parameters[1],
                   term.nonlinear_parameters[2], 1.0, columns.col(0));
      for (std::size_t k = 3; k + 1 < term.nonlinear_parameters.size(); k += 2) {
        AddTransient(run, term.nonlinear_parameters[0], term.nonlinear_parameters[1],
                     term.nonlinear_parameters[k], term.nonlinear_parameters[k + 1], columns.col(0));
      }
      break;
    case VibrationForm::kGrowth:
      for (Index i = 0; i < n; ++i) {
        const auto sample = static_cast<std::size_t>(i);
        const double growth = model::ImbalanceGrowth(run.speed_rad_per_s[sample], RadPerSFromRpm(1000.0));
        columns(i, 0) = growth * run.nominal(i, 1);
        columns(i, 1) = growth * run.nominal(i, 2);
      }
      break;
    case VibrationForm::kDriven:
      FillDriven(run, term, columns);
      break;
    case VibrationForm::kBurst:
      FillBurst(run, term, columns);
      break;
    case VibrationForm::kLevels:
      for (Index i = 0; i < n; ++i) {
        const double x = 2.0 * run.time_s[static_cast<std::size_t>(i)] / run.span_s() - 1.0;
        columns(i, 0) = x;
        columns(i, 1) = x * x;
        columns(i, 2) = x * x * x;
      }
      break;
    case VibrationForm::kNarrowband:
      break;
  }
  return columns;
}

std::vector<double> PackTerms(const std::vector<VibrationTerm>& terms) {
  std::vector<double> state{static_cast<double>(terms.size())};
  for (const VibrationTerm& term : terms) {
    state.push_back(static_cast<double>(term.cause));
    state.push_back(static_cast<double>(term.form));
    state.push_back(static_cast<double>(term.lines.size()));
    for (const LineOrder& line : term.lines)
      state.insert(state.end(), {line.harmonic, line.offset, static_cast<double>(line.speed_power)});
    state.push_back(static_cast<double>(term.nonlinear_parameters.size()));
    state.insert(state.end(), term.nonlinear_parameters.begin(), term.nonlinear_parameters.end());
    state.push_back(static_cast<double>(term.observable.size()));
    for (const char observable : term.observable) state.push_back(observable);
    state.push_back(static_cast<double>(term.slips.size()));
    state.insert(state.end(), term.slips.begin(), term.slips.end());
  }
  return state;
}

std::vector<VibrationTerm> UnpackTerms(const std::vector<double>& state) {
  std::size_t next_number = 0;
  const auto next = [&] { return next_number < state.size() ? state[next_number++] : 0.0; };
  std::vector<VibrationTerm> terms(static_cast<std::size_t>(next()));
  for (VibrationTerm& term : terms) {
    term.cause = static_cast<std::size_t>(next());
    term.form = static_cast<VibrationForm>(static_cast<int>(next()));
    term.lines.resize(static_cast<std::size_t>(next()));
    for (LineOrder& line : term.lines) {
      line.harmonic = next();
      line.offset = next();
      line.speed_power = static_cast<int>(next());
    }
    term.nonlinear_parameters.resize(static_cast<std::size_t>(next()));
    for (double& nonlinear_parameter : term.nonlinear_parameters) nonlinear_parameter = next();
    term.observable.resize(static_cast<std::size_t>(next()));
    for (char& observable : term.observable) observable = static_cast<char>(next());
    term.slips.resize(static_cast<std::size_t>(next()));
    for (double& slip : term.slips) slip = next();
  }
  return terms;
}

}  // namespace strainwave::analysis::diagnosis
