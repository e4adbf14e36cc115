// What a person or a drive wrote comes out of every message of the program as it went in, in both languages,
// with axis names, and with places at commands.
#include <gtest/gtest.h>

#include "cli/hint_place.hpp"
#include "report/catalogue.hpp"
#include "report/phrase.hpp"
#include "report/zh_po.hpp"
#include "show/axis_names.hpp"

namespace servoctl::cli {
namespace {

/// Texts that look like what the program itself says.
constexpr std::string_view kForeign[] = {
    "node 1: lost",      "a: no answer", "failed", "bus-off",  "-n 1",
    "`read 0x6041`",     "{} {0} {:x}",  "节点 1", "feeder",   "node 1.json",
    "no such file: (x)", "1, 2 and 3",   "ready",  "a\"b'c`d", "timeout"};

/// A number where the text asks for one; nothing where fmt would have to be given a width as well.
std::optional<Message::Argument> argument_for(std::string_view format, std::string_view foreign) {
  if (format.empty() || format == "s") return Verbatim{std::string(foreign)};
  if (format.find('{') != std::string_view::npos) return std::nullopt;
  if (format.find_first_of("<>^") != std::string_view::npos) return Verbatim{std::string(foreign)};
  if (format.find_first_of("fgeE.") != std::string_view::npos) return 1.5;
  return std::uint64_t{1};
}

/// A message of this text with the foreign one wherever it takes a text; nothing where it has no place for
/// one.
std::optional<Message> with_foreign(const std::string& literal, std::string_view foreign) {
  std::vector<Message::Argument> arguments;
  bool any = false;
  for (std::size_t at = literal.find('{'); at != std::string::npos; at = literal.find('{', at + 1)) {
    if (literal.compare(at, 2, "{{") == 0) {
      ++at;
      continue;
    }
    const auto end = literal.find('}', at);
    const auto inside = std::string_view(literal).substr(at + 1, end - at - 1);
    const auto colon = inside.find(':');
    // Numbered places, and braces of JSON or TOML.
    if (end == std::string::npos || (colon != 0 && !inside.empty())) return std::nullopt;
    auto argument = argument_for(colon == 0 ? inside.substr(1) : std::string_view(), foreign);
    if (!argument) return std::nullopt;
    any = any || std::holds_alternative<Verbatim>(*argument);
    arguments.push_back(std::move(*argument));
  }
  return any ? std::optional(Message(literal, std::move(arguments))) : std::nullopt;
}

TEST(MessageProperty, WhatOthersWroteComesOutOfEveryMessageAsItWentIn) {
  const auto entries = report::parse_po(report::zh_po(), "zh.po");
  ASSERT_TRUE(entries);
  const show::AxisNames names({{1, "feeder"}, {2, "lift"}});
  const auto line = parse_line(std::vector<std::string>{"status", "-n", "1", "-b", "sim:gsd600@1"});
  ASSERT_TRUE(line);
  std::size_t messages = 0;
  for (const auto& entry : *entries) {
    for (const auto foreign : kForeign) {
      const auto made = with_foreign(entry.id, foreign);
      if (!made) continue;
      ++messages;
      for (const bool chinese : {false, true}) {
        auto said = *made;
        names.put_into(said);
        if (chinese) report::put_into_chinese(said);
        Outcome outcome;
        outcome.notices = {said};
        const auto text = with_place(std::move(outcome), *line).notices.front().text();
        ASSERT_NE(text.find(foreign), std::string::npos)
            << "of '" << foreign << "' in '" << entry.id << "' came: " << text;
      }
    }
  }
  EXPECT_GT(messages, 30'000U);
}

}  // namespace
}  // namespace servoctl::cli
