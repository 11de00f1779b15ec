// SPDX-License-Identifier: Apache-2.0
// The order spectrum of what the simulation misses, with the orders that have a name.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "analysis/diagnosis/residual_views.h"
#include "analysis/diagnosis/residuals.h"
#include "analysis/harmonic_regression.h"
#include "analysis/transmission_orders.h"
#include "analysis/units.h"
#include "bench/diagnosis/diagnosis_pictures.h"
#include "bench/diagnosis/picture_frame.h"
#include "bench/diagnosis/residual_views.h"
#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;
using diagnosis::Regressor;

constexpr double kMostOrders = 4000.0;
constexpr double kMostWork = 3e8;  // samples × orders: a second or two
constexpr std::size_t kOrdersListed = 9;

// What the spectrum runs over: an angle, in turns, or time, in seconds.
struct Axis {
  const Regressor* over{};
  std::string title;
  std::string unit;  // of the list's numbers: "per output turn", "Hz"
  std::vector<double> angle_rad;
  double lowest{};
  double step{};
  std::size_t count{};
  double folding{};  // orders this far apart look the same; 0: they do not
  double end{};      // beyond it the samples tell nothing
  double left{};     // where the picture begins

  double OrderAt(std::size_t k) const { return lowest + step * static_cast<double>(k); }
  double highest() const { return OrderAt(count - 1); }
  double Seen(double order) const {
    return folding > 0.0 ? std::abs(order - folding * std::round(order / folding)) : order;
  }
};

double MedianStep(std::span<const double> angle_rad, std::span<const std::size_t> segments) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < angle_rad.size(); ++i) {
    if (std::ranges::binary_search(segments, i)) continue;
    const double step = std::abs(angle_rad[i] - angle_rad[i - 1]);
    if (step > 0.0) steps.push_back(step);
  }
  if (steps.empty()) return 0.0;
  std::ranges::nth_element(steps, steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2));
  return steps[steps.size() / 2];
}

Axis AxisOf(const DiagnosisReport& report) {
  const diagnosis::Study& study = *report.input.study;
  const std::vector<Regressor>& regressors = study.regressors();
  // An angle that goes hardly anywhere has no orders.
  const auto turns = [](const Regressor& regressor) {
    const auto [low, high] = std::ranges::minmax(regressor.values);
    return regressor.angle && high - low > 0.5 * kTwoPi;
  };
  auto found = std::ranges::find_if(regressors, [&](const Regressor& regressor) {
    return regressor.name == "output_angle" && turns(regressor);
  });
  if (found == regressors.end()) found = std::ranges::find_if(regressors, turns);
  if (found == regressors.end()) found = std::ranges::find(regressors, "time", &Regressor::name);
  Axis axis;
  if (found != regressors.end()) {
    axis.over = &*found;
    axis.angle_rad = found->values;
  } else {
    axis.angle_rad.resize(study.measured().size());
    std::iota(axis.angle_rad.begin(), axis.angle_rad.end(), 0.0);
  }
  if (axis.over != nullptr && axis.over->angle) {
    axis.unit = "per " + diagnosis::TurnOf(*axis.over);
    axis.title = "order " + axis.unit;
    axis.folding = diagnosis::FoldingOrder(axis.angle_rad, report.result.weights);
  } else {
    const bool is_time = axis.over != nullptr && axis.over->title.ends_with("/ s");
    axis.unit = is_time ? "Hz" : "per sample";
    axis.title = is_time ? "frequency (Hz)" : "periods per sample";
    for (double& place : axis.angle_rad) place *= kTwoPi;
  }
  const auto [low, high] = std::ranges::minmax(axis.angle_rad);
  const double cell = kTwoPi / std::max(high - low, 1e-12);
  const double step = MedianStep(axis.angle_rad, study.segments());
  axis.end = (step > 0.0 ? kPi / step : 100.0 * cell) - 0.5 * cell;
  axis.lowest = 0.5 * cell;
  axis.step = 0.25 * cell;
  const double affordable = kMostWork / static_cast<double>(axis.angle_rad.size());
  axis.count = static_cast<std::size_t>(
      std::clamp((axis.end - axis.lowest) / axis.step + 1.0, 8.0, std::min(kMostOrders, affordable)));
  return axis;
}

// Turns of the axis' angle a second.
double TurnsPerSecond(const DiagnosisReport& report, const Axis& axis) {
  const diagnosis::Study& study = *report.input.study;
  const auto time = std::ranges::find(study.regressors(), "time", &Regressor::name);
  if (time == study.regressors().end()) return 0.0;
  double turns = 0.0;
  double seconds = 0.0;
  for (std::size_t i = 1; i < axis.angle_rad.size(); ++i) {
    if (std::ranges::binary_search(study.segments(), i)) continue;
    turns += std::abs(axis.angle_rad[i] - axis.angle_rad[i - 1]) / kTwoPi;
    seconds += time->values[i] - time->values[i - 1];
  }
  return seconds > 0.0 ? turns / seconds : 0.0;
}

// An order with a name, for the list beside the spectrum.
struct NamedOrder {
  double order{};
  double seen{};
  std::string name;
};

std::vector<NamedOrder> FoundOrders(const DiagnosisReport& report, const Axis& axis) {
  const bool over_angle = axis.over != nullptr && axis.over->angle;
  std::vector<NamedOrder> orders;
  const auto add = [&](double order, std::string name) {
    orders.push_back({order, axis.Seen(order), std::move(name)});
  };
  for (const auto* findings : {&report.result.causes, &report.result.nuisance_terms}) {
    for (const diagnosis::Finding& finding : *findings) {
      const std::string& cause = report.input.study->causes()[finding.index].name;
      std::string every;  // what rings has its lines an order apart
      for (const diagnosis::ParameterValue& parameter : finding.parameters) {
        if (over_angle && (parameter.name.starts_with("order") || parameter.name.ends_with("_order"))) {
          add(parameter.value, cause + " (found)");
          every = fmt::format(", a line every {:.4g}", parameter.value);
        } else if (over_angle && parameter.name == "ring_Hz") {
          const double turns_per_s = TurnsPerSecond(report, axis);
          if (turns_per_s > 0.0) add(parameter.value / turns_per_s, cause + " rings" + every);
        } else if (axis.unit == "Hz" && parameter.name == "frequency_Hz") {
          add(parameter.value, cause + " (found)");
        }
      }
    }
  }
  return orders;
}

// Of a long record not all orders can be had: what was found, or the ring in which it is observable, is to be
// among them.
void MoveTo(const std::vector<NamedOrder>& found, Axis& axis) {
  constexpr double kRoom = 1.15;
  double furthest = 0.0;
  for (const NamedOrder& order : found) {
    if (order.seen < axis.end) furthest = std::max(furthest, order.seen);
  }
  if (furthest <= axis.highest()) return;
  axis.lowest += std::min(kRoom * furthest, axis.end) - axis.highest();
  axis.left = axis.lowest;
}

std::vector<NamedOrder> NamedOrdersOf(const DiagnosisReport& report, const Axis& axis,
                                      std::vector<NamedOrder> orders) {
  if (report.input.kind == StudyKind::kTransmissionError && axis.over != nullptr) {
    for (const auto& known : analysis::KnownOrders(report.input.mapping.ratio)) {
      orders.push_back({known.order, axis.Seen(known.order), known.name});
    }
  }
  if (report.input.kind == StudyKind::kVibration && axis.over != nullptr && axis.over->angle) {
    orders.push_back({1.0, axis.Seen(1.0), "shaft"});
    orders.push_back({2.0, axis.Seen(2.0), "shaft, twice"});
  }
  // What is off the picture needs no mark.
  std::erase_if(
      orders, [&](const NamedOrder& order) { return order.seen > axis.highest() || order.seen < axis.left; });
  std::ranges::stable_sort(orders, {}, &NamedOrder::seen);
  if (orders.size() > kOrdersListed) orders.resize(kOrdersListed);
  return orders;
}

double HighestNear(const std::vector<double>& amplitude, const Axis& axis, double order) {
  double highest = 0.0;
  for (std::size_t k = 0; k < axis.count; ++k) {
    // Half a resolution cell either way.
    if (std::abs(axis.OrderAt(k) - order) <= 2.1 * axis.step) highest = std::max(highest, amplitude[k]);
  }
  return highest;
}

std::string ListEntry(const std::string& text, double x, double y, std::string_view side,
                      std::string_view colour) {
  return fmt::format("set label {} at screen {:.4f},{:.4f} {} font ',13' textcolor rgb '{}'\n", Quoted(text),
                     x, y, side, colour);
}

// Numbers above the marks; neighbours that would overprint each other share one.
std::string Marks(const std::vector<NamedOrder>& orders, double left, double right, double top) {
  const double range = right - left;
  std::string commands;
  for (std::size_t i = 0; i < orders.size();) {
    std::string text;
    const double from = orders[i].seen;
    double to = from;
    for (; i < orders.size() && orders[i].seen - to < 0.045 * range; ++i) {
      to = orders[i].seen;
      text += fmt::format("{}{:.4g}", text.empty() ? "" : ", ", orders[i].order);
      commands += fmt::format(
          "set arrow from first {0:.6g}, graph 0 to first {0:.6g}, graph 1 nohead dashtype 3 linewidth 1 "
          "linecolor rgb '#999999' back\n",
          to);
    }
    commands += fmt::format("set label {} at first {:.6g},{:.6g} {} offset 0,0.6 font ',13'\n", Quoted(text),
                            0.5 * (from + to), top, from - left < 0.03 * range ? "left" : "center");
  }
  return commands;
}

std::string List(const std::vector<NamedOrder>& orders, const Axis& axis, const std::vector<double>& before,
                 const std::vector<double>& after, bool extended, const std::string& unit, double height_px) {
  double y = 1.0 - 100.0 / height_px;
  const double row = 30.0 / height_px;
  std::string commands = ListEntry("order", 0.685, y, "right", "#666666") +
                         ListEntry(fmt::format("amplitude ({})", unit), 0.985, y, "right", "#666666");
  for (const NamedOrder& order : orders) {
    y -= row;
    std::string name = order.name.substr(0, 44);
    if (std::abs(order.seen - order.order) > 1e-6) name += fmt::format(" (seen at {:.3g})", order.seen);
    commands += ListEntry(fmt::format("{:.4g}", order.order), 0.685, y, "right", "#222222");
    commands += ListEntry(name, 0.695, y, "left", "#222222");
    y -= 0.72 * row;
    commands += ListEntry(fmt::format("{:.3g}", HighestNear(before, axis, order.seen)),
                          extended ? 0.915 : 0.985, y, "right", kLastColour.plain);
    if (extended) {
      commands += ListEntry(fmt::format("{:.3g}", HighestNear(after, axis, order.seen)), 0.985, y, "right",
                            kFirstColour.plain);
    }
  }
  return commands;
}

std::vector<double> Spectrum(const DiagnosisReport& report, const diagnosis::ModelFit& fit,
                             const Axis& axis) {
  const diagnosis::Study& study = *report.input.study;
  std::vector<double> residual = diagnosis::ResidualsOf(study, fit);
  double mean = 0.0;
  for (const double value : residual) mean += value / static_cast<double>(residual.size());
  for (double& value : residual) value = (value - mean) * study.unit_per_si();
  return AmplitudesAt(axis.angle_rad, residual, report.result.weights, axis.lowest, axis.step, axis.count);
}

// Over time, what a slow measurement misses is slow: the rest of the axis would be empty.
std::size_t CountThatMatters(std::span<const double> before, std::span<const double> after) {
  constexpr double kMatters = 0.03;
  constexpr std::size_t kLeast = 60;
  const double level = kMatters * std::max(std::ranges::max(before), std::ranges::max(after));
  std::size_t count = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    if (std::max(before[k], after[k]) > level) count = k + 1;
  }
  return std::min(before.size(), std::max(kLeast, count + count / 4));
}

}  // namespace

std::filesystem::path DrawResidualSpectrum(const DiagnosisReport& report, const std::filesystem::path& stem) {
  constexpr double kHeight = 560.0;
  Axis axis = AxisOf(report);
  const std::vector<NamedOrder> found = FoundOrders(report, axis);
  MoveTo(found, axis);
  const bool extended = IsExtended(report);
  const std::vector<double> before = Spectrum(report, report.result.nominal, axis);
  const std::vector<double> after = Spectrum(report, report.result.extended, axis);
  if (axis.over == nullptr || !axis.over->angle) axis.count = CountThatMatters(before, after);
  std::vector<double> orders(axis.count);
  for (std::size_t k = 0; k < axis.count; ++k) orders[k] = axis.OrderAt(k);
  const double top = std::max(1e-12, 1.05 * std::max(std::ranges::max(before), std::ranges::max(after)));
  const std::vector<NamedOrder> named = NamedOrdersOf(report, axis, found);
  const auto shown = [&](const std::vector<double>& amplitude) {
    return std::span<const double>(amplitude).first(axis.count);
  };
  std::string script = DataBlock("spectrum", {orders, shown(before), shown(after)}) + CommonStyle();
  script += TitleLabel(TitleOf(report, "spectrum of what the simulation misses"), kHeight);
  script += fmt::format(
      "set lmargin at screen {}\nset rmargin at screen {}\nset tmargin at screen {:.5f}\nset bmargin at "
      "screen {:.5f}\n",
      kPanelLeft, named.empty() ? 0.975 : 0.62, 1.0 - 118.0 / kHeight, 75.0 / kHeight);
  script += fmt::format("set xrange [{:.6g}:{:.6g}]\nset yrange [0:{:.6g}]\nset xlabel {}\nset ylabel {}\n",
                        axis.left, axis.highest(), top, Quoted(axis.title),
                        Quoted(fmt::format("amplitude ({})", report.input.study->unit())));
  std::vector<LegendEntry> legend{{kLastColour.plain, NominalName(report)}};
  if (extended) legend.push_back({kFirstColour.plain, ExtendedName(report)});
  script += "unset key\n" + Legend(legend, {1.0 - 118.0 / kHeight, 75.0 / kHeight}, kHeight, 48.0);
  script += Marks(named, axis.left, axis.highest(), top);
  if (!named.empty()) {
    script += List(named, axis, before, after, extended, report.input.study->unit(), kHeight);
  }
  script += fmt::format(
      "plot $spectrum using 1:2 with filledcurves y1=0 linecolor rgb '{0}',\\\n"
      "  $spectrum using 1:2 with lines linewidth 1.4 linecolor rgb '{0}'",
      kLastColour.plain);
  if (extended) {
    script += fmt::format(
        ",\\\n  $spectrum using 1:3 with filledcurves y1=0 linecolor rgb '{0}',\\\n"
        "  $spectrum using 1:3 with lines linewidth 1.4 linecolor rgb '{0}'",
        kFirstColour.plain);
  }
  return RenderPicture(script + "\n", stem, {.width_px = 1200, .height_px = static_cast<int>(kHeight)});
}

}  // namespace strainwave::bench
