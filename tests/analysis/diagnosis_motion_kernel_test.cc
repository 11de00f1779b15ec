// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/motion/kernel.h"

namespace strainwave::analysis::diagnosis::diagnosis_motion_kernel_test {
namespace {

// A slow motion is a parabola under the kernel: an acceleration that is a thousandth off there is an inertia
// that is a thousandth off, ten standard errors of a long record.
TEST(MotionKernel, DerivesAParabolaExactly) {
  constexpr double kStep_s = 0.01;
  constexpr double kPlace = 2.0, kSpeed = -3.0, kHalfAcceleration = 5.0;
  for (const double sigma : {1.24, 1.6, 3.0, 6.0, 20.0}) {
    for (const double shift_s : {0.0, 0.3 * kStep_s, -1.7 * kStep_s}) {
      for (const int derivative : {0, 1, 2}) {
        const KernelTaps kernel = MakeKernel(sigma * kStep_s, kStep_s, derivative, shift_s);
        std::vector<double> samples;
        for (std::size_t k = 0; k < kernel.taps.size(); ++k) {
          const double time_s = (static_cast<double>(k) - static_cast<double>(kernel.reach)) * kStep_s;
          samples.push_back(kPlace + kSpeed * time_s + kHalfAcceleration * time_s * time_s);
        }
        const double expected[] = {kPlace + kSpeed * shift_s + kHalfAcceleration * shift_s * shift_s,
                                   kSpeed + 2.0 * kHalfAcceleration * shift_s, 2.0 * kHalfAcceleration};
        EXPECT_NEAR(kernel.At(samples, kernel.reach), expected[derivative], 1e-8)
            << sigma << " steps, " << shift_s << " s, derivative " << derivative;
      }
    }
  }
}

TEST(MotionKernel, LetsSlowSinesThroughAndFastOnesNot) {
  constexpr double kSigma = 3.0;  // of a step of 1
  for (const auto& [omega, passed] : {std::pair{0.03, 1.0}, std::pair{0.3, 1.0}, std::pair{1.25, 0.0}}) {
    for (const int derivative : {0, 2}) {
      const KernelTaps kernel = MakeKernel(kSigma, 1.0, derivative);
      std::vector<double> samples;
      for (std::size_t k = 0; k < kernel.taps.size(); ++k)
        samples.push_back(std::cos(omega * (static_cast<double>(k) - static_cast<double>(kernel.reach))));
      const double scale = derivative == 2 ? -omega * omega : 1.0;
      EXPECT_NEAR(kernel.At(samples, kernel.reach) / scale, passed, 1e-3) << omega << ' ' << derivative;
    }
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_motion_kernel_test
