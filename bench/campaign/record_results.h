// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/quantities.h"
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
  double standard_error_rad{};      // of the correction
  double residual_rad{};            // of one reading after the correction
  double reference_accuracy_rad{};  // half width, of what the correction was measured against

  /// What the encoder reads too much where it reads this.
  double At(double reading_deg) const;
};

/// What the bench knows of itself that a record does not say: all zero for a record from elsewhere.
struct BenchCorrections {
  analysis::SeriesCompliance series_compliance;
  double torque_gain_relative_se{};
  EncoderCorrection encoder;
  double encoder_accuracy_rad{};  // of the output encoder, half width
  /// Standard deviation of one measurement repeated on this bench, by quantity ("k1_Nm_per_rad"); what no
  /// single record can say of itself: how the gear seats when it is locked, where the drives come to rest.
  std::map<std::string, double, std::less<>> repeatability;
};

/// True where a blank test has said what the bench adds to the twist.
bool KnowsCompliance(const BenchCorrections& corrections);

/// Transmission error of a record of that kind (docs/contract.md#transmission-error).
analysis::TransmissionError TransmissionErrorOf(const daq::Record& record,
                                                const BenchCorrections& corrections);

/// T1, T2 and T3 of a record, with the defaults of docs/contract.md#record-files.
analysis::TestTorques TestTorquesOf(const daq::Record& record);

/// Torsional stiffness of a hysteresis record, series compliance removed. The standard errors hold what the
/// record itself says; `WithBenchUncertainty` adds what the bench must say.
analysis::TorsionalStiffness StiffnessOf(const daq::Record& record, analysis::StiffnessMethod method,
                                         const BenchCorrections& corrections);

/// Adds to a stiffness what its records cannot say of themselves: the uncertainty of the torque calibration
/// and of the series compliance, which averaging loops does not shrink, and the repeatability of the
/// quantity.
analysis::Estimate WithBenchUncertainty(const analysis::Estimate& stiffness_Nm_per_rad,
                                        std::string_view quantity, const BenchCorrections& corrections);

/// The same for an angle in arcmin: the encoder's correction, what it leaves of each reading (e_max), the
/// accuracy of the encoder at the sample that is taken as zero (e_avg), and the repeatability.
analysis::Estimate WithEncoderUncertainty(const analysis::Estimate& angle_arcmin,
                                          const analysis::Quantity& quantity,
                                          const BenchCorrections& corrections);

}  // namespace strainwave::bench
