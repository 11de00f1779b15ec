// SPDX-License-Identifier: Apache-2.0
#include "analysis/networks/batch_gradient.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace strainwave::analysis::networks {
namespace {

using Eigen::Index;

// Smaller slices would leave the matrix products too little to do, more would be many gradients to add.
constexpr Index kFewestSamples = 16;
constexpr Index kMostSlices = 8;
// Each slice reads all parameters and writes a gradient of them. Of 2500 samples in batches of 32 through
// `ann`, whose samples use each parameter once, an epoch takes a quarter less in slices of 32 than of 16
// (predictor_benchmark).
constexpr Index kFewestUses = 32;

Index FewestSamplesOf(const Network& network) {
  Index products = 1;  // of a sample with parameters
  for (const Network::Stage& stage : network.stages()) products += stage.weights * stage.output.length;
  return std::max(kFewestSamples, kFewestUses * network.parameter_count() / products);
}

}  // namespace

template <typename Scalar>
BatchGradient<Scalar>::BatchGradient(const Network& network, Loss loss, ParallelFor parallel)
    : network_(network),
      loss_(loss),
      parallel_(std::move(parallel)),
      fewest_samples_(FewestSamplesOf(network)) {}

template <typename Scalar>
template <typename Task>
double BatchGradient<Scalar>::OverSlices(Index samples, const Task& task) {
  if (samples < 1) throw std::invalid_argument("inputs has 0 columns (expected at least one sample)");
  const Index count = std::clamp<Index>(samples / fewest_samples_, 1, kMostSlices);
  used_ = static_cast<std::size_t>(count);
  slices_.resize(std::max(slices_.size(), used_));
  parallel_(used_, [&](std::size_t slice) {
    const auto number = static_cast<Index>(slice);
    const Index begin = number * samples / count;
    task(slices_[slice], begin, (number + 1) * samples / count - begin);
  });
  double loss = 0.0;
  for (std::size_t slice = 0; slice < used_; ++slice) loss += slices_[slice].loss;
  return loss;
}

template <typename Scalar>
double BatchGradient<Scalar>::Compute(const Vector<Scalar>& parameters,
                                      const Eigen::Ref<const Matrix<Scalar>>& inputs,
                                      const Eigen::Ref<const Matrix<Scalar>>& targets) {
  const double loss = OverSlices(inputs.cols(), [&](Slice& slice, Index begin, Index samples) {
    const auto own = inputs.middleCols(begin, samples);
    const Matrix<Scalar>& outputs = Forward<Scalar>(network_, parameters, own, slice.pass);
    slice.loss = LossShare<Scalar>(loss_, outputs, targets.middleCols(begin, samples), inputs.cols(),
                                   &slice.pass.gradients.back());
    Backward<Scalar>(network_, parameters, own, slice.pass, slice.gradient);
  });
  for (std::size_t slice = 1; slice < used_; ++slice) slices_[0].gradient += slices_[slice].gradient;
  return loss;
}

template <typename Scalar>
double BatchGradient<Scalar>::ComputeLoss(const Vector<Scalar>& parameters,
                                          const Eigen::Ref<const Matrix<Scalar>>& inputs,
                                          const Eigen::Ref<const Matrix<Scalar>>& targets) {
  return OverSlices(inputs.cols(), [&](Slice& slice, Index begin, Index samples) {
    const Matrix<Scalar>& outputs =
        Forward<Scalar>(network_, parameters, inputs.middleCols(begin, samples), slice.pass);
    slice.loss =
        LossShare<Scalar>(loss_, outputs, targets.middleCols(begin, samples), inputs.cols(), nullptr);
  });
}

template class BatchGradient<float>;
template class BatchGradient<double>;

}  // namespace strainwave::analysis::networks
