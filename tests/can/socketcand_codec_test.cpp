// Elements are those of doc/protocol.md of linux-can/socketcand, and what its src/state_raw.c prints.
#include "can/socketcand_codec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "can/controller_report.hpp"

namespace servoctl::can {
namespace {

using ElementKind = SocketcandElement::Kind;
using Elements = std::vector<std::string>;

Elements elements_of(std::string_view bytes, std::size_t piece = 0) {
  SocketcandReader reader;
  if (piece == 0) piece = bytes.size() + 1;
  for (; !bytes.empty(); bytes.remove_prefix(std::min(piece, bytes.size())))
    reader.put(bytes.substr(0, piece));
  Elements out;
  while (const auto element = reader.take()) {
    switch (element->kind) {
      case ElementKind::hi: out.emplace_back("hi"); break;
      case ElementKind::ok: out.emplace_back("ok"); break;
      case ElementKind::echo: out.emplace_back("echo"); break;
      case ElementKind::frame:
        out.push_back(std::to_string(element->time.count()) + " " + to_string(element->frame));
        break;
      case ElementKind::refusal: out.push_back("refusal " + element->text); break;
      case ElementKind::other: out.emplace_back("other"); break;
      case ElementKind::damaged: out.emplace_back("damaged"); break;
    }
  }
  return out;
}

TEST(SocketcandCodec, ReadsWhatAServerSays) {
  EXPECT_EQ(elements_of("< hi >< ok >< echo >"), (Elements{"hi", "ok", "echo"}));
  EXPECT_EQ(elements_of("< frame 123 23.424242 1A220344 >"), (Elements{"23424242 123#1A220344"}));
  EXPECT_EQ(elements_of("< frame 1AAAAAAA 1700000000.000001 01F1 >"),
            (Elements{"1700000000000001 1AAAAAAA#01F1"}));
  EXPECT_EQ(elements_of("< frame 00000123 1.000000 00 >"), (Elements{"1000000 00000123#00"}));
  EXPECT_EQ(elements_of("< frame 080 1.000000  >"), (Elements{"1000000 080#"})) << "SYNC has no data";
  EXPECT_EQ(elements_of("< error could not open bus >"), (Elements{"refusal could not open bus"}));
  EXPECT_EQ(elements_of("< stat 1 2 3 4 >"), (Elements{"other"}));
}

TEST(SocketcandCodec, ReadsErrorFrames) {
  SocketcandReader reader;
  reader.put("< error 040 1700000000.000001 >");
  const auto element = reader.take();
  ASSERT_TRUE(element);
  ASSERT_EQ(element->kind, ElementKind::frame);
  EXPECT_EQ(parse_report(element->frame), ControllerReport::bus_off);
}

TEST(SocketcandCodec, WritesFrames) {
  EXPECT_EQ(socketcand_send(parse_frame("123#").value()), "< send 123 0 >");
  EXPECT_EQ(socketcand_send(parse_frame("1AAAAAAA#01F1").value()), "< send 1AAAAAAA 2 1 f1 >");
  EXPECT_EQ(socketcand_send(parse_frame("001#00").value()), "< send 001 1 0 >");
  EXPECT_EQ(socketcand_send(parse_frame("00000001#00").value()), "< send 00000001 1 0 >")
      << "8 digits are 29 bits";
}

TEST(SocketcandCodec, ElementsAreTheSameHoweverTheyAreCut) {
  const std::string all = "< hi > < frame 123 23.424242 1A220344 >\n< error a b c >< echo >x< ok >";
  for (std::size_t piece = 1; piece < all.size(); ++piece)
    EXPECT_EQ(elements_of(all, piece), elements_of(all)) << piece;
}

TEST(SocketcandCodec, WhatIsNoFrameIsDamaged) {
  for (const char* text : {"< frame 123 23.424242 1A2 >", "< frame 123 23.424242 112233445566778899 >",
                           "< frame 800 1.000000 00 >", "< frame 12 1.000000 00 >", "< frame 123 1 00 >",
                           "< frame 123 >", "< frame 20000000 1.000000 00 >", "< frame 123 1.0 00 >",
                           "< frame 123 1.000000 0G >", "< frame 123 1.000000 00 11 >"})
    EXPECT_EQ(elements_of(text), (Elements{"damaged"})) << text;
  EXPECT_EQ(elements_of("HTTP/1.1 400 Bad Request\r\n< hi >"), (Elements{"damaged", "hi"}));
  EXPECT_EQ(elements_of("< frame 123 < ok >"), (Elements{"damaged", "ok"}));
  EXPECT_EQ(elements_of("<" + std::string(100'000, 'a') + ">< ok >"), (Elements{"damaged", "ok"}));
}

TEST(SocketcandPlaceText, IsServerPortAndInterface) {
  const auto place = [](const char* text) { return parse_socketcand_place(text).value(); };
  EXPECT_EQ(place("//host:29536/can0"), (SocketcandPlace{"host", 29536, "can0"}));
  EXPECT_EQ(place("//10.0.0.7/vcan1"), (SocketcandPlace{"10.0.0.7", 29536, "vcan1"}));
  EXPECT_EQ(place("//[fe80::1%eth0]:1/can0"), (SocketcandPlace{"fe80::1%eth0", 1, "can0"}));
  EXPECT_EQ(place("//[::1]/can0"), (SocketcandPlace{"::1", 29536, "can0"}));
  EXPECT_EQ(place("//[::1]/can0").server(), "[::1]:29536");
  for (const char* text :
       {"", "host/can0", "//", "//host", "//host/", "///can0", "//:29536/can0", "//host:0/can0",
        "//host:65536/can0", "//host:/can0", "//host:x/can0", "//host/can0/x", "//host/can 0",
        "//host/can0>< rawmode", "//host/a-name-too-long-for-linux", "//[::1/can0", "//user@host/can0"}) {
    const auto wrong = parse_socketcand_place(text);
    ASSERT_FALSE(wrong) << text;
    EXPECT_EQ(wrong.error().code, Errc::usage);
  }
}

}  // namespace
}  // namespace servoctl::can
