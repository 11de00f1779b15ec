// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/cycle_curves.h"

#include <cstddef>
#include <optional>

#include "analysis/quantities.h"
#include "analysis/units.h"
#include "bench/campaign/recompute.h"

namespace strainwave::bench {

namespace quantities = analysis::quantities;

std::vector<double> TwistOf(const daq::Record& record, double compliance_rad_per_Nm) {
  std::vector<double> twist_rad;
  const auto angle_deg = record.Doubles("output_angle_deg");
  const auto torque_Nm = record.Doubles("torque_Nm");
  for (std::size_t i = 0; i < angle_deg.size(); ++i) {
    twist_rad.push_back(RadFromDeg(angle_deg[i] - angle_deg.front()) - compliance_rad_per_Nm * torque_Nm[i]);
  }
  return twist_rad;
}

void AddUncertainty(const BenchCorrections& corrections, analysis::TransmissionError& error) {
  const auto add = [&](std::optional<analysis::SweepError>& sweep, const analysis::Quantity& quantity) {
    if (!sweep) return;
    const analysis::Estimate arcmin{ArcminFromRad(sweep->e_max_rad.value),
                                    ArcminFromRad(sweep->e_max_rad.standard_error)};
    sweep->e_max_rad.standard_error =
        RadFromArcmin(WithEncoderUncertainty(arcmin, quantity, corrections).standard_error);
  };
  add(error.cw, quantities::kEMax);
  add(error.ccw, quantities::kEMaxCcw);
}

CycleCurves ReadCycleCurves(const CampaignFolder& folder, const Journal& journal, int cycle,
                            const CycleContext& context) {
  CycleCurves drawn;
  drawn.records = ReadCycleRecords(folder, journal, cycle);
  drawn.analysis = AnalyzeCycle(drawn.records, context);
  if (drawn.analysis.transmission_error)
    AddUncertainty(context.corrections, *drawn.analysis.transmission_error);
  if (drawn.analysis.loop != nullptr) {
    drawn.twist_rad =
        TwistOf(*drawn.analysis.loop, context.corrections.series_compliance.compliance_rad_per_Nm.value);
    const auto torque = drawn.analysis.loop->Doubles("torque_Nm");
    drawn.torque_Nm.assign(torque.begin(), torque.end());
  }
  return drawn;
}

}  // namespace strainwave::bench
