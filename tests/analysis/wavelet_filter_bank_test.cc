// SPDX-License-Identifier: Apache-2.0
// What defines each family: orthogonality to even shifts, vanishing moments, and the sum. Where the numbers
// came from has no part in it; wavelet_filters.py derives them anew.
#include "analysis/wavelets/filter_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "tests/analysis/message_of.h"

namespace strainwave::analysis::wavelets::wavelet_filter_bank_test {
namespace {

// Doubles hold about 2e-16 of a tap; PyWavelets prints its symlets to some 12 digits.
double DigitsOf(const std::string& name) { return name.starts_with("sym") ? 1e-10 : 1e-14; }

int OrderOf(const std::string& name) {
  return name == "haar" ? 1 : std::stoi(name.substr(name.find_first_of("0123456789")));
}

// ∑ sign^i ((i − centre) / half)^power h_i, half the length of the filter: moments of size one.
long double Moment(const std::vector<double>& h, int power, long double centre, int sign) {
  const long double half = static_cast<long double>(h.size()) / 2.0L;
  long double moment = 0.0L;
  for (std::size_t i = 0; i < h.size(); ++i) {
    const long double place = (static_cast<long double>(i) - centre) / half;
    moment +=
        (i % 2 == 1 && sign < 0 ? -1.0L : 1.0L) * std::pow(place, power) * static_cast<long double>(h[i]);
  }
  return moment;
}

// Haar, db1 to db20, sym2 to sym20, coif1 to coif5: what the other tests go through.
TEST(FilterBank, ThereIsOneOfEachNameOfTheFourFamilies) {
  const auto names = WaveletNames();
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), 1U + 20U + 19U + 5U);
}

TEST(FilterBank, IsOrthonormalToItsEvenShifts) {
  for (const std::string& name : WaveletNames()) {
    const FilterBank bank = FilterBankOf(name);
    for (std::size_t shift = 0; shift < bank.length(); shift += 2) {
      long double low = 0.0L;
      long double high = 0.0L;
      long double mixed = 0.0L;
      for (std::size_t i = shift; i < bank.length(); ++i) {
        low += static_cast<long double>(bank.decomposition_low[i]) * bank.decomposition_low[i - shift];
        high += static_cast<long double>(bank.decomposition_high[i]) * bank.decomposition_high[i - shift];
        mixed += static_cast<long double>(bank.decomposition_low[i]) * bank.decomposition_high[i - shift];
      }
      EXPECT_NEAR(static_cast<double>(low), shift == 0 ? 1.0 : 0.0, DigitsOf(name))
          << name << " shift " << shift;
      EXPECT_NEAR(static_cast<double>(high), shift == 0 ? 1.0 : 0.0, DigitsOf(name))
          << name << " shift " << shift;
      EXPECT_NEAR(static_cast<double>(mixed), 0.0, DigitsOf(name)) << name << " shift " << shift;
    }
  }
}

TEST(FilterBank, SumsToTheRootOfTwo) {
  for (const std::string& name : WaveletNames()) {
    const long double sum = Moment(FilterBankOf(name).reconstruction_low, 0, 0.0L, 1);
    EXPECT_NEAR(static_cast<double>(sum), std::numbers::sqrt2, DigitsOf(name)) << name;
  }
}

TEST(FilterBank, HasTheVanishingMomentsOfItsFamily) {
  for (const std::string& name : WaveletNames()) {
    const FilterBank bank = FilterBankOf(name);
    const bool coiflet = name.starts_with("coif");
    const int order = OrderOf(name);
    EXPECT_EQ(bank.length(), static_cast<std::size_t>((coiflet ? 6 : 2) * order)) << name;
    const long double middle = static_cast<long double>(bank.length() - 1) / 2.0L;
    for (int power = 0; power < (coiflet ? 2 : 1) * order; ++power) {
      EXPECT_NEAR(static_cast<double>(Moment(bank.reconstruction_low, power, middle, -1)), 0.0,
                  DigitsOf(name))
          << name << " moment " << power;
    }
  }
}

TEST(FilterBank, CoifletsHaveVanishingMomentsOfTheScalingFunctionToo) {
  for (int order = 1; order <= 5; ++order) {
    const std::vector<double> low = FilterBankOf("coif" + std::to_string(order)).reconstruction_low;
    for (int power = 1; power < 2 * order; ++power) {
      EXPECT_NEAR(static_cast<double>(Moment(low, power, 2.0L * order, 1)), 0.0, 1e-14)
          << order << " " << power;
    }
  }
}

// Of all filters with the same moments, the energy of db arrives first, that of sym about the middle.
TEST(FilterBank, DaubechiesLeadAndSymletsAreCentred) {
  for (int order = 2; order <= 20; ++order) {
    const auto centre = [](const std::vector<double>& h) {
      double place = 0.0;
      for (std::size_t i = 0; i < h.size(); ++i) place += static_cast<double>(i) * h[i] * h[i];
      return place / static_cast<double>(h.size() - 1);
    };
    const double db = centre(FilterBankOf("db" + std::to_string(order)).reconstruction_low);
    const double sym = centre(FilterBankOf("sym" + std::to_string(order)).reconstruction_low);
    EXPECT_LE(db, sym + 1e-12) << order;
    if (order >= 4) {
      EXPECT_NEAR(sym, 0.5, 0.12) << order;
    }
  }
}

TEST(FilterBank, RelatesItsFourFiltersAsPyWaveletsDoes) {
  const FilterBank haar = FilterBankOf("haar");
  const double root = std::sqrt(0.5);
  EXPECT_EQ(haar.decomposition_low, (std::vector<double>{root, root}));
  EXPECT_EQ(haar.decomposition_high, (std::vector<double>{-root, root}));
  EXPECT_EQ(haar.reconstruction_high, (std::vector<double>{root, -root}));
  EXPECT_EQ(FilterBankOf("db1").decomposition_low, haar.decomposition_low);
}

TEST(FilterBank, RefusesANameThatItDoesNotKnow) {
  for (const char* name : {"", "db", "db0", "db21", "db08", "sym1", "coif6", "morl", "DB2"}) {
    EXPECT_EQ(MessageOf([&] { FilterBankOf(name); }),
              "wavelet = '" + std::string(name) +
                  "' is not known (expected haar, db1 to db20, sym2 to sym20 or coif1 to coif5)");
  }
}

}  // namespace
}  // namespace strainwave::analysis::wavelets::wavelet_filter_bank_test
