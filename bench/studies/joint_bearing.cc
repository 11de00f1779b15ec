// SPDX-License-Identifier: Apache-2.0
#include "bench/studies/joint_bearing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>

#include "analysis/bearing_orders.h"
#include "analysis/model/ringing_mode.h"
#include "analysis/model/to_and_fro.h"
#include "analysis/units.h"
#include "daq/cycle_file.h"

namespace strainwave::bench {
namespace {

namespace model = analysis::model;

constexpr double kSampleRate_hz = 1031.0;
constexpr std::size_t kSamples = 4096;
constexpr std::size_t kOversampling = 16;  // the joint is computed this much more finely
constexpr double kFineRate_hz = kSampleRate_hz * kOversampling;
constexpr std::size_t kSettling = 4096;  // fine samples before a record, for all to ring
constexpr std::size_t kAxes = 3;
constexpr std::array<const char*, kAxes> kAxisNames{"accel_x_m_per_s2", "accel_y_m_per_s2",
                                                    "accel_z_m_per_s2"};

// A deep-groove ball bearing 609 and the gear of the third joint of a PUMA 560 [K].
constexpr analysis::RollingBearing kBearing{
    .elements = 7, .element_diameter_m = 3.969e-3, .pitch_diameter_m = 16.5e-3, .contact_angle_rad = 0.0};
constexpr double kRatio = 53.7;
constexpr double kPinionTeeth = 13.0;
constexpr double kSlip = 0.015;  // of the passing order, from one passing to the next

// Modes of the arm, then of bearing seat and housing; what each axis sees of them. All [K]: the study tells
// that the eleventh natural frequency of the arm lies at about 103 Hz.
struct ModeShape {
  double frequency_Hz;
  double damping;
  std::array<double, kAxes> seen;
  double by_friction;  // m/s² of the noise of friction
  double by_impact;    // m/s² an impact of 1 mm at full speed
};
constexpr std::array<ModeShape, 8> kModes{{{14.0, 0.04, {1.0, 0.5, 0.8}, 0.05, 0.02},
                                           {31.0, 0.03, {0.6, 1.0, 0.7}, 0.05, 0.04},
                                           {58.0, 0.03, {0.9, 0.6, 1.0}, 0.05, 0.18},
                                           {103.0, 0.025, {1.0, 0.5, 0.9}, 0.06, 0.40},
                                           {187.0, 0.02, {0.9, 0.4, 1.0}, 0.07, 0.70},
                                           {364.0, 0.02, {1.0, 0.6, 0.8}, 0.09, 1.30},
                                           {2610.0, 0.02, {0.8, 0.6, 1.0}, 0.12, 3.20},
                                           {5230.0, 0.015, {1.0, 0.5, 0.9}, 0.10, 4.00}}};
constexpr std::size_t kModeCount = kModes.size();

struct Condition {
  const char* name;
  double inner_mm;
  double outer_mm;
  bool pair;
};
constexpr std::array<Condition, 6> kConditions{{{"healthy", 0.0, 0.0, false},
                                                {"inner_race", 1.0, 0.0, false},
                                                {"outer_race_1mm", 0.0, 1.0, false},
                                                {"outer_race_2mm", 0.0, 2.0, false},
                                                {"inner_race+outer_race_1mm", 1.0, 1.0, true},
                                                {"inner_race+outer_race_2mm", 1.0, 2.0, true}}};

constexpr std::array<double, 2> kLoads_kg{0.0, 2.0};
constexpr std::array<double, 3> kSpeeds_percent{50.0, 75.0, 100.0};
constexpr int kRecordsOfSingle = 24;
constexpr int kRecordsOfPair = 8;
constexpr int kUnitsByDefault = 4;

// Boost's distributions give the same numbers with every standard library, std's do not.
class JointDraw {
 public:
  explicit JointDraw(std::uint64_t seed) : engine_(seed) {}
  double Normal() { return normal_(engine_); }
  double Factor(double deviation) { return std::exp(deviation * Normal()); }
  double Share() { return uniform_(engine_); }

 private:
  std::mt19937_64 engine_;
  boost::random::normal_distribution<double> normal_;
  boost::random::uniform_real_distribution<double> uniform_{0.0, 1.0};
};

// What is drawn anew each time that the joint is put together.
struct Mounting {
  std::array<double, kModeCount> frequency_Hz{};
  std::array<double, kModeCount> damping{};
  std::array<std::array<double, kAxes>, kModeCount> seen{};
  std::array<double, kAxes> sensor_gain{};
  double friction{};
  double mesh_m_per_s2{};
  double eccentricity_m_per_s2{};
  double reversal{};       // the impact of the backlash where it turns round
  double severity{};       // of the damage: depth, edges, grease
  double waviness{};       // of a sound bearing: impacts at the passing orders, a share of a 1 mm damage
  double load_zone_rad{};  // of the damage on the outer race, from where the load stands
};

Mounting DrawMounting(std::uint64_t seed) {
  JointDraw draw(seed);
  Mounting drawn;
  for (std::size_t m = 0; m < kModeCount; ++m) {
    drawn.frequency_Hz[m] = kModes[m].frequency_Hz * draw.Factor(0.03);
    drawn.damping[m] = kModes[m].damping * draw.Factor(0.2);
    for (std::size_t a = 0; a < kAxes; ++a) drawn.seen[m][a] = kModes[m].seen[a] * draw.Factor(0.15);
  }
  for (double& gain : drawn.sensor_gain) gain = draw.Factor(0.05);
  drawn.friction = draw.Factor(0.2);
  drawn.mesh_m_per_s2 = 0.25 * draw.Factor(0.2);
  drawn.eccentricity_m_per_s2 = 0.15 * draw.Factor(0.4);
  drawn.reversal = draw.Factor(0.4);
  drawn.severity = draw.Factor(0.15);
  drawn.waviness = 0.05 * draw.Factor(0.4);
  drawn.load_zone_rad = 0.5 * draw.Normal();
  return drawn;
}

struct JointRun {
  double load_kg{};
  double speed_percent{};
  bool filtered{};
  std::uint64_t seed{};
};

// An impact each time that something passes; slip lets the passings drift.
class Passings {
 public:
  Passings(double order, JointDraw& draw) : order_(order), draw_(draw), next_(draw.Share()) {}
  // @param turns  of the input shaft since the last step, in either direction.
  bool Step(double turns) {
    passed_ += order_ * std::abs(turns);
    if (passed_ < next_) return false;
    next_ += 1.0 + kSlip * draw_.Normal();
    return true;
  }

 private:
  double order_;
  JointDraw& draw_;
  double passed_{};
  double next_;
};

// Of a load that presses in one direction: none on the other side.
double InLoadZone(double angle_rad) { return std::pow(std::max(0.0, std::cos(angle_rad)), 1.5); }

using Axes = std::array<std::vector<float>, kAxes>;

Axes SimulateJoint(const Condition& condition, const Mounting& mounting, const JointRun& run) {
  JointDraw draw(run.seed);
  const analysis::BearingOrders orders = analysis::BearingOrdersOf(kBearing);
  const model::ToAndFro motion{.stroke_rad = RadFromDeg(270.0),
                               .top_speed_rad_per_s = 3.0 * run.speed_percent / 100.0 * draw.Factor(0.01),
                               .acceleration_rad_per_s2 = 12.0 * run.speed_percent / 100.0,
                               .rest_s = 0.02};
  const double friction = mounting.friction * (1.0 + 0.15 * run.load_kg) * draw.Factor(0.1);
  const double load = 1.0 + 0.25 * run.load_kg;
  std::vector<model::RingingMode> modes;
  for (std::size_t m = 0; m < kModeCount; ++m)
    modes.emplace_back(mounting.frequency_Hz[m], mounting.damping[m], kFineRate_hz);
  std::vector<model::ButterworthLowPass> filters(kAxes, {8, 0.4 * kSampleRate_hz, kFineRate_hz});
  Passings inner(orders.inner_race, draw);
  Passings outer(orders.outer_race, draw);
  const double start_s = motion.Period_s() * draw.Share();
  const double mesh_phase = kTwoPi * draw.Share();
  const double severity = mounting.severity;
  Axes axes;
  for (std::vector<float>& axis : axes) axis.reserve(kSamples);
  double direction = 0.0;
  for (std::size_t i = 0; axes[0].size() < kSamples; ++i) {
    const model::JointState joint = motion.At(start_s + static_cast<double>(i) / kFineRate_hz);
    const double shaft_rad = kRatio * joint.angle_rad;
    const double pace = std::abs(joint.speed_rad_per_s) / 3.0;  // of full speed
    const double turns = kRatio * joint.speed_rad_per_s / kFineRate_hz / kTwoPi;
    double impact = 0.0;
    if (inner.Step(turns)) {
      // The place goes through the zone where the load presses, once a turn.
      const double zone = 0.25 + 0.75 * InLoadZone(shaft_rad);
      impact += (severity * std::pow(condition.inner_mm, 0.8) + mounting.waviness) * zone * draw.Factor(0.15);
    }
    if (outer.Step(turns)) {
      // It rests, and gravity moves the load about it as the arm turns.
      const double zone = 0.4 + 0.6 * InLoadZone(mounting.load_zone_rad + 0.3 * std::sin(joint.angle_rad));
      impact += (severity * std::pow(condition.outer_mm, 0.8) + mounting.waviness) * zone * draw.Factor(0.15);
    }
    impact *= pace * load;
    const double now_direction = joint.speed_rad_per_s > 0.0 ? 1.0 : joint.speed_rad_per_s < 0.0 ? -1.0 : 0.0;
    if (now_direction != 0.0 && now_direction != direction) {
      if (direction != 0.0) impact += 1.5 * mounting.reversal * draw.Factor(0.2);
      direction = now_direction;
    }
    const double rub = friction * pace * draw.Normal();
    std::array<double, kModeCount> ringing{};
    for (std::size_t m = 0; m < kModeCount; ++m) {
      // So that noise of 1 rings with a standard deviation of 1, whatever the mode.
      const double noise_gain =
          2.0 * std::sqrt(mounting.damping[m] * kTwoPi * mounting.frequency_Hz[m] / kFineRate_hz);
      ringing[m] = modes[m].Step(kModes[m].by_impact * impact + kModes[m].by_friction * noise_gain * rub);
    }
    const bool keep = i >= kSettling && (i - kSettling) % kOversampling == 0;
    if (!keep && !run.filtered) continue;
    const double mesh = mounting.mesh_m_per_s2 * pace * load *
                        (std::sin(kPinionTeeth * shaft_rad + mesh_phase) +
                         0.4 * std::sin(2.0 * kPinionTeeth * shaft_rad + 1.7 * mesh_phase));
    const double once = mounting.eccentricity_m_per_s2 * pace * pace * std::sin(shaft_rad);
    // Of the wrist, half a metre from the joint's axis, in a frame that turns with it.
    constexpr double kArm_m = 0.45;
    const std::array<double, kAxes> moved{
        kArm_m * joint.acceleration_rad_per_s2,
        -kArm_m * joint.speed_rad_per_s * joint.speed_rad_per_s + 9.81 * std::cos(joint.angle_rad),
        0.05 * joint.acceleration_rad_per_s2};
    constexpr std::array<double, kAxes> kMeshSeen{1.0, 0.5, 0.8};
    for (std::size_t a = 0; a < kAxes; ++a) {
      double value = moved[a] + kMeshSeen[a] * mesh + once;
      for (std::size_t m = 0; m < kModeCount; ++m) value += mounting.seen[m][a] * ringing[m];
      if (run.filtered) value = filters[a].Step(value);
      if (!keep) continue;
      constexpr double kSensorNoise_m_per_s2 = 0.12;
      constexpr double kStep_m_per_s2 = 0.02;
      const double measured = mounting.sensor_gain[a] * value + kSensorNoise_m_per_s2 * draw.Normal();
      axes[a].push_back(static_cast<float>(kStep_m_per_s2 * std::round(measured / kStep_m_per_s2)));
    }
  }
  return axes;
}

daq::Record RecordOf(Axes axes, const JointRun& run) {
  daq::Record record;
  record.kind = daq::RecordKind::kVibration;
  record.SetMetadata("sample_rate_hz", kSampleRate_hz);
  record.SetMetadata("load_kg", run.load_kg);
  record.SetMetadata("speed_percent", run.speed_percent);
  record.SetMetadata("bearing_elements", static_cast<double>(kBearing.elements));
  record.SetMetadata("bearing_element_diameter_mm", 1e3 * kBearing.element_diameter_m);
  record.SetMetadata("bearing_pitch_diameter_mm", 1e3 * kBearing.pitch_diameter_m);
  for (std::size_t a = 0; a < kAxes; ++a)
    record.columns.push_back({kAxisNames[a], std::move(axes[a]), "", ""});
  return record;
}

// One number of several, so that a record's bits do not depend on which others are made.
std::uint64_t SeedOf(std::uint64_t seed, std::uint64_t condition, std::uint64_t unit, std::uint64_t record) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                         static_cast<std::uint32_t>(condition), static_cast<std::uint32_t>(unit),
                         static_cast<std::uint32_t>(record)};
  std::array<std::uint32_t, 2> words{};
  sequence.generate(words.begin(), words.end());
  return (static_cast<std::uint64_t>(words[0]) << 32U) | words[1];
}

// Loads and speeds in turn; the last quarter is filtered.
JointRun RunOf(int record, int records, std::uint64_t seed) {
  const auto k = static_cast<std::size_t>(record);
  return {.load_kg = kLoads_kg[k % kLoads_kg.size()],
          .speed_percent = kSpeeds_percent[(k / kLoads_kg.size()) % kSpeeds_percent.size()],
          .filtered = 4 * record >= 3 * records,
          .seed = seed};
}

}  // namespace

StudySummary MakeJointBearing(const StudySettings& settings) {
  const int units = settings.units.value_or(kUnitsByDefault);
  std::size_t all = 0;
  for (const Condition& condition : kConditions)
    all += static_cast<std::size_t>(units * (condition.pair ? kRecordsOfPair : kRecordsOfSingle));
  LabelsWriter labels({"class", "fault_inner_race", "fault_outer_race", "faults", "damage_mm", "load_kg",
                       "speed_percent", "anti_alias_filter"});
  std::filesystem::create_directories(settings.out / "records");
  std::size_t done = 0;
  for (std::size_t c = 0; c < kConditions.size(); ++c) {
    const Condition& condition = kConditions[c];
    for (int unit = 0; unit < units; ++unit) {
      const auto u = static_cast<std::uint64_t>(unit);
      const Mounting mounting = DrawMounting(SeedOf(settings.seed, c, u, 0));
      const int records = condition.pair ? kRecordsOfPair : kRecordsOfSingle;
      for (int r = 0; r < records; ++r) {
        const JointRun run =
            RunOf(r, records, SeedOf(settings.seed, c, u, static_cast<std::uint64_t>(r) + 1));
        const daq::NamedRecord named{"vibration", RecordOf(SimulateJoint(condition, mounting, run), run)};
        const std::string file = fmt::format("records/{:04d}.h5", ++done);
        daq::WriteRecordsAtomically(settings.out / file, {&named, 1});
        labels.Add(
            file, fmt::format("mounting_{:02d}", static_cast<int>(c) * units + unit + 1),
            {condition.name, condition.inner_mm > 0.0 ? "1" : "0", condition.outer_mm > 0.0 ? "1" : "0",
             std::to_string((condition.inner_mm > 0.0) + (condition.outer_mm > 0.0)),
             fmt::format("{:g}", std::max(condition.inner_mm, condition.outer_mm)),
             fmt::format("{:g}", run.load_kg), fmt::format("{:g}", run.speed_percent),
             run.filtered ? "1" : "0"});
        settings.progress(done, all);
      }
    }
  }
  return labels.Write(settings.out);
}

}  // namespace strainwave::bench
