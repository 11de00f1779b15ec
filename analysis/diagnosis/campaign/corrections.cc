// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/campaign/causes.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

// Courses without a meaning of their own, numbered.
std::vector<SeriesNumber> Numbered(std::size_t count) {
  std::vector<SeriesNumber> numbers;
  for (std::size_t k = 1; k <= count; ++k) {
    numbers.push_back(
        {.what = std::string(kCurvePart) + std::to_string(k), .per = "", .unit_per = "", .factor = 1.0});
  }
  return numbers;
}

CauseRule NuisanceTerm(const CampaignLayout& layout, const SeriesChoice& choice, const std::string& name,
                       std::size_t freedom, double trials_factor, bool local) {
  return {.name = name + choice.Suffix(layout),
          .sentence = "a shape without a cause: " + name + choice.Suffix(layout),
          .where = Where::kUndecided,
          .effect = "",
          .parameters = {},
          .degrees_of_freedom = static_cast<int>(freedom),
          .trials_factor = choice.TrialsFactor(layout, trials_factor),
          .local = local,
          .named = false,
          .to_settle = ""};
}

void AddSmooth(const LayoutPointer& layout, SeparableModel& model) {
  // From the second cosine on: constant and trend are the wear model's.
  constexpr std::size_t kCourses = 5;
  for (const SeriesChoice& choice : ChoicesOf(*layout)) {
    SeparableTerm term =
        SeriesTerm(layout, choice, kCourses, [layout](std::span<const double>, Eigen::MatrixXd& course) {
          for (Index c = 0; c < course.rows(); ++c) {
            for (Index k = 0; k < course.cols(); ++k) {
              course(c, k) = std::cos(static_cast<double>(k + 2) * kPi *
                                      layout->load_share[static_cast<std::size_t>(c)]);
            }
          }
        });
    DescribeSeries(term, layout, choice, Numbered(kCourses), {});
    model.causes.push_back(std::move(term));
    model.rules.push_back(NuisanceTerm(*layout, choice, "smooth function of load time",
                                       kCourses * choice.series.size(), 1.0, false));
  }
}

void AddTemperatureCurve(const LayoutPointer& layout, SeparableModel& model) {
  if (layout->temperature_degC.empty()) return;
  const auto [low, high] =
      std::minmax_element(layout->temperature_degC.begin(), layout->temperature_degC.end());
  if (*high - *low < 1.0) return;
  const double centre = 0.5 * (*low + *high);
  const double half = 0.5 * (*high - *low);
  constexpr std::size_t kCourses = 3;
  for (const SeriesChoice& choice : ChoicesOf(*layout)) {
    SeparableTerm term = SeriesTerm(
        layout, choice, kCourses, [layout, centre, half](std::span<const double>, Eigen::MatrixXd& course) {
          for (Index c = 0; c < course.rows(); ++c) {
            const double x = (layout->temperature_degC[static_cast<std::size_t>(c)] - centre) / half;
            course(c, 0) = x;
            course(c, 1) = x * x;
            course(c, 2) = x * x * x;
          }
        });
    DescribeSeries(term, layout, choice, Numbered(kCourses), {});
    model.causes.push_back(std::move(term));
    model.rules.push_back(NuisanceTerm(*layout, choice, "smooth function of temperature",
                                       kCourses * choice.series.size(), 1.0, false));
  }
}

void AddLine(const LayoutPointer& layout, SeparableModel& model) {
  const std::vector<double>& time = layout->time_s.empty() ? layout->load_time_s : layout->time_s;
  const double span = time.back() - time.front();
  if (!(span > 0.0)) return;
  // Slower than three periods in the campaign is a curve, not a line.
  const double lowest = 3.0 * kTwoPi / span;
  const double highest = 0.5 * kTwoPi * static_cast<double>(layout->cycles() - 1) / span;
  if (highest <= lowest) return;
  const NonlinearParameterRange range{lowest, highest, 0.2 * kTwoPi / span};
  const double independent = (highest - lowest) * span / kTwoPi;
  for (const SeriesChoice& choice : ChoicesOf(*layout)) {
    SeparableTerm term = SeriesTerm(
        layout, choice, 2, [time](std::span<const double> nonlinear_parameters, Eigen::MatrixXd& course) {
          for (Index c = 0; c < course.rows(); ++c) {
            const double angle = nonlinear_parameters[0] * (time[static_cast<std::size_t>(c)] - time.front());
            course(c, 0) = std::cos(angle);
            course(c, 1) = std::sin(angle);
          }
        });
    term.nonlinear_parameters = {range};
    DescribeSeries(term, layout, choice, Numbered(2), {{"rate_rad_per_s", "rad/s", 1.0, false}});
    term.starts = [layout, term, time, range](const WeightedResidual& residual) {
      // The strongest lines of each mixture, judged together.
      std::vector<std::vector<double>> rates;
      for (std::size_t s = 0; s < layout->segments.size(); ++s) {
        const std::size_t first = layout->segments[s];
        const std::size_t last =
            s + 1 < layout->segments.size() ? layout->segments[s + 1] : layout->measured.size();
        std::vector<double> at;
        for (std::size_t i = first; i < last; ++i) at.push_back(time[layout->cycle_of[i]] - time.front());
        for (const LinePeak& peak :
             FindLines(at, residual.values.subspan(first, last - first),
                       residual.weights.subspan(first, last - first), range.low, range.high, 2)) {
          rates.push_back({std::clamp(peak.order, range.low, range.high)});
        }
      }
      return BestCandidates(*layout, term, residual, rates, 2);
    };
    model.causes.push_back(std::move(term));
    model.rules.push_back(
        NuisanceTerm(*layout, choice, "line over time", 2 * choice.series.size() + 1, independent, false));
  }
}

// A deviation that comes and goes again, between a bump and a window: flat on top, e^(−ln 2) at the width's
// ends.
void AddPassing(const LayoutPointer& layout, SeparableModel& model) {
  const double cycles = static_cast<double>(layout->cycles());
  constexpr double kNarrowest = 2.0;
  const double widest = 0.5 * cycles;
  std::vector<std::vector<double>> locations;
  for (double width = 3.0; width <= 0.4 * cycles; width *= 1.6) {
    for (double centre = 0.5 * width; centre <= cycles - 0.5 * width; centre += std::max(1.0, 0.3 * width)) {
      locations.push_back({centre, width});
    }
  }
  const double trials_factor = static_cast<double>(locations.size());
  // Long campaigns: the search is coarser than the count that the p-value pays for, and the fit moves it.
  constexpr std::size_t kSearched = 300;
  const std::size_t stride = locations.size() / kSearched + 1;
  for (const SeriesChoice& choice : ChoicesOf(*layout)) {
    SeparableTerm term = SeriesTerm(
        layout, choice, 1, [](std::span<const double> nonlinear_parameters, Eigen::MatrixXd& course) {
          for (Index c = 0; c < course.rows(); ++c) {
            const double x =
                2.0 * (static_cast<double>(c) + 0.5 - nonlinear_parameters[0]) / nonlinear_parameters[1];
            course(c, 0) = std::exp2(-x * x * x * x);
          }
        });
    term.nonlinear_parameters = {{0.0, cycles, 1.0}, {kNarrowest, widest, 1.0}};
    DescribeSeries(term, layout, choice, Numbered(1),
                   {{"centre_cycle", "1", 1.0, true}, {"width_cycles", "1", 1.0, false}});
    term.starts = [layout, term, locations, stride](const WeightedResidual& residual) {
      std::vector<std::vector<double>> coarse;
      for (std::size_t i = 0; i < locations.size(); i += stride) coarse.push_back(locations[i]);
      return BestCandidates(*layout, term, residual, coarse, 2);
    };
    model.causes.push_back(std::move(term));
    model.rules.push_back(
        NuisanceTerm(*layout, choice, "passing deviation", choice.series.size() + 2, trials_factor, true));
  }
}

void AddOtherRunIn(const LayoutPointer& layout, SeparableModel& model) {
  const SeriesChoice all = ChoicesOf(*layout).front();
  const double shortest = std::max(0.003, 3.0 / static_cast<double>(layout->cycles()));
  const NonlinearParameterRange range{shortest, 0.5, 0.2 * layout->run_in_share};
  SeparableTerm term = SeriesTerm(
      layout, all, 1, [layout](std::span<const double> nonlinear_parameters, Eigen::MatrixXd& course) {
        for (Index c = 0; c < course.rows(); ++c) {
          course(c, 0) = std::exp(-layout->load_share[static_cast<std::size_t>(c)] / nonlinear_parameters[0]);
        }
      });
  term.nonlinear_parameters = {range};
  DescribeSeries(term, layout, all, Numbered(1), {{"run_in_h", "h", layout->load_span_s / 3600.0, false}});
  term.starts = [layout, term, range](const WeightedResidual& residual) {
    std::vector<std::vector<double>> shares;
    for (double share = range.low; share <= range.high; share *= 1.5) {
      // Next to the one that is there already the two are one.
      if (std::abs(std::log(share / layout->run_in_share)) > 0.3) shares.push_back({share});
    }
    return BestCandidates(*layout, term, residual, shares, 2);
  };
  model.causes.push_back(std::move(term));
  model.rules.push_back(
      NuisanceTerm(*layout, all, "run-in of another length", all.series.size() + 1, 3.0, false));
}

}  // namespace

void AddCampaignNuisanceTerms(const LayoutPointer& layout, SeparableModel& model) {
  AddSmooth(layout, model);
  AddTemperatureCurve(layout, model);
  AddLine(layout, model);
  AddPassing(layout, model);
  AddOtherRunIn(layout, model);
}

}  // namespace strainwave::analysis::diagnosis
