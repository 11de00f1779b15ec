// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "schedules/reader/findings.h"

namespace strainwave::schedules {

/// One value of a file in a comparison: what it is called there, and what it is worth in SI.
struct Named {
  std::string path;  // "phases[2].output_torque"
  double value{};
};

/// Compares values of one file, or of two, and words what does not hold in the text of the files:
/// "output_torque = 80 Nm is above output_torque = 60 Nm (line 14)".
/// A comparison with a value that could not be read is not made: its mistake has been reported.
class Comparison {
 public:
  /// @param origins, findings  of the file whose values stand on the left; must outlive this.
  Comparison(const Origins& origins, FindingList& findings) : origins_(origins), findings_(findings) {}

  bool Readable(std::string_view path) const;
  /// "80 Nm" as the file has it; the bare SI number for a value that came from no file.
  std::string Written(const Named& value) const;

  void MustNotExceed(const Named& left, const Named& right) const;
  void MustBeBelow(const Named& left, const Named& right) const;
  void MustReach(const Named& left, const Named& right) const;
  /// Against a value of another file: "output_torque = 120 Nm is above the torque transducer's range = 100 Nm
  /// (bench.yaml, line 12)".
  void MustNotExceed(const Named& left, std::string_view foreign_name, const Named& right,
                     const Origins& foreign_origins, std::string_view foreign_file) const;

  void Error(std::string_view path, std::string message) const;
  void Warning(std::string_view path, std::string message) const;

 private:
  struct Place {
    int line{};
    int column{};
  };
  Place PlaceOf(std::string_view path) const;
  void Say(const Named& left, std::string_view relation, const Named& right) const;

  const Origins& origins_;
  FindingList& findings_;
};

/// The last part of a path: "output_torque".
std::string_view KeyOf(std::string_view path);

}  // namespace strainwave::schedules
