#include <gtest/gtest.h>

#include <algorithm>

#include "base/file.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "command/help_text.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"
#include "command/shell_completion.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::commands {
using namespace command;
namespace {

const std::string kFolder = source_dir() + "/completions/";

TEST(Registry, FindsEveryCommandByThePathItSays) {
  const auto commands = registry();
  for (std::size_t i = 0; i < commands.size(); ++i) {
    EXPECT_EQ(registered_path(i), commands[i]->path);
    EXPECT_EQ(find_command(commands[i]->path), commands[i]);
  }
  EXPECT_EQ(find_command("param"), nullptr);
}

TEST(CompletionScripts, InTheTreeAreFresh) {
  const std::pair<const char*, const char*> files[] = {
      {"bash", "servoctl.bash"}, {"zsh", "_servoctl"}, {"fish", "servoctl.fish"}};
  for (const auto& entry : files)
    EXPECT_EQ(read_file(kFolder + entry.second).value(), completion_script(entry.first))
        << entry.second << ": run ./dev completions";
}

TEST(CompletionScripts, AskTheProgramAndKnowNoWordThemselves) {
  for (const std::string shell : {"bash", "zsh", "fish"}) {
    const auto script = completion_script(shell);
    EXPECT_NE(script.find(" __complete " + shell + " "), std::string::npos) << shell;
    EXPECT_EQ(script.find("--bus"), std::string::npos) << shell;
    EXPECT_EQ(script.back(), '\n') << shell;
  }
}

TEST(CompletionWords, OfFilesAreOfferedOnlyWhereTheyStandForThemselves) {
  for (const auto* word :
       {"Pn0214", "P0.03", "PA-21", "Fn_33", "homing_speeds.switch", "0x6041:0", "sim:", "位置"})
    EXPECT_TRUE(can_be_offered(word)) << word;
  for (const auto* word : {"", "-rf", "$(reboot)", "`id`", "a b", "a;b", "a\nb", "a\x1B[2J", "a'b", "a\"b",
                           "a\u202Eb", "~", "a\x9B"})
    EXPECT_FALSE(can_be_offered(word)) << word;
}

TEST(Help, OfEveryCommandNamesItsParametersAndFitsEightyColumns) {
  for (const auto* command : registry()) {
    const auto text = help_text(command->path, 80);
    ASSERT_TRUE(text) << command->path;
    for (const auto& p : command->parameters)
      EXPECT_NE(lower(*text).find(p.name), std::string::npos) << command->path << " " << p.name;
    for (const auto line : split(*text, '\n')) EXPECT_LE(display_width(line), 80U) << line;
    EXPECT_FALSE(command->summary.empty()) << command->path;
    EXPECT_NE(command->summary.back(), '.') << command->path;
    EXPECT_EQ(command->run == nullptr, command->of_front_end) << command->path;
  }
  const auto program = help_text("", 80);
  for (const auto* command : registry())
    EXPECT_NE(program->find(command->path), std::string::npos) << command->path;
}

TEST(Help, OfEveryCommandShowsItsExamplesBetweenItsOptionsAndThoseOfAll) {
  for (const auto* command : registry()) {
    EXPECT_GE(command->examples.size(), 1U) << command->path;
    EXPECT_LE(command->examples.size(), 3U) << command->path;
    const auto text = help_text(command->path, 80).value();
    const auto begin = text.find("\nExamples:\n");
    const auto end = text.find("\nOptions of every command:\n");
    const auto own = text.find("\nOptions:\n");
    ASSERT_LT(begin, end) << command->path;
    EXPECT_TRUE(own == std::string::npos || own < begin) << command->path;
    for (const auto& example : command->examples) {
      EXPECT_LT(text.find("\n  " + std::string(example.line) + "\n      "), end) << example.line;
      EXPECT_TRUE((std::string(example.line) + " ").starts_with(std::string(command->path) + " "))
          << example.line;
      EXPECT_NE(std::string_view(example.what).back(), '.') << example.line;
    }
  }
}

TEST(Help, OfAWordOfThePromptTellsWhatItDoes) {
  for (const auto& word : prompt_words()) {
    const auto text = help_text(word.name, 80);
    ASSERT_TRUE(text) << word.name;
    EXPECT_TRUE(text->starts_with("At the prompt: " + prompt_usage(word) + "\n")) << *text;
    for (const auto line : split(*text, '\n')) EXPECT_LE(display_width(line), 80U) << line;
    for (const auto& example : word.examples)
      EXPECT_NE(text->find("\n  " + std::string(example.line) + "\n"), std::string::npos) << example.line;
    EXPECT_NE(help_text("", 80)->find("\n  " + prompt_usage(word) + " "), std::string::npos) << word.name;
  }
  EXPECT_EQ(help_text("quit", 80).value(), help_text("exit", 80).value());
  EXPECT_NE(help_text("und", 80).error().hint.text().find("undo"), std::string::npos);
}

TEST(Help, OfBusTellsOfTheWordAndOfTheCommands) {
  const auto text = help_text("bus", 80).value();
  EXPECT_TRUE(text.starts_with("At the prompt: bus BUS\n")) << text;
  for (const auto* name : {"bus status", "bus up", "bus down", "bus detect"})
    EXPECT_NE(text.find("\n  " + std::string(name) + " "), std::string::npos) << text;
}

TEST(Help, OfAGroupListsItsCommands) {
  const auto text = help_text("param", 80);
  ASSERT_TRUE(text);
  for (const auto* name : {"param list", "param get", "param set", "param search", "param explain"})
    EXPECT_NE(text->find(name), std::string::npos);
  EXPECT_FALSE(help_text("parm", 80));
}

TEST(Registry, HasEveryPathOnceAndGroupsTogether) {
  std::vector<std::string_view> paths;
  for (const auto* command : registry()) {
    EXPECT_EQ(find_command(command->path), command);
    EXPECT_EQ(std::count(paths.begin(), paths.end(), command->path), 0) << command->path;
    paths.push_back(command->path);
  }
}

}  // namespace
}  // namespace servoctl::commands
