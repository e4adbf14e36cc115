// What an NMT reset of the communication brings back, and what only one of the node does (CiA
// 301, 7.3.2.2.1).
#include "sim_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

class Reset : public DrivenTest {
 protected:
  void take(const std::string& request) { ASSERT_EQ(sdo(request).substr(0, 6), "581#60") << request; }
  void reset(const char* command) {
    send(command);
    while (next(100ms) != "701#00") {
    }
  }
};
constexpr const char* kResetNode = "000#8101";
constexpr const char* kResetCommunication = "000#8201";

struct FamilyFrames {
  const char* family;
  const char* cob_id;                     ///< Of TPDO1, low byte first: another than the factory's …
  const char* factory_cob_id;             ///< … which is this.
  const char* mode = "2F60600003000000";  ///< A write of 3 to 6060h.
};

class ResetOfFamily : public Reset, public testing::WithParamInterface<FamilyFrames> {};

TEST_P(ResetOfFamily, OfTheCommunicationBringsBackItsAreaAlone) {
  boot(GetParam().family);
  take("601#2B171000F4010000");
  take(std::string("601#") + GetParam().mode);
  take(std::string("601#23001801") + GetParam().cob_id);
  EXPECT_EQ(sdo("601#4000180100000000"), std::string("581#43001801") + GetParam().cob_id);
  reset(kResetCommunication);
  EXPECT_EQ(sdo("601#4017100000000000"), "581#4B17100000000000");
  EXPECT_EQ(sdo("601#4000180100000000"), std::string("581#43001801") + GetParam().factory_cob_id);
  EXPECT_EQ(sdo("601#4060600000000000").substr(12), "03000000") << "no object of the communication";
  EXPECT_EQ(next(2s), "") << "and no heartbeat";
  reset(kResetNode);
  EXPECT_NE(sdo("601#4060600000000000").substr(12), "03000000");
}

INSTANTIATE_TEST_SUITE_P(Families, ResetOfFamily,
                         testing::Values(FamilyFrames{"gsd600", "810100C0", "81010040"},
                                         FamilyFrames{"dm", "81010000", "81010080", "2B60600003000000"},
                                         FamilyFrames{"da200", "81010080", "81010000"},
                                         FamilyFrames{"ts", "81010080", "81010000"},
                                         FamilyFrames{"cia402", "81010080", "81010000"}),
                         [](const auto& test) { return std::string(test.param.family); });

class StoredCommunication : public Reset, public testing::WithParamInterface<const char*> {};

TEST_P(StoredCommunication, ComesBackWithAResetAndTheDefaultsBehind1011h) {
  boot(GetParam());
  take("601#2B171000F4010000");
  take("601#2310100173617665");
  take("601#2B17100064000000");
  reset(kResetCommunication);
  EXPECT_EQ(sdo("601#4017100000000000"), "581#4B171000F4010000");
  take("601#231110016C6F6164");
  EXPECT_EQ(sdo("601#4017100000000000"), "581#4B171000F4010000") << "not before the reset";
  reset(kResetCommunication);
  EXPECT_EQ(sdo("601#4017100000000000"), "581#4B17100000000000");
}

INSTANTIATE_TEST_SUITE_P(Families, StoredCommunication, testing::Values("dm", "cia402"),
                         [](const auto& test) { return std::string(test.param); });

TEST_F(Reset, OfTheCommunicationForgetsWhoWasWatched) {
  boot("gsd600");
  take("601#23161001F4017F00");
  send("77F#05");
  reset(kResetCommunication);
  EXPECT_EQ(sdo("601#4016100100000000"), "581#4316100100000000");
  EXPECT_EQ(next(2s), "") << "nobody is missed";
}

TEST_F(Reset, OfTheCommunicationTakesTheDa200OutOfOperationalAndItsPower) {  // 147
  boot("da200");
  send("000#0101");
  for (const char* word : {"06", "07", "0F"}) take(std::string("601#2B406000") + word + "000000");
  ASSERT_EQ(drive().power_state(), drive::DriveState::operation_enabled);
  reset(kResetCommunication);
  EXPECT_EQ(drive().power_state(), drive::DriveState::switch_on_disabled);
}

TEST_F(Reset, OfTheNodeAloneTakesOverWhatIsSetForTheNextStart) {  // Pn0116: effective after a restart.
  boot("gsd600");
  take("601#2B002075C8000000");
  reset(kResetCommunication);
  EXPECT_EQ(sdo("601#4017100000000000"), "581#4B17100000000000");
  reset(kResetNode);
  EXPECT_EQ(sdo("601#4017100000000000"), "581#4B171000C8000000");
}

}  // namespace
}  // namespace servoctl::sim
