// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <matio.h>

namespace strainwave::daq {

struct CloseMat {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};

/// A MAT file and a variable of one, as matio hands them out; null where it could not.
using MatHandle = std::unique_ptr<mat_t, CloseMat>;
using MatVariable = std::unique_ptr<matvar_t, FreeVariable>;

}  // namespace strainwave::daq
