// PDO parameters of simulated drives, step by step as CiA 301 tells the change of a mapping
// (7.5.2.36, 7.5.2.38).
#include "sim_support.hpp"

#include <fmt/format.h>

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

class Mapping : public DrivenTest {
 protected:
  static constexpr const char* kTaken = "581#60";
  /// Sets bit 31 of a COB-ID, where there is one, or clears it.
  void set_valid(std::uint16_t record, bool valid) {
    if (profile().dictionary.find({record, 1}) == nullptr) return;
    const auto cob_id = load_le(drive().value({record, 1})) & 0x7FFF'FFFFU;
    const auto bytes = to_hex(store_le(cob_id | (valid ? 0U : 0x8000'0000U), 4), "");
    const auto request = fmt::format("601#23{:02X}{:02X}01{}", record & 0xFFU, record >> 8U, bytes);
    ASSERT_EQ(sdo(request).substr(0, 6), kTaken) << request;
  }
  /// Types 252 and 253 of TPDO1 are refused while bit 30 of its COB-ID forbids remote frames.
  void expect_remote_types_by_bit_30() {
    ASSERT_EQ(sdo("601#23001801810100C0").substr(0, 6), kTaken);
    for (const char* type : {"FC", "FD"})
      EXPECT_EQ(sdo("601#2F001802" + std::string(type) + "000000"), "581#8000180230000906") << type;
    ASSERT_EQ(sdo("601#2300180181010080").substr(0, 6), kTaken);
    for (const char* type : {"FC", "FD"})
      EXPECT_EQ(sdo("601#2F001802" + std::string(type) + "000000").substr(0, 6), kTaken) << type;
  }
};

struct Mapped {
  const char* family;
  const char* answer;  ///< To an entry that is written while its count is not 0.
};

class MappedEntries : public Mapping, public testing::WithParamInterface<Mapped> {};

TEST_P(MappedEntries, AreNotWrittenBeforeTheCountIsZero) {
  boot(GetParam().family);
  const auto refused = [&](const char* object) {
    const auto code = std::string(GetParam().answer);
    return "581#80" + std::string(object) + code.substr(6, 2) + code.substr(4, 2) + code.substr(2, 2) +
           code.substr(0, 2);
  };
  // RPDO1 and TPDO1 are made invalid, mapped with one object, and then changed without going by the count.
  set_valid(0x1400, false);
  set_valid(0x1800, false);
  for (const char* request : {"601#2F00160000000000", "601#2300160110004060", "601#2F00160001000000",
                              "601#2F001A0000000000", "601#23001A0110004160", "601#2F001A0001000000"})
    ASSERT_EQ(sdo(request).substr(0, 6), kTaken) << request;
  EXPECT_EQ(sdo("601#2300160108006060"), refused("001601"));
  EXPECT_EQ(sdo("601#2300160208006060"), refused("001602"));
  EXPECT_EQ(sdo("601#23001A0220006460"), refused("001A02"));
  EXPECT_EQ(sdo("601#4000160100000000"), "581#4300160110004060");
  EXPECT_EQ(sdo("601#2F00160000000000").substr(0, 6), kTaken);
  EXPECT_EQ(sdo("601#2300160110004060").substr(0, 6), kTaken);
}

TEST_P(MappedEntries, ThatAreNotThereAreNotCounted) {  // 0604 0042h
  boot(GetParam().family);
  set_valid(0x1400, false);
  set_valid(0x1800, false);
  for (const char* request : {"601#2F00160000000000", "601#2300160110004060", "601#2300160200000000",
                              "601#2F001A0000000000", "601#23001A0110004160", "601#23001A0200000000"})
    ASSERT_EQ(sdo(request).substr(0, 6), kTaken) << request;
  EXPECT_EQ(sdo("601#2F00160002000000"), "581#8000160042000406");
  EXPECT_EQ(sdo("601#2F001A0002000000"), "581#80001A0042000406");
  EXPECT_EQ(sdo("601#2F00160001000000").substr(0, 6), kTaken);
  EXPECT_EQ(sdo("601#2F001A0001000000").substr(0, 6), kTaken);
}

TEST_P(MappedEntries, AreNoMoreThanTheDriveHas) {
  boot(GetParam().family);
  set_valid(0x1400, false);
  set_valid(0x1800, false);
  for (const std::uint16_t index : {std::uint16_t{0x1600}, std::uint16_t{0x1A00}}) {
    unsigned last = 0;
    for (const auto& entry : profile().dictionary.object(index)->entries)
      last = std::max<unsigned>(last, entry.address.sub);
    ASSERT_GT(last, 0U);
    const auto object = fmt::format("{:02X}{:02X}00", index & 0xFFU, index >> 8U);
    for (const auto count : {last + 1, 0x41U, 0xFFU})
      EXPECT_EQ(sdo(fmt::format("601#2F{}{:02X}000000", object, count)), "581#80" + object + "42000406")
          << count;
  }
}

INSTANTIATE_TEST_SUITE_P(Families, MappedEntries,
                         testing::Values(Mapped{"gsd600", "06010000"}, Mapped{"dm", "06010000"},
                                         Mapped{"da200", "08000000"}, Mapped{"ts", "06010000"},
                                         Mapped{"sv2", "06010000"}, Mapped{"cia402", "06010000"}),
                         [](const auto& test) { return std::string(test.param.family); });

TEST_F(Mapping, ACountBeyondTheSubIndexesIsRefused) {
  boot("cia402");  // Eight entries.
  (void)sdo("601#2300140101020080");
  ASSERT_EQ(sdo("601#2F00160000000000").substr(0, 6), kTaken);
  for (int sub = 1; sub <= 8; ++sub)
    ASSERT_EQ(sdo(fmt::format("601#230016{:02X}08000500", sub)).substr(0, 6), kTaken);  // Gaps of 8 bits.
  for (const char* count : {"09", "41", "FE", "FF"})
    EXPECT_EQ(sdo("601#2F001600" + std::string(count) + "000000"), "581#8000160042000406") << count;
  EXPECT_EQ(sdo("601#2F00160008000000").substr(0, 6), kTaken);
}

TEST_F(Mapping, ACanIdOfAnotherServiceIsNotTakenForAPdoThatIsValid) {  // Table 40
  boot("cia402");
  ASSERT_EQ(sdo("601#2300140101020080").substr(0, 6), kTaken);
  for (const char* id : {"00000000", "7F000000", "01010000", "80010000", "81050000", "01060000", "E0060000",
                         "01070000", "FF070000"})
    EXPECT_EQ(sdo("601#23001401" + std::string(id)), "581#8000140130000906") << id;
  EXPECT_EQ(sdo("601#2300140181050080").substr(0, 6), kTaken) << "it is not in use";
  EXPECT_EQ(sdo("601#2300140181010000").substr(0, 6), kTaken);
}

TEST_F(Mapping, RemoteFramesAreNoTypeWhereTheyAreForbidden) {  // 1800h:01, bit 30
  boot("cia402");
  expect_remote_types_by_bit_30();
  for (const char* type : {"F1", "FB"})
    EXPECT_EQ(sdo("601#2F001802" + std::string(type) + "000000"), "581#8000180230000906") << type;
  for (const char* type : {"F1", "FC", "FD"})
    EXPECT_EQ(sdo("601#2F001402" + std::string(type) + "000000"), "581#8000140230000906") << "RPDO " << type;
  for (const char* type : {"00", "F0", "FE", "FF"})
    EXPECT_EQ(sdo("601#2F001402" + std::string(type) + "000000").substr(0, 6), kTaken) << "RPDO " << type;
}

TEST_F(Mapping, TheInhibitTimeStaysWhileThePdoIsValid) {  // CiA 301, 7.5.2.37
  boot("cia402");
  ASSERT_EQ(sdo("601#2300180181010000").substr(0, 6), kTaken);
  EXPECT_EQ(sdo("601#2B00180364000000"), "581#8000180330000906");
  EXPECT_EQ(sdo("601#2B00180300000000").substr(0, 6), kTaken) << "what it is";
  EXPECT_EQ(sdo("601#2B00180564000000").substr(0, 6), kTaken) << "the event timer is free";
  ASSERT_EQ(sdo("601#2300180181010080").substr(0, 6), kTaken);
  EXPECT_EQ(sdo("601#2B00180364000000").substr(0, 6), kTaken);
}

TEST_F(Mapping, TheSyncStartValueStaysWhileThePdoIsValid) {  // CiA 301, 7.5.2.37
  boot("dm");
  ASSERT_EQ(sdo("601#2300180181010000").substr(0, 6), kTaken);
  EXPECT_EQ(sdo("601#2F00180603000000"), "581#8000180630000906");
  ASSERT_EQ(sdo("601#2300180181010080").substr(0, 6), kTaken);
  EXPECT_EQ(sdo("601#2F00180603000000").substr(0, 6), kTaken);
}

TEST_F(Mapping, OfTheTsTheInhibitTimeChangesWhileThePdoIsValid) {  // 1771, 1794
  boot("ts");
  EXPECT_EQ(sdo("601#2B00180364000000").substr(0, 6), kTaken);
}

TEST_F(Mapping, AValidPdoOfElevenBitsHasNoHigherOnes) {  // CiA 301, table 66: bits 11 to 28 are 0
  boot("cia402");
  ASSERT_EQ(sdo("601#2300180181010080").substr(0, 6), kTaken);
  for (const char* id : {"81010010", "81010100", "81090000"})
    EXPECT_EQ(sdo("601#23001801" + std::string(id)), "581#8000180130000906") << id;
  EXPECT_EQ(sdo("601#2300180181010030").substr(0, 6), kTaken) << "29 bits";
  ASSERT_EQ(sdo("601#2300180181010080").substr(0, 6), kTaken);
  ASSERT_EQ(sdo("601#2300180181010000").substr(0, 6), kTaken);
  EXPECT_EQ(sdo("601#2300180181010010"), "581#8000180130000906") << "while it is valid";
}

class IndexZero : public Mapping, public testing::WithParamInterface<const char*> {};

TEST_P(IndexZero, IsNoObject) {
  boot(GetParam());
  (void)sdo("601#2300140101020080");
  ASSERT_EQ(sdo("601#2F00160000000000").substr(0, 6), kTaken);
  EXPECT_EQ(sdo("601#2300160108000000"), "581#8000160100000206");
}

INSTANTIATE_TEST_SUITE_P(Families, IndexZero, testing::Values("cia402", "dm", "ts"),
                         [](const auto& test) { return std::string(test.param); });

TEST_F(Mapping, OfTheTsARemoteFrameIsATypeAsBit30Says) {
  boot("ts");
  expect_remote_types_by_bit_30();
}

TEST_F(Mapping, OfTheGsd600NoRemoteFrameIsAType) {  // 241 to 253 are reserved (1664).
  boot("gsd600");
  ASSERT_EQ(sdo("601#23001801810100C0").substr(0, 6), kTaken);
  for (const char* type : {"FC", "FD"})
    EXPECT_EQ(sdo("601#2F001802" + std::string(type) + "000000"), "581#8000180230000906") << type;
}

struct OnChange {
  const char* family;
  const char* type;
};

class OnEnteringOperational : public Mapping, public testing::WithParamInterface<OnChange> {};

TEST_P(OnEnteringOperational, ATpdoOnChangeIsSentOnce) {  // CiA 301, table 72: 254, 255
  boot(GetParam().family);
  set_valid(0x1800, false);
  for (const char* request : {"601#2F001A0000000000", "601#23001A0110004160", "601#2F001A0001000000"})
    ASSERT_EQ(sdo(request).substr(0, 6), kTaken) << request;
  ASSERT_EQ(sdo("601#2F001802" + std::string(GetParam().type) + "000000").substr(0, 6), kTaken);
  ASSERT_EQ(sdo("601#2B00180500000000").substr(0, 6), kTaken);
  set_valid(0x1800, true);
  for (int times = 0; times < 2; ++times) {
    send("000#0101");
    int sent = 0;
    for (auto frame = next(50ms); !frame.empty(); frame = next(50ms))
      if (frame.substr(0, 4) == "181#") ++sent;
    EXPECT_EQ(sent, 1);
    send("000#8001");
    (void)next(5ms);
  }
}

INSTANTIATE_TEST_SUITE_P(Families, OnEnteringOperational,
                         testing::Values(OnChange{"gsd600", "FE"}, OnChange{"gsd600", "FF"},
                                         OnChange{"dm", "FE"}, OnChange{"da200", "FE"}, OnChange{"ts", "FF"},
                                         OnChange{"cia402", "FE"}, OnChange{"cia402", "FF"}),
                         [](const auto& test) {
                           return std::string(test.param.family) + "_" + test.param.type;
                         });

}  // namespace
}  // namespace servoctl::sim
