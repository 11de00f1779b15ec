// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "analysis/torsional_stiffness.h"
#include "analysis/transmission_error.h"
#include "daq/record.h"

namespace strainwave::bench {

/// Error of the output encoder as the blank test has found it, harmonics of one output turn; taken off the
/// output angle before the transmission error is formed.
struct EncoderCorrection {
  struct Harmonic {
    int order{};
    double cosine_rad{};
    double sine_rad{};
  };
  std::vector<Harmonic> harmonics;
  double standard_error_rad{};
};

/// What the bench knows of itself that a record does not say: all zero for a record from elsewhere.
struct BenchCorrections {
  analysis::SeriesCompliance series_compliance;
  double torque_gain_relative_se{};
  EncoderCorrection encoder;
};

/// Transmission error of a record of that kind (contract, sections 2 and 3).
analysis::TransmissionError TransmissionErrorOf(const daq::Record& record, const BenchCorrections& corrections);

/// Torsional stiffness of a hysteresis record, series compliance removed. The standard errors hold what the
/// record itself says; `AddCommonUncertainty` adds what all records of a bench share.
analysis::TorsionalStiffness StiffnessOf(const daq::Record& record, analysis::StiffnessMethod method,
                                         const BenchCorrections& corrections);

/// Adds the uncertainty of the torque calibration and of the series compliance to a stiffness. They are the
/// same for every loop, so averaging loops does not shrink them.
analysis::Estimate AddCommonUncertainty(const analysis::Estimate& stiffness_Nm_per_rad,
                                        const BenchCorrections& corrections);

}  // namespace strainwave::bench
