// Emergencies under the CAN-ID that 1014h tells (CiA 301, 7.5.2.17).
#include "canopen/emergency_ids.hpp"

#include "canopen/node_watch.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

TEST(EmergencyIds, ArePredefinedUntilSomethingElseIsKnown) {
  const EmergencyIds ids;
  EXPECT_EQ(ids.parse(frame("083#3081110000000000"))->node, 3);
  EXPECT_FALSE(ids.parse(frame("281#3081110000000000")));
}

TEST(EmergencyIds, OfA1014hThatWasReadAreTheNodes) {
  EmergencyIds ids;
  ids.learn(3, 0x281);
  const auto found = ids.parse(frame("281#30811105060708AA"));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->node, 3);
  EXPECT_EQ(found->code, 0x8130);
  EXPECT_EQ(found->vendor, (std::array<std::uint8_t, 5>{5, 6, 7, 8, 0xAA}));
  EXPECT_FALSE(ids.parse(frame("281#30"))) << "a byte is no emergency";
  EXPECT_FALSE(ids.parse(frame("281#R8")));
  EXPECT_EQ(ids.parse(frame("083#3081"))->node, 3) << "it may have restarted";
  EXPECT_EQ(ids.parse(frame("085#3081"))->node, 5) << "the others send as before";
  ids.learn(3, 0x83);
  EXPECT_FALSE(ids.parse(frame("281#3081")));
}

TEST(EmergencyIds, MayBeThatOfAnotherNodeAndHave29Bits) {
  EmergencyIds ids;
  ids.learn(3, 0x85);
  EXPECT_EQ(ids.parse(frame("085#3081"))->node, 3);
  ids.learn(4, 0x2000'0085);
  EXPECT_EQ(ids.parse(frame("00000085#3081"))->node, 4);
  EXPECT_EQ(ids.parse(frame("085#3081"))->node, 3);
}

TEST(EmergencyIds, BelongToTheNodeOfThatNumberOnceItsOwn1014hSaysSo) {
  EmergencyIds ids;
  ids.learn(3, 0x85);
  ids.learn(5, 0x85);
  EXPECT_EQ(ids.parse(frame("085#3081"))->node, 5);
}

TEST(EmergencyIds, OfAnotherNodeAreForgottenAtABootUp) {
  EmergencyIds ids;
  ids.learn(3, 0x85);
  ids.learn(4, 0x281);
  ids.on_boot_up(3);
  ids.on_boot_up(4);
  EXPECT_EQ(ids.parse(frame("085#3081"))->node, 5);
  EXPECT_EQ(ids.parse(frame("281#3081"))->node, 4) << "it may be stored";
}

TEST(EmergencyIds, AreNotTakenFromOtherServicesNorWhenTheyAreSwitchedOff) {
  EmergencyIds ids;
  for (const std::uint32_t cob_id :
       {0x8000'0281U, 0U, 0x80U, 0x100U, 0x583U, 0x603U, 0x701U, 0x7E4U, 0x10U}) {
    ids.learn(3, cob_id);
    auto heard = frame("281#3081110000000000");
    EXPECT_FALSE(ids.parse(heard)) << cob_id;
    heard.id = cob_id & 0x7FFU;
    if (heard.id != 0x281) {
      EXPECT_FALSE(ids.parse(heard)) << cob_id;
    }
  }
}

TEST(EmergencyIds, AreHeardByTheWatch) {
  NodeWatch watch;
  watch.learn_emergency_id(3, 0x281);
  watch.on_frame(frame("281#3081110000000000"), TimePoint{});
  const auto event = watch.take_event();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->node, 3);
  EXPECT_EQ(std::get<Emergency>(event->what).code, 0x8130);
  EXPECT_EQ(watch.emergencies(3).size(), 1U);
}

}  // namespace
}  // namespace servoctl::canopen
