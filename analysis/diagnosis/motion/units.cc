// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kDegrees = 180.0 / kPi;
constexpr double kRpm = 60.0 / kTwoPi;

struct Agreement {
  double factor{};  // velocity column over the position's own
  double correlation{};
  double lag_s{};  // of the velocity column behind the position
};

// Way by the velocity column over windows against the way that the position went.
Agreement Compare(const MotionData& record) {
  const std::size_t n = record.position.size();
  const std::size_t window = std::clamp<std::size_t>(n / 200, 4, 200);
  std::vector<double> way(n, 0.0);
  for (std::size_t i = 1; i < n; ++i) {
    way[i] = way[i - 1] +
             0.5 * (record.velocity[i] + record.velocity[i - 1]) * (record.time_s[i] - record.time_s[i - 1]);
  }
  // Over a gap the velocity column says nothing of the way.
  const double longest_s = 2.0 * static_cast<double>(window) *
                           (record.time_s.back() - record.time_s.front()) /
                           static_cast<double>(std::max<std::size_t>(1, n - 1));
  const auto spans_gap = [&](std::size_t i) {
    return record.time_s[i] - record.time_s[i - window] > longest_s;
  };
  double pp = 0.0;
  double vv = 0.0;
  double pv = 0.0;
  for (std::size_t i = window; i < n; ++i) {
    if (spans_gap(i)) continue;
    const double by_position = record.position[i] - record.position[i - window];
    const double by_velocity = way[i] - way[i - window];
    pp += by_position * by_position;
    vv += by_velocity * by_velocity;
    pv += by_position * by_velocity;
  }
  Agreement agreement;
  if (!(pp > 0.0) || !(vv > 0.0)) return agreement;
  agreement.factor = pv / pp;
  agreement.correlation = pv / std::sqrt(pp * vv);
  // way(t) = factor · position(t − lag): the rest against the change of velocity.
  double rest = 0.0;
  double change = 0.0;
  for (std::size_t i = window; i < n; ++i) {
    if (spans_gap(i)) continue;
    const double velocity_change = record.velocity[i] - record.velocity[i - window];
    const double by_position = agreement.factor * (record.position[i] - record.position[i - window]);
    rest += velocity_change * (way[i] - way[i - window] - by_position);
    change += velocity_change * velocity_change;
  }
  if (change > 0.0) agreement.lag_s = -rest / change;
  return agreement;
}

bool Near(double value, double wanted) { return std::abs(value / wanted - 1.0) < 0.03; }

void Scale(std::vector<double>& values, double factor) {
  for (double& value : values) value *= factor;
}

}  // namespace

void SettleUnits(MotionData& record, const std::string& name, std::vector<std::string>& warnings) {
  if (record.velocity.empty()) return;
  const Agreement agreement = Compare(record);
  const double factor = agreement.factor;
  if (agreement.correlation < 0.9) {
    warnings.push_back(
        fmt::format("{}the velocity column does not follow the position (correlation {:.2f}): left "
                    "out",
                    name, agreement.correlation));
    record.velocity.clear();
    return;
  }
  if (Near(factor, 1.0)) {
    // A column that lags (filtered, or a backward difference) would act as a delay of the friction.
    const double step_s = (record.time_s.back() - record.time_s.front()) /
                          static_cast<double>(std::max<std::size_t>(1, record.time_s.size() - 1));
    if (std::abs(agreement.lag_s) > 0.15 * step_s) record.velocity.clear();
    return;
  }
  struct Unit {
    double factor;
    bool linear;
    bool of_position;  // the position is the one that is off
    const char* text;
  };
  static const std::array<Unit, 6> kUnits{{
      {kRpm, false, false, "revolutions per minute, not rad/s"},
      {kDegrees, false, false, "degrees per second, not rad/s"},
      {1.0 / kDegrees, false, true, "degrees, not rad"},
      {1e3, true, false, "mm/s, not m/s"},
      {1e-3, true, true, "mm, not m"},
      {60.0, true, false, "m/min, not m/s"},
  }};
  for (const Unit& unit : kUnits) {
    if (unit.linear != record.linear || !Near(factor, unit.factor)) continue;
    if (unit.of_position) {
      warnings.push_back(
          fmt::format("{}the position goes {:.4g} times as far as the velocity says: it looks like {}; "
                      "converted",
                      name, 1.0 / factor, unit.text));
      Scale(record.position, factor < 1.0 ? unit.factor : 1.0);
    } else {
      warnings.push_back(
          fmt::format("{}the velocity column is {:.4g} times the position's rate: it looks like {}; "
                      "converted",
                      name, factor, unit.text));
      Scale(record.velocity, 1.0 / unit.factor);
    }
    return;
  }
  warnings.push_back(
      fmt::format("{}the velocity column is {:.4g} times the position's rate, which is no unit that we "
                  "know: left out",
                  name, factor));
  record.velocity.clear();
}

std::string InertiaWarning(double fitted, double known, double standard_error, bool linear) {
  if (!(known > 0.0) || !(fitted > 0.0)) return {};
  const double factor = fitted / known;
  if (std::abs(factor - 1.0) < std::max(0.15, 5.0 * standard_error / known)) return {};
  const char* what = linear ? "mass" : "inertia";
  const char* unit = linear ? "kg" : "kg m²";
  std::string text = fmt::format("{} comes out as {:.4g} {}, the file says {:.4g} (a factor of {:.4g})", what,
                                 fitted, unit, known, factor);
  if (!linear && (Near(factor, kDegrees) || Near(factor, 1.0 / kDegrees))) {
    return text + (factor < 1.0 ? ": the position looks like degrees, not rad"
                                : ": the inertia or the torque looks like "
                                  "one made for degrees");
  }
  if (Near(factor, 1e3) || Near(factor, 1e-3)) return text + ": looks like a unit that is off by a thousand";
  if (!linear && (Near(factor, kRpm) || Near(factor, 1.0 / kRpm))) {
    return text + ": looks like revolutions per minute taken for rad/s";
  }
  if (factor < 0.5 || factor > 2.0) {
    return text +
           (linear ? ": the force may be a current or a voltage without its gain, or the mass is another one"
                   : ": the torque may be a current without its gain, may stand on the other side of the "
                     "gear, or "
                     "the inertia is another one");
  }
  return text;
}

}  // namespace strainwave::analysis::diagnosis
