// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace strainwave::daq {

/// One thing that is wrong in a record file.
struct Finding {
  std::string place;  // "run.csv:7:3", or the file alone where it has no lines
  std::string what;
  std::string expected;
};

/// A record file that cannot be taken as it is, with everything that was found wrong in it.
/// `what()` holds one line a finding, `PLACE: error: WHAT (expected EXPECTED)`, at most `kMostShown` of them,
/// and a last line with the number of those left out.
class RecordError : public std::runtime_error {
 public:
  static constexpr std::size_t kMostShown = 20;

  /// `findings` is not empty.
  explicit RecordError(std::vector<Finding> findings);
  RecordError(std::string place, std::string what, std::string expected)
      : RecordError(std::vector<Finding>{{std::move(place), std::move(what), std::move(expected)}}) {}

  const std::vector<Finding>& findings() const { return findings_; }

 private:
  std::vector<Finding> findings_;
};

}  // namespace strainwave::daq
