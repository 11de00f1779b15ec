// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/prediction/signal_settings.h"

namespace strainwave::bench {

/// What the vibration of a gear depends on beside its state.
enum class OperatingQuantity { kOutputTorque, kInputSpeed, kTemperature };
inline constexpr std::array kOperatingQuantities{
    OperatingQuantity::kOutputTorque, OperatingQuantity::kInputSpeed, OperatingQuantity::kTemperature};

/// `output_torque_Nm`, `input_speed_rpm`, `temperature_degC`: how columns, metadata and channels tell them,
/// and the units of all numbers here. Torque and speed are without their sign, the temperature is the gear's.
std::string_view NameOf(OperatingQuantity quantity);

/// Under what a gear runs, as far as it is known.
class OperatingPoint {
 public:
  std::optional<double>& operator[](OperatingQuantity quantity) {
    return values_[static_cast<std::size_t>(quantity)];
  }
  const std::optional<double>& operator[](OperatingQuantity quantity) const {
    return values_[static_cast<std::size_t>(quantity)];
  }

 private:
  std::array<std::optional<double>, kOperatingQuantities.size()> values_;
};

/// What can tell a quantity: its own name, or another, whose values are multiplied by `factor`.
struct OperatingName {
  std::string_view name;
  OperatingQuantity quantity;
  double factor;
};
std::span<const OperatingName> OperatingNames();

/// The means over those of the signals that tell a quantity. None where a value is no number or none that the
/// quantity can have.
OperatingPoint OperatingPointOf(std::span<const NamedSignal> signals);

/// `own`, and from `given` what it does not know.
OperatingPoint Completed(const OperatingPoint& own, const OperatingPoint& given);

/// Where both know a quantity and differ by more than it may leave a range: "output_torque_Nm is 5 and was
/// given as 40; 5 counts".
std::vector<std::string> Contradictions(const OperatingPoint& own, const OperatingPoint& given);

/// The range of the operating points that a predictor was trained at. A quantity is known where every point
/// knows it.
class OperatingEnvelope {
 public:
  struct Range {
    double least{};
    double greatest{};
    bool operator==(const Range&) const = default;
  };

  void Include(const OperatingPoint& point);
  void Include(const OperatingEnvelope& other);

  std::optional<Range> RangeOf(OperatingQuantity quantity) const;

  /// What leaves the envelope: "output_torque_Nm is 5 (trained at 40.1 to 40.3)".
  std::vector<std::string> Left(const OperatingPoint& point) const;

  /// What cannot be judged: "output_torque_Nm is not known (trained at 40.1 to 40.3)", and what training did
  /// not know.
  std::vector<std::string> NotKnown(const OperatingPoint& point) const;

  /// "output_torque_Nm 40.1 to 40.3, input_speed_rpm 2400, temperature_degC not known".
  std::string Text() const;

  /// The names of what training did not know.
  std::vector<std::string> WithoutRange() const;

  /// `{"output_torque_Nm": [40.1, 40.3], "input_speed_rpm": …, "temperature_degC": null}`.
  nlohmann::ordered_json Json() const;
  /// @throws nlohmann::json::exception, std::invalid_argument for a range that is none.
  static OperatingEnvelope From(const nlohmann::ordered_json& json);

 private:
  struct Seen {
    std::optional<Range> range;
    bool everywhere{true};
  };
  void Include(OperatingQuantity quantity, const std::optional<Range>& range);

  std::array<Seen, kOperatingQuantities.size()> seen_;
};

/// Why something is outside, in words: "2.0 times the limit", "output_torque_Nm is 5 (trained at 40)", or
/// both.
std::string OutsideText(double distance, const std::vector<std::string>& left);

}  // namespace strainwave::bench
