// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>

#include <Eigen/Core>

namespace strainwave::bench {

/// An exported network as a monitor runs it: OpenCV's `dnn` module. One object a thread.
class OnnxNetwork {
 public:
  enum class Predicts { kValues, kClasses };

  /// @param bytes  of a file that `OnnxBytes` wrote. Whatever else they are, they are looked at before OpenCV
  ///   sees them: operators, sizes and shapes must be those of such a file.
  /// @throws std::invalid_argument saying what is not as expected.
  OnnxNetwork(const std::string& bytes, Eigen::Index inputs, Eigen::Index outputs,
              Predicts predicts = Predicts::kValues);
  OnnxNetwork(OnnxNetwork&&) noexcept;
  OnnxNetwork& operator=(OnnxNetwork&&) noexcept;
  ~OnnxNetwork();

  struct Output {
    Eigen::RowVectorXd prediction;  // of classes: their probabilities
    Eigen::RowVectorXd half_width;  // of classes: 0
    double distance{};
  };
  /// @param features  unscaled, as many as inputs.
  /// @throws std::invalid_argument for another number of features.
  Output Run(const Eigen::RowVectorXd& features);

 private:
  struct Net;
  std::unique_ptr<Net> net_;
  Eigen::Index inputs_;
  Eigen::Index outputs_;
};

/// "values", "classes".
constexpr const char* NameOf(OnnxNetwork::Predicts predicts) {
  return predicts == OnnxNetwork::Predicts::kClasses ? "classes" : "values";
}

}  // namespace strainwave::bench
