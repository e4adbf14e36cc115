// Which COB-IDs an object may hold: every CAN-ID of 11 bits, for every object that holds one.
#include "canopen/cob_id_rules.hpp"

#include <gtest/gtest.h>

#include <ios>

namespace servoctl::canopen {
namespace {

/// CiA 301, table 40, written out: no configurable object may have these.
bool restricted(std::uint32_t id) {
  return id <= 0x07F || (id >= 0x101 && id <= 0x180) || (id >= 0x581 && id <= 0x5FF) ||
         (id >= 0x601 && id <= 0x67F) || (id >= 0x6E0 && id <= 0x6FF) || (id >= 0x701 && id <= 0x7FF);
}

TEST(CobIdRules, RefuseEveryRestrictedCanIdForSyncTimeEmcyAndPdos) {
  for (std::uint32_t id = 0; id <= 0x7FF; ++id) {
    if (!restricted(id)) continue;
    for (const ObjectAddress object :
         {ObjectAddress{0x1005, 0}, {0x1014, 0}, {0x1400, 1}, {0x15FF, 1}, {0x1800, 1}, {0x19FF, 1}})
      EXPECT_FALSE(cob_id_conflict(object, id, 1).empty()) << to_string(object) << " " << id;
    EXPECT_FALSE(cob_id_conflict({0x1012, 0}, id | 0x8000'0000, 1).empty()) << id;
    EXPECT_FALSE(cob_id_conflict({0x1012, 0}, id | 0x4000'0000, 1).empty()) << id;
  }
}

TEST(CobIdRules, LeaveEveryOtherServiceItsPlace) {
  for (const std::uint32_t id : {0x80U, 0x81U, 0xFFU, 0x100U})
    EXPECT_FALSE(cob_id_conflict({0x1801, 1}, id, 1).empty()) << id;
  EXPECT_EQ(cob_id_conflict({0x1005, 0}, 0x80, 1), "");
  EXPECT_EQ(cob_id_conflict({0x1005, 0}, 0x4000'0080, 1), "");
  EXPECT_EQ(cob_id_conflict({0x1005, 0}, 0x100, 1), "CAN-ID 0x100 belongs to TIME");
  EXPECT_EQ(cob_id_conflict({0x1012, 0}, 0x8000'0100, 1), "");
  EXPECT_EQ(cob_id_conflict({0x1014, 0}, 0x85, 5), "");
  EXPECT_EQ(cob_id_conflict({0x1014, 0}, 0x84, 5), "CAN-ID 0x084 belongs to EMCY of another node");
  EXPECT_EQ(cob_id_conflict({0x1014, 0}, 0x80, 5), "CAN-ID 0x080 belongs to SYNC");
  EXPECT_EQ(cob_id_conflict({0x1200, 1}, 0x601, 1), "");
  EXPECT_EQ(cob_id_conflict({0x1280, 2}, 0x701, 1), "CAN-ID 0x701 belongs to error control");
}

TEST(CobIdRules, TakeWhatIsNotInUseWhatIsFreeAndWhatHas29Bits) {
  for (std::uint32_t id = 0; id <= 0x7FF; ++id) {
    EXPECT_EQ(cob_id_conflict({0x1400, 1}, id | 0x8000'0000, 1), "");
    EXPECT_EQ(cob_id_conflict({0x1400, 1}, id | 0x2000'0000, 1), "");
    EXPECT_EQ(cob_id_conflict({0x1012, 0}, id, 1), "");
    EXPECT_EQ(cob_id_conflict({0x1600, 1}, id, 1), "") << "a mapping is no COB-ID";
    EXPECT_EQ(cob_id_conflict({0x1400, 2}, id, 1), "");
  }
  for (const std::uint32_t id : {0x181U, 0x201U, 0x4FFU, 0x580U, 0x600U, 0x680U, 0x6DFU, 0x700U})
    EXPECT_EQ(cob_id_conflict({0x1800, 1}, id, 1), "") << id;
}

TEST(CobIdRules, KnowEveryRestrictedCanId) {
  for (std::uint32_t id = 0; id <= 0x7FF; ++id)
    EXPECT_EQ(is_restricted(id), restricted(id)) << std::hex << id;
}

}  // namespace
}  // namespace servoctl::canopen
