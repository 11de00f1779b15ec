// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/parameter_words.h"

#include <algorithm>
#include <array>

#include "analysis/diagnosis/study.h"
#include "analysis/quantities.h"

namespace strainwave::bench {
namespace {

namespace quantities = analysis::quantities;

struct Words {
  std::string_view name;  // as it is, or how it begins
  std::string_view words;
};

// Beside the quantities of analysis/quantities.h. Of those that fit, the longest name counts. Units stand in
// the names and are not said again.
constexpr std::array kWords{
    // hysteresis
    Words{"k1_asymmetry_share", "by how much K1 is higher for positive than for negative torque"},
    Words{"k2_asymmetry_share", "the same of K2"},
    Words{"k3_asymmetry_share", "the same of K3"},
    Words{"k2_k3_asymmetry_share", "the same of K2 and K3 alike"},
    Words{"law_asymmetry_share", "the same of all three, each by its own"},
    Words{"asymmetry_share", "the same of all three alike"},
    Words{"k1_", quantities::kK1.meaning},
    Words{"k2_", quantities::kK2.meaning},
    Words{"k3_", quantities::kK3.meaning},
    Words{"second_friction_torque_Nm", "of the second friction element"},
    Words{"second_yield_twist_arcmin", "twist at which the second element slides"},
    Words{"third_friction_torque_Nm", "of the third friction element"},
    Words{"spread_friction_torque_Nm", "of elements that slide one after the other"},
    Words{"offset_arcmin", "where zero lies"},
    Words{"offset_Nm", "reading without torque"},
    Words{"start_share", "how far the friction was wound up at the start, -1 to 1"},
    Words{"load_start", "how far the friction was wound up at the start, -1 to 1"},
    Words{"backlash_", "play: width of the dead zone"},
    Words{"dead_zone_torque_Nm", "torque at which the play is used up"},
    Words{"beside_friction", "1: the play lies beside the friction, 0: in series"},
    Words{"rounded", "1: the play ends softly"},
    Words{"slip_torque_Nm", "torque at which the locked input begins to move"},
    Words{"slip_balance", "slip of one direction against the other"},
    Words{"slip_", "how far it moves beyond that"},
    Words{"creep_share_per_decade", "share of the twist that is added in ten times the time"},
    Words{"creep_share", "share of the twist that comes late"},
    Words{"creep_", "twist that comes late"},
    Words{"time_constant_", "time in which 63 % of it has come"},
    Words{"longest_time_constant_s", "the same of the slowest part"},
    Words{"hardening_", "how the stiffness rises with the cube of the twist"},
    Words{"viscous_difference_", "viscous friction of one direction against the other"},
    Words{"viscous_", "friction that rises with the speed"},
    Words{"lag_rad_s_per_Nm", "twist that follows the torque's rate"},
    Words{"torque_lag_s", "by how much the torque's reading is late"},
    Words{"friction_rise_share", "rise of the friction for each tenfold rate"},
    Words{"linear_friction_rise_share", "rise of the friction with the rate"},
    Words{"usual_rate_Nm_per_s", "rate at which the friction is as stated"},
    // transmission error
    Words{"second_harmonic_amplitude_arcmin", "error twice per turn of the input"},
    Words{"second_harmonic_phase_deg", "where on the turn it is highest"},
    Words{"windup_", "twist under the torque"},
    Words{"drift_swing_", "from one end of the drift to the other"},
    Words{"drift_", "drift"},
    Words{"drift_per_h", "share of the friction by which it drifts"},
    Words{"seen_arcmin", "how much of it the samples show"},
    // motion
    Words{"inertia_kgm2", "inertia that the drive moves"},
    Words{"mass_kg", "mass that the drive moves"},
    Words{"coulomb_", "friction that has the same size at every speed"},
    Words{"stribeck_speed_", "speed at which the extra friction has fallen to 37 %"},
    Words{"stribeck_exponent", "how steeply it falls"},
    Words{"stribeck_", "extra friction at standstill"},
    Words{"drag_", "friction that rises with the square of the speed"},
    Words{"delay_s", "by how much the torque acts late"},
    Words{"load_coefficient", "friction per torque transmitted"},
    Words{"torque_Nm", "size"},
    Words{"force_N", "size"},
    Words{"duration_s", "how long it lasts"},
    Words{"inertia_share", "share of the inertia behind the spring"},
    Words{"swinging_second_", "inertia that swings behind the spring"},
    Words{"second_inertia_kgm2", "inertia behind the spring"},
    Words{"second_mass_kg", "mass behind the spring"},
    Words{"load_inertia_kgm2", "inertia behind the play"},
    Words{"load_mass_kg", "mass behind the play"},
    Words{"contact_Hz", "frequency of the contact"},
    Words{"contact_damping_ratio", "damping of the contact"},
    Words{"damping_ratio", "damping, 1: it does not swing"},
    Words{"frequency_Hz", "natural frequency"},
    // vibration
    Words{"first_amplitude_", "line once per turn of the shaft"},
    Words{"first_phase_", "where on the turn it is highest"},
    Words{"second_amplitude_", "line twice per turn of the shaft"},
    Words{"second_phase_", "where on the turn it is highest"},
    Words{"mean_frequency_Hz", "frequency about which it rings"},
    Words{"mean_", "mean of the channel"},
    Words{"mesh_order", "meetings of teeth per turn of the input"},
    Words{"defect_order", "knocks per turn of the shaft"},
    Words{"crack_order", "passes of the crack per turn of the shaft"},
    Words{"ring_Hz", "frequency at which each knock rings"},
    Words{"modulated_per_turn", "how often per turn it swells"},
    // campaign
    Words{"trend_", "slope over the load time"},
    Words{"late_", "what it gains late in the life"},
    Words{"run_in_h", "load time of running in"},
    Words{"run_in_", "what running in changes"},
    Words{"step_", "size of the jump"},
    Words{"rate_change_", "change of the slope"},
    Words{"cycle", "cycle at which it comes"},
    Words{"recovery_cycles", "cycles in which it passes"},
    // whatever stands somewhere
    Words{"amplitude_", "amplitude"},
    Words{"phase_deg", "where on the turn it is highest"},
    Words{"order_per_", "periods per turn"},
    Words{"height_", "height"},
    Words{"bell_height_", "height"},
    Words{"level_", "level"},
    Words{"width_", "width"},
    Words{"centre_", "middle"},
    Words{"from_", "where it begins"},
    Words{"to_", "where it ends"},
    Words{"begin_s", "when it begins"},
    Words{"end_s", "when it ends"},
    Words{"period_", "period"},
};

}  // namespace

std::string_view ParameterWords(std::string_view name) {
  if (name.ends_with("_per_K")) return "change with the temperature";
  if (const analysis::Quantity* const quantity = analysis::FindQuantity(name)) return quantity->meaning;
  const Words* best = nullptr;
  for (const Words& words : kWords) {
    const bool fits = words.name.ends_with('_') ? name.starts_with(words.name) : name == words.name;
    if (fits && (best == nullptr || words.name.size() > best->name.size())) best = &words;
  }
  return best == nullptr ? std::string_view{} : best->words;
}

bool IsDetail(std::string_view name) {
  constexpr std::array<std::string_view, 5> kLists{"cosine_", "sine_", "line_", "deviation_",
                                                   analysis::diagnosis::kCurvePart};
  return std::ranges::any_of(kLists, [&](std::string_view list) { return name.starts_with(list); });
}

}  // namespace strainwave::bench
