// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/spectrum.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kSpectrumPadding = 4;

// Residual times weight, at even steps of the axis.
std::vector<double> AtEvenSteps(std::span<const double> abscissa, std::span<const double> residual,
                                std::span<const double> weights, double step, bool even) {
  const std::size_t n = abscissa.size();
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n; ++i) values[i] = weights[i] > 0.0 ? residual[i] : 0.0;
  if (even) return values;
  const auto count = static_cast<std::size_t>((abscissa.back() - abscissa.front()) / step) + 1;
  std::vector<double> grid(count, 0.0);
  std::size_t i = 0;
  for (std::size_t g = 0; g < count; ++g) {
    const double x = abscissa.front() + step * static_cast<double>(g);
    while (i + 2 < n && abscissa[i + 1] <= x) ++i;
    const double gap = abscissa[i + 1] - abscissa[i];
    if (!(gap > 0.0) || gap > 2.5 * step) continue;
    const double u = (x - abscissa[i]) / gap;
    if (i == 0 || i + 2 >= n) {
      grid[g] = (1.0 - u) * values[i] + u * values[i + 1];
      continue;
    }
    // Cubic through four neighbours, taken as evenly spaced.
    grid[g] = -u * (u - 1.0) * (u - 2.0) / 6.0 * values[i - 1] +
              (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0 * values[i] -
              (u + 1.0) * u * (u - 2.0) / 2.0 * values[i + 1] +
              (u + 1.0) * u * (u - 1.0) / 6.0 * values[i + 2];
  }
  return grid;
}

// Smooth background: medians of blocks of cells, straight lines between them on a logarithmic scale.
std::vector<double> BackgroundOf(const std::vector<double>& power, std::size_t padding) {
  const std::size_t cells = power.size() / padding;
  const std::size_t block = std::max<std::size_t>(48, cells / 24);
  const std::size_t blocks = std::max<std::size_t>(1, cells / block);
  std::vector<double> level(blocks);
  std::vector<double> values;
  for (std::size_t b = 0; b < blocks; ++b) {
    values.clear();
    const std::size_t last = b + 1 == blocks ? cells : (b + 1) * block;
    for (std::size_t c = b * block; c < last; ++c) values.push_back(power[c * padding]);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    level[b] = std::log(std::max(*middle / std::numbers::ln2, 1e-300));
  }
  std::vector<double> background(power.size());
  for (std::size_t j = 0; j < power.size(); ++j) {
    const double block_position =
        (static_cast<double>(j) / static_cast<double>(padding) + 0.5) / static_cast<double>(block) - 0.5;
    const double clamped = std::clamp(block_position, 0.0, static_cast<double>(blocks - 1));
    const auto below = std::min(static_cast<std::size_t>(clamped), blocks - 1);
    const std::size_t above = std::min(below + 1, blocks - 1);
    const double u = clamped - static_cast<double>(below);
    background[j] = std::exp((1.0 - u) * level[below] + u * level[above]);
  }
  return background;
}

// The largest length up to this one that the transform is quick for.
std::size_t FastLength(std::size_t length) {
  for (std::size_t size = length; size > 1; --size) {
    std::size_t rest = size;
    for (const std::size_t factor : {2, 3, 5}) {
      while (rest % factor == 0) rest /= factor;
    }
    if (rest == 1) return size;
  }
  return length;
}

// Without its first line, the mean; tapered, so that strong lines do not spill over the whole spectrum. A sum
// of squares of one is what noise of unit variance has in each line.
std::vector<std::complex<double>> TaperedSpectrum(std::span<const double> values) {
  values = values.first(FastLength(values.size()));
  const auto n = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double value : values) mean += value / n;
  std::vector<double> tapered(values.size());
  double taper_square = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double taper = 1.0 - std::cos(kTwoPi * (static_cast<double>(i) + 0.5) / n);
    tapered[i] = taper * (values[i] - mean);
    taper_square += taper * taper;
  }
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<std::complex<double>> spectrum;
  transform.fwd(spectrum, tapered);
  if (spectrum.size() < 3) return {};
  spectrum.erase(spectrum.begin());
  spectrum.pop_back();
  for (std::complex<double>& line : spectrum) line /= std::sqrt(taper_square);
  return spectrum;
}

std::vector<double> PowerOf(std::span<const std::complex<double>> spectrum) {
  std::vector<double> power;
  for (const std::complex<double>& line : spectrum) power.push_back(std::norm(line));
  return power;
}

double MeanOf(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

}  // namespace

double BroadbandDeviation(std::span<const double> values) {
  return std::sqrt(MeanOf(BackgroundOf(PowerOf(TaperedSpectrum(values)), 1)));
}

double BroadbandCorrelation(std::span<const double> a, std::span<const double> b) {
  std::vector<std::complex<double>> sum = TaperedSpectrum(a);
  std::vector<std::complex<double>> difference = TaperedSpectrum(b);
  const std::vector<double> of_a = BackgroundOf(PowerOf(sum), 1);
  const std::vector<double> of_b = BackgroundOf(PowerOf(difference), 1);
  for (std::size_t j = 0; j < sum.size(); ++j) {
    const std::complex<double> one = sum[j] / std::sqrt(of_a[j]);
    const std::complex<double> other = difference[j] / std::sqrt(of_b[j]);
    sum[j] = one + other;
    difference[j] = one - other;
  }
  const double in_step = MeanOf(BackgroundOf(PowerOf(sum), 1));
  const double against = MeanOf(BackgroundOf(PowerOf(difference), 1));
  return (in_step - against) / (in_step + against);
}

VibrationSpectrum::VibrationSpectrum(const VibrationSamples& samples, std::span<const double> residual,
                                     std::span<const double> weights, SpectrumAxis axis) {
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  highest_ = 1e300;
  cell_ = 1e300;
  step_ = 1e300;
  for (const VibrationRun& run : samples.runs) {
    const bool turns = axis == SpectrumAxis::kTurns;
    const std::vector<double>& abscissa = turns ? run.angle_rad : run.time_s;
    const double length = turns ? abscissa.back() / kTwoPi : abscissa.back();
    const double step = abscissa.back() / static_cast<double>(abscissa.size() - 1);
    bool even = true;
    for (std::size_t i = 0; i < abscissa.size() && even; ++i) {
      even = std::abs(abscissa[i] - step * static_cast<double>(i)) < 0.02 * step;
    }
    Run own;
    for (const VibrationSegment& channel : run.channels) {
      std::vector<double> values = AtEvenSteps(abscissa, residual.subspan(channel.first, run.size()),
                                               weights.subspan(channel.first, run.size()), step, even);
      const std::size_t size = std::bit_ceil(kSpectrumPadding * values.size());
      values.resize(size, 0.0);
      std::vector<std::complex<double>> spectrum;
      transform.fwd(spectrum, values);
      std::vector<double> power(size / 2);
      for (std::size_t j = 0; j < power.size(); ++j) power[j] = std::norm(spectrum[j]);
      const std::vector<double> background = BackgroundOf(power, kSpectrumPadding);
      std::vector<std::complex<float>> amplitudes(power.size());
      own.power.resize(power.size(), 0.0F);
      own.per_step = static_cast<double>(size) * step / (turns ? kTwoPi : 1.0);
      own.step = 1.0 / own.per_step;
      for (std::size_t j = 0; j < power.size(); ++j) {
        own.power[j] += static_cast<float>(power[j] / background[j]);
        amplitudes[j] = std::complex<float>(spectrum[j] / std::sqrt(background[j]));
      }
      own.of_channel.push_back(std::move(amplitudes));
      ++channels_;
    }
    highest_ = std::min(highest_, own.step * static_cast<double>(own.power.size() - 1));
    cell_ = std::min(cell_, 1.0 / length);
    step_ = std::min(step_, own.step);
    runs_.push_back(std::move(own));
  }
}

double VibrationSpectrum::At(double order) const noexcept {
  if (!(order > 0.0)) return 0.0;
  double sum = 0.0;
  for (const Run& run : runs_) {
    const auto bin = static_cast<std::size_t>(order * run.per_step + 0.5);
    if (bin < run.power.size()) sum += static_cast<double>(run.power[bin]);
  }
  return sum;
}

void VibrationSpectrum::AmplitudesAt(std::size_t run, double order,
                                     std::span<std::complex<float>> amplitudes) const noexcept {
  const Run& own = runs_[run];
  const auto bin = static_cast<std::size_t>(std::max(0.0, order) * own.per_step + 0.5);
  for (std::size_t c = 0; c < amplitudes.size(); ++c) {
    const bool known = c < own.of_channel.size() && bin < own.power.size();
    amplitudes[c] = known ? own.of_channel[c][bin] : std::complex<float>();
  }
}

std::vector<SpectrumPeak> FindPeaks(const VibrationSpectrum& spectrum, double lowest, double highest,
                                    std::size_t count) {
  const double step = spectrum.step();
  std::vector<SpectrumPeak> peaks;
  highest = std::min(highest, spectrum.highest());
  double before = 0.0;
  double here = spectrum.At(lowest);
  for (double order = lowest; order < highest; order += step) {
    const double after = spectrum.At(order + step);
    if (here > before && here >= after) {
      const double bend = before - 2.0 * here + after;
      const double shift = bend < 0.0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
      peaks.push_back({order + shift * step, here});
    }
    before = here;
    here = after;
  }
  std::sort(peaks.begin(), peaks.end(),
            [](const SpectrumPeak& a, const SpectrumPeak& b) { return a.power > b.power; });
  std::vector<SpectrumPeak> chosen;
  for (const SpectrumPeak& peak : peaks) {
    if (chosen.size() == count) break;
    const bool near = std::any_of(chosen.begin(), chosen.end(), [&](const SpectrumPeak& other) {
      return std::abs(other.order - peak.order) < 1.5 * spectrum.cell();
    });
    if (!near) chosen.push_back(peak);
  }
  return chosen;
}

double ExcessOf(double sum, double cells) noexcept {
  if (!(sum > cells)) return 0.0;
  const double mean = sum / cells;
  return cells * (mean - 1.0 - std::log(mean));
}

}  // namespace strainwave::analysis::diagnosis
