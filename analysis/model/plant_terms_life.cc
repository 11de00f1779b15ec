// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/plant_term_groups.h"

namespace strainwave::analysis::model {

void AddLife(PlantParameters& p, std::vector<BoundTerm>& terms) {
  WearRates& wear = p.wear;
  terms.push_back({"run_in",
                   "E23",
                   {{"life_share", "1", &wear.run_in_life_share, 1e12, true},
                    Amount("tooth_rate", "1", wear.tooth_running_in)}});
  terms.push_back({"tooth_wear",
                   "E23",
                   {Amount("steady", "1", wear.tooth_steady), Amount("late", "1", wear.tooth_late),
                    Amount("grease_coupling", "1", wear.tooth_grease_coupling),
                    Scale("doubling_K", "K", wear.tooth_doubling_K)}});
  terms.push_back(
      {"flexspline_fatigue",
       "E23",
       {Amount("start", "1", wear.flexspline_start), Amount("growth", "1", wear.flexspline_growth)}});
  terms.push_back(
      {"grease_ageing",
       "E23",
       {Amount("rate", "1", wear.grease_rate), Scale("doubling_K", "K", wear.grease_doubling_K)}});
  SpecimenScatter& sd = p.scatter;
  terms.push_back({"specimen_scatter",
                   "E25",
                   {Amount("stiffness", "1", sd.stiffness), Amount("kinematic", "1", sd.kinematic),
                    Amount("friction", "1", sd.friction), Amount("wear_rate", "1", sd.wear_rate),
                    Amount("wear_effect", "1", sd.wear_effect), Amount("vibration", "1", sd.vibration)}});
  terms.push_back(
      {"seating_scatter",
       "E25",
       {Amount("stiffness", "1", p.seating.stiffness), Amount("kinematic", "1", p.seating.kinematic)}});
}

void AddVibration(PlantParameters& p, std::vector<BoundTerm>& terms) {
  Vibration& v = p.vibration;
  BoundTerm shaft{"vibration_orders", "E14", {}};
  constexpr std::string_view kOrderNames[] = {"input_1_m_per_s2", "input_2_m_per_s2",  "input_4_m_per_s2",
                                              "tooth_m_per_s2",   "mesh_160_m_per_s2", "mesh_162_m_per_s2"};
  for (std::size_t k = 0; k < 3; ++k)
    shaft.parameters.push_back(Amount(kOrderNames[k], "m/s²", v.order_m_per_s2[k]));
  terms.push_back(std::move(shaft));
  BoundTerm mesh{"vibration_tooth_mesh", "E2", {}};
  for (std::size_t k = 3; k < kVibrationOrders; ++k) {
    mesh.parameters.push_back(Amount(kOrderNames[k], "m/s²", v.order_m_per_s2[k]));
  }
  mesh.parameters.push_back(Amount("sideband_depth", "1", v.sideband_depth));
  mesh.parameters.push_back(Amount("output_modulation", "1", v.output_modulation));
  terms.push_back(std::move(mesh));
  BoundTerm modes{"vibration_resonances", "", {}};
  constexpr std::string_view kModeNames[][3] = {{"mode_1_m_per_s2", "mode_1_Hz", "mode_1_damping"},
                                                {"mode_2_m_per_s2", "mode_2_Hz", "mode_2_damping"},
                                                {"mode_3_m_per_s2", "mode_3_Hz", "mode_3_damping"}};
  for (std::size_t m = 0; m < kVibrationModes; ++m) {
    modes.parameters.push_back(Amount(kModeNames[m][0], "m/s²", v.mode_m_per_s2[m]));
    modes.parameters.push_back(Scale(kModeNames[m][1], "Hz", v.mode_Hz[m]));
    modes.parameters.push_back(Scale(kModeNames[m][2], "1", v.mode_damping[m]));
  }
  terms.push_back(std::move(modes));
  terms.push_back({"vibration_noise",
                   "",
                   {Amount("broadband_m_per_s2", "m/s²", v.broadband_m_per_s2),
                    Amount("sensor_m_per_s2", "m/s²", v.sensor_noise_m_per_s2)}});
  terms.push_back(
      {"vibration_drift",
       "",
       {Amount("sensor_drift", "1", v.sensor_drift), Amount("scatter_per_run", "1", v.scatter_per_run)}});
}

void AddVibrationCauses(PlantParameters& p, std::vector<BoundTerm>& terms) {
  VibrationCauses& v = p.vibration_causes;
  terms.push_back(
      {"vibration_bearing_defect",
       "E24",
       {Amount("amplitude_m_per_s2", "m/s²", v.bearing.amplitude_m_per_s2),
        Scale("order_per_turn", "1", v.bearing.order), Nonlinear("phase_rad", "rad", v.bearing.phase_rad),
        Nonlinear("modulation", "1", v.bearing.modulation),
        Amount("ringing_m_per_s2", "m/s²", v.bearing.ringing.amplitude_m_per_s2),
        Scale("mode_Hz", "Hz", v.bearing.ringing.mode_Hz),
        Scale("mode_damping", "1", v.bearing.ringing.mode_damping)}});
  terms.push_back({"vibration_imbalance",
                   "",
                   {Amount("amplitude_m_per_s2", "m/s²", v.imbalance.amplitude_m_per_s2),
                    Nonlinear("phase_rad", "rad", v.imbalance.phase_rad),
                    Scale("reference_speed_rad_per_s", "rad/s", v.imbalance.reference_speed_rad_per_s)}});
  terms.push_back({"vibration_flexspline_crack",
                   "E23",
                   {Amount("amplitude_m_per_s2", "m/s²", v.crack.amplitude_m_per_s2),
                    Nonlinear("phase_rad", "rad", v.crack.phase_rad),
                    Nonlinear("harmonic_share", "1", v.crack.harmonic_share),
                    Nonlinear("modulation", "1", v.crack.modulation),
                    Amount("ringing_m_per_s2", "m/s²", v.crack.ringing.amplitude_m_per_s2),
                    Scale("mode_Hz", "Hz", v.crack.ringing.mode_Hz),
                    Scale("mode_damping", "1", v.crack.ringing.mode_damping)}});
  terms.push_back(
      {"vibration_torsional_resonance",
       "E15",
       {Size("deviation_m_per_s2", "m/s²", v.mode.deviation_m_per_s2),
        Amount("line_m_per_s2", "m/s²", v.mode.line_m_per_s2), Scale("line_order", "1", v.mode.line_order),
        Scale("frequency_Hz", "Hz", v.mode.frequency_Hz), Scale("damping", "1", v.mode.damping)}});
}

}  // namespace strainwave::analysis::model
