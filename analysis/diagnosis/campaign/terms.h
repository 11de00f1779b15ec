// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "analysis/diagnosis/campaign/layout.h"
#include "analysis/diagnosis/separable_study.h"

namespace strainwave::analysis::diagnosis {

using LayoutPointer = std::shared_ptr<const CampaignLayout>;

/// Fills cycles × k with the course of a term over the campaign; each series that the term acts on gets k
/// coefficients of its own.
using CourseFill = std::function<void(std::span<const double> nonlinear_parameters, Eigen::MatrixXd& course)>;

/// Which series a term acts on: all, or a single one.
struct SeriesChoice {
  std::vector<std::size_t> series;
  bool single{};

  /// " of k2_Nm_per_rad" for a single one, else empty.
  std::string Suffix(const CampaignLayout& layout) const;
  /// Search locations, more for a single series whose scatter is known from few cycles.
  double TrialsFactor(const CampaignLayout& layout, double search_locations) const;
};

/// All series together, then each one alone; only the one where there is only one.
std::vector<SeriesChoice> ChoicesOf(const CampaignLayout& layout);

/// A number that people read, made of one coefficient: its name in a series, and its size per scaled unit.
struct SeriesNumber {
  std::string what;      // "step"
  std::string per;       // "per_1000h", "" for none
  std::string unit_per;  // "/(1000 h)", "" for none
  double factor{1.0};
};

/// A shape that people read; `cycle` marks a row of the campaign, shown as the cycle's number.
struct NonlinearParameterNumber {
  std::string name;
  std::string unit;
  double factor{1.0};
  bool cycle{};
};

inline constexpr double kAnySize = std::numeric_limits<double>::infinity();

/// Rules for the sizes of a term. A single series' one has to be away from zero; of all together the
/// likelihood decides.
void AddSizeRules(const CampaignLayout& layout, const SeriesChoice& choice, const SeriesNumber& number,
                  CauseRule& rule);

/// Term with one column a series and course column, in the order of the choice, course by course.
SeparableTerm SeriesTerm(const LayoutPointer& layout, const SeriesChoice& choice, std::size_t courses,
                         CourseFill fill);

/// Describes each coefficient (`numbers`: one a course) and shape by itself.
void DescribeSeries(SeparableTerm& term, const LayoutPointer& layout, const SeriesChoice& choice,
                    std::vector<SeriesNumber> numbers,
                    std::vector<NonlinearParameterNumber> nonlinear_parameters);

/// Describes two courses (cosine, sine) a series as amplitude and phase.
void DescribeSeriesAsHarmonic(SeparableTerm& term, const LayoutPointer& layout, const SeriesChoice& choice);

/// The `count` candidates that would take most from a residual, the wear model refitted beside each.
std::vector<std::vector<double>> BestCandidates(const CampaignLayout& layout, const SeparableTerm& term,
                                                const WeightedResidual& residual,
                                                const std::vector<std::vector<double>>& candidates,
                                                std::size_t count);

}  // namespace strainwave::analysis::diagnosis
