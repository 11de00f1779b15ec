// SPDX-License-Identifier: Apache-2.0
#include "bench/plots/order_spectrum.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

using analysis::OrderLine;

constexpr std::size_t kListedOrders = 10;

// An order above half the sampling is drawn where the samples show it.
double ShownOrder(const OrderLine& line) {
  return line.aliased ? line.alias_order_per_output_rev : line.order_per_output_rev;
}

double AmplitudeArcmin(const OrderLine& line) { return ArcminFromRad(line.amplitude_rad.value); }

std::vector<OrderLine> NamedOrders(std::span<const OrderLine> lines) {
  std::vector<OrderLine> named;
  std::copy_if(lines.begin(), lines.end(), std::back_inserter(named), [](const OrderLine& line) {
    return !line.name.empty() && std::isfinite(line.amplitude_rad.value);
  });
  std::stable_sort(named.begin(), named.end(), [](const OrderLine& a, const OrderLine& b) {
    return AmplitudeArcmin(a) > AmplitudeArcmin(b);
  });
  named.resize(std::min(named.size(), kListedOrders));
  std::sort(named.begin(), named.end(), [](const OrderLine& a, const OrderLine& b) {
    return a.order_per_output_rev < b.order_per_output_rev;
  });
  return named;
}

const OrderLine* FindOrder(std::span<const OrderLine> lines, double order_per_output_rev) {
  const auto found = std::find_if(lines.begin(), lines.end(), [&](const OrderLine& line) {
    return std::abs(line.order_per_output_rev - order_per_output_rev) < 1e-6;
  });
  return found == lines.end() ? nullptr : &*found;
}

std::string SpectrumData(std::string_view name, std::span<const OrderLine> lines) {
  std::vector<double> order;
  std::vector<double> amplitude_arcmin;
  for (const OrderLine& line : lines) {
    order.push_back(ShownOrder(line));
    amplitude_arcmin.push_back(AmplitudeArcmin(line));
  }
  return DataBlock(name, {order, amplitude_arcmin});
}

// Numbers above the stems. Neighbours that would overprint each other share one label.
std::string StemLabels(std::vector<OrderLine> named, std::span<const OrderLine> last, double range) {
  std::sort(named.begin(), named.end(),
            [](const OrderLine& a, const OrderLine& b) { return ShownOrder(a) < ShownOrder(b); });
  std::string commands;
  for (std::size_t i = 0; i < named.size();) {
    std::string text;
    double height = 0.0;
    const double from = ShownOrder(named[i]);
    double to = from;
    for (; i < named.size() && ShownOrder(named[i]) - to < 0.05 * range; ++i) {
      to = ShownOrder(named[i]);
      text += fmt::format("{}{:g}", text.empty() ? "" : ", ", named[i].order_per_output_rev);
      const OrderLine* again = FindOrder(last, named[i].order_per_output_rev);
      height = std::max({height, AmplitudeArcmin(named[i]), again ? AmplitudeArcmin(*again) : 0.0});
    }
    const bool beside_axis = from < 0.03 * range;
    commands += fmt::format("set label {} at first {:.6g},{:.6g} {} offset 0,0.7 font ',13'\n", Quoted(text),
                            beside_axis ? from : 0.5 * (from + to), height, beside_axis ? "left" : "center");
  }
  return commands;
}

std::string ListLabel(const std::string& text, double x, double y, std::string_view side,
                      std::string_view colour) {
  return fmt::format("set label {} at screen {:.4f},{:.4f} {} font ',13' textcolor rgb '{}'\n", Quoted(text),
                     x, y, side, colour);
}

// The list beside the spectrum: order, source, amplitude in the first and in the last measurement.
std::string OrderList(std::span<const OrderLine> named, std::span<const OrderLine> last,
                      const SpectrumFrame& frame) {
  constexpr std::string_view kInk = "#222222";
  const double order_right = frame.list_left + 0.035;
  const double name_left = order_right + 0.012;
  const double last_right = 0.985;
  const double first_right = last.empty() ? last_right : last_right - 0.065;
  const double row_height =
      std::min(0.034, (frame.top - frame.bottom) / static_cast<double>(kListedOrders + 1));
  double y = frame.top - 0.5 * row_height;
  std::string commands = ListLabel("order", order_right, y, "right", "#666666");
  commands += ListLabel("amplitude (arcmin)", last_right, y, "right", "#666666");
  for (const OrderLine& line : named) {
    y -= row_height;
    std::string name = line.name;
    if (line.aliased) {
      // To a tenth: the fold of a sweep whose steps are not quite equal is no round number.
      name += fmt::format(" (seen at {:g})", std::round(10.0 * line.alias_order_per_output_rev) / 10.0);
    }
    commands += ListLabel(fmt::format("{:g}", line.order_per_output_rev), order_right, y, "right", kInk);
    commands += ListLabel(name, name_left, y, "left", kInk);
    commands +=
        ListLabel(fmt::format("{:.3f}", AmplitudeArcmin(line)), first_right, y, "right", kFirstColour.plain);
    if (const OrderLine* again = FindOrder(last, line.order_per_output_rev)) {
      commands += ListLabel(fmt::format("{:.3f}", AmplitudeArcmin(*again)), last_right, y, "right",
                            kLastColour.plain);
    }
  }
  return commands;
}

}  // namespace

SpectrumScript MakeSpectrumScript(std::span<const OrderLine> first, std::span<const OrderLine> last,
                                  const SpectrumFrame& frame) {
  double highest_order = 1.0;
  double highest_arcmin = 0.0;
  for (const std::span<const OrderLine> lines : {first, last}) {
    for (const OrderLine& line : lines) {
      highest_order = std::max(highest_order, ShownOrder(line));
      highest_arcmin = std::max(highest_arcmin, AmplitudeArcmin(line));
    }
  }
  if (!(highest_arcmin > 0.0)) {
    highest_arcmin = 1.0;
  }
  const std::vector<OrderLine> named = NamedOrders(first);
  SpectrumScript script;
  script.data = SpectrumData("spectrum_first", first);
  script.commands = fmt::format(
      "set lmargin at screen {}\nset rmargin at screen {}\n"
      "set bmargin at screen {}\nset tmargin at screen {}\n",
      frame.left, frame.right, frame.bottom, frame.top);
  script.commands += "set title ''\nset key off\nunset xzeroaxis\n";
  script.commands +=
      "set xlabel 'order per output revolution' offset 0,0.4\nset ylabel 'amplitude (arcmin)' offset 1,0\n";
  script.commands += "set xtics autofreq\nset logscale y 10\nset format y '%g'\n";
  // Three decades below the strongest order lies only noise.
  script.commands +=
      fmt::format("set xrange [{:.6g}:{:.6g}]\nset yrange [{:.6g}:{:.6g}]\n", -0.012 * highest_order,
                  1.04 * highest_order, 1e-3 * highest_arcmin, 3.0 * highest_arcmin);
  script.commands += StemLabels(named, last, highest_order) + OrderList(named, last, frame);
  script.commands +=
      fmt::format("plot $spectrum_first using 1:2 with impulses linewidth {} linecolor rgb '{}'",
                  last.empty() ? 2 : 4, last.empty() ? kFirstColour.plain : kFirstColour.pale);
  if (!last.empty()) {
    script.data += SpectrumData("spectrum_last", last);
    script.commands += fmt::format(
        ",\\\n  $spectrum_last using 1:2 with impulses linewidth 1.5 linecolor rgb '{}'", kLastColour.plain);
  }
  script.commands += '\n';
  return script;
}

}  // namespace strainwave::bench
