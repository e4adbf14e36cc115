// Communication objects of simulated drives, with frames and abort codes as CiA 301 prints them (7.5.2).
#include "sim_support.hpp"

#include <cstdio>
#include <tuple>

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

const char* const kTaken = "60";
const char* const kRange = "0609 0030";

class CommunicationObjects : public DrivenTest {
 protected:
  /// What became of a write of `data`, low byte first: `60`, or the abort code as CiA 301 prints it.
  std::string put(std::uint16_t index, unsigned sub, std::string_view data) {
    char head[24];
    const auto command = 0x23U | (4U - static_cast<unsigned>(data.size()) / 2) << 2U;
    std::snprintf(head, sizeof head, "601#%02X%02X%02X%02X", command, index & 0xFFU, index >> 8U, sub);
    const auto answer = sdo(std::string(head) + std::string(data) + std::string(8 - data.size(), '0'));
    if (answer.substr(4, 2) != "80") return answer.substr(4, 2);
    return answer.substr(18, 2) + answer.substr(16, 2) + " " + answer.substr(14, 2) + answer.substr(12, 2);
  }
  std::string get(std::uint16_t index, unsigned sub) {
    char frame[24];
    std::snprintf(frame, sizeof frame, "601#40%02X%02X%02X00000000", index & 0xFFU, index >> 8U, sub);
    return sdo(frame).substr(4);
  }
};

class OfFamily : public CommunicationObjects, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override { boot(GetParam()); }
  bool has(std::uint16_t index, std::uint8_t sub) const {
    const auto* entry = profile().dictionary.find({index, sub});
    return entry != nullptr && od::writable(entry->access);
  }
};

class SyncObject : public OfFamily {};
class TimeObject : public OfFamily {};
class EmergencyObject : public OfFamily {};
class HeartbeatConsumers : public OfFamily {};
class SyncCounter : public OfFamily {};
class StoreAndRestore : public OfFamily {};

std::string family_name(const testing::TestParamInfo<const char*>& test) { return test.param; }

TEST_P(SyncObject, CanIdIsNoRestrictedOneAndHas11Bits) {
  for (const char* id : {"00000000", "01000000", "7F000000", "01010000", "80010000", "81050000", "FF050000",
                         "01060000", "7F060000", "E0060000", "FF060000", "01070000", "7F070000", "FF070000"})
    EXPECT_EQ(put(0x1005, 0, id), kRange) << id;
  EXPECT_EQ(put(0x1005, 0, "00080000"), kRange);
  EXPECT_EQ(put(0x1005, 0, "80000020"), kRange) << "bit 29";
  for (const char* id : {"81000000", "00010000", "81010000", "80050000", "00060000", "00070000", "80000000"})
    EXPECT_EQ(put(0x1005, 0, id), kTaken) << id;
}

TEST_P(SyncObject, IsProducedByNone) {
  EXPECT_EQ(put(0x1005, 0, "80000040"), kRange);
  EXPECT_EQ(get(0x1005, 0), "4305100080000000");
}

TEST_P(TimeObject, CanIdIsNoRestrictedOneAndStaysWhileItIsTaken) {
  for (const char* id : {"7F000000", "01010080", "00060180", "01070000", "00010020", "00010040"})
    EXPECT_EQ(put(0x1012, 0, id), kRange) << id;
  EXPECT_EQ(put(0x1012, 0, "00000000"), kRange) << "the CAN-ID of NMT";
  EXPECT_EQ(put(0x1012, 0, "00020080"), kTaken);
  EXPECT_EQ(put(0x1012, 0, "00000000"), kRange);
  EXPECT_EQ(put(0x1012, 0, "00010080"), kRange);
  EXPECT_EQ(put(0x1012, 0, "00020000"), kTaken);
  EXPECT_EQ(put(0x1012, 0, "00010080"), kTaken);
}

TEST_P(EmergencyObject, CanIdIsNoRestrictedOneAndStaysWhileItIsValid) {
  for (const char* id : {"7F000080", "01010080", "81050080", "FF060080", "81000020", "81000040", "81080080"})
    EXPECT_EQ(put(0x1014, 0, id), kRange) << id;
  EXPECT_EQ(put(0x1014, 0, "81000000"), kTaken) << "what it is";
  EXPECT_EQ(put(0x1014, 0, "82000000"), kRange) << "while it is valid";
  EXPECT_EQ(put(0x1014, 0, "81000080"), kTaken);
  EXPECT_EQ(put(0x1014, 0, "01070000"), kRange);
  EXPECT_EQ(put(0x1014, 0, "82000000"), kTaken);
}

TEST_P(HeartbeatConsumers, OneNodeIsNotWatchedByTwoEntries) {
  EXPECT_EQ(put(0x1016, 1, "E8030500"), kTaken);  // The example of a manual: node 5, 1000 ms.
  EXPECT_EQ(put(0x1016, 2, "F4010500"), "0604 0043");
  EXPECT_EQ(put(0x1016, 1, "F4010500"), kTaken) << "its own entry";
  EXPECT_EQ(put(0x1016, 2, "00000500"), kTaken) << "a time of 0 watches nobody";
  EXPECT_EQ(put(0x1016, 3, "F401C500"), kTaken) << "no node-ID: not used";
  EXPECT_EQ(put(0x1016, 1, "00000000"), kTaken);
  EXPECT_EQ(put(0x1016, 2, "F4010500"), kTaken);
}

TEST_P(SyncCounter, HasARangeAndChangesWhileThePeriodIsZero) {
  for (const char* value : {"01", "F1", "FF"}) EXPECT_EQ(put(0x1019, 0, value), kRange) << value;
  for (const char* value : {"02", "F0", "00", "0A"}) EXPECT_EQ(put(0x1019, 0, value), kTaken) << value;
  EXPECT_EQ(put(0x1006, 0, "E8030000"), kTaken);
  EXPECT_EQ(put(0x1019, 0, "0B"), "0800 0022");
  EXPECT_EQ(put(0x1019, 0, "0A"), kTaken) << "what it is";
  EXPECT_EQ(put(0x1006, 0, "00000000"), kTaken);
  EXPECT_EQ(put(0x1019, 0, "0B"), kTaken);
}

TEST_P(StoreAndRestore, EverySubIndexWantsItsSignature) {
  for (const auto index : {std::uint16_t{0x1010}, std::uint16_t{0x1011}})
    for (std::uint8_t sub = 1; has(index, sub); ++sub) {
      const auto before = get(index, sub);
      const auto* right = index == 0x1010 ? "73617665" : "6C6F6164";
      const auto* wrong = index == 0x1010 ? "6C6F6164" : "73617665";
      EXPECT_EQ(put(index, sub, wrong), "0800 0020") << index << ":" << unsigned{sub};
      EXPECT_EQ(put(index, sub, "01000000"), "0800 0020") << index << ":" << unsigned{sub};
      EXPECT_EQ(put(index, sub, right), kTaken) << index << ":" << unsigned{sub};
      EXPECT_EQ(get(index, sub), before) << "what it can do";
    }
}

// Those that have the object, and where it can be written.
INSTANTIATE_TEST_SUITE_P(Families, SyncObject, testing::Values("gsd600", "dm", "ts", "cia402"), family_name);
INSTANTIATE_TEST_SUITE_P(Families, TimeObject, testing::Values("dm", "ts"), family_name);
INSTANTIATE_TEST_SUITE_P(Families, EmergencyObject, testing::Values("gsd600", "dm", "ts", "cia402"),
                         family_name);
INSTANTIATE_TEST_SUITE_P(Families, HeartbeatConsumers, testing::Values("gsd600", "dm", "cia402"),
                         family_name);
INSTANTIATE_TEST_SUITE_P(Families, SyncCounter, testing::Values("dm", "cia402"), family_name);
INSTANTIATE_TEST_SUITE_P(Families, StoreAndRestore, testing::Values("gsd600", "dm", "cia402"), family_name);

TEST_F(CommunicationObjects, EachGroupIsStoredAndRestoredByItself) {
  boot("cia402");
  const std::tuple<std::uint16_t, const char*, const char*> settings[] = {
      {0x1017, "F401", "4B171000F4010000"}, {0x6081, "39300000", "4381600039300000"}};
  for (const auto& [index, data, read] : settings) EXPECT_EQ(put(index, 0, data), kTaken);
  EXPECT_EQ(put(0x1010, 2, "73617665"), kTaken);
  const auto restart = [&] {
    send("000#8101");
    while (next(100ms) != "701#00") {
    }
  };
  restart();
  EXPECT_EQ(get(0x1017, 0), "4B171000F4010000");
  EXPECT_NE(get(0x6081, 0), "4381600039300000") << "not of this group";
  EXPECT_EQ(put(0x6081, 0, "39300000"), kTaken);
  EXPECT_EQ(put(0x1010, 3, "73617665"), kTaken);
  EXPECT_EQ(put(0x1011, 2, "6C6F6164"), kTaken);
  restart();
  EXPECT_EQ(get(0x1017, 0), "4B17100000000000");
  EXPECT_EQ(get(0x6081, 0), "4381600039300000");
}

TEST_F(CommunicationObjects, TheGenericDriveTellsTheModesItTakes) {  // CiA 402-2, 6502h: bit n - 1 for mode n
  boot("cia402");
  EXPECT_EQ(get(0x6502, 0), "43026500EF030000");
  for (int mode = 1; mode <= 11; ++mode) {
    char byte[3];
    std::snprintf(byte, sizeof byte, "%02X", static_cast<unsigned>(mode));
    EXPECT_EQ(put(0x6060, 0, byte) == kTaken, (0x03EFU >> (mode - 1) & 1U) != 0) << mode;
  }
}

TEST_F(CommunicationObjects, TheSyncPeriodOfTheDa200IsZeroOrAThousandMicroseconds) {  // 145
  boot("da200");
  for (const char* value : {"01000000", "F4010000", "E7030000"}) {
    EXPECT_EQ(put(0x1006, 0, value), kRange) << value;
    EXPECT_EQ(emergency_.substr(10, 4), "1A04") << "Er26-4 (1087)";
    EXPECT_EQ(get(0x1006, 0), "4306100000000000");
  }
  for (const char* value : {"E8030000", "E9030000", "FFFFFFFF", "00000000"})
    EXPECT_EQ(put(0x1006, 0, value), kTaken) << value;
}

TEST_F(CommunicationObjects, ModesThatAManualPrintsStay) {
  boot("gsd600");
  EXPECT_EQ(get(0x6502, 0), "430265006D000000");  // 5336
}

class LongDownload : public OfFamily {};

TEST_P(LongDownload, ToWhatIsReadOnlyEndsWhereItBegins) {  // CiA 301, 7.2.4.3.3
  const bool segmented = profile().rules.sdo.segmented;
  const std::string refused = segmented ? "02000106" : "01000405";  // 0601 0002h; 0504 0001h: none at all.
  EXPECT_EQ(sdo("601#2141600002000000"), "581#80416000" + refused);
  EXPECT_EQ(sdo("601#2041600000000000"), "581#80416000" + refused);
  EXPECT_EQ(segmented, std::string(GetParam()) != "gsd600");
}

INSTANTIATE_TEST_SUITE_P(Families, LongDownload,
                         testing::Values("gsd600", "dm", "da200", "ts", "sv2", "cia402"), family_name);

TEST_F(CommunicationObjects, ALongDownloadToWhatIsReadOnlyEndsWhereItBegins) {  // CiA 301, 7.2.4.3.3
  boot("cia402");
  EXPECT_EQ(sdo("601#2141600002000000"), "581#8041600002000106");  // Segmented, with its size.
  EXPECT_EQ(sdo("601#2041600000000000"), "581#8041600002000106");  // … without.
  EXPECT_EQ(sdo("601#C641600002000000"), "581#8041600002000106");  // Block.
  EXPECT_EQ(sdo("601#2100200004000000"), "581#8000200000000206");
  EXPECT_EQ(sdo("601#2140600902000000"), "581#8040600911000906");
  EXPECT_EQ(sdo("601#0041600000000000"), "581#8040600901000405") << "nothing is under way";
}

TEST_F(CommunicationObjects, ALongDownloadToWhatIsReadOnlyIsAlarmedOnce) {
  boot("da200");
  EXPECT_EQ(sdo("601#2141600002000000"), "581#8041600002000106");
  EXPECT_EQ(emergency_.substr(10, 4), "1A05");  // Er26-5
  emergency_.clear();
  wait(10ms);
  EXPECT_EQ(emergency_, "");
}

}  // namespace
}  // namespace servoctl::sim
