// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "analysis/networks/loss.h"
#include "analysis/networks/network.h"
#include "analysis/parallel_for.h"

namespace strainwave::analysis::networks {

/// Loss and gradient of a batch. The batch is cut into slices, as many as its size and the network say alone,
/// and what they give is added in their order: the same bits on any number of threads.
template <typename Scalar>
class BatchGradient {
 public:
  /// @param network  must outlive this.
  BatchGradient(const Network& network, Loss loss, ParallelFor parallel);

  /// @param inputs, targets  one sample a column, at least one.
  /// @return the loss.
  double Compute(const Vector<Scalar>& parameters, const Eigen::Ref<const Matrix<Scalar>>& inputs,
                 const Eigen::Ref<const Matrix<Scalar>>& targets);
  /// Of the last `Compute`; the caller may change it.
  Vector<Scalar>& gradient() { return slices_.front().gradient; }

  /// The loss alone.
  double ComputeLoss(const Vector<Scalar>& parameters, const Eigen::Ref<const Matrix<Scalar>>& inputs,
                     const Eigen::Ref<const Matrix<Scalar>>& targets);

 private:
  struct Slice {
    Pass<Scalar> pass;
    Vector<Scalar> gradient;
    double loss{};
  };
  // Runs `task(slice, first sample, samples)` over the slices; returns the sum of their losses.
  template <typename Task>
  double OverSlices(Eigen::Index samples, const Task& task);

  const Network& network_;
  Loss loss_;
  ParallelFor parallel_;
  Eigen::Index fewest_samples_;  // of a slice
  std::vector<Slice> slices_;
  std::size_t used_{};
};

}  // namespace strainwave::analysis::networks
