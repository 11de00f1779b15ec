// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "analysis/diagnosis/motion/delay.h"
#include "analysis/diagnosis/motion/grid.h"
#include "analysis/diagnosis/motion/impacts.h"
#include "analysis/diagnosis/motion/samples.h"
#include "analysis/diagnosis/motion/settled_grid.h"
#include "analysis/diagnosis/motion/simulated_axis.h"
#include "analysis/diagnosis/motion/terms.h"
#include "analysis/diagnosis/motion/units.h"
#include "analysis/diagnosis/records.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Standard errors of the inertia from which on causes that live of the acceleration can be judged.
constexpr double kAccelerates = 10.0;
// Held out are parts of a move, longer than the autocorrelation of noise: a speed that comes in one move
// only, or the one impact that tells a gap's width, is not predicted by the rest of the record, which says
// nothing of it.
constexpr std::size_t kBlocks = 60;
constexpr std::size_t kFewestInBlock = 12;
constexpr std::uint64_t kDrawsApart = 1000;  // of simulated records that belong together

void AddRegressors(const MotionGrid& grid, const MotionUnits& units, SeparableModel& model) {
  const auto at_rows = [&](const std::vector<double>& points) {
    std::vector<double> values;
    values.reserve(grid.rows());
    for (const std::size_t point : grid.point_of_row) values.push_back(points[point]);
    return values;
  };
  model.regressors.push_back({.name = "position",
                              .title = units.linear ? "position / mm" : "position / deg",
                              .per_unit = units.linear ? 1e3 : DegFromRad(1.0),
                              .values = at_rows(grid.position),
                              .angle = !units.linear});
  model.regressors.push_back(
      {.name = "speed",
       .title = "velocity / " + (units.linear ? std::string("mm/s") : std::string("rpm")),
       .per_unit = units.linear ? 1e3 : RpmFromRadPerS(1.0),
       .values = at_rows(grid.velocity)});
  model.regressors.push_back({.name = "acceleration",
                              .title = units.linear ? "acceleration / m/s²" : "acceleration / rad/s²",
                              .values = at_rows(grid.passed_acceleration)});
  // As the nominal model has it: the measured one holds the same noise as what is left, and would explain it.
  const Eigen::VectorXd torque = grid.nominal * grid.prefit;
  model.regressors.push_back({.name = "torque",
                              .title = units.linear ? "force / N" : "torque / Nm",
                              .values = std::vector<double>(torque.begin(), torque.end())});
  model.regressors.push_back({.name = "time", .title = "time / s", .values = at_rows(grid.time_s)});
  model.regressors.push_back({.name = "direction", .title = "direction", .values = at_rows(grid.direction)});
  if (!grid.temperature_degC.empty()) {
    model.regressors.push_back(
        {.name = "temperature", .title = "temperature / °C", .values = at_rows(grid.temperature_degC)});
  }
}

// The shortest of all segments.
double SamplingStep_s(const MotionSamples& samples) {
  return std::ranges::min_element(samples.segments, {}, &EvenSegment::step_s)->step_s;
}

}  // namespace

std::unique_ptr<Study> MakeMotionStudy(std::span<const MotionData> records) {
  const MotionSamples samples = KeepImpacts(records, PrepareMotion(records));
  const auto [grid, delay] = MakeSettledGrid(samples);
  const MotionUnits units{samples.linear};
  SeparableModel model;
  model.measured = grid->measured;
  model.segments = grid->response_segments;
  model.weights = grid->weights;
  model.warnings = samples.warnings;
  model.unit = units.torque();
  model.noise_floor = grid->noise_floor;
  model.filtered_out_variance = grid->filtered_out_variance;
  model.block_length = std::max(kFewestInBlock, grid->rows() / kBlocks);
  // The torque's own were left out before the low-pass; a lone row is a reversal that comes late.
  model.spikes_are_outliers = false;
  if (grid->prefit(0) < -kAccelerates * grid->inertia_error) {
    model.warnings.push_back(
        fmt::format("the {} comes out negative: the position or the {} has the other sign",
                    samples.linear ? "mass" : "inertia", samples.linear ? "force" : "torque"));
  }
  if (samples.inertia) {
    const std::string warning =
        InertiaWarning(grid->prefit(0), *samples.inertia, grid->inertia_error, samples.linear);
    if (!warning.empty()) model.warnings.push_back(warning);
  }
  if (const double way = MeanWay(grid->reversal_smoothing); way > 0.0) {
    model.warnings.push_back(fmt::format(
        "friction changes its sign over a way of about {:.2g} {} (presliding), not at once: taken "
        "into the nominal model",
        way, units.position()));
  }
  AddNominalMotion(grid, units, model);
  AddFrictionCauses(grid, units, model);
  AddPositionCauses(grid, units, model);
  if (std::abs(grid->prefit(0)) > kAccelerates * grid->inertia_error) {
    AddLoadCause(grid, units, model);
    AddDynamicCauses(grid, units, model);
    AddDelayCause(grid, delay.delay_s, SamplingStep_s(samples), units, model);
  } else {
    model.warnings.push_back(
        "no verdict on load_dependent_friction, torsional_resonance, backlash and time_delay: the motion "
        "hardly accelerates");
  }
  AddDisturbanceCause(grid, units, model);
  AddMotionNuisanceTerms(grid, units, model);
  AddRegressors(*grid, units, model);
  return std::make_unique<SeparableStudy>(std::move(model));
}

SimulateNull SimulateMotion(std::vector<MotionData> records) {
  return [records = std::move(records)](std::span<const ParameterValue> nominal,
                                        std::uint64_t draw) -> std::unique_ptr<Study> {
    const auto number = [&](std::string_view begin) {
      const auto found = std::ranges::find_if(
          nominal, [&](const ParameterValue& value) { return value.name.starts_with(begin); });
      return found == nominal.end() ? 0.0 : found->value;
    };
    const AxisNumbers numbers{number("inertia_") + number("mass_"), number("viscous_"), number("coulomb_"),
                              number("offset_")};
    std::vector<MotionData> simulated;
    for (const MotionData& record : records) {
      auto one = SimulateAxis(record, numbers, draw * kDrawsApart + simulated.size());
      if (!one) return nullptr;
      simulated.push_back(std::move(*one));
    }
    try {
      return MakeMotionStudy(simulated);
    } catch (const std::invalid_argument&) {
      return nullptr;
    }
  };
}

}  // namespace strainwave::analysis::diagnosis
