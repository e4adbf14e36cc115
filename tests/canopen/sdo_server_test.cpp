#include "canopen/sdo_server.hpp"

#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>

#include <map>

#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_client.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

/// Serves what the test puts in; refuses with the code the test sets.
class Store final : public ObjectStore {
 public:
  std::uint32_t read(ObjectAddress object, Bytes& out) override {
    if (refusal != 0) return refusal;
    out = values[object];
    return 0;
  }
  std::uint32_t write(ObjectAddress object, ByteSpan data) override {
    if (refusal != 0) return refusal;
    values[object] = Bytes(data.begin(), data.end());
    return 0;
  }
  std::uint32_t check_writable(ObjectAddress object) override {
    return object == ObjectAddress{0x1008, 0} ? sdo_abort::kReadOnly : 0;
  }
  std::map<ObjectAddress, Bytes> values;
  std::uint32_t refusal = 0;
};

class SdoServerTest : public testing::Test {
 protected:
  Store store;
  SdoServer server{2, store, {}};
  TimePoint now{1s};
};

TEST_F(SdoServerTest, AnswersShortReadsExpedited) {
  store.values[{0x6041, 0}] = {0x50, 0x02};
  play(server, now, {"< 602#4041600000000000", "> 582#4B41600050020000"});
  store.values[{0x6041, 0}] = {1};
  play(server, now, {"< 602#4041600000000000", "> 582#4F41600001000000"});
  store.values[{0x6041, 0}] = {1, 2, 3};
  play(server, now, {"< 602#4041600000000000", "> 582#4741600001020300"});
  store.values[{0x6041, 0}] = {1, 2, 3, 4};
  play(server, now, {"< 602#4041600000000000", "> 582#4341600001020304"});
}

TEST_F(SdoServerTest, TakesExpeditedWritesOfEveryLength) {
  play(server, now, {"< 602#2F60600003000000", "> 582#6060600000000000"});
  EXPECT_EQ((store.values[{0x6060, 0}]), Bytes{3});
  play(server, now, {"< 602#2B40600000060000", "> 582#6040600000000000"});
  EXPECT_EQ((store.values[{0x6040, 0}]), (Bytes{0, 6}));
  play(server, now, {"< 602#2700200101020300", "> 582#6000200100000000"});
  EXPECT_EQ((store.values[{0x2000, 1}]), (Bytes{1, 2, 3}));
  play(server, now, {"< 602#2200200101020304", "> 582#6000200100000000"});
  EXPECT_EQ((store.values[{0x2000, 1}]), (Bytes{1, 2, 3, 4}));
}

TEST_F(SdoServerTest, GivesALongObjectInSegments) {
  store.values[{0x1008, 0}] = {1, 2, 3, 4, 5, 6, 7, 8};
  play(server, now,
       {"< 602#4008100000000000", "> 582#4108100008000000", "< 602#6000000000000000",
        "> 582#0001020304050607", "< 602#7000000000000000", "> 582#1D08000000000000"});
}

TEST_F(SdoServerTest, RefusesALongerTransferToWhatIsReadOnlyWhereItBegins) {  // 7.2.4.3.3, 7.2.4.3.9
  play(server, now, {"< 602#2108100008000000", "> 582#8008100002000106"});
  play(server, now, {"< 602#2008100000000000", "> 582#8008100002000106"});
  play(server, now, {"< 602#C208100008000000", "> 582#8008100002000106"});
  EXPECT_EQ(server.deadline(), kNever);
}

TEST_F(SdoServerTest, TakesALongObjectInSegmentsAndWritesItAtTheEnd) {
  play(server, now,
       {"< 602#2100200008000000", "> 582#6000200000000000", "< 602#0001020304050607",
        "> 582#2000000000000000"});
  EXPECT_TRUE((store.values[{0x2000, 0}].empty()));
  play(server, now, {"< 602#1D08000000000000", "> 582#3000000000000000"});
  EXPECT_EQ((store.values[{0x2000, 0}]), (Bytes{1, 2, 3, 4, 5, 6, 7, 8}));
}

TEST_F(SdoServerTest, PassesRefusalsOnWithIndexAndSubIndex) {
  store.refusal = sdo_abort::kReadOnly;
  play(server, now, {"< 602#2F41600501000000", "> 582#8041600502000106"});
  store.refusal = sdo_abort::kNoObject;
  play(server, now, {"< 602#40FF5F0000000000", "> 582#80FF5F0000000206"});
}

TEST_F(SdoServerTest, RefusesSegmentsWhereTheDriveHasNone) {
  SdoServer expedited(2, store, {.segmented = false});
  store.values[{0x1008, 0}] = {1, 2, 3, 4, 5};
  play(expedited, now,
       {"< 602#2100200008000000", "> 582#8000200001000405", "< 602#4008100000000000",
        "> 582#8008100000000106"});
}

TEST_F(SdoServerTest, AbortsOnAWrongToggleOrASegmentOutOfPlace) {
  play(server, now,
       {"< 602#2100200008000000", "> 582#6000200000000000", "< 602#1001020304050607",
        "> 582#8000200000000305"});
  play(server, now,
       {"< 602#6000000000000000", "> 582#8000200001000405", "< 602#0001020304050607",
        "> 582#8000200001000405"});
  play(server, now, {"< 602#E000200000000000", "> 582#8000200001000405"});
}

TEST_F(SdoServerTest, AbortsWhenTheSizeIsNotTheOneAnnounced) {
  play(server, now,
       {"< 602#2100200004000000", "> 582#6000200000000000", "< 602#0501020304050000",
        "> 582#8000200012000706"});
  play(server, now,
       {"< 602#2100200008000000", "> 582#6000200000000000", "< 602#0501020304050000",
        "> 582#8000200013000706"});
  EXPECT_TRUE((store.values[{0x2000, 0}].empty()));
}

TEST_F(SdoServerTest, ForgetsATransferTheClientAborts) {
  play(server, now,
       {"< 602#2100200008000000", "> 582#6000200000000000", "< 602#8000200000000405",
        "< 602#0001020304050607", "> 582#8000200001000405"});
}

TEST_F(SdoServerTest, GivesTheClientItsFullTimeForEverySegment) {
  play(server, now,
       {"< 602#2100200010000000", "> 582#6000200000000000", "+ 900ms", "< 602#0031323334353637",
        "> 582#2000000000000000", "+ 999ms", "+ 1ms", "> 582#8000200000000405"});
  store.values[{0x2000, 0}] = Bytes(20, 1);
  play(server, now,
       {"< 602#4000200000000000", "> 582#4100200014000000", "+ 900ms", "< 602#6000000000000000",
        "> 582#0001010101010101", "+ 999ms", "+ 1ms", "> 582#8000200000000405"});
}

TEST_F(SdoServerTest, GivesUpAClientThatFallsSilent) {
  play(server, now,
       {"< 602#2100200008000000", "> 582#6000200000000000", "+ 999ms", "+ 1ms", "> 582#8000200000000405",
        "+ 5s"});
}

TEST_F(SdoServerTest, IgnoresFramesForOthers) {
  play(server, now, {"< 603#4041600000000000", "< 582#4041600000000000", "< 602#404160", "< 602#R"});
}

RC_GTEST_PROP(SdoChannel, CarriesAnyBytesBothWays, (const Bytes& data)) {
  Store store;
  SdoServer server(5, store, {});
  SdoClient client(5, 1s);
  TimePoint now{1s};
  const auto run = [&]() -> Result<Bytes> {
    for (int steps = 0; steps < 2000; ++steps) {
      if (auto result = client.take_result()) return *result;
      if (const auto request = client.take_frame()) server.on_frame(*request, now);
      if (const auto answer = server.take_frame()) client.on_frame(*answer, now);
    }
    return fail(Errc::bug, "no end");
  };
  client.start_download({0x2000, 1}, data, now);
  RC_ASSERT(run().has_value());
  RC_ASSERT((store.values[{0x2000, 1}] == data));
  client.start_upload({0x2000, 1}, now);
  RC_ASSERT(run().value() == data);
}

}  // namespace
}  // namespace servoctl::canopen
