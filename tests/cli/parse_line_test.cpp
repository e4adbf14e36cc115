#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <string>
#include <thread>

#include "base/text.hpp"
#include "cli/parse.hpp"
#include "command/registry.hpp"

namespace servoctl::cli {
namespace {

using Words = std::vector<std::string>;

TEST(ParseLine, TakesGlobalOptionsOnBothSidesOfTheCommand) {
  for (const auto& words : {Words{"-n", "3", "--bus", "can0", "param", "get", "Pn0202"},
                            Words{"param", "get", "Pn0202", "--bus=can0", "-n3"},
                            Words{"--bus", "can0", "param", "get", "-n", "3", "Pn0202"}}) {
    const auto line = parse_line(words);
    ASSERT_TRUE(line) << line.error().message.text();
    EXPECT_EQ(line->command->path, "param get");
    EXPECT_EQ(line->arguments.text("--bus"), "can0");
    EXPECT_EQ(line->arguments.text("--node"), "3");
    EXPECT_EQ(line->arguments.text("id"), "Pn0202");
  }
}

TEST(ParseLine, SaysWhichCommandMayBeMeant) {
  const std::pair<Words, std::string> lines[] = {
      {{"parm", "get"}, "'parm' is not a command: did you mean param get"},
      {{"parm", "-n", "1"}, "'parm' is not a command: did you mean param"},
      {{"fault", "rest"}, "'fault rest' is not a command: did you mean fault reset"},
      {{"param", "gte"}, "'param gte' is not a command: did you mean param get"},
      {{"param", "-d", "gsd600"}, "'param' is not a command: use `param list`, `param get`, "},
      {{"param", "frobnicated"}, "'param frobnicated' is not a command: use `param list`, "},
      {{"wait", "300ms"}, "'wait' is a word of batch files, and no command: `run FILE` runs one"}};
  for (const auto& [words, said] : lines) {
    const auto line = parse_line(words);
    ASSERT_FALSE(line);
    EXPECT_EQ((line.error().message.text() + ": " + line.error().hint.text()).substr(0, said.size()), said);
  }
}

TEST(ParseLine, SaysWhatAWordOfOtherToolsMeansBeforeWhatItIsSpelledLike) {
  const std::pair<Words, std::string> lines[] = {
      {{"reset"}, "'reset' is not a command: `fault reset` resets a fault, `nmt reset` restarts"},
      {{"start"}, "'start' is not a command: `nmt start` makes a node operational, `enable` energises"},
      {{"off"}, "'off' is not a command: `disable` de-energises a drive"},
      {{"list"}, "'list' is not a command: `scan` lists the drives"},
      {{"get", "Pn0202"}, "'get' is not a command: `read` reads an object, `param get`"},
      {{"set", "Pn0202=5"}, "'set' is not a command: `write` writes an object, `param set`"},
      {{"connect", "can0"},
       "'connect' is not a command: there is no connection to make: name the bus with -b"},
      {{"slaves"}, "'slaves' is not a command: `scan` finds"},
      {{"upload", "0x6041"}, "'upload' is not a command: `read` reads one object (SDO upload)"},
      {{"download"}, "'download' is not a command: `write` writes one object (SDO download)"},
      {{"dump"}, "'dump' is not a command: `backup` saves all values"},
      {{"ERRORS"}, "'ERRORS' is not a command: `fault show` shows the faults"},
      {{"sdo", "read", "0x6041"}, "'sdo' is not a command: `read` reads an object (SDO upload)"}};
  for (const auto& [words, said] : lines) {
    const auto line = parse_line(words);
    ASSERT_FALSE(line);
    EXPECT_EQ((line.error().message.text() + ": " + line.error().hint.text()).substr(0, said.size()), said);
  }
}

TEST(ParseLine, LeavesValuesAsTheyAreWritten) {
  const auto line = parse_line({"write", "6040h", "-010"});
  ASSERT_TRUE(line) << line.error().message.text();
  EXPECT_EQ(line->arguments.text("object"), "6040h");
  EXPECT_EQ(line->arguments.text("value"), "-010");
}

TEST(ParseLine, TakesEveryWordBehindTwoDashesAsAValue) {
  for (const auto* text :
       {"", "-", "--", "-h", "--help", "--from=/etc/passwd", "--yes", "-n", "{}", "[a,b]", "%%", "a b"}) {
    const auto line = parse_line({"write", "0x2000", "--type", "string", "--", text});
    ASSERT_TRUE(line) << text << ": " << line.error().message.text();
    EXPECT_EQ(line->arguments.text("object"), "0x2000");
    EXPECT_EQ(line->arguments.text("--type"), "string");
    ASSERT_TRUE(line->arguments.has("value")) << text;
    EXPECT_EQ(line->arguments.text("value"), text);
    EXPECT_FALSE(line->arguments.has("--yes"));
    EXPECT_FALSE(line->arguments.has("--from"));
  }
  const auto many = parse_line({"read", "a", "--", "[b,c]", "--", "--yes"});
  ASSERT_TRUE(many) << many.error().message.text();
  const auto all = many->arguments.all("object");
  EXPECT_EQ(Words(all.begin(), all.end()), (Words{"a", "[b,c]", "--", "--yes"}));
  EXPECT_EQ(parse_line({"write", "a", "b", "--", "c"}).error().message.text(),
            "write: unexpected argument 'c'");
  EXPECT_EQ(parse_line({"write", "a", "{}"})->arguments.text("value"), "{}");
}

TEST(ParseLine, RefusesAnOptionWithoutItsValueAndASwitchWithOne) {
  const std::pair<Words, std::string> lines[] = {
      {{"backup", "a.json", "--format"}, "backup: --format needs a value"},
      {{"read", "0x6041", "--to", "--json"}, "read: --to needs a value"},
      {{"read", "0x6041", "-n", "-b", "can0"}, "read: --node needs a value"},
      {{"report", "a.html", "--tests", "--title", "Press"}, "report: --tests needs a value"},
      {{"jog", "30rpm", "--yes=no"}, "jog: --yes takes no value"},
      {{"restore", "a.json", "--dry-run=false"}, "restore: --dry-run takes no value"},
      {{"scan", "-y=0"}, "scan: --yes takes no value"}};
  for (const auto& [words, said] : lines) {
    const auto line = parse_line(words);
    ASSERT_FALSE(line) << said;
    EXPECT_EQ(line.error().message.text(), said);
  }
  EXPECT_EQ(parse_line({"backup", "a.json", "--format"}).error().hint.text().substr(0, 10), "--format: ");
  const auto line = parse_line({"read", "0x6041", "--to=--json", "--timeout", "-5"});
  ASSERT_TRUE(line) << line.error().message.text();
  EXPECT_EQ(line->arguments.text("--to"), "--json");
  EXPECT_EQ(line->arguments.text("--timeout"), "-5");
}

TEST(ParseLine, KnowsTheOptionsThatStandWithoutACommand) {
  for (const auto& words : {Words{"-b", "can0", "--readonly"}, Words{"--dry-rum"}, Words{"-b", "can0", "-X"},
                            Words{"--keep", "-b", "can0"}, Words{"-n3", "--nonsense"}})
    EXPECT_FALSE(check_options_alone(words)) << words.back();
  EXPECT_EQ(check_options_alone({"-b", "can0", "--dryrun"}).error().message.text(),
            "there is no option '--dryrun'");
  EXPECT_EQ(check_options_alone({"--dryrun"}).error().hint.text(), "did you mean --dry-run?");
  for (const auto& words :
       {Words{}, Words{"-b", "can0", "-n3", "--read-only"}, Words{"--bus=can0", "-y"}, Words{"-d", "-x"}})
    EXPECT_TRUE(check_options_alone(words));
  // `help` behind them asks about none of them.
  EXPECT_FALSE(parse_line({"-b", "can0", "--readonly", "help"}));
  EXPECT_TRUE(parse_line({"help", "--for"}));
}

TEST(ParseLine, RefusesAnOptionWithTwoValues) {
  for (const Words& words : {Words{"status", "-n", "1", "--node", "2"},
                             {"status", "-b", "can0", "--bus=can1"},
                             {"read", "0x1000", "--timeout", "1s", "--timeout", "2s"}}) {
    const auto line = parse_line(words);
    ASSERT_FALSE(line) << words[1];
    EXPECT_EQ(line.error().code, Errc::usage);
    EXPECT_NE(line.error().message.text().find("is given twice: "), std::string::npos)
        << line.error().message.text();
  }
  EXPECT_TRUE(parse_line({"status", "-n", "1", "--node", "1"}));
}

TEST(ParseLine, TakesOptionsBehindTwoDashesWhenEveryArgumentHasItsValue) {
  const auto line = parse_line({"jog", "--", "-30rpm", "--for", "2s", "-n", "1"});
  ASSERT_TRUE(line) << line.error().message.text();
  EXPECT_EQ(line->arguments.text("speed"), "-30rpm");
  EXPECT_EQ(line->arguments.text("--for"), "2s");
  EXPECT_EQ(line->arguments.text("--node"), "1");
  const auto write = parse_line({"write", "0x2000", "-n", "1", "--", "--yes", "--keep"});
  ASSERT_TRUE(write) << write.error().message.text();
  EXPECT_EQ(write->arguments.text("value"), "--yes");
  EXPECT_TRUE(write->arguments.has("--keep"));
  EXPECT_FALSE(write->arguments.has("--yes"));
  EXPECT_EQ(parse_line({"jog", "--", "-30rpm", "--bogus"}).error().message.text(),
            "jog: there is no option '--bogus'");
}

TEST(ParseLine, GivesManyWordsToTheParameterThatTakesThem) {
  const auto line = parse_line({"read", "a", "b", "--type", "u8", "c"});
  ASSERT_TRUE(line) << line.error().message.text();
  const auto all = line->arguments.all("object");
  EXPECT_EQ(Words(all.begin(), all.end()), (Words{"a", "b", "c"}));
  EXPECT_EQ(line->arguments.text("--type"), "u8");
}

TEST(ParseLine, LeaksNoValueIntoTheNextLine) {
  ASSERT_TRUE(parse_line({"read", "a", "--type", "u8"}));
  EXPECT_FALSE(parse_line({"read", "a"})->arguments.has("--type"));
}

/// What a line gives, in words.
std::string outcome_of(const Words& words) {
  const auto line = parse_line(words);
  if (!line) return line.error().message.text();
  std::string out(line->command->path);
  const auto add = [&](std::span<const command::Parameter> parameters) {
    for (const auto& parameter : parameters)
      for (const auto& value : line->arguments.all(parameter.name))
        out += "\n" + std::string(parameter.name) + " " + value;
  };
  add(line->command->parameters);
  add(command::global_options());
  return out;
}

/// Lines of a command: bare, with all it takes, and wrong in every way.
std::vector<Words> lines_of(const command::Command& command) {
  const auto path = split(command.path, ' ');
  Words bare(path.begin(), path.end());
  auto whole = bare;
  const auto add = [](Words& line, const command::Parameter& parameter) {
    if (parameter.name.starts_with("-")) line.emplace_back(parameter.name);
    if (parameter.kind != command::Kind::flag)
      line.emplace_back(parameter.choices.empty() ? "1" : parameter.choices.front());
  };
  for (const auto& parameter : command.parameters) {
    if (parameter.required) add(bare, parameter);
    add(whole, parameter);
  }
  for (const auto& parameter : command::global_options()) add(whole, parameter);
  std::vector<Words> out = {bare, whole, {path.begin(), path.end()}};
  for (const auto& more : std::vector<Words>{{"--bogus"},
                                             {"x", "y", "z"},
                                             {"--", "-1", "-2"},
                                             {"--json", "-n"},
                                             {"--json=no"},
                                             {"-n", "2", "-n", "3"}}) {
    out.push_back(bare);
    out.back().insert(out.back().end(), more.begin(), more.end());
  }
  return out;
}

/// CLI11 throws where two names of a command are the same to it.
TEST(ParseLine, KnowsEveryOptionOfEveryCommandAtOnce) {
  for (const auto* command : command::registry()) {
    Words words;
    for (const auto word : split(command->path, ' ')) words.emplace_back(word);
    const auto name_all = [&](std::span<const command::Parameter> parameters) {
      for (const auto& parameter : parameters) {
        if (!parameter.name.starts_with("-") || std::ranges::count(words, parameter.name) > 0) continue;
        words.emplace_back(parameter.name);
        if (parameter.kind != command::Kind::flag)
          words.emplace_back(parameter.kind == command::Kind::choice ? parameter.choices.front() : "1");
      }
    };
    name_all(command->parameters);
    name_all(command::global_options());
    const auto line = parse_line(words);
    EXPECT_TRUE(line || line.error().message.text().ends_with(" is missing")) << line.error().message.text();
  }
}

TEST(ParseLine, ReadsEveryLineAsIfItWereTheFirst) {
  std::size_t pairs = 0;
  for (const auto* command : command::registry()) {
    const auto lines = lines_of(*command);
    Words first(lines.size());
    for (std::size_t i = 0; i < lines.size(); ++i)  // A thread that has read none.
      std::thread([&] { first[i] = outcome_of(lines[i]); }).join();
    for (const auto& before : lines)
      for (std::size_t i = 0; i < lines.size(); ++i, ++pairs) {
        (void)parse_line(before);
        ASSERT_EQ(outcome_of(lines[i]), first[i]) << fmt::format("{}", fmt::join(before, " ")) << ", then "
                                                  << fmt::format("{}", fmt::join(lines[i], " "));
      }
  }
  EXPECT_GT(pairs, 5000U);
}

}  // namespace
}  // namespace servoctl::cli
