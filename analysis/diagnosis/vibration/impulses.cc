// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/impulses.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "analysis/diagnosis/vibration/families.h"
#include "analysis/diagnosis/vibration/ring.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Best = std::optional<TermFit>;

constexpr std::size_t kMostStarts = 12;
constexpr std::size_t kMostRefined = 2;
// What a train has to explain beyond its strongest line, in variances of the noise: more than its numbers
// take from noise, and more than a line that is no pure sine leaves.
constexpr double kBeyondLine = 28.0;
constexpr double kBeyondLineShare = 0.05;

double TurnHz(const VibrationRemainder& remainder) {
  return remainder.samples().runs.front().mean_speed_rad_per_s / kTwoPi;
}

VibrationTerm RingTerm(const VibrationRemainder& remainder, std::size_t index, double order, double ring_Hz,
                       double damping) {
  VibrationTerm term;
  term.cause = index;
  term.form = VibrationForm::kRing;
  term.heard.assign(remainder.samples().channels(), 1);
  term.shapes = {order, ring_Hz, damping};
  for (const VibrationRun& run : remainder.samples().runs) {
    term.shapes.push_back(BestRingPhase(run, {order, ring_Hz, damping, 0.0, {}}, remainder.residual(),
                                        remainder.solver().weights()));
  }
  return term;
}

// The best damping for a start, as it is.
Best FirstLook(const VibrationRemainder& remainder, std::size_t index, const TrainStart& start) {
  Best best;
  if (start.ring_Hz > 0.97 * remainder.samples().highest_Hz()) return best;
  for (const double damping : {0.015, 0.04, 0.12, 0.4}) {
    Keep(remainder.With(RingTerm(remainder, index, start.order, start.ring_Hz, damping), 0), best);
  }
  return best;
}

// A train that lets one of its harmonics ring is a line with too many numbers.
bool IsOneLine(const VibrationRemainder& remainder, const TermFit& solution) {
  const VibrationTerm& ring = solution.term;
  const VibrationSpectrum& spectrum = remainder.over_turns();
  double strongest = 0.0;
  double order = ring.shapes[0];
  for (int k = 1; k * ring.shapes[0] < spectrum.highest(); ++k) {
    if (spectrum.At(k * ring.shapes[0]) <= strongest) continue;
    strongest = spectrum.At(k * ring.shapes[0]);
    order = k * ring.shapes[0];
  }
  VibrationTerm line;
  line.cause = ring.cause;
  line.form = VibrationForm::kLines;
  line.heard = ring.heard;
  line.lines = {{1.0, 0.0}};
  line.shapes = {order};
  const TermFit alone = remainder.With(std::move(line), 3);
  const double by_line = (remainder.base().square_sum - alone.square_sum) / solution.variance();
  const double beyond = (alone.square_sum - solution.square_sum) / solution.variance();
  return beyond < kBeyondLine + kBeyondLineShare * by_line;
}

// Refines a first look, a period of the ring to both sides, and with each modulation.
void Improve(const VibrationRemainder& remainder, TermFit look, const std::vector<double>& modulations,
             Best& best) {
  Best plain = remainder.Refine(std::move(look), 12);
  for (const double periods : {-1.0, 1.0}) {
    VibrationTerm moved = plain->term;
    for (std::size_t r = 3; r < moved.shapes.size(); ++r) {
      moved.shapes[r] += periods * moved.shapes[0] * TurnHz(remainder) / moved.shapes[1];
    }
    Keep(remainder.With(std::move(moved), 6), plain);
  }
  const VibrationTerm simple = plain->term;
  Keep(std::move(*plain), best);
  for (const double modulation : modulations) {
    VibrationTerm term = simple;
    term.lines = {{0.0, modulation}};
    // A channel that the even impulses did not pay for may pay now.
    term.heard.assign(term.heard.size(), 1);
    term.shapes.insert(term.shapes.begin() + 3, {0.0, 0.0});
    Keep(remainder.With(std::move(term), 8), best);
  }
}

}  // namespace

Best SearchImpulses(const VibrationRemainder& remainder, std::size_t index,
                    const std::vector<TrainStart>& starts, const std::vector<double>& modulations,
                    const std::function<bool(double order)>& allowed) {
  std::vector<TermFit> looks;
  for (const TrainStart& start : starts) {
    if (looks.size() == kMostStarts) break;
    if (Best look = FirstLook(remainder, index, start)) {
      looks.push_back(remainder.Refine(std::move(*look), 3));
    }
  }
  std::sort(looks.begin(), looks.end(), [](const auto& a, const auto& b) { return a.bic() < b.bic(); });
  looks.resize(std::min(looks.size(), kMostRefined));
  Best best;
  for (TermFit& look : looks) Improve(remainder, std::move(look), modulations, best);
  if (!best) return best;
  // Every second impulse, or each twice: the same harmonics, or half of them.
  const VibrationTerm found = best->term;
  for (const double multiple : {0.5, 2.0, 3.0}) {
    const double order = multiple * found.shapes[0];
    if (!allowed(order)) continue;
    if (Best look = FirstLook(remainder, index, {order, found.shapes[1], 0.0})) {
      // A look that is far behind does not catch up.
      if (look->bic() < best->bic() + 60.0) Improve(remainder, std::move(*look), modulations, best);
    }
  }
  if (IsOneLine(remainder, *best)) return std::nullopt;
  return best;
}

}  // namespace strainwave::analysis::diagnosis
