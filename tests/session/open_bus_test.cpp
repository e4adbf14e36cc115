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
    EXPECT_FALSE(wrong.error().hint.empty()) << url;
  }
}

TEST(BusUrl, TellsTheBitrateOfASerialAdapter) {
  EXPECT_EQ(bitrate_of("slcan:/dev/ttyACM0@500k"), 500'000U);
  EXPECT_EQ(bitrate_of("slcan:/dev/ttyACM0"), std::nullopt);
  EXPECT_EQ(bitrate_of("socketcand://cabinet/can0"), std::nullopt);
  EXPECT_EQ(bitrate_of("local:x"), std::nullopt);
}

TEST(BusUrl, OnlySocketcandHasNoRemoteFrames) {
  EXPECT_FALSE(carries_remote_frames("socketcand://cabinet/can0"));
  for (const char* url : {"can0", "socketcan:can0", "slcan:/dev/ttyACM0@1M", "local:x"})
    EXPECT_TRUE(carries_remote_frames(url)) << url;
}

}  // namespace
}  // namespace servoctl::session
