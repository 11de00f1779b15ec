// SPDX-License-Identifier: Apache-2.0
#include "analysis/wavelets/filter_bank.h"

#include <fmt/format.h>

#include <span>
#include <stdexcept>
#include <utility>

#include "analysis/wavelets/filter_tables.h"

namespace strainwave::analysis::wavelets {
namespace {

struct Family {
  std::string_view name;
  std::size_t first;
  std::size_t last;
  std::size_t taps_per_order;
  std::span<const double> table;  // the filters of all orders, one after the other
};

constexpr Family kFamilies[] = {
    {"db", 1, 20, 2, kDaubechies}, {"sym", 2, 20, 2, kSymlets}, {"coif", 1, 5, 6, kCoiflets}};

std::span<const double> TapsOf(const Family& family, std::size_t order) {
  std::size_t begin = 0;
  for (std::size_t below = family.first; below < order; ++below) begin += family.taps_per_order * below;
  return family.table.subspan(begin, family.taps_per_order * order);
}

FilterBank BankOf(std::string name, std::span<const double> reconstruction_low) {
  FilterBank bank;
  bank.name = std::move(name);
  bank.reconstruction_low.assign(reconstruction_low.begin(), reconstruction_low.end());
  bank.decomposition_low.assign(reconstruction_low.rbegin(), reconstruction_low.rend());
  double sign = -1.0;
  for (const double tap : reconstruction_low) {
    bank.decomposition_high.push_back(sign * tap);
    sign = -sign;
  }
  bank.reconstruction_high.assign(bank.decomposition_high.rbegin(), bank.decomposition_high.rend());
  return bank;
}

}  // namespace

FilterBank FilterBankOf(std::string_view name) {
  if (name == "haar") return BankOf("haar", TapsOf(kFamilies[0], 1));
  for (const Family& family : kFamilies) {
    for (std::size_t order = family.first; order <= family.last; ++order) {
      std::string own = fmt::format("{}{}", family.name, order);
      if (own == name) return BankOf(std::move(own), TapsOf(family, order));
    }
  }
  throw std::invalid_argument(fmt::format(
      "wavelet = '{}' is not known (expected haar, db1 to db20, sym2 to sym20 or coif1 to coif5)", name));
}

std::vector<std::string> WaveletNames() {
  std::vector<std::string> names{"haar"};
  for (const Family& family : kFamilies) {
    for (std::size_t order = family.first; order <= family.last; ++order) {
      names.push_back(fmt::format("{}{}", family.name, order));
    }
  }
  return names;
}

}  // namespace strainwave::analysis::wavelets
