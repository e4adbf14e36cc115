// Lines as in the help of CANopenNode's 309/CO_gateway_ascii.c and in test/co-gw_txt.c of lely-core.
#include "gateway/request.hpp"

#include <gtest/gtest.h>

#include "gateway/line_reader.hpp"
#include "gateway/words.hpp"

namespace servoctl::gateway {
namespace {

using Words = std::vector<std::string>;

Request request_of(std::string_view line) { return take_apart(split_words(line).value()); }

TEST(GatewayWords, AreSeparatedByBlanksAndEndAtAComment) {
  EXPECT_EQ(split_words("[1]\t4  r 0x1017 0 # comment"), (Words{"[1]", "4", "r", "0x1017", "0"}));
  EXPECT_EQ(split_words("# comment"), Words{});
  EXPECT_EQ(split_words(""), Words{});
  EXPECT_EQ(split_words(" \r"), Words{});
}

TEST(GatewayWords, HoldBlanksInQuotesAndAQuoteByTwo) {
  EXPECT_EQ(split_words(R"(w 0x1008 0 vs "a ""b"" # c" # d)"),
            (Words{"w", "0x1008", "0", "vs", R"(a "b" # c)"}));
  EXPECT_EQ(split_words(R"("")"), (Words{""}));
  EXPECT_EQ(split_words(R"("a)"), std::nullopt);
  EXPECT_EQ(split_words(R"("a"b)"), std::nullopt);
  EXPECT_EQ(split_words(R"(a"b")"), std::nullopt);
  EXPECT_EQ(split_words(in_quotes(R"(a "b" # c)")), (Words{R"(a "b" # c)"}));
  EXPECT_EQ(in_quotes(std::string_view("a\0\r\nb", 5)), "\"ab\"") << "a line ends only where it is to end";
}

TEST(GatewayRequest, HasNumberNetworkNodeAndCommand) {
  const auto line = request_of("[4294967295] 1 4 Read 0x1017 0 u16");
  EXPECT_EQ(line.sequence, 4294967295U);
  EXPECT_EQ(line.numbers, (std::vector<std::uint64_t>{1, 4}));
  EXPECT_EQ(service_of(line), Service::read);
  EXPECT_EQ(object_of(line).value(), (ObjectAddress{0x1017, 0}));
}

TEST(GatewayRequest, ANumberThatIsNoneIsACommand) {
  EXPECT_EQ(request_of("[4294967296] start").sequence, std::nullopt);
  EXPECT_EQ(request_of("[] start").sequence, std::nullopt);
  EXPECT_EQ(request_of("[-1] start").sequence, std::nullopt);
  EXPECT_EQ(request_of("1 2 3 start").words.front(), "3");
  EXPECT_EQ(service_of(request_of("[1] 64h start")), Service::other);
}

TEST(GatewayRequest, KnowsTheCommandsOfTheStandardInAnyCase) {
  EXPECT_EQ(service_of(request_of("[1] 1 STOP")), Service::stop);
  EXPECT_EQ(service_of(request_of("[1] 1 preoperational")), Service::preop);
  EXPECT_EQ(service_of(request_of("[1] 1 reset node")), Service::reset_node);
  EXPECT_EQ(service_of(request_of("[1] 1 reset Communication")), Service::reset_communication);
  EXPECT_EQ(service_of(request_of("[1] 1 reset")), Service::other);
  EXPECT_EQ(service_of(request_of("[1] lss_store")), Service::other);
}

TEST(GatewayRequest, AnIndexOutOfRangeIsRefused) {
  EXPECT_EQ(object_of(request_of("r 65536 0")).error().message.text(), "'65536' is not an index");
  EXPECT_EQ(object_of(request_of("r 0x1000 256")).error().message.text(), "'256' is not a sub-index");
  EXPECT_EQ(object_of(request_of("r 0x1000")).error().message.text(), "'' is not a sub-index");
  EXPECT_EQ(object_of(request_of("r -1 0")).error().message.text(), "'-1' is not an index");
}

TEST(GatewayLines, EndWithAnyEndAndAreTheSameHoweverTheyAreCut) {
  LineReader reader;
  Words lines;
  for (const char byte : std::string_view("[1] start\r\n[2] stop\n\r\n[3] half")) {
    reader.put({&byte, 1});
    while (const auto line = reader.take()) lines.push_back(line->text);
  }
  EXPECT_EQ(lines, (Words{"[1] start", "[2] stop", ""}));
  EXPECT_EQ(reader.pending(), 8U);
}

TEST(GatewayLines, OneThatIsTooLongTakesNoRoomAndTheNextIsWhole) {
  LineReader reader(16);
  reader.put("[7] r ");
  for (int i = 0; i < 1'000; ++i) {
    reader.put(std::string(100, 'x'));
    ASSERT_LE(reader.pending(), 16U);
    ASSERT_FALSE(reader.take());
  }
  reader.put("\n[8] start\n");
  const auto cut = reader.take().value();
  EXPECT_TRUE(cut.too_long);
  EXPECT_EQ(cut.text, "[7] r xxxxxxxxxx");
  const auto whole = reader.take().value();
  EXPECT_FALSE(whole.too_long);
  EXPECT_EQ(whole.text, "[8] start");
}

TEST(GatewayLines, OneWithoutAnEndTakesNoRoomWhenItCameTogetherWithAWholeOne) {
  LineReader reader(4);
  reader.put("1234\n12345678");
  EXPECT_EQ(reader.take().value().text, "1234");
  EXPECT_EQ(reader.pending(), 4U);
  reader.put("\n");
  EXPECT_TRUE(reader.take().value().too_long);
}

TEST(GatewayLines, OneThatComesWholeAndIsTooLongIsToldAsWell) {
  LineReader reader(4);
  reader.put("12345\n1234\n");
  EXPECT_TRUE(reader.take().value().too_long);
  EXPECT_FALSE(reader.take().value().too_long);
}

}  // namespace
}  // namespace servoctl::gateway
