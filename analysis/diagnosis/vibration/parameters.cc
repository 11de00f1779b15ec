// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/vibration/slipping.h"
#include "analysis/model/vibration_orders.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

const VibrationSegment& ChannelAt(const VibrationSamples& samples, std::size_t channel) {
  for (const VibrationRun& run : samples.runs) {
    if (channel < run.channels.size()) return run.channels[channel];
    channel -= run.channels.size();
  }
  return samples.runs.back().channels.back();
}

struct Polar {
  double amplitude{}, amplitude_error{}, phase_rad{}, phase_error_rad{};
};

// Amplitude and phase of the pair of coefficients at `first`, in the unit of the channel; of a single
// coefficient where `width` is 1.
Polar PolarAt(const VibrationSamples& samples, const VibrationSolution& solution, std::size_t channel,
              Index first, const MatrixXd& nonlinear_parameters, Index width = 2) {
  const VibrationSolution::Channel& fitted = solution.channels[channel];
  const double scale = 1.0 / ChannelAt(samples, channel).scale;
  Eigen::Vector2d pair = Eigen::Vector2d::Zero();
  pair.head(width) = scale * fitted.fit.coefficients.segment(first, width);
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  covariance.topLeftCorner(width, width) =
      solution.variance() * fitted.fit.inverse.block(first, first, width, width);
  if (nonlinear_parameters.size() > 0 && fitted.follows_nonlinear_parameters.size() > 0) {
    const MatrixXd follows = fitted.follows_nonlinear_parameters.middleRows(first, width);
    covariance.topLeftCorner(width, width) += follows * nonlinear_parameters * follows.transpose();
  }
  covariance *= scale * scale;
  Polar polar{pair.norm(), 0.0, std::atan2(pair(1), pair(0)), kPi};
  if (polar.amplitude > 0.0) {
    const Eigen::Vector2d along = pair / polar.amplitude;
    const Eigen::Vector2d across(-along(1), along(0));
    polar.amplitude_error = StandardErrorOf(along.dot(covariance * along));
    polar.phase_error_rad = std::min(kPi, StandardErrorOf(across.dot(covariance * across)) / polar.amplitude);
  }
  return polar;
}

// Channel and pair of a term whose amplitude is largest.
struct LargestAmplitude {
  std::size_t channel{};
  std::size_t pair{};
  Polar polar;
};
LargestAmplitude LargestPair(const VibrationSamples& samples, const VibrationSolution& solution,
                             std::size_t term, std::size_t from, std::size_t to,
                             const MatrixXd& nonlinear_parameters) {
  LargestAmplitude largest;
  largest.polar.amplitude = -1.0;
  const Index width = HasPairs(solution.terms[term].form) ? 2 : 1;
  for (std::size_t c = 0; c < solution.channels.size(); ++c) {
    if (solution.channels[c].first[term] < 0) continue;
    for (std::size_t pair = from; pair < to; ++pair) {
      const Polar polar =
          PolarAt(samples, solution, c, solution.channels[c].first[term] + static_cast<Index>(2 * pair),
                  nonlinear_parameters, width);
      if (polar.amplitude > largest.polar.amplitude) largest = {c, pair, polar};
    }
  }
  return largest;
}

// Standard deviation of a narrow-band process in the channel where it is largest, times √2.
ParameterValue NarrowAmplitude(const VibrationSamples& samples, const VibrationSolution& solution,
                               std::size_t term, const MatrixXd& nonlinear_parameters,
                               Index first_nonlinear_parameter) {
  const VibrationTerm& narrow = solution.terms[term];
  ParameterValue best{AmplitudeName(samples), UnitOfChannel(samples.runs.front().channels.front().name), 0.0,
                      0.0};
  for (std::size_t c = 0; c < narrow.observable.size(); ++c) {
    if (narrow.observable[c] == 0) continue;
    const double unit = std::sqrt(2.0) * samples.noise_floor / ChannelAt(samples, c).scale;
    const double amplitude = unit * std::abs(narrow.nonlinear_parameters[2 + c]);
    if (amplitude <= best.value) continue;
    best.value = amplitude;
    const Index parameter = first_nonlinear_parameter + 2 + static_cast<Index>(c);
    if (nonlinear_parameters.size() > 0)
      best.standard_error = unit * StandardErrorOf(nonlinear_parameters(parameter, parameter));
  }
  return best;
}

void AddCoefficients(const VibrationSamples& samples, const VibrationSolution& solution, std::size_t term,
                     std::vector<ParameterValue>& values) {
  const Index width = ColumnsOf(solution.terms[term]);
  for (Index column = 0; column < width; ++column) {
    for (std::size_t c = 0; c < solution.channels.size(); ++c) {
      const VibrationSolution::Channel& channel = solution.channels[c];
      if (channel.first[term] < 0) continue;
      const VibrationSegment& segment = ChannelAt(samples, c);
      const Index at = channel.first[term] + column;
      values.push_back({CoefficientName(solution.terms[term], column, segment.name),
                        UnitOfChannel(segment.name), channel.fit.coefficients(at) / segment.scale,
                        StandardErrorOf(solution.variance() * channel.fit.inverse(at, at)) / segment.scale});
    }
  }
}

// The number that names a family of lines.
std::string OrderName(VibrationCause cause) {
  switch (cause) {
    case VibrationCause::kGearMesh:
    case VibrationCause::kToothEngagement:
      return "mesh_order";
    case VibrationCause::kBearingDefect:
      return "defect_order";
    case VibrationCause::kFlexsplineCrack:
      return "crack_order";
    case VibrationCause::kLineOverAngle:
      return "order_per_input_turn";
    case VibrationCause::kImbalance:
    case VibrationCause::kTorsionalResonance:
    case VibrationCause::kLineOverTime:
    case VibrationCause::kHighResonance:
    case VibrationCause::kBurst:
    case VibrationCause::kSlowChange:
      break;
  }
  return "order";
}

// No fit shows how far the angle's own scale is off.
double WithAngle(double order, double error) { return std::hypot(error, kUnseenWander * order); }

void AddLineNumbers(const VibrationSamples& samples, const VibrationSolution& solution, std::size_t t,
                    VibrationCause cause, const MatrixXd& nonlinear_parameters,
                    Index first_nonlinear_parameter, std::vector<ParameterValue>& values) {
  const VibrationTerm& term = solution.terms[t];
  const double base = term.nonlinear_parameters.empty() ? 1.0 : term.nonlinear_parameters[0];
  const double error =
      !term.nonlinear_parameters.empty() && nonlinear_parameters.size() > 0
          ? StandardErrorOf(nonlinear_parameters(first_nonlinear_parameter, first_nonlinear_parameter))
          : 0.0;
  // Gains that follow the speed come after those that do not: an amplitude is that over all speeds.
  const auto steady = static_cast<std::size_t>(std::ranges::count(term.lines, 0, &LineOrder::speed_power));
  const LargestAmplitude largest = LargestPair(samples, solution, t, 0, steady, nonlinear_parameters);
  double named = base;
  double named_error = error;
  if (cause == VibrationCause::kGearMesh) {
    // The stronger one of the two mesh orders.
    const double flexspline = model::FlexsplineMeshOrder(samples.ratio);
    const LineOrder& line = term.lines[largest.pair];
    const double order = line.harmonic * base + line.offset;
    const double teeth =
        std::abs(order - flexspline) < 1.5 ? flexspline : model::CircularSplineMeshOrder(samples.ratio);
    named = teeth * (term.nonlinear_parameters.empty() ? 1.0 : base);
    named_error = teeth * error;
  } else if ((cause == VibrationCause::kFlexsplineCrack || cause == VibrationCause::kToothEngagement) &&
             term.nonlinear_parameters.empty()) {
    named = model::CrackOrder(samples.ratio);
  }
  if (named_error > 0.0) named_error = WithAngle(named, named_error);
  values.push_back({OrderName(cause), "1/turn", named, named_error});
  if (cause == VibrationCause::kLineOverAngle) {
    const double turn_Hz = samples.runs.front().mean_speed_rad_per_s / kTwoPi;
    values.push_back({"mean_frequency_Hz", "Hz", named * turn_Hz, named_error * turn_Hz});
  }
  values.push_back({AmplitudeName(samples), UnitOfChannel(ChannelAt(samples, largest.channel).name),
                    largest.polar.amplitude, largest.polar.amplitude_error});
  if (term.lines.size() < 2 && cause == VibrationCause::kLineOverAngle) return;
  for (std::size_t l = 0; l < term.lines.size(); ++l) {
    values.push_back({fmt::format("line_{}", l + 1), "1/turn",
                      term.lines[l].harmonic * base + term.lines[l].offset,
                      std::abs(term.lines[l].harmonic) * error});
    if (term.lines[l].speed_power > 0)
      values.push_back({fmt::format("line_{}_speed_power", l + 1), "1",
                        static_cast<double>(term.lines[l].speed_power), 0.0});
  }
}

}  // namespace

std::string CoefficientName(const VibrationTerm& term, Index column, const std::string& channel) {
  if (term.form == VibrationForm::kLevels) return fmt::format("power_{}_{}", column + 1, channel);
  if (!HasPairs(term.form)) return "gain_" + channel;
  return fmt::format("{}_{}_{}", column % 2 == 0 ? "cosine" : "sine", column / 2 + 1, channel);
}

std::string UnitOfChannel(const std::string& channel) {
  struct Ending {
    const char* ending;
    const char* unit;
  };
  constexpr Ending kEndings[] = {{"_m_per_s2", "m/s^2"}, {"_rad_per_s", "rad/s"}, {"_mm_per_s", "mm/s"},
                                 {"_m_per_s", "m/s"},    {"_Nm", "Nm"},           {"_A", "A"}};
  for (const Ending& ending : kEndings) {
    const std::size_t suffix = channel.rfind(ending.ending);
    // The number of the record may stand behind the unit.
    if (suffix != std::string::npos && suffix + std::string(ending.ending).size() + 4 >= channel.size())
      return ending.unit;
  }
  return {};
}

std::string AmplitudeName(const VibrationSamples& samples) {
  return UnitOfChannel(samples.runs.front().channels.front().name) == "m/s^2" ? "amplitude_m_per_s2"
                                                                              : "amplitude";
}

std::vector<ParameterValue> DescribeNominal(const VibrationSamples& samples,
                                            const VibrationSolution& solution) {
  std::vector<ParameterValue> values;
  for (std::size_t c = 0; c < solution.channels.size(); ++c) {
    const VibrationSegment& segment = ChannelAt(samples, c);
    const std::string unit = UnitOfChannel(segment.name);
    const ChannelFit& fit = solution.channels[c].fit;
    values.push_back({"mean_" + segment.name, unit, fit.coefficients(0) / segment.scale,
                      StandardErrorOf(solution.variance() * fit.inverse(0, 0)) / segment.scale});
    if (!samples.angle_known()) continue;
    for (const char* which : {"first", "second"}) {
      const Polar polar = PolarAt(samples, solution, c, which[0] == 'f' ? 1 : 3, {});
      values.push_back({fmt::format("{}_amplitude_{}", which, segment.name), unit, polar.amplitude,
                        polar.amplitude_error});
      values.push_back({fmt::format("{}_phase_deg_{}", which, segment.name), "deg",
                        DegFromRad(polar.phase_rad), DegFromRad(polar.phase_error_rad)});
    }
  }
  return values;
}

std::vector<ParameterValue> DescribeTerm(const VibrationSamples& samples, const VibrationSolution& solution,
                                         std::size_t t, VibrationCause cause,
                                         const MatrixXd& nonlinear_parameters) {
  const VibrationTerm& term = solution.terms[t];
  Index first_nonlinear_parameter = 0;
  for (std::size_t before = 0; before < t; ++before) {
    first_nonlinear_parameter += static_cast<Index>(solution.terms[before].nonlinear_parameters.size());
  }
  std::vector<ParameterValue> values;
  const auto add_nonlinear_parameter = [&](std::size_t s, const std::string& name, const std::string& unit) {
    const Index parameter = first_nonlinear_parameter + static_cast<Index>(s);
    values.push_back({name, unit, term.nonlinear_parameters[s],
                      nonlinear_parameters.size() > 0
                          ? StandardErrorOf(nonlinear_parameters(parameter, parameter))
                          : 0.0});
  };
  const auto add_amplitude = [&](std::size_t pairs, const std::string& name) {
    const LargestAmplitude largest = LargestPair(samples, solution, t, 0, pairs, nonlinear_parameters);
    values.push_back({name, UnitOfChannel(ChannelAt(samples, largest.channel).name), largest.polar.amplitude,
                      largest.polar.amplitude_error});
    return largest;
  };
  switch (term.form) {
    case VibrationForm::kLines:
      AddLineNumbers(samples, solution, t, cause, nonlinear_parameters, first_nonlinear_parameter, values);
      break;
    case VibrationForm::kTones:
      add_nonlinear_parameter(0, "frequency_Hz", "Hz");
      add_amplitude(1, AmplitudeName(samples));
      break;
    case VibrationForm::kImpulseTrain:
      add_nonlinear_parameter(0, OrderName(cause), "1/turn");
      values.back().standard_error = std::hypot(WithAngle(values.back().value, values.back().standard_error),
                                                OrderErrorOfSlips(samples, term));
      add_amplitude(1, AmplitudeName(samples));
      add_nonlinear_parameter(1, "ring_Hz", "Hz");
      add_nonlinear_parameter(2, "ring_decay_ratio", "1");
      if (!term.slips.empty()) values.push_back({"slip_share", "1", SlipShareOf(term.slips), 0.0});
      for (std::size_t m = 0; m < term.lines.size(); ++m) {
        values.push_back({"modulated_per_turn", "1/turn", term.lines[m].offset, 0.0});
        add_nonlinear_parameter(3 + 2 * m, "modulation_cosine", "1");
        add_nonlinear_parameter(4 + 2 * m, "modulation_sine", "1");
      }
      for (std::size_t r = 0; r < samples.runs.size(); ++r) {
        add_nonlinear_parameter(3 + 2 * term.lines.size() + r, fmt::format("place_{}_turns", r + 1), "1");
      }
      break;
    case VibrationForm::kPulses: {
      values.push_back({OrderName(cause), "1/turn", term.lines[0].offset, 0.0});
      add_amplitude(1, AmplitudeName(samples));
      std::size_t s = 0;
      if (WidthIsNonlinearParameter(term)) {
        add_nonlinear_parameter(s++, "pulse_width", "1");
      } else {
        values.push_back({"pulse_width", "1", term.lines[0].harmonic, 0.0});
      }
      if (term.lines.size() > 1) {
        values.push_back({"modulated_per_turn", "1/turn", term.lines[1].offset, 0.0});
        add_nonlinear_parameter(s++, "modulation_cosine", "1");
        add_nonlinear_parameter(s++, "modulation_sine", "1");
      }
      for (std::size_t r = 0; r < samples.runs.size(); ++r)
        add_nonlinear_parameter(s + r, fmt::format("place_{}_turns", r + 1), "1");
      break;
    }
    case VibrationForm::kGrowth: {
      const LargestAmplitude largest = add_amplitude(1, AmplitudeName(samples));
      values.back().name =
          "amplitude_at_1000_rpm" + values.back().name.substr(std::string("amplitude").size());
      values.push_back({"phase_deg", "deg", DegFromRad(largest.polar.phase_rad),
                        DegFromRad(largest.polar.phase_error_rad)});
      break;
    }
    case VibrationForm::kDriven:
      add_nonlinear_parameter(0, "frequency_Hz", "Hz");
      add_nonlinear_parameter(1, "damping_ratio", "1");
      add_amplitude(term.lines.size(), AmplitudeName(samples));
      for (std::size_t l = 0; l < term.lines.size(); ++l) {
        values.push_back({fmt::format("line_{}", l + 1), "1/turn", term.lines[l].harmonic, 0.0});
      }
      break;
    case VibrationForm::kNarrowband:
      add_nonlinear_parameter(0, "frequency_Hz", "Hz");
      add_nonlinear_parameter(1, "damping_ratio", "1");
      values.push_back(
          NarrowAmplitude(samples, solution, t, nonlinear_parameters, first_nonlinear_parameter));
      for (std::size_t c = 0; c < term.observable.size(); ++c) {
        if (term.observable[c] == 0) continue;
        const VibrationSegment& segment = ChannelAt(samples, c);
        values.push_back({"deviation_" + segment.name, UnitOfChannel(segment.name),
                          term.nonlinear_parameters[2 + c] * samples.noise_floor / segment.scale, 0.0});
      }
      return values;
    case VibrationForm::kTransients:
      add_nonlinear_parameter(0, "frequency_Hz", "Hz");
      add_nonlinear_parameter(1, "damping_ratio", "1");
      add_amplitude(1, AmplitudeName(samples));
      add_nonlinear_parameter(2, "knock_1_s", "s");
      for (std::size_t k = 3; k + 1 < term.nonlinear_parameters.size(); k += 2) {
        add_nonlinear_parameter(k, fmt::format("knock_{}_s", (k + 1) / 2), "s");
        add_nonlinear_parameter(k + 1, fmt::format("knock_{}_height", (k + 1) / 2), "1");
      }
      break;
    case VibrationForm::kBurst:
      add_nonlinear_parameter(0, "frequency_Hz", "Hz");
      add_nonlinear_parameter(1, "centre_s", "s");
      add_nonlinear_parameter(2, "width_s", "s");
      add_amplitude(1, AmplitudeName(samples));
      break;
    case VibrationForm::kLevels:
      break;
  }
  AddCoefficients(samples, solution, t, values);
  return values;
}

}  // namespace strainwave::analysis::diagnosis
