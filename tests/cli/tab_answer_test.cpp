// What the completion scripts of the shells are told.
#include "cli/tab_answer.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/text.hpp"
#include "cli/terminal/begun_line.hpp"
#include "command/registry.hpp"
#include "recording_console.hpp"
#include "show/known_drive.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBreaks = " \t\n\"'@><=;|&(:";

class TabAnswers : public testing::Test {
 protected:
  TabAnswers() : shell(console, options()) {}
  ~TabAnswers() override { fs::remove_all(folder()); }
  static fs::path folder() { return fs::temp_directory_path() / ("tab-" + std::to_string(::getpid())); }
  static Shell::Options options() {
    fs::create_directories(folder());
    Shell::Options out;
    out.drive_folders = {fs::path(source_dir()) / "eds"};
    out.state_folder = folder();
    return out;
  }
  std::string bash(const std::string& line, const std::string& type = "9") {
    return answer_tab(std::vector<std::string>{"bash", type, "60", kBreaks, "servoctl " + line}, shell);
  }
  std::string fish(const std::string& begun, std::vector<std::string> words) {
    words.insert(words.begin(), {"fish", begun});
    return answer_tab(words, shell);
  }
  std::string zsh(const std::string& begun, std::vector<std::string> words) {
    words.insert(words.begin(), {"zsh", begun});
    return answer_tab(words, shell);
  }
  static std::string write(const std::string& name, std::string_view text) {
    std::ofstream(folder() / name) << text;
    return (folder() / name).string();
  }
  RecordingConsole console;
  Shell shell;
};

TEST_F(TabAnswers, TellBashTheEndOfAWordThatItBreaks) {
  EXPECT_EQ(bash("-d gsd600 param set Pn0214=40H"), "words\n40Hz");
  EXPECT_EQ(bash("scan -b sim:gsd600@1?st"), "open\n@1\\?state=");
  EXPECT_EQ(bash("scan -b 'sim:gsd600@1?st"), "open\nsim:gsd600@1?state=");
  EXPECT_EQ(bash("scan -b sim:gs"), "open\ngsd600@");
  EXPECT_EQ(bash("scan --bus=coe:si"), "open\nsim:");
}

TEST_F(TabAnswers, AreQuotedAsTheWordWasBegun) {
  EXPECT_EQ(bash("-d gsd600 param set Pn0000=Position\\ m"), "words\nPosition\\ mode");
  EXPECT_EQ(bash("-d gsd600 param set 'Pn0000=Position m"), "words\nPn0000=Position mode");
  EXPECT_EQ(bash("-d gsd600 param set Pn0000=\"Position m"), "words\nPosition mode");
  EXPECT_EQ(fish("'Pn0000=Position m", {"-d", "gsd600", "param", "set"}),
            "words\nPn0000=Position mode\t0 Position mode");
  EXPECT_EQ(bash_text("a $(b) 'c' \"d\" `e` \\", 0), "a\\ \\$\\(b\\)\\ \\'c\\'\\ \\\"d\\\"\\ \\`e\\`\\ \\\\");
  EXPECT_EQ(bash_text("$(b) 'c' \"d\" `e` \\", '"'), "\\$(b) 'c' \\\"d\\\" \\`e\\` \\\\");
  EXPECT_EQ(bash_text("$(b) 'c'", '\''), "$(b) '\\''c'\\''");
  EXPECT_EQ(bash_text("echo x!y", '"'), "echo x\"\\!\"y") << "history is looked up within double quotes";
  EXPECT_EQ(bash_text("echo x!y", 0), "echo\\ x\\!y");
  EXPECT_EQ(bash_text("echo x!y", '\''), "echo x!y");
}

TEST_F(TabAnswers, SayWhatAWordIsWhereBashOnlyLists) {
  EXPECT_EQ(bash("help param se"), "words\nset\nsearch");
  EXPECT_EQ(bash("help param se", "63"),
            "words\nset     Change panel parameters of a drive and read them…\n"
            "search  Find panel parameters by words, in English or Ch…");
  // `%` goes through the candidates and puts in each.
  EXPECT_EQ(bash("help param se", "37"), "words\nset\nsearch");
  EXPECT_NE(bash("help param se", "33").find("Find panel"), std::string::npos);
  // What all have in common is put in: it ends where it ended without what they are.
  const auto with_hints = bash("-d gsd600 param set 'Pn0000=Position", "33");
  EXPECT_EQ(with_hints.find("words\nPn0000=Position mode  "), 0U) << with_hints;
  EXPECT_NE(with_hints.find("\nPn0000=Position/speed mode  "), std::string::npos) << with_hints;
}

TEST_F(TabAnswers, AreWordAndMeaningForZshAndFish) {
  EXPECT_EQ(fish("sta", {"-d", "gsd600", "read"}).substr(0, 12), "words\nstatus");
  EXPECT_NE(fish("statusw", {"-d", "gsd600", "read"}).find("statusword\t0x6041"), std::string::npos);
  EXPECT_EQ(zsh("coe:s", {"-b"}),
            "open\n=values values\nvalues+coe\\:sim\\::simulated EtherCAT drives: coe:sim:sv2@1");
  EXPECT_EQ(zsh("35", {"-d", "gsd600", "home"}),
            "words\n=values values\nvalues-35:Present position is home, no motion (enabled only)");
}

TEST_F(TabAnswers, TellTheCommandsBehindHelpAndWhatAGroupHas) {
  EXPECT_EQ(fish("ex", {"help", "param"}), "words\nexplain\tShow all that is known about a panel parameter");
  EXPECT_EQ(fish("lss", {}), "words\nlss\tscan, inquire, select, set-node, set-bitrate, store");
  EXPECT_EQ(fish("un", {}).find("undo"), std::string::npos) << "a word of the prompt alone";
}

TEST_F(TabAnswers, KnowEveryCommandOptionAndChoice) {
  for (const auto* command : command::registry()) {
    std::vector<std::string> words;
    for (const auto word : split(command->path, ' ')) {
      EXPECT_NE((fish("", words) + "\t").find("\n" + std::string(word) + "\t"), std::string::npos)
          << command->path;
      words.emplace_back(word);
    }
    const auto options = fish("-", words);
    const auto all = fish("", words);
    for (const auto& parameter : command->parameters) {
      const std::string name(parameter.name);
      const bool option = name.starts_with("-");
      if (option) {
        EXPECT_NE(options.find("\n" + name + "\t"), std::string::npos) << command->path << name;
      }
      auto before = words;
      if (option) before.push_back(name);
      for (const auto choice : parameter.choices)
        EXPECT_NE(((option ? fish("", before) : all) + "\n").find("\n" + std::string(choice) + "\n"),
                  std::string::npos)
            << command->path << " " << name << " " << choice;
    }
  }
}

TEST_F(TabAnswers, LeaveFilesToTheShellWhereAnyMayStand) {
  EXPECT_EQ(zsh("", {"backup"}), "files");
  EXPECT_EQ(bash("--cabinet "), "files");
  const auto sheet = write("a sheet.eds", "");
  write("a picture.png", "");
  EXPECT_EQ(fish((folder() / "a").string(), {"-d"}), "words\n" + sheet);
  EXPECT_EQ(fish((folder() / "a").string(), {"backup"}),
            "words\n" + (folder() / "a picture.png").string() + "\n" + sheet);
  EXPECT_EQ(bash("--cabinet=" + folder().string() + "/a\\ s"), "words\n" + bash_text(sheet, 0));
}

TEST_F(TabAnswers, FindTheFamilyByWhatElseTheLineSays) {
  const auto cabinet = write("cabinet.toml",
                             "[bus.main]\nurl = \"can0\"\n[axis.feeder]\nbus = \"main\"\nnode = 3\nfamily = "
                             "\"gsd600\"\n[axis.lift]\nbus = \"main\"\nnode = 4\nfamily = \"ts\"\n");
  const auto knows = [&](const std::string& line) {
    return bash(line + " param get pn0214") == "words\nPn0214";
  };
  EXPECT_FALSE(knows(""));
  for (const auto* line :
       {"-d gsd600", "-dgsd600", "--drive=gsd600", "-d 'gsd600'", "-b sim:gsd600@1,ts@2 -n 1"})
    EXPECT_TRUE(knows(line)) << line;
  EXPECT_FALSE(knows("-b sim:gsd600@1,ts@2 -n 2"));
  EXPECT_FALSE(knows("-b sim:gsd600@1,ts@2")) << "either may be meant";
  EXPECT_TRUE(knows("--cabinet " + cabinet + " -n feeder"));
  EXPECT_TRUE(knows("--cabinet " + cabinet + " -b main -n 3"));
  EXPECT_FALSE(knows("--cabinet " + cabinet + " -n lift"));
  shell.defaults().cabinet = cabinet;
  EXPECT_EQ(bash("param get feeder pn0214"), "words\nPn0214");
  EXPECT_EQ(bash("jog lif"), "words\nlift");
  EXPECT_EQ(fish("lift,f", {"status", "-n"}), "words\nlift,feeder\taxis: main node 3, gsd600");
  EXPECT_EQ(fish("", {"-b", "main", "clone", "--from"}), "words\n3\tfeeder, gsd600\n4\tlift, ts");
  // As it was said with -d in an earlier line.
  show::KnownDrive known;
  known.family = "gsd600";
  known.time = "2026-01-01T00:00:00Z";
  known.identity.node = 7;
  ASSERT_TRUE(show::KnownDriveFile(folder(), "can0", 7).write(known));
  EXPECT_TRUE(knows("-b can0 -n 7"));
  EXPECT_FALSE(knows("-b can1 -n 7"));
}

TEST_F(TabAnswers, SayWhatMayStandWhereNoWordCanBeOffered) {
  EXPECT_EQ(bash("-d gsd600 param set Pn0214 "), "note 1..65535 Hz, default 600");
  EXPECT_EQ(fish("", {"read"}), "note -d FAMILY before it tells which names there are");
  EXPECT_EQ(fish("", {"move"}).substr(0, 13), "note target: ");
  EXPECT_EQ(fish("5", {"watch", "--for"}), "words\n5ms\n5s\n5min");
}

TEST_F(TabAnswers, OpenNoBusAndSurviveQuestionsThatAreNone) {
  for (const auto* line :
       {"-b local:x -n 1 -d gsd600 read ", "-b sim:gsd600@1 scan ", "--cabinet /none -n a ", "-d /none read ",
        "'", "\\", "-b", "--bus=", "-b sim:?", "-b sim:,", "-n , ", "-d '$(x)' param get P"})
    static_cast<void>(bash(line));
  EXPECT_EQ(shell.session(), nullptr);
  EXPECT_EQ(console.out_text + console.err_text, "");

  EXPECT_EQ(answer_tab(std::vector<std::string>{}, shell), "");
  EXPECT_EQ(answer_tab(std::vector<std::string>{"bash"}, shell), "");
  EXPECT_EQ(answer_tab(std::vector<std::string>{"bash", "x", "y", "", ""}, shell), "");
  EXPECT_EQ(answer_tab(std::vector<std::string>{"ksh", ""}, shell), "");
}

TEST_F(TabAnswers, OfferNoNameThatLooksLikeAnOption) {
  write("--yes.eds", "");
  const auto before = fs::current_path();
  fs::current_path(folder());
  EXPECT_EQ(bash("-d --y").find("--yes.eds"), 6U);
  write("plain.eds", "");
  const auto offered = bash("-d ");
  EXPECT_NE((offered + "\n").find("\nplain.eds\n"), std::string::npos) << offered;
  EXPECT_EQ(offered.find("--yes.eds"), std::string::npos);
  fs::current_path(before);
}

TEST(BegunLine, IsReadAsTheShellReadsIt) {
  const auto last = [](std::string_view line, LineSyntax syntax) {
    return begun_line(line, {}, syntax).last;
  };
  EXPECT_EQ(last("a \"b\\c", LineSyntax::servoctl), "bc");
  EXPECT_EQ(last("a \"b\\c\\\"d", LineSyntax::bash), "b\\c\"d");
  EXPECT_EQ(last("'it\\'s", LineSyntax::fish), "it's");
  EXPECT_EQ(last("\"a`\\`", LineSyntax::fish), "a`\\`");
  EXPECT_EQ(last("a\\ b", LineSyntax::bash), "a b");
  EXPECT_EQ(last("#a", LineSyntax::zsh), "#a");
  EXPECT_EQ(last("a#b", LineSyntax::bash), "a#b");
  EXPECT_EQ(last("a '#b", LineSyntax::bash), "#b");
  EXPECT_TRUE(begun_line("a # b", {}, LineSyntax::bash).comment);
  EXPECT_FALSE(begun_line("a '# b", {}, LineSyntax::bash).comment);
  EXPECT_EQ(begun_line("a\r\nb").words, std::vector<std::string>{"a"});
}

TEST(BegunLine, TellsWhereTheWordOfAShellBegins) {
  const auto kept = [](std::string_view line) { return begun_line(line, kBreaks).kept; };
  EXPECT_EQ(kept("a b"), 0U);
  EXPECT_EQ(kept("a b=c"), 2U);
  EXPECT_EQ(kept("a b=c d"), 0U);
  EXPECT_EQ(kept("a b\\=c"), 0U);
  EXPECT_EQ(kept("a b:c@d"), 3U) << "bash keeps the sign before a host";
  EXPECT_EQ(kept("a 'b=c"), 0U);
  EXPECT_EQ(kept("a b='c=d"), 2U);
  EXPECT_EQ(kept("a b='c=d'"), 2U);
  EXPECT_EQ(kept("a 'b=c'd"), 0U);
  EXPECT_EQ(kept("a b=c "), 0U);
  EXPECT_EQ(begun_line("a b='c d").last, "b=c d");
  EXPECT_EQ(begun_line("a b='c d").quote, '\'');
  EXPECT_EQ(begun_line("a b='c d'").quote, '\0');
}

}  // namespace
}  // namespace servoctl::cli
