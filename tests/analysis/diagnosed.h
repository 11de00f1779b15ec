// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/diagnose.h"
#include "analysis/diagnosis/records.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::diagnosis {

using Names = std::vector<std::string>;

/// What the program says of records, by name.
struct Diagnosed {
  std::unique_ptr<Study> study;
  Diagnosis diagnosis;

  Names names() const {
    Names names;
    for (const Finding& cause : diagnosis.causes) names.push_back(study->causes()[cause.index].name);
    return names;
  }
  /// A parameter of the first cause; not a number where there is none.
  ParameterValue value(const std::string& parameter) const {
    if (!diagnosis.causes.empty()) {
      for (const ParameterValue& value : diagnosis.causes.front().parameters) {
        if (value.name == parameter) return value;
      }
    }
    return {parameter, "", NAN, NAN};
  }
  ParameterValue nominal(const std::string& parameter) const {
    for (const ParameterValue& value : diagnosis.extended.nominal) {
      if (value.name == parameter) return value;
    }
    return {parameter, "", NAN, NAN};
  }
};

/// What a study says when it refuses a record; empty where it takes it.
template <typename Data>
std::string RefusalOf(std::unique_ptr<Study> (*make)(std::span<const Data>), const Data& record) {
  return MessageOf([&] { make({&record, 1}); });
}

/// @param make  one of records.h
template <typename Data>
Diagnosed DiagnoseRecords(std::unique_ptr<Study> (*make)(std::span<const Data>),
                          const std::vector<Data>& records) {
  Diagnosed diagnosed;
  diagnosed.study = make(records);
  diagnosed.diagnosis = Diagnose(*diagnosed.study);
  return diagnosed;
}

}  // namespace strainwave::analysis::diagnosis
