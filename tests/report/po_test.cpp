#include "report/po.hpp"

#include <gtest/gtest.h>

namespace servoctl::report {
namespace {

std::string refusal_of(std::string_view text) {
  const auto read = parse_po(text, "x.po");
  return read ? "read" : read.error().message.text();
}

TEST(Po, ReadsMessagesRemarksAndContinuationLines) {
  const auto read = parse_po(
      "msgid \"\"\nmsgstr \"Content-Type: text/plain\\n\"\n\n#. made of: pieces\n#: commands/a.cpp\n"
      "msgid \"one\\n\"\n\"two \\\"3\\\" \\\\\"\nmsgstr \"一\\t\"\n\nmsgid \"b\"\nmsgstr \"\"\n",
      "x.po");
  ASSERT_TRUE(read) << read.error().message.text();
  ASSERT_EQ(read->size(), 2U);
  EXPECT_EQ((*read)[0].id, "one\ntwo \"3\" \\");
  EXPECT_EQ((*read)[0].text, "一\t");
  EXPECT_EQ((*read)[0].remarks, std::vector<std::string>{"made of: pieces"});
  EXPECT_EQ((*read)[0].line, 6U);
  EXPECT_EQ((*read)[1].text, "");
}

TEST(Po, SaysInWhichLineItIsWrong) {
  EXPECT_EQ(refusal_of("msgid \"a\"\n\nmsgid \"b\"\n"), "x.po:3: msgid without msgstr");
  EXPECT_EQ(refusal_of("\nmsgstr \"b\"\n"), "x.po:2: msgstr without msgid");
  EXPECT_EQ(refusal_of("msgid \"a\nmsgstr \"\""), "x.po:1: a string ends with \"");
  EXPECT_EQ(refusal_of("msgid \"a\\q\"\nmsgstr \"\""), "x.po:1: unknown escape");
  EXPECT_EQ(refusal_of("hello"), "x.po:1: neither msgid, msgstr, a comment nor a string");
  EXPECT_EQ(refusal_of("msgid \"a\"\nmsgstr \"\"\nmsgid \"a\"\nmsgstr \"\"\n"),
            "x.po:5: the msgid of line 3 appears twice");
}

}  // namespace
}  // namespace servoctl::report
