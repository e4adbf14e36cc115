#include "gateway/answer.hpp"

#include <gtest/gtest.h>

#include "gateway/address.hpp"

namespace servoctl::gateway {
namespace {

using AnswerKind = Answer::Kind;

TEST(GatewayAnswer, IsWrittenAsCanOpenNodeDoes) {
  EXPECT_EQ(ok_line(7), "[7] OK\r\n");
  EXPECT_EQ(value_line(7, "1000"), "[7] 1000\r\n");
  EXPECT_EQ(error_line(7, Code::syntax), "[7] ERROR:101 #Syntax error.\r\n");
  EXPECT_EQ(error_line(7, Code::syntax, "a\r\n[8] OK"), "[7] ERROR:101 #Syntax error: a\\r\\n[8] OK.\r\n")
      << "nothing in it ends the line";
  auto refused = make_error(Errc::sdo_abort, "no");
  refused.abort_code = 0x0602'0000;
  EXPECT_TRUE(failure_line(7, refused).starts_with("[7] ERROR:0x06020000 #")) << failure_line(7, refused);
  EXPECT_TRUE(failure_line(7, make_error(Errc::timeout, "no")).starts_with("[7] ERROR:0x05040000 #"));
  EXPECT_TRUE(failure_line(7, make_error(Errc::protocol, "odd")).starts_with("[7] ERROR:0x05040001 #odd"));
  EXPECT_TRUE(failure_line(7, make_error(Errc::refused, "odd")).starts_with("[7] ERROR:102 #"));
}

void expect_answer(std::string_view line, AnswerKind kind, std::uint32_t sequence, std::uint32_t number,
                   std::string_view text) {
  const auto answer = parse_answer(line).value();
  EXPECT_EQ(answer.kind, kind) << line;
  EXPECT_EQ(answer.sequence, sequence) << line;
  EXPECT_EQ(answer.number, number) << line;
  EXPECT_EQ(answer.text, text) << line;
}

TEST(GatewayAnswer, OfOtherStacksIsUnderstood) {
  expect_answer("[1] OK", AnswerKind::ok, 1, 0, "OK");
  expect_answer("[1] 1000", AnswerKind::value, 1, 0, "1000");
  expect_answer("[1] E8 03 ", AnswerKind::value, 1, 0, "E8 03");
  expect_answer("[1] ", AnswerKind::value, 1, 0, "");
  expect_answer("[1] \"OK\"", AnswerKind::value, 1, 0, "\"OK\"");
  // CANopenNode, 309/CO_gateway_ascii.c.
  expect_answer("[1] ERROR:101 #Syntax error.\r", AnswerKind::error, 1, 101, "#Syntax error.");
  expect_answer("[4294967295] ERROR:0x06020000 #Object does not exist.", AnswerKind::abort, 4294967295U,
                0x0602'0000, "#Object does not exist.");
  // lely-core, src/co/gw_txt.c.
  expect_answer("[1] ERROR: 107 (Unsupported node)", AnswerKind::error, 1, 107, "(Unsupported node)");
  expect_answer("[1] ERROR: 06020000 (Object does not exist)", AnswerKind::abort, 1, 0x0602'0000,
                "(Object does not exist)");
  expect_answer("1 4 BOOT_UP", AnswerKind::event, 0, 0, "1 4 BOOT_UP");
  expect_answer("1 4 EMCY 8130 11 0 0 0 0 0", AnswerKind::event, 0, 0, "1 4 EMCY 8130 11 0 0 0 0 0");
}

TEST(GatewayAnswer, OfNobodyIsAnEventOrAnError) {
  EXPECT_FALSE(parse_answer(" \r"));
  expect_answer("[x] OK", AnswerKind::event, 0, 0, "[x] OK");
  expect_answer("[4294967296] OK", AnswerKind::event, 0, 0, "[4294967296] OK");
  expect_answer("[1 OK", AnswerKind::event, 0, 0, "[1 OK");
  expect_answer("[1] ERROR:zzzz", AnswerKind::error, 1, 0, "zzzz");
  expect_answer("[1] ERROR:", AnswerKind::error, 1, 0, "");
}

TEST(GatewayAddress, IsLocalOnlyWhereNobodyElseReachesIt) {
  for (const auto* local : {"127.0.0.1:60000", "127.0.0.2", "[::1]:60000", "localhost:1", "/run/gateway"})
    EXPECT_TRUE(parse_place(local).value().is_local()) << local;
  for (const auto* open :
       {"0.0.0.0:60000", "[::]:60000", "192.168.1.5", "127.example.com", "[::ffff:10.0.0.1]"})
    EXPECT_FALSE(parse_place(open).value().is_local()) << open;
}

TEST(GatewayAddress, IsReadAndWritten) {
  EXPECT_EQ(parse_place("host").value().text(), "host:60000");
  EXPECT_EQ(parse_place("[::1]:5").value().text(), "[::1]:5");
  EXPECT_EQ(parse_url("//host:5/2").value().text(), "host:5");
  EXPECT_EQ(parse_url("//host:5/2").value().network, 2);
  EXPECT_EQ(parse_url("/run/x").value().text(), "/run/x");
  for (const auto* wrong : {"", "//", "//:5", "//h:0", "//h:65536", "//h:x", "//h/0", "//h/x", "x", "/"})
    EXPECT_EQ(parse_url(wrong).error().code, Errc::usage) << wrong;
  EXPECT_EQ(parse_place(":5").error().code, Errc::usage);
  EXPECT_EQ(parse_place("/" + std::string(108, 'x')).error().code, Errc::usage) << "sun_path has 108 bytes";
}

}  // namespace
}  // namespace servoctl::gateway
