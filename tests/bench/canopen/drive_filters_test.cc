// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/canopen/drive_filters.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace strainwave::bench::drive_filters_test {
namespace {

using protocols::canopen::DriveProfile;
using protocols::canopen::PdoFlow;
using protocols::canopen::PdoSetting;

bool Passes(const std::vector<CanFilter>& filters, std::uint32_t id) {
  return std::ranges::any_of(filters, [&](const CanFilter& filter) {
    return !filter.extended && (filter.id & filter.mask) == (id & filter.mask);
  });
}

PdoSetting Pdo(PdoFlow flow, std::uint16_t number, std::uint32_t cob_id) {
  return {flow, number, cob_id, 255, {}, {}, {}};
}

TEST(FiltersOfDrive, LetThroughWhatItsMasterMustHear) {
  const auto filters = FiltersOfDrive({}, 5);
  // NMT and SYNC of another master; EMCY, TPDOs 1 to 4, and the answer to an SDO; its heartbeat and others'.
  for (const std::uint32_t id : {0x000, 0x080, 0x085, 0x185, 0x285, 0x385, 0x485, 0x585, 0x705, 0x706}) {
    EXPECT_TRUE(Passes(filters, id)) << std::hex << id;
  }
  for (const std::uint32_t id : {0x086, 0x186, 0x386, 0x586, 0x606}) {
    EXPECT_FALSE(Passes(filters, id)) << std::hex << id;
  }
}

TEST(FiltersOfDrive, LetThroughPdosThatDoNotBearItsNumber) {
  DriveProfile profile;
  profile.pdos = {Pdo(PdoFlow::kFromDrive, 1, 0x1A0), Pdo(PdoFlow::kFromDrive, 2, 0x280),
                  Pdo(PdoFlow::kToDrive, 1, 0x220)};
  const auto filters = FiltersOfDrive(profile, 5);
  EXPECT_TRUE(Passes(filters, 0x1A5));
  EXPECT_FALSE(Passes(filters, 0x1A6));
  EXPECT_FALSE(Passes(filters, 0x225)) << "it is sent, and opens its filter by itself";
  EXPECT_EQ(filters.size(), FiltersOfNode(5).size() + 1);
}

}  // namespace
}  // namespace strainwave::bench::drive_filters_test
