// SPDX-License-Identifier: Apache-2.0
#include "bench/records/metadata_warnings.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "analysis/quantities.h"

namespace strainwave::bench::metadata_warnings_test {
namespace {

using Warnings = std::vector<std::string>;
using Metadata = std::vector<std::pair<std::string, std::string>>;

Warnings Of(const std::string& kind, const Metadata& metadata) {
  daq::Record record;
  record.kind = daq::RecordKind::Named(kind);
  record.metadata = metadata;
  return MetadataWarnings(record);
}

TEST(MetadataWarnings, AreNoneOfARecordThatSaysAll) {
  EXPECT_EQ(Of("hysteresis", {{"t1_Nm", "14"}, {"t2_Nm", "48"}, {"t3_Nm", "92"}, {"lock_angle_deg", "90"}}),
            Warnings());
  EXPECT_EQ(Of("transmission_error", {{"ratio", "100"}, {"absolute", "true"}, {"step_deg", "1"}}),
            Warnings());
  EXPECT_EQ(Of("motion", {{"kt_Nm_per_A", "0.11"}}), Warnings());
  EXPECT_EQ(Of("vibration", {{"sample_rate_hz", "12800"}, {"class", "worn"}}), Warnings());
}

TEST(MetadataWarnings, AreNoneOfWhatAPredictorMayLearn) {
  for (const analysis::Quantity& quantity : analysis::kPredictedQuantities)
    EXPECT_EQ(Of("vibration", {{std::string(quantity.name), "2"}}), Warnings()) << quantity.name;
}

TEST(MetadataWarnings, NameEachDefaultThatIsTaken) {
  EXPECT_EQ(Of("transmission_error", {}), Warnings{"metadata ratio is missing: the default of 80 is taken"});
  EXPECT_EQ(Of("hysteresis", {{"t2_Nm", "20"}}),
            (Warnings{"metadata t1_Nm is missing: the default of 7 Nm is taken",
                      "metadata t3_Nm is missing: the default of 34 Nm is taken"}));
}

TEST(MetadataWarnings, SayWhichKeyWasMeant) {
  const std::pair<const char*, const char*> kMeant[] = {{"T3_Nm", "t3_Nm"},   {"t3", "t3_Nm"},
                                                        {"T3 (Nm)", "t3_Nm"}, {"t3_NM", "t3_Nm"},
                                                        {"t3_kNm", "t3_Nm"},  {"t3-nm", "t3_Nm"}};
  for (const auto& [written, meant] : kMeant) {
    EXPECT_EQ(Of("hysteresis", {{"t1_Nm", "5"}, {"t2_Nm", "20"}, {written, "50"}}),
              (Warnings{"metadata t3_Nm is missing: the default of 34 Nm is taken",
                        fmt::format("metadata '{}' is not known and not read; did you mean '{}'?", written,
                                    meant)}));
  }
  for (const char* written : {"Ratio", "gear_ratio", "ratio_1", "ration"}) {
    EXPECT_EQ(Of("transmission_error", {{written, "100"}}).back(),
              fmt::format("metadata '{}' is not known and not read; did you mean 'ratio'?", written));
  }
  EXPECT_EQ(Of("motion", {{"inertia", "0.02"}}),
            Warnings{"metadata 'inertia' is not known and not read; did you mean 'inertia_kgm2'?"});
  EXPECT_EQ(Of("vibration", {{"samplerate_hz", "12800"}}),
            Warnings{"metadata 'samplerate_hz' is not known and not read; did you mean 'sample_rate_hz'?"});
}

TEST(MetadataWarnings, NameAKeyThatNothingReadsButOfAVibrationWhereItMayBeALabel) {
  EXPECT_EQ(Of("motion", {{"operator", "AB"}}), Warnings{"metadata 'operator' is not known and not read"});
  EXPECT_EQ(Of("vibration", {{"wear_um", "3"}}), Warnings());
}

}  // namespace
}  // namespace strainwave::bench::metadata_warnings_test
