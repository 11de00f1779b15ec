// SPDX-License-Identifier: Apache-2.0
// Packets and 224 features of a cycle, and the search for the parameters of a Gaussian process, in the sizes
// of docs/health.md. Prints a line each: the median of several rounds, of processor time, so that what else
// the machine does counts less.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <random>
#include <vector>

#include "analysis/features/packet_features.h"
#include "analysis/statistics/gaussian_process.h"

namespace {

double ProcessorTime_us() { return 1e6 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

template <typename Work>
double Median_us(int rounds, int repeats, const Work& work) {
  std::vector<double> times_us;
  work();
  for (int round = 0; round < rounds; ++round) {
    const double start_us = ProcessorTime_us();
    for (int repeat = 0; repeat < repeats; ++repeat) work();
    times_us.push_back((ProcessorTime_us() - start_us) / repeats);
  }
  std::ranges::sort(times_us);
  return times_us[times_us.size() / 2];
}

}  // namespace

int main() {
  namespace features = strainwave::analysis::features;
  namespace statistics = strainwave::analysis::statistics;
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  std::vector<double> current(2400);
  std::vector<double> velocity(2400);
  for (std::size_t i = 0; i < current.size(); ++i) {
    const double time_s = static_cast<double>(i) / 1000.0;
    velocity[i] = std::clamp(3.0 * std::sin(6.283185307 * time_s / 2.4), -1.0, 1.0) + 0.01 * normal(engine);
    current[i] = 2.0 * velocity[i] + 0.3 * std::sin(6.283185307 * 47.3 * time_s) + 0.05 * normal(engine);
  }
  features::PacketFeatures packets;
  std::vector<double> values(packets.CountPerChannel());
  std::printf("packets db6 of 2 x 2400 samples, 224 features: %.1f us a cycle\n", Median_us(9, 400, [&] {
                packets.Compute(current, values);
                packets.Compute(velocity, values);
              }));
  for (const Eigen::Index coordinates : {1, 14}) {
    std::uniform_real_distribution<double> even(0.0, 10.0);
    Eigen::MatrixXd points(45, coordinates);
    Eigen::VectorXd measured(45);
    for (Eigen::Index i = 0; i < 45; ++i) {
      for (Eigen::Index k = 0; k < coordinates; ++k) points(i, k) = even(engine);
      measured(i) = std::sin(points(i, 0)) + 0.3 * points(i, coordinates - 1) + 0.1 * normal(engine);
    }
    const statistics::ReplicatedData data = statistics::Replicated(points, measured);
    double likelihood = 0.0;
    const double time_us =
        Median_us(9, 3, [&] { likelihood = statistics::FitGaussianProcess(data, {}).log_likelihood(); });
    std::printf("gaussian process of 45 points, %d coordinates, 10 restarts: %.2f ms, ln likelihood %.4f\n",
                static_cast<int>(coordinates), time_us / 1000.0, likelihood);
  }
  return 0;
}
