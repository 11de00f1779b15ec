// SPDX-License-Identifier: Apache-2.0
#include "analysis/rainflow.h"

#include <cmath>

#include "analysis/arguments.h"

namespace strainwave::analysis {
namespace {

// Where the load turns round, the first load and the last among them.
std::vector<double> ReversalsOf(std::span<const double> loads) {
  std::vector<double> reversals;
  for (const double load : loads) {
    RequireFinite("load", load);
    const std::size_t count = reversals.size();
    if (count > 0 && load == reversals.back()) continue;
    if (count > 1 && (load > reversals.back()) == (reversals.back() > reversals[count - 2])) {
      reversals.back() = load;
    } else {
      reversals.push_back(load);
    }
  }
  return reversals;
}

RainflowRange RangeBetween(double from, double to, double cycles) {
  return {std::abs(to - from), 0.5 * (from + to), cycles};
}

// Counts what the newest reversal closes.
void Close(RainflowPart& part) {
  std::vector<double>& open = part.open;
  while (open.size() >= 3) {
    const std::size_t last = open.size() - 1;
    const double newest = std::abs(open[last] - open[last - 1]);      // X
    const double before = std::abs(open[last - 1] - open[last - 2]);  // Y
    if (newest < before) return;
    const bool has_start = open.size() == 3;  // Y begins where the history does
    part.closed.push_back(RangeBetween(open[last - 2], open[last - 1], has_start ? 0.5 : 1.0));
    if (has_start) {
      open.erase(open.begin());
    } else {
      open.erase(open.end() - 3, open.end() - 1);
    }
  }
}

}  // namespace

RainflowPart CountRainflowPart(std::span<const double> loads) {
  RainflowPart part;
  for (const double reversal : ReversalsOf(loads)) {
    // The one before is a reversal, since this one comes after it; whether the last is, what follows decides.
    Close(part);
    part.open.push_back(reversal);
  }
  return part;
}

std::vector<RainflowRange> CountRainflow(std::span<const double> loads) {
  RainflowPart part = CountRainflowPart(loads);
  Close(part);
  for (std::size_t i = 1; i < part.open.size(); ++i)
    part.closed.push_back(RangeBetween(part.open[i - 1], part.open[i], 0.5));
  return part.closed;
}

double EquivalentCycles(std::span<const RainflowRange> ranges, double range, double exponent) {
  RequirePositive("range", range);
  RequireFinite("exponent", exponent);
  double cycles = 0.0;
  for (const RainflowRange& counted : ranges)
    cycles += counted.cycles * std::pow(counted.range / range, exponent);
  return cycles;
}

}  // namespace strainwave::analysis
