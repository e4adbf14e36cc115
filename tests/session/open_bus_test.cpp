#include "session/open_bus.hpp"

#include <gtest/gtest.h>

namespace servoctl::session {
namespace {

TEST(BusUrl, IsCheckedBeforeAnythingIsOpened) {
  for (const char* url :
       {"can0", "socketcan:can0", "slcan:/dev/ttyACM0@1M", "slcan:/dev/ttyUSB0@500k,57600",
        "socketcand://cabinet/can0", "socketcand://[::1]:29536/can0", "local:x", "sim:dm@1"})
    EXPECT_TRUE(check_url(url)) << url;
  for (const char* url : {"", "slcan:", "slcan:/dev/ttyACM0", "slcan:/dev/ttyACM0@83k", "socketcand:can0",
                          "socketcand://cabinet", "socketcand://cabinet:0/can0", "slkan:/dev/ttyACM0@1M"}) {
    const auto wrong = check_url(url);
    ASSERT_FALSE(wrong) << url;
    EXPECT_EQ(wrong.error().code, Errc::usage) << url;
    EXPECT_FALSE(wrong.error().hint.text().empty()) << url;
  }
}

TEST(BusUrl, TellsTheBitrateOfASerialAdapter) {
  EXPECT_EQ(bitrate_of("slcan:/dev/ttyACM0@500k"), 500'000U);
  EXPECT_EQ(bitrate_of("slcan:/dev/ttyACM0"), std::nullopt);
  EXPECT_EQ(bitrate_of("socketcand://cabinet/can0"), std::nullopt);
  EXPECT_EQ(bitrate_of("local:x"), std::nullopt);
}

/// What a drive is to store follows from it: a bus of which nothing is known runs at none.
TEST(BusUrl, RunsAtABitrateThatIsKnownOrAtAnyWhereThereIsNone) {
  EXPECT_TRUE(runs_at("slcan:/dev/ttyACM0@500k", 500'000));
  EXPECT_FALSE(runs_at("slcan:/dev/ttyACM0@500k", 250'000));
  EXPECT_TRUE(runs_at("sim:gsd600@1", 250'000));
  EXPECT_TRUE(runs_at("local:cell", 250'000));
  for (const auto* url :
       {"socketcand://192.0.2.1/can0", "gateway://192.0.2.1:6000", "nosuchcan7", "replay:a.log"})
    EXPECT_FALSE(runs_at(url, 500'000)) << url;
}

TEST(BusUrl, OnlySocketcandHasNoRemoteFrames) {
  EXPECT_FALSE(carries_remote_frames("socketcand://cabinet/can0"));
  for (const char* url : {"can0", "socketcan:can0", "slcan:/dev/ttyACM0@1M", "local:x"})
    EXPECT_TRUE(carries_remote_frames(url)) << url;
}

}  // namespace
}  // namespace servoctl::session
