// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace strainwave::daq {

/// What a record measured (docs/contract.md#record-files): one of the kinds that there are, or, of a file
/// that is yet to be checked, the text that names none of them.
class RecordKind {
 public:
  enum Value { kUnknown, kTransmissionError, kHysteresis, kMotion, kVibration, kMotor, kJoints, kHistory };

  RecordKind() = default;
  RecordKind(Value value) : value_(value) {}  // NOLINT(google-explicit-constructor): a value is a kind
  /// @param name  as files have it: "transmission_error"
  static RecordKind Named(std::string_view name);

  Value value() const { return value_; }
  /// As files have it; of an unknown kind the text that it was made from.
  std::string_view name() const;

  friend bool operator==(const RecordKind& a, const RecordKind& b) = default;
  friend bool operator==(const RecordKind& a, Value b) { return a.value_ == b; }

 private:
  Value value_{kUnknown};
  std::string unknown_;
};

}  // namespace strainwave::daq
