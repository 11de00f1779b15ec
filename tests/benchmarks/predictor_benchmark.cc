// SPDX-License-Identifier: Apache-2.0
// How long a vibration record takes to become features, and an epoch of the two networks. Run:
// build/benchmarks/predictor_benchmark [--widest avx2|sse4|none] [options of Google Benchmark]; --widest
// leaves wider vectors of this machine unused. Beside what others take: tests/benchmarks/run
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string_view>
#include <vector>

#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include "analysis/features/wavelet_features.h"
#include "analysis/networks/training.h"
#include "analysis/wavelets/decomposition.h"
#include "bench/campaign/on_all_processors.h"
#include "tests/benchmarks/peaks.h"

namespace strainwave::analysis {
namespace {

// Meshing harmonics and noise, as the peers' record.
std::vector<std::vector<double>> Record(std::size_t channels, std::size_t samples) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> record(channels, std::vector<double>(samples));
  for (std::size_t c = 0; c < channels; ++c) {
    for (std::size_t i = 0; i < samples; ++i) {
      const double turn = 437.0 * (1.0 + 0.01 * static_cast<double>(c)) * static_cast<double>(i) / 51200.0;
      double value = 0.5 * normal(random);
      for (int harmonic = 1; harmonic <= 5; ++harmonic)
        value += std::sin(6.2831853 * harmonic * turn) / harmonic;
      record[c][i] = value;
    }
  }
  return record;
}

void Decomposes(benchmark::State& state, wavelets::Details details) {
  const auto record =
      Record(static_cast<std::size_t>(state.range(0)), static_cast<std::size_t>(state.range(1)));
  const wavelets::FilterBank bank = wavelets::FilterBankOf("sym8");
  wavelets::Decomposition decomposition;
  for (auto _ : state) {
    for (const std::vector<double>& channel : record) {
      wavelets::Decompose(channel, bank, wavelets::Border::kSymmetric, 7, details, decomposition);
      benchmark::DoNotOptimize(decomposition.approximations.back().data());
    }
  }
}
BENCHMARK_CAPTURE(Decomposes, approximations, wavelets::Details::kLeaveOut)
    ->Args({4, 102400})
    ->Args({6, 200000})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Decomposes, all, wavelets::Details::kKeep)
    ->Args({4, 102400})
    ->Args({6, 200000})
    ->Unit(benchmark::kMillisecond);

void ComputesTheFeatures(benchmark::State& state) {
  const auto record =
      Record(static_cast<std::size_t>(state.range(0)), static_cast<std::size_t>(state.range(1)));
  features::WaveletFeatures features;
  std::vector<double> values(features.CountPerChannel());
  for (auto _ : state) {
    for (const std::vector<double>& channel : record) {
      features.Compute(channel, values);
      benchmark::DoNotOptimize(values.data());
    }
  }
}
BENCHMARK(ComputesTheFeatures)->Args({4, 102400})->Args({6, 200000})->Unit(benchmark::kMillisecond);

void TrainsAnEpoch(benchmark::State& state, const char* model, const ParallelFor& parallel) {
  const networks::Network network(networks::DesignOf(model, 204, 4));
  networks::Samples<float> samples{networks::Matrix<float>::Random(204, 2500),
                                   networks::Matrix<float>::Random(4, 2500).array() + 3.0F};
  networks::TrainingOptions options;
  options.epochs = 1;
  options.batch = static_cast<int>(state.range(0));
  options.parallel = parallel;
  networks::Vector<float> parameters = networks::InitialParameters<float>(network, 1);
  for (auto _ : state) networks::Train(network, samples, {}, options, parameters);
}
BENCHMARK_CAPTURE(TrainsAnEpoch, ann, "ann", InTurn)->Arg(32)->Arg(2500)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(TrainsAnEpoch, cnn, "cnn", InTurn)->Arg(32)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(TrainsAnEpoch, ann_threads, "ann", bench::OnAllProcessors)
    ->Arg(32)
    ->Arg(2500)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(TrainsAnEpoch, cnn_threads, "cnn", bench::OnAllProcessors)
    ->Arg(32)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void PredictsOneRecord(benchmark::State& state) {
  const networks::Network network(networks::DesignOf("ann", 204, 4));
  const auto parameters = networks::InitialParameters<float>(network, 1);
  const networks::Matrix<float> input = networks::Matrix<float>::Random(204, 1);
  networks::Pass<float> pass;
  for (auto _ : state) {
    benchmark::DoNotOptimize(networks::Forward<float>(network, parameters, input, pass).data());
  }
}
BENCHMARK(PredictsOneRecord)->Unit(benchmark::kMicrosecond);

// The roof over the others: operations a second, and bytes a second from and to memory.
template <typename Scalar>
void MultipliesAndAdds(benchmark::State& state) {
  Scalar value = 1;
  double operations = 0.0;
  for (auto _ : state) operations += peaks::MultiplyAdd(100000, value);
  benchmark::DoNotOptimize(value);
  state.counters["per_second"] = benchmark::Counter(operations, benchmark::Counter::kIsRate);
}
BENCHMARK_TEMPLATE(MultipliesAndAdds, float);
BENCHMARK_TEMPLATE(MultipliesAndAdds, double);

void CopiesMemory(benchmark::State& state) {
  const std::vector<double> from(std::size_t{1} << 25U, 1.0);  // past every cache but the largest of servers
  std::vector<double> to(from.size());
  for (auto _ : state) {
    std::copy(from.begin(), from.end(), to.begin());
    benchmark::DoNotOptimize(to.data());
    benchmark::ClobberMemory();
  }
  const auto bytes = 2.0 * sizeof(double) * static_cast<double>(from.size() * state.iterations());
  state.counters["per_second"] = benchmark::Counter(bytes, benchmark::Counter::kIsRate);
}
BENCHMARK(CopiesMemory);

// False for a word that it does not know.
bool UseAtMost(std::string_view widest) {
  constexpr std::int64_t kAboveAvx2 = HWY_AVX3 | HWY_AVX3_DL;
  constexpr std::int64_t kAboveSse4 = kAboveAvx2 | HWY_AVX2;
  if (widest == "avx2") {
    hwy::DisableTargets(kAboveAvx2);
  } else if (widest == "sse4") {
    hwy::DisableTargets(kAboveSse4);
  } else if (widest == "none") {
    hwy::DisableTargets(kAboveSse4 | HWY_SSE4 | HWY_SSSE3);
  } else {
    return false;
  }
  return true;
}

}  // namespace
}  // namespace strainwave::analysis

int main(int argc, char** argv) {
  if (argc > 2 && std::string_view(argv[1]) == "--widest") {
    if (!strainwave::analysis::UseAtMost(argv[2])) {
      std::fputs("--widest takes avx2, sse4 or none\n", stderr);
      return 2;
    }
    argv[2] = argv[0];
    argv += 2;
    argc -= 2;
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
