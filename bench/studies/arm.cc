// SPDX-License-Identifier: Apache-2.0
#include "bench/studies/arm.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>

#include <fmt/format.h>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>

#include "analysis/model/puma_560.h"
#include "analysis/units.h"
#include "daq/csv_record.h"
#include "daq/joint_columns.h"

namespace strainwave::bench {
namespace {

namespace model = analysis::model;

constexpr std::size_t kJoints = 6;
constexpr double kRate_hz = 1000.0;
constexpr double kHandToPayload_m = 0.1;
constexpr double kReference_degC = 22.0;
using PerJoint = std::array<double, kJoints>;

// Draws that are the same with every standard library.
class ArmDraw {
 public:
  explicit ArmDraw(std::uint64_t seed) : engine_(seed) {}
  double Normal() { return normal_(engine_); }
  double Factor(double deviation) { return std::exp(deviation * Normal()); }
  double Between(double low, double high) { return low + (high - low) * unit_(engine_); }
  std::size_t Below(std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(Between(0.0, static_cast<double>(count))));
  }

 private:
  std::mt19937_64 engine_;
  boost::random::normal_distribution<double> normal_;
  boost::random::uniform_real_distribution<double> unit_{0.0, 1.0};
};

enum class Fault { kNone, kBrake, kReducer };
constexpr const char* NameOf(Fault fault) {
  switch (fault) {
    case Fault::kNone:
      return "none";
    case Fault::kBrake:
      return "brake";
    case Fault::kReducer:
      return "reducer";
  }
  return "";
}

// Where an arm stands, and how it is used there.
struct Origin {
  const char* name;
  double shortest_s, longest_s;  // of a record
  double least_payload_kg, most_payload_kg;
  double least_speed, most_speed;  // share of the joints' greatest
  double dwell_s;                  // at each pose
  double reach;                    // of the poses, a share of the joints' ranges
};
constexpr Origin kRig{"rig", 6.0, 9.0, 0.0, 1.0, 0.5, 1.0, 0.1, 1.0};
constexpr Origin kPlant{"plant", 3.0, 5.0, 0.5, 2.5, 0.35, 0.8, 0.3, 0.6};

// One arm as it was mounted.
struct Arm {
  std::string unit;
  const Origin* origin;
  Fault fault;        // that it gets
  bool seen_healthy;  // before that
  std::vector<model::JointFriction> friction;
  PerJoint torque_gain;
  PerJoint torque_offset_Nm;
  double payload_kg;
  std::vector<PerJoint> poses_rad;
};

constexpr PerJoint kMiddle_rad{0.0, 0.9, -1.6, 0.0, 0.3, 0.0};
constexpr PerJoint kReach_rad{1.4, 0.8, 0.9, 1.2, 1.0, 1.8};
constexpr PerJoint kTop_rad_per_s{1.43, 0.94, 2.1, 4.0, 4.2, 4.0};
constexpr PerJoint kTop_rad_per_s2{4.0, 3.0, 6.0, 20.0, 20.0, 20.0};

Arm MountArm(std::string unit, const Origin& origin, Fault fault, bool seen_healthy, ArmDraw& draw) {
  constexpr double kFrictionScatter = 0.15;
  constexpr double kGainScatter = 0.02;
  constexpr double kOffsetShare = 0.005;
  Arm arm{.unit = std::move(unit),
          .origin = &origin,
          .fault = fault,
          .seen_healthy = seen_healthy,
          .friction = model::Puma560Friction(),
          .torque_gain = {},
          .torque_offset_Nm = {},
          .payload_kg = draw.Between(origin.least_payload_kg, origin.most_payload_kg),
          .poses_rad = {}};
  const std::vector<double> peak_Nm = model::Puma560PeakTorques_Nm();
  for (std::size_t j = 0; j < kJoints; ++j) {
    model::JointFriction& friction = arm.friction[j];
    const double factor = draw.Factor(kFrictionScatter);
    friction.coulomb_Nm *= factor;
    friction.breakaway_Nm *= factor * draw.Factor(0.5 * kFrictionScatter);
    friction.viscous_Nms_per_rad *= draw.Factor(kFrictionScatter);
    arm.torque_gain[j] = draw.Factor(kGainScatter);
    arm.torque_offset_Nm[j] = kOffsetShare * peak_Nm[j] * draw.Normal();
  }
  const std::size_t poses = 4 + draw.Below(4);
  for (std::size_t p = 0; p < poses; ++p) {
    PerJoint pose{};
    for (std::size_t j = 0; j < kJoints; ++j)
      pose[j] = kMiddle_rad[j] + origin.reach * kReach_rad[j] * draw.Between(-1.0, 1.0);
    arm.poses_rad.push_back(pose);
  }
  return arm;
}

// What a fault does to the joints of an arm.
struct Damage {
  std::size_t joint{};  // from 1; 0: none
  double drag_Nm{};
  model::ReducerWear wear{};
};

Damage DrawDamage(Fault fault, ArmDraw& draw) {
  Damage damage;
  if (fault == Fault::kBrake) {
    damage.joint = 1 + draw.Below(kJoints);
    // Published: a brake of 8.0 Nm or more that stayed engaged, on motors of 4.3 kW at joints 1 to 3 and 2.0
    // kW at 4 to 6. At 2000 rpm these have 20.5 and 9.5 Nm, of which the peak is about three times (both
    // assumed): the brake takes 0.13 and 0.28 of the peak. Sliding, a worn lining takes less.
    const double share = damage.joint <= 3 ? 0.13 : 0.28;
    damage.drag_Nm = draw.Between(0.6, 1.1) * share * model::Puma560PeakTorques_Nm()[damage.joint - 1];
  } else if (fault == Fault::kReducer) {
    damage.joint = 2 + draw.Below(2);
    damage.wear = {.friction_share = draw.Between(0.25, 0.8),
                   .ripple_share = draw.Between(0.1, 0.3),
                   .teeth_per_turn = 40.0,
                   .phase_rad = draw.Between(0.0, kTwoPi)};
  }
  return damage;
}

struct Motion {
  PerJoint q{}, qd{}, qdd{};
};

// From pose to pose, all joints together, each by a polynomial of the fifth degree that starts and ends at
// rest.
std::vector<Motion> MoveAround(const Arm& arm, double speed_share, double duration_s, ArmDraw& draw) {
  constexpr double kPeakSpeed = 1.875;  // of the polynomial, for a unit of way and time
  constexpr double kPeakAcceleration = 5.7735;
  const auto rows = static_cast<std::size_t>(duration_s * kRate_hz);
  std::vector<Motion> motion;
  std::size_t at = draw.Below(arm.poses_rad.size());
  while (motion.size() < rows) {
    const PerJoint& from = arm.poses_rad[at];
    at = (at + 1) % arm.poses_rad.size();
    const PerJoint& to = arm.poses_rad[at];
    const double share = speed_share * draw.Between(0.8, 1.0);
    double move_s = 0.2;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double way_rad = std::abs(to[j] - from[j]);
      move_s = std::max({move_s, kPeakSpeed * way_rad / (share * kTop_rad_per_s[j]),
                         std::sqrt(kPeakAcceleration * way_rad / (share * share * kTop_rad_per_s2[j]))});
    }
    const auto steps = static_cast<std::size_t>(move_s * kRate_hz);
    for (std::size_t k = 0; k < steps && motion.size() < rows; ++k) {
      const double u = static_cast<double>(k) / static_cast<double>(steps);
      const double s = u * u * u * (10.0 + u * (-15.0 + 6.0 * u));
      const double ds = 30.0 * u * u * (1.0 - u) * (1.0 - u) / move_s;
      const double dds = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / (move_s * move_s);
      Motion now;
      for (std::size_t j = 0; j < kJoints; ++j) {
        const double way = to[j] - from[j];
        now.q[j] = from[j] + way * s;
        now.qd[j] = way * ds;
        now.qdd[j] = way * dds;
      }
      motion.push_back(now);
    }
    Motion rest;
    rest.q = to;
    const auto still = static_cast<std::size_t>(arm.origin->dwell_s * kRate_hz);
    for (std::size_t k = 0; k < still && motion.size() < rows; ++k) motion.push_back(rest);
  }
  return motion;
}

// The model's torque of each joint, and what the current says of it.
std::vector<double> Torques_Nm(const Arm& arm, const std::vector<model::ArmLink>& links, const Damage& damage,
                               double temperature_degC, const Motion& now) {
  constexpr double kViscousPerK = 0.02;
  constexpr double kCoulombPerK = 0.003;
  const double warmer_K = temperature_degC - kReference_degC;
  std::vector<double> torques_Nm = model::InverseDynamics_Nm(links, now.q, now.qd, now.qdd);
  for (std::size_t j = 0; j < kJoints; ++j) {
    model::JointFriction friction = arm.friction[j];
    friction.viscous_Nms_per_rad *= std::exp(-kViscousPerK * warmer_K);
    friction.coulomb_Nm *= 1.0 - kCoulombPerK * warmer_K;
    friction.breakaway_Nm *= 1.0 - kCoulombPerK * warmer_K;
    const double lost_Nm = model::FrictionTorque_Nm(friction, now.qd[j]);
    torques_Nm[j] += lost_Nm;
    if (damage.joint == j + 1)
      torques_Nm[j] += model::BrakeDrag_Nm(damage.drag_Nm, now.qd[j]) +
                       model::WearTorque_Nm(damage.wear, lost_Nm, now.q[j]);
    torques_Nm[j] = arm.torque_gain[j] * torques_Nm[j] + arm.torque_offset_Nm[j];
  }
  return torques_Nm;
}

// As many places as a controller logs.
double Rounded(double value, double per_unit) { return std::round(value * per_unit) / per_unit; }

daq::Record MeasureArm(const Arm& arm, const Damage& damage, double speed_share, ArmDraw& draw) {
  constexpr double kPlaces = 1e6;
  constexpr double kTorquePlaces = 1e3;
  constexpr double kEncoder_rad = 2e-5;
  constexpr double kVelocityNoise_rad_per_s = 2e-3;
  constexpr double kTorqueNoiseShare = 0.004;
  const double temperature_degC = draw.Between(10.0, 35.0);
  const double duration_s = draw.Between(arm.origin->shortest_s, arm.origin->longest_s);
  const std::vector<model::ArmLink> links =
      model::WithPayload(model::Puma560(), arm.payload_kg, kHandToPayload_m);
  const std::vector<double> peak_Nm = model::Puma560PeakTorques_Nm();
  const std::vector<Motion> motion = MoveAround(arm, speed_share, duration_s, draw);
  std::vector<double> time_s;
  std::array<std::vector<double>, kJoints> q, qd, tau;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    time_s.push_back(static_cast<double>(i) / kRate_hz);
    const std::vector<double> torques_Nm = Torques_Nm(arm, links, damage, temperature_degC, motion[i]);
    for (std::size_t j = 0; j < kJoints; ++j) {
      q[j].push_back(Rounded(std::round(motion[i].q[j] / kEncoder_rad) * kEncoder_rad, kPlaces));
      qd[j].push_back(Rounded(motion[i].qd[j] + kVelocityNoise_rad_per_s * draw.Normal(), kPlaces));
      tau[j].push_back(
          Rounded(torques_Nm[j] + kTorqueNoiseShare * peak_Nm[j] * draw.Normal(), kTorquePlaces));
    }
  }
  daq::Record record{.kind = daq::RecordKind::kJoints, .metadata = {}, .columns = {}, .source = {}};
  record.SetMetadata("sample_rate_hz", kRate_hz);
  record.SetMetadata("temperature_degC", Rounded(temperature_degC, 10.0));
  record.columns.push_back({"time_s", std::move(time_s), {}, {}});
  using daq::JointQuantity;
  for (std::size_t j = 0; j < kJoints; ++j) {
    record.columns.push_back({JointColumnName(JointQuantity::kPosition, j + 1), std::move(q[j]), {}, {}});
    record.columns.push_back({JointColumnName(JointQuantity::kVelocity, j + 1), std::move(qd[j]), {}, {}});
    record.columns.push_back({JointColumnName(JointQuantity::kTorque, j + 1), std::move(tau[j]), {}, {}});
  }
  return record;
}

// How many arms of an origin stay healthy, get a fault, and of these were seen healthy before.
struct Counts {
  int healthy, faulty, seen_healthy;
};

void MountArms(const Origin& origin, Fault fault, const Counts& counts, ArmDraw& draw,
               std::vector<Arm>& arms) {
  for (int i = 0; i < counts.healthy + counts.faulty; ++i) {
    const bool sound = i < counts.healthy;
    arms.push_back(MountArm(fmt::format("{}_{:02}", origin.name, i + 1), origin, sound ? Fault::kNone : fault,
                            !sound && i - counts.healthy < counts.seen_healthy, draw));
  }
}

}  // namespace

StudySummary MakeArmStudy(const StudySettings& settings) {
  ArmDraw draw(settings.seed);
  // The published study: four healthy rigs and three with a brake fault, eight plants and seven worn ones.
  Counts rigs{4, 3, 2};
  Counts plants{8, 7, 4};
  if (settings.units) rigs = plants = {*settings.units, *settings.units, (*settings.units + 1) / 2};
  std::vector<Arm> arms;
  MountArms(kRig, Fault::kBrake, rigs, draw, arms);
  MountArms(kPlant, Fault::kReducer, plants, draw, arms);

  LabelsWriter labels({"class", "origin", "fault", "joint", "payload_kg", "speed_share"});
  std::vector<std::pair<const Arm*, Fault>> runs;
  for (const Arm& arm : arms) {
    if (arm.seen_healthy) runs.emplace_back(&arm, Fault::kNone);
    runs.emplace_back(&arm, arm.fault);
  }
  std::size_t done = 0;
  for (const auto& [arm, fault] : runs) {
    const Damage damage = DrawDamage(fault, draw);
    const double speed_share =
        Rounded(draw.Between(arm->origin->least_speed, arm->origin->most_speed), 100.0);
    const std::string file = fmt::format("{:03}.csv", ++done);
    daq::WriteCsvRecord(MeasureArm(*arm, damage, speed_share, draw), settings.out / file);
    labels.Add(file, arm->unit,
               {fault == Fault::kNone ? "healthy" : "faulty", arm->origin->name, NameOf(fault),
                std::to_string(damage.joint), fmt::format("{:.2f}", arm->payload_kg),
                fmt::format("{:.2f}", speed_share)});
    settings.progress(done, runs.size());
  }
  return labels.Write(settings.out);
}

}  // namespace strainwave::bench
