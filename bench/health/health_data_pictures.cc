// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "analysis/amplitude_spectrum.h"
#include "analysis/wavelets/packets.h"
#include "bench/health/health_pictures.h"
#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kMostShown = 4;
constexpr const char* kPalette = "set palette defined (0 '#0072B2', 0.5 '#CCCCCC', 1 '#D55E00')\n";

std::string ConditionText(const HealthData& data, int condition) {
  std::string text;
  for (std::size_t c = 0; c < data.components.size(); ++c)
    text += fmt::format("{}{} {:.2g}", c > 0 ? ", " : "", data.components[c],
                        data.conditions(condition, static_cast<Eigen::Index>(c)));
  return text;
}

// As new; each component at its worst with the others as little worn as there is; all of them together.
std::vector<const MotorExample*> Shown(const HealthData& data) {
  std::vector<const MotorExample*> shown;
  const auto add = [&](auto score) {
    const MotorExample* best = nullptr;
    double most = -1e300;
    for (const MotorExample& example : data.examples) {
      const Eigen::VectorXd health = data.conditions.row(example.condition);
      const double value = score(health);
      if (value > most) {
        most = value;
        best = &example;
      }
    }
    if (best != nullptr && std::ranges::find(shown, best) == shown.end() && shown.size() < kMostShown)
      shown.push_back(best);
  };
  add([](const Eigen::VectorXd& health) { return -health.sum(); });
  for (Eigen::Index c = 0; c < data.conditions.cols(); ++c)
    add([c](const Eigen::VectorXd& health) { return 10.0 * health(c) - health.sum(); });
  add([](const Eigen::VectorXd& health) { return health.sum(); });
  return shown;
}

std::filesystem::path DrawSignals(const HealthData& data, const std::filesystem::path& stem) {
  const std::vector<const MotorExample*> shown = Shown(data);
  std::string script = CommonStyle();
  std::string panels = fmt::format(
      "set multiplot layout {},2 title 'a cycle in some conditions' font ',16'\nunset key\n", shown.size());
  for (std::size_t k = 0; k < shown.size(); ++k) {
    std::vector<double> time_s(shown[k]->channels.front().size());
    for (std::size_t i = 0; i < time_s.size(); ++i) time_s[i] = static_cast<double>(i) / data.sample_rate_hz;
    const std::string name = fmt::format("cycle{}", k);
    script += DataBlock(name, {time_s, shown[k]->channels[0], shown[k]->channels[1]});
    const char* labels[] = {"current, A", "velocity, rad/s"};
    for (int channel = 0; channel < 2; ++channel)
      panels += fmt::format(
          "set title {}\nset xlabel 's'\nset ylabel '{}'\nplot ${} using 1:{} with lines lc rgb '{}'\n",
          Quoted(ConditionText(data, shown[k]->condition)), labels[channel], name, channel + 2,
          channel == 0 ? kFirstColour.plain : kLastColour.plain);
  }
  return RenderPicture(script + panels + "unset multiplot\n", stem,
                       {1300, 260 * static_cast<int>(shown.size()) + 60});
}

std::filesystem::path DrawSpectra(const HealthData& data, const std::filesystem::path& stem) {
  std::string script = CommonStyle() + kPalette;
  std::string plots;
  const double most = std::max(1.0, data.conditions.rowwise().sum().maxCoeff());
  for (std::size_t k = 0; k < data.examples.size(); ++k) {
    const analysis::AmplitudeSpectrum spectrum =
        analysis::AmplitudeSpectrumOf(data.examples[k].channels.front(), data.sample_rate_hz, 1024);
    if (spectrum.frequency_Hz.empty()) continue;
    const std::string name = fmt::format("spectrum{}", k);
    script += DataBlock(name, {spectrum.frequency_Hz, spectrum.amplitude});
    plots += fmt::format("{}${} using 1:2 with lines lw 1.1 lc palette frac {:.3f} title {}",
                         plots.empty() ? "plot " : ", ", name,
                         data.conditions.row(data.examples[k].condition).sum() / most,
                         Quoted(ConditionText(data, data.examples[k].condition)));
  }
  script +=
      "set title 'current, amplitude spectrum of a cycle'\nset logscale y\nset xlabel 'Hz'\nset ylabel 'A'\n"
      "set key outside right top\nunset colorbox\n" +
      plots + "\n";
  return RenderPicture(script, stem, {1300, 700});
}

std::filesystem::path DrawCoefficients(const HealthData& data, const std::filesystem::path& stem) {
  const std::vector<const MotorExample*> shown = Shown(data);
  const std::vector<analysis::features::PacketBand> bands =
      analysis::features::PacketBands(data.recipe.levels, data.sample_rate_hz);
  const auto bank = analysis::wavelets::FilterBankOf(data.recipe.wavelet);
  std::string script = CommonStyle();
  std::string panels = fmt::format(
      "set multiplot layout {},{} title 'coefficients of the current by band' font ',16'\n"
      "unset key\nset xtics 0.5\n",
      bands.size(), shown.size());
  for (std::size_t place = 0; place < bands.size(); ++place) {
    const auto band = std::ranges::find(bands, place, &analysis::features::PacketBand::by_frequency);
    const auto leaf = static_cast<std::size_t>(band - bands.begin());
    std::vector<analysis::wavelets::Packets> all(shown.size());
    double most = 1e-12;  // one scale for all conditions
    for (std::size_t k = 0; k < shown.size(); ++k) {
      analysis::wavelets::DecomposePackets(shown[k]->channels.front(), bank, data.recipe.border,
                                           data.recipe.levels, all[k]);
      for (const double value : all[k].leaves[leaf]) most = std::max(most, std::abs(value));
    }
    panels +=
        fmt::format("set yrange [{0}:{1}]\nset ytics ({0}, 0, {1})\nset format y '%.2g'\n", -most, most);
    for (std::size_t k = 0; k < shown.size(); ++k) {
      const analysis::wavelets::Packets& packets = all[k];
      const std::vector<double>& x = shown[k]->channels.front();
      std::vector<double> time_s(packets.leaves[leaf].size());
      for (std::size_t i = 0; i < time_s.size(); ++i)
        time_s[i] =
            static_cast<double>(i * x.size()) / static_cast<double>(time_s.size()) / data.sample_rate_hz;
      const std::string name = fmt::format("band{}_{}", place, k);
      script += DataBlock(name, {time_s, packets.leaves[leaf]});
      panels += fmt::format("set title {}\nplot ${} using 1:2 with lines lc rgb '{}'\n",
                            Quoted(place == 0 ? ConditionText(data, shown[k]->condition)
                                              : fmt::format("W{} ({}), {:g} to {:g} Hz", place, band->path,
                                                            band->low_hz, band->high_hz)),
                            name, kFirstColour.plain);
    }
  }
  return RenderPicture(
      script + panels + "unset multiplot\n", stem,
      {400 * static_cast<int>(shown.size()) + 60, 170 * static_cast<int>(bands.size()) + 60});
}

// Over all cycles: the energy of each band, conditions side by side.
std::filesystem::path DrawEnergies(const HealthData& data, const std::filesystem::path& stem) {
  const std::vector<analysis::features::PacketBand> bands =
      analysis::features::PacketBands(data.recipe.levels, data.sample_rate_hz);
  std::string script = CommonStyle() + kPalette;
  std::string panels = fmt::format(
      "set multiplot layout {},2 title 'energy of the bands of the current; colour: {}' font ',16'\n"
      "unset key\nset logscale y\nset xlabel 'condition, by health'\nset cbrange [0:1]\n",
      (bands.size() + 1) / 2, data.components.back());
  for (std::size_t place = 0; place < bands.size(); ++place) {
    const auto band = std::ranges::find(bands, place, &analysis::features::PacketBand::by_frequency);
    const auto feature =
        (band - bands.begin()) * static_cast<std::ptrdiff_t>(analysis::features::kBandFeatures);
    std::vector<double> at;
    std::vector<double> energy;
    std::vector<double> colour;
    for (Eigen::Index i = 0; i < data.samples.size(); ++i) {
      const int condition = data.condition[static_cast<std::size_t>(i)];
      at.push_back(condition + 1.0 + 0.3 * (static_cast<double>(i % 11) / 10.0 - 0.5));
      energy.push_back(std::max(1e-12, data.samples.features(i, feature)));
      colour.push_back(data.conditions(condition, data.conditions.cols() - 1));
    }
    const std::string name = fmt::format("energy{}", place);
    script += DataBlock(name, {at, energy, colour});
    panels += fmt::format(
        "set title {}\nplot ${} using 1:2:3 with points pt 7 ps 0.3 lc palette\n",
        Quoted(fmt::format("W{} ({}), {:g} to {:g} Hz", place, band->path, band->low_hz, band->high_hz)),
        name);
  }
  return RenderPicture(script + panels + "unset multiplot\n", stem,
                       {1300, 240 * static_cast<int>((bands.size() + 1) / 2) + 60});
}

}  // namespace

std::vector<std::filesystem::path> DrawHealthData(const HealthData& data,
                                                  const std::filesystem::path& folder) {
  if (data.examples.empty()) return {};
  return {DrawSignals(data, folder / "signals"), DrawSpectra(data, folder / "spectra"),
          DrawCoefficients(data, folder / "coefficients"), DrawEnergies(data, folder / "band_energies")};
}

}  // namespace strainwave::bench
