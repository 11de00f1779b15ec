// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/learning_curve.h"

#include <algorithm>
#include <atomic>
#include <mutex>

#include "analysis/prediction/informative_records.h"
#include "analysis/prediction/scaler.h"

namespace strainwave::analysis::prediction {
namespace {

constexpr Eigen::Index kFewest = 20;

std::vector<Eigen::Index> Even(Eigen::Index rows, Eigen::Index count) {
  std::vector<Eigen::Index> chosen;
  for (Eigen::Index i = 0; i < count; ++i) chosen.push_back(i * rows / count);
  return chosen;
}

}  // namespace

std::vector<LearningPoint> LearningCurve(const Samples& samples, const Split& split,
                                         const EnsembleSettings& settings, const FitProgress& progress) {
  const Samples pool = Rows(samples, split.train);
  const Samples test = Rows(samples, split.test);
  const Eigen::MatrixXd scaled = Standardizing(pool.features).Apply(pool.features);
  std::vector<LearningPoint> points;
  for (Eigen::Index count = std::min(kFewest, pool.size()); count < pool.size(); count *= 2) {
    points.push_back({count, 0.0, 0.0});
  }
  points.push_back({pool.size(), 0.0, 0.0});

  EnsembleSettings single = settings;
  single.members = 1;
  single.parallel = InTurn;
  single.training.parallel = InTurn;
  std::atomic<bool> go_on{true};
  std::mutex telling;
  double done = 0.0;
  settings.parallel(2 * points.size(), [&](std::size_t task) {
    if (!go_on) return;
    LearningPoint& point = points[task / 2];
    const bool active = task % 2 == 0;
    const Samples chosen =
        Rows(pool, active ? ChooseInformative(scaled, point.count) : Even(pool.size(), point.count));
    const Ensemble network = TrainEnsemble(chosen, single);
    const Contestant judged = Judge("network", test, network.Predict(test.features).mean);
    (active ? point.active_percent : point.even_percent) = judged.Error_percent();
    const std::lock_guard lock(telling);
    done += 1.0;
    if (progress && !progress(done / static_cast<double>(2 * points.size()))) go_on = false;
  });
  if (!go_on) throw TrainingEnded();
  return points;
}

}  // namespace strainwave::analysis::prediction
