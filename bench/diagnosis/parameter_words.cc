// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/parameter_words.h"

#include <algorithm>
#include <array>

#include "analysis/diagnosis/study.h"
#include "analysis/quantities.h"

namespace strainwave::bench {
namespace {

namespace quantities = analysis::quantities;

struct NamedWords {
  std::string_view name;  // as it is, or how it begins
  std::string_view words;
};

// Beside the quantities of analysis/quantities.h. Of those that fit, the longest name counts. Units stand in
// the names and are not said again.
constexpr std::array kWords{
    // hysteresis
    NamedWords{"k1_asymmetry_share", "by how much K1 is higher for positive than for negative torque"},
    NamedWords{"k2_asymmetry_share", "the same of K2"},
    NamedWords{"k3_asymmetry_share", "the same of K3"},
    NamedWords{"k2_k3_asymmetry_share", "the same of K2 and K3 alike"},
    NamedWords{"law_asymmetry_share", "the same of all three, each by its own"},
    NamedWords{"asymmetry_share", "the same of all three alike"},
    NamedWords{"k1_", quantities::kK1.meaning},
    NamedWords{"k2_", quantities::kK2.meaning},
    NamedWords{"k3_", quantities::kK3.meaning},
    NamedWords{"second_friction_torque_Nm", "of the second friction element"},
    NamedWords{"second_yield_twist_arcmin", "twist at which the second element slides"},
    NamedWords{"third_friction_torque_Nm", "of the third friction element"},
    NamedWords{"spread_friction_torque_Nm", "of elements that slide one after the other"},
    NamedWords{"offset_arcmin", "where zero lies"},
    NamedWords{"offset_Nm", "reading without torque"},
    NamedWords{"start_share", "how far the friction was wound up at the start, -1 to 1"},
    NamedWords{"load_start", "how far the friction was wound up at the start, -1 to 1"},
    NamedWords{"backlash_", "play: width of the dead zone"},
    NamedWords{"dead_zone_torque_Nm", "torque at which the play is used up"},
    NamedWords{"beside_friction", "1: the play lies beside the friction, 0: in series"},
    NamedWords{"rounded", "1: the play ends softly"},
    NamedWords{"slip_torque_Nm", "torque at which the locked input begins to move"},
    NamedWords{"slip_balance", "slip of one direction against the other"},
    NamedWords{"slip_", "how far it moves beyond that"},
    NamedWords{"creep_share_per_decade", "share of the twist that is added in ten times the time"},
    NamedWords{"creep_share", "share of the twist that comes late"},
    NamedWords{"creep_", "twist that comes late"},
    NamedWords{"time_constant_", "time in which 63 % of it has come"},
    NamedWords{"longest_time_constant_s", "the same of the slowest part"},
    NamedWords{"hardening_", "how the stiffness rises with the cube of the twist"},
    NamedWords{"viscous_difference_", "viscous friction of one direction against the other"},
    NamedWords{"viscous_", "friction that rises with the speed"},
    NamedWords{"lag_rad_s_per_Nm", "twist that follows the torque's rate"},
    NamedWords{"torque_lag_s", "by how much the torque's reading is late"},
    NamedWords{"friction_rise_share", "rise of the friction for each tenfold rate"},
    NamedWords{"linear_friction_rise_share", "rise of the friction with the rate"},
    NamedWords{"usual_rate_Nm_per_s", "rate at which the friction is as stated"},
    // transmission error
    NamedWords{"second_harmonic_amplitude_arcmin", "error twice per turn of the input"},
    NamedWords{"second_harmonic_phase_deg", "where on the turn it is highest"},
    NamedWords{"windup_", "twist under the torque"},
    NamedWords{"drift_swing_", "from one end of the drift to the other"},
    NamedWords{"drift_", "drift"},
    NamedWords{"drift_per_h", "share of the friction by which it drifts"},
    NamedWords{"seen_arcmin", "how much of it the samples show"},
    // motion
    NamedWords{"inertia_kgm2", "inertia that the drive moves"},
    NamedWords{"mass_kg", "mass that the drive moves"},
    NamedWords{"coulomb_", "friction that has the same size at every speed"},
    NamedWords{"stribeck_speed_", "speed at which the extra friction has fallen to 37 %"},
    NamedWords{"stribeck_exponent", "how steeply it falls"},
    NamedWords{"stribeck_", "extra friction at standstill"},
    NamedWords{"drag_", "friction that rises with the square of the speed"},
    NamedWords{"delay_s", "by how much the torque acts late"},
    NamedWords{"load_coefficient", "friction per torque transmitted"},
    NamedWords{"torque_Nm", "size"},
    NamedWords{"force_N", "size"},
    NamedWords{"duration_s", "how long it lasts"},
    NamedWords{"inertia_share", "share of the inertia behind the spring"},
    NamedWords{"swinging_second_", "inertia that swings behind the spring"},
    NamedWords{"second_inertia_kgm2", "inertia behind the spring"},
    NamedWords{"second_mass_kg", "mass behind the spring"},
    NamedWords{"load_inertia_kgm2", "inertia behind the play"},
    NamedWords{"load_mass_kg", "mass behind the play"},
    NamedWords{"contact_Hz", "frequency of the contact"},
    NamedWords{"contact_damping_ratio", "damping of the contact"},
    NamedWords{"damping_ratio", "damping, 1: it does not swing"},
    NamedWords{"frequency_Hz", "natural frequency"},
    // vibration
    NamedWords{"first_amplitude_", "line once per turn of the shaft"},
    NamedWords{"first_phase_", "where on the turn it is highest"},
    NamedWords{"second_amplitude_", "line twice per turn of the shaft"},
    NamedWords{"second_phase_", "where on the turn it is highest"},
    NamedWords{"mean_frequency_Hz", "frequency about which it rings"},
    NamedWords{"mean_", "mean of the channel"},
    NamedWords{"mesh_order", "meetings of teeth per turn of the input"},
    NamedWords{"defect_order", "knocks per turn of the shaft"},
    NamedWords{"crack_order", "passes of the crack per turn of the shaft"},
    NamedWords{"ring_Hz", "frequency at which each knock rings"},
    NamedWords{"modulated_per_turn", "how often per turn it swells"},
    // campaign
    NamedWords{"trend_", "slope over the load time"},
    NamedWords{"late_", "what it gains late in the life"},
    NamedWords{"run_in_h", "load time of running in"},
    NamedWords{"run_in_", "what running in changes"},
    NamedWords{"step_", "size of the jump"},
    NamedWords{"rate_change_", "change of the slope"},
    NamedWords{"cycle", "cycle at which it comes"},
    NamedWords{"recovery_cycles", "cycles in which it passes"},
    // whatever stands somewhere
    NamedWords{"amplitude_", "amplitude"},
    NamedWords{"phase_deg", "where on the turn it is highest"},
    NamedWords{"order_per_", "periods per turn"},
    NamedWords{"height_", "height"},
    NamedWords{"bell_height_", "height"},
    NamedWords{"level_", "level"},
    NamedWords{"width_", "width"},
    NamedWords{"centre_", "middle"},
    NamedWords{"from_", "where it begins"},
    NamedWords{"to_", "where it ends"},
    NamedWords{"begin_s", "when it begins"},
    NamedWords{"end_s", "when it ends"},
    NamedWords{"period_", "period"},
};

}  // namespace

std::string_view ParameterWords(std::string_view name) {
  if (name.ends_with("_per_K")) return "change with the temperature";
  if (const analysis::Quantity* const quantity = analysis::FindQuantity(name)) return quantity->meaning;
  const NamedWords* best = nullptr;
  for (const NamedWords& words : kWords) {
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
