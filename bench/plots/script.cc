// SPDX-License-Identifier: Apache-2.0
#include "bench/plots/script.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

namespace strainwave::bench {

std::string Quoted(std::string_view text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'') {
      quoted += "''";
    } else {
      const bool control = static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
      quoted += control ? ' ' : c;
    }
  }
  return quoted + "'";
}

std::string DataBlock(std::string_view name, std::initializer_list<std::span<const double>> columns) {
  if (columns.size() == 0) {
    throw std::invalid_argument("columns is empty (expected at least one)");
  }
  const std::size_t rows = columns.begin()->size();
  for (const std::span<const double> column : columns) {
    if (column.size() != rows) {
      throw std::invalid_argument(fmt::format(
          "columns of {} and {} rows stand side by side (expected one length)", rows, column.size()));
    }
  }
  std::string block = fmt::format("${} << END_OF_DATA\n", name);
  for (std::size_t row = 0; row < rows; ++row) {
    for (const std::span<const double> column : columns) {
      // gnuplot leaves a gap in a line where a value is undefined.
      std::isfinite(column[row]) ? fmt::format_to(std::back_inserter(block), "{:.8g} ", column[row])
                                 : fmt::format_to(std::back_inserter(block), "NaN ");
    }
    block += '\n';
  }
  return block + "END_OF_DATA\n";
}

std::string EstimateText(const analysis::Estimate& estimate, std::string_view unit) {
  if (!std::isfinite(estimate.value)) {
    return "no value";
  }
  if (!std::isfinite(estimate.standard_error) || estimate.standard_error <= 0.0) {
    return fmt::format("{:.4g} {}", estimate.value, unit);
  }
  const int decimals =
      std::clamp(1 - static_cast<int>(std::floor(std::log10(estimate.standard_error))), 0, 9);
  return fmt::format("{:.{}f} ± {:.{}f} {}", estimate.value, decimals, estimate.standard_error, decimals,
                     unit);
}

std::string CommonStyle() {
  return "set border 3 linewidth 0.8 linecolor rgb '#444444'\n"
         "set tics nomirror out scale 0.6 textcolor rgb '#222222'\n"
         "set grid xtics ytics back linetype 1 linewidth 0.6 linecolor rgb '#E2E2E2'\n"
         "set style fill transparent solid 0.25 noborder\n";
}

}  // namespace strainwave::bench
