// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/operating_envelope.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/prediction/record_operating_point.h"

namespace strainwave::bench::operating_envelope_test {
namespace {

using enum OperatingQuantity;
using Texts = std::vector<std::string>;

OperatingPoint PointAt(double output_torque_Nm, double input_speed_rpm, double temperature_degC) {
  OperatingPoint point;
  point[kOutputTorque] = output_torque_Nm;
  point[kInputSpeed] = input_speed_rpm;
  point[kTemperature] = temperature_degC;
  return point;
}

// What three records of a gear of size 32 were taken at.
OperatingEnvelope TrainedAt() {
  OperatingEnvelope envelope;
  for (const double temperature_degC : {52.0, 44.0, 48.0}) {
    envelope.Include(PointAt(120.0, 1500.0, temperature_degC));
  }
  return envelope;
}

TEST(OperatingEnvelope, IsLeftByAnotherLoadSpeedOrTemperature) {
  const OperatingEnvelope envelope = TrainedAt();
  EXPECT_EQ(envelope.Left(PointAt(120.0, 1500.0, 50.0)), Texts{});
  EXPECT_EQ(envelope.Left(PointAt(116.0, 1470.0, 40.0)), Texts{}) << "as near as a controller holds them";
  EXPECT_EQ(envelope.Left(PointAt(31.5, 1500.0, 50.0)), Texts{"output_torque_Nm is 31.5 (trained at 120)"});
  EXPECT_EQ(envelope.Left(PointAt(140.0, 700.0, 21.0)),
            (Texts{"output_torque_Nm is 140 (trained at 120)", "input_speed_rpm is 700 (trained at 1500)",
                   "temperature_degC is 21 (trained at 44 to 52)"}));
}

TEST(OperatingEnvelope, SaysWhatIsNotKnown) {
  OperatingPoint speed_alone;
  speed_alone[kInputSpeed] = 1500.0;
  const OperatingEnvelope envelope = TrainedAt();
  EXPECT_EQ(envelope.Left(speed_alone), Texts{});
  EXPECT_EQ(envelope.NotKnown(speed_alone), (Texts{"output_torque_Nm is not known (trained at 120)",
                                                   "temperature_degC is not known (trained at 44 to 52)"}));
  EXPECT_EQ(envelope.NotKnown(Completed(speed_alone, PointAt(120.0, 99.0, 50.0))), Texts{});
}

TEST(OperatingEnvelope, KnowsOnlyWhatEveryRecordTold) {
  OperatingEnvelope envelope = TrainedAt();
  OperatingPoint silent = PointAt(120.0, 1500.0, 50.0);
  silent[kOutputTorque].reset();
  envelope.Include(silent);
  EXPECT_EQ(envelope.Left(PointAt(5.0, 1500.0, 50.0)), Texts{});
  EXPECT_EQ(envelope.NotKnown(PointAt(5.0, 1500.0, 50.0)),
            Texts{"the training did not know output_torque_Nm: another one now is not noticed"});
  EXPECT_EQ(envelope.Text(), "output_torque_Nm not known, input_speed_rpm 1500, temperature_degC 44 to 52");
  envelope.Include(TrainedAt());
  EXPECT_FALSE(envelope.RangeOf(kOutputTorque)) << "another source does not make up for it";
}

TEST(OperatingEnvelope, ReadsBackAsItWasWritten) {
  OperatingEnvelope envelope = TrainedAt();
  envelope.Include(OperatingPoint{});
  envelope.Include(PointAt(1.0, 2.0, 3.0));
  EXPECT_EQ(envelope.Json().dump(),
            R"({"output_torque_Nm":null,"input_speed_rpm":null,"temperature_degC":null})");
  const auto json = TrainedAt().Json();
  EXPECT_EQ(
      json.dump(),
      R"({"output_torque_Nm":[120.0,120.0],"input_speed_rpm":[1500.0,1500.0],"temperature_degC":[44.0,52.0]})");
  EXPECT_EQ(OperatingEnvelope::From(json).Json(), json);
}

TEST(OperatingPointOf, TakesMeansOfWhatSignalsTell) {
  const std::vector<double> torque_Nm{-40.0, 38.0, -42.0};  // back and forth: loaded all the time
  const std::vector<double> speed_rad_per_s{100.0};
  const std::vector<double> temperature_degC{-4.0, 2.0};
  const OperatingPoint point =
      OperatingPointOf(std::vector<NamedSignal>{{"torque_Nm", torque_Nm},
                                                {"input_speed_rad_per_s", speed_rad_per_s},
                                                {"gear_temperature_degC", temperature_degC}});
  EXPECT_DOUBLE_EQ(point[kOutputTorque].value(), 40.0);
  EXPECT_DOUBLE_EQ(point[kInputSpeed].value(), 954.92965855137201);  // 100 rad/s · 60 / 2π
  EXPECT_DOUBLE_EQ(point[kTemperature].value(), -1.0);
}

TEST(OperatingPointOf, TakesMetadataWhereARecordHasNoColumn) {
  daq::Record record;
  record.kind = daq::RecordKind::kVibration;
  record.columns.push_back({"accel_x_m_per_s2", std::vector<double>{1.0, 2.0}, "", ""});
  record.columns.push_back({"temperature_degC", std::vector<double>{30.0, 32.0}, "", ""});
  record.SetMetadata("output_torque_Nm", -18.0);
  const OperatingPoint point = OperatingPointOf(record);
  EXPECT_EQ(point[kOutputTorque], 18.0);
  EXPECT_EQ(point[kInputSpeed], std::nullopt);
  EXPECT_EQ(point[kTemperature], 31.0);
}

TEST(OperatingPoint, SaysWhereTwoSourcesContradictEachOther) {
  EXPECT_EQ(Contradictions(PointAt(120.0, 1500.0, 50.0), PointAt(118.0, 1490.0, 47.0)), Texts{});
  EXPECT_EQ(Contradictions(PointAt(12.0, 1500.0, 50.0), PointAt(120.0, 1500.0, 50.0)),
            Texts{"output_torque_Nm is 12 and was given as 120; 12 counts"});
}

}  // namespace
}  // namespace strainwave::bench::operating_envelope_test
