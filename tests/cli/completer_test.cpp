// What Tab offers, with what it says beside it.
#include "cli/terminal/completer.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "cli/line_runner.hpp"
#include "cli/shell.hpp"
#include "cli/terminal/prompt_words.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

class Completing : public testing::Test {
 protected:
  Completing() : shell(console, options()) {}
  static Shell::Options options() {
    Shell::Options out;
    out.drive_folders = {fs::path(source_dir()) / "eds"};
    out.clock = sim::SimBus::Clock::virtual_time;
    out.defaults.bus = "sim:gsd600@1,gsd600@5";
    out.defaults.drive = "gsd600";
    out.defaults.nodes = "1";
    return out;
  }
  /// The hint beside the word; "(none)" where it is not offered.
  std::string hint(std::string_view line, std::string_view word) {
    for (const auto& one : complete(line, shell).candidates)
      if (one.word == word) return one.hint;
    return "(none)";
  }
  bool offers_word(std::string_view line, std::string_view word) { return hint(line, word) != "(none)"; }
  RecordingConsole console;
  Shell shell;
};

TEST_F(Completing, SaysBesideAWordWhatItIs) {
  EXPECT_EQ(hint("read statusw", "statusword"), "0x6041");
  EXPECT_EQ(hint("read 0x604", "0x6041"), "Statusword");
  EXPECT_EQ(hint("param get Pn021", "Pn0214"), "Speed loop gain 1");
  shell.defaults().chinese = true;
  EXPECT_EQ(hint("param get Pn021", "Pn0214"), "速度环增益 1");
  EXPECT_EQ(hint("param get 速度环增", "速度环增益\\ 1"), "Pn0214");
  EXPECT_EQ(hint("param set 免调整", "免调整刚性等级"), "Pn0271");
  EXPECT_EQ(hint("read 状态", "状态字"), "0x6041");
  EXPECT_EQ(hint("read ", "状态字"), "(none)") << "only for who begins so";
  EXPECT_EQ(hint("param list 增", "增益"), "参数组");
  EXPECT_EQ(hint("param ", "search"), "按词查找面板参数，中文或英文");
  shell.defaults().chinese = false;
  EXPECT_EQ(hint("param ", "search"), "Find panel parameters by words, in English or Chinese");
  EXPECT_TRUE(hint("read --ty", "--type").starts_with("data type")) << hint("read --ty", "--type");
  EXPECT_EQ(hint("un", "undo"), "Put back what the last `param set` or `write` replaced");
  EXPECT_TRUE(offers_word("un", "undo"));
  EXPECT_TRUE(offers_word("help un", "undo"));
  EXPECT_EQ(hint("help un", "undo"), hint("un", "undo"));
}

TEST_F(Completing, OffersWhatAValueMayBe) {
  EXPECT_TRUE(offers_word("mode ", "pv"));
  EXPECT_TRUE(offers_word("mode 3", "3"));
  EXPECT_TRUE(offers_word("home 3", "35"));
  EXPECT_EQ(hint("param set Pn0000 ", "0"), "Position mode");
  EXPECT_EQ(hint("param set Pn0000 Posi", "Position\\ mode"), "0 Position mode");
  EXPECT_EQ(hint("mode ", "pv"), "3 Profile velocity (pv)");
  EXPECT_EQ(hint("param set Pn0000 0", "0"), "Position mode");
  EXPECT_TRUE(offers_word("param set Pn0000=", "Pn0000=0"));
  EXPECT_TRUE(offers_word("param set Pn0000=1 Pn021", "Pn0214"));
  EXPECT_TRUE(offers_word("write modes_of_operation 3", "3"));
  EXPECT_NE(complete("param set Pn0214 ", shell).note.find("Hz"), std::string::npos);
  EXPECT_TRUE(complete("param set Pn0214 ", shell).candidates.empty());
  EXPECT_TRUE(offers_word("param set Pn0214 40", "40Hz"));
}

TEST_F(Completing, OffersTheWordsOfNamesThatAreExplained) {
  EXPECT_TRUE(offers_word("explain COMM", "COMM1/COMM2"));
  EXPECT_TRUE(offers_word("explain statusw", "statusword"));
  EXPECT_TRUE(offers_word("explain homing m", "method"));
  EXPECT_TRUE(offers_word("explain homing method ", "17"));
  EXPECT_TRUE(offers_word("explain AL s", "status"));
  EXPECT_TRUE(offers_word("explain exit ", "codes"));
  EXPECT_FALSE(offers_word("explain CN", "CN3")) << "it is of another family";
}

TEST_F(Completing, OffersEachMethodByItsNumberThoughSeveralHaveOneName) {
  for (const bool chinese : {false, true}) {
    shell.defaults().chinese = chinese;
    const auto methods = complete("home ", shell).candidates;
    for (const auto* number : {"1", "4", "5", "6", "35"})
      EXPECT_TRUE(std::any_of(methods.begin(), methods.end(), [&](const Candidate& one) {
        return one.word == number && !one.hint.empty();
      })) << number;
  }
}

TEST_F(Completing, TakesTheFamilyOfANodeFromTheCabinetFileAsTheLineDoes) {
  const auto file = fs::temp_directory_path() / ("family-" + std::to_string(::getpid()) + ".toml");
  std::ofstream(file)
      << "[bus.main]\nurl = \"sim:gsd600@1\"\n[axis.lift]\nbus = \"main\"\nnode = 1\nfamily = "
         "\"gsd600\"\n";
  shell.defaults().cabinet = file.string();
  shell.defaults().drive = "dm";
  shell.defaults().bus = "main";
  EXPECT_TRUE(offers_word("param get Pn021", "Pn0214"));
  EXPECT_EQ(prompt_text(shell).text, "servoctl main node 1 gsd600> ");
  EXPECT_EQ(LineRunner(shell).run("drive dm"), 2);
  EXPECT_NE(console.err_text.find("1 is gsd600 by the cabinet file, not dm"), std::string::npos)
      << console.err_text;
  fs::remove(file);
}

TEST_F(Completing, LooksInsideNamesWhereNoneBeginsSo) {
  EXPECT_EQ(hint("param get gain", "Pn0214"), "Speed loop gain 1");
  EXPECT_EQ(hint("param set LOOP", "Pn0214"), "Speed loop gain 1");
  EXPECT_TRUE(complete("param get gain", shell).inside);
  EXPECT_TRUE(offers_word("read actual_v", "position_actual_value"));
  EXPECT_FALSE(complete("read statusw", shell).inside);
  EXPECT_FALSE(offers_word("param get g", "Pn0214")) << "one letter is in too many";
  EXPECT_TRUE(complete("gain", shell).candidates.empty()) << "no command";
  shell.defaults().chinese = true;
  EXPECT_EQ(hint("param get 环增益", "Pn0214"), "速度环增益 1");
}

TEST_F(Completing, OffersParametersWhereNoCommandBeginsSo) {
  EXPECT_EQ(hint("Pn021", "Pn0214"), "Speed loop gain 1");
  EXPECT_TRUE(offers_word("Pn0214=40", "Pn0214=40Hz"));
  EXPECT_FALSE(offers_word("p", "Pn0214")) << "commands begin so";
}

TEST_F(Completing, OffersUnitsBehindANumber) {
  EXPECT_TRUE(offers_word("jog 60", "60rpm"));
  EXPECT_TRUE(offers_word("move 1.5", "1.5rev"));
  EXPECT_TRUE(offers_word("move -90", "-90deg"));
  EXPECT_TRUE(offers_word("torque 5", "5%"));
}

TEST_F(Completing, SaysWhichUnitsNeedTheCountsOfATurn) {
  EXPECT_EQ(complete("move 90", shell).candidates.front().word, "90inc");
  EXPECT_EQ(hint("move 90", "90deg"), "needs --turn, or `units learn` before");
  EXPECT_EQ(complete("jog 60", shell).candidates.front().word, "60inc/s");
  EXPECT_EQ(hint("move --turn 131072 90", "90deg"), "");
  EXPECT_FALSE(offers_word("move --turn 131072 90", "90inc"));
  EXPECT_EQ(hint("move -d ts 90", "90deg"), "needs --turn");
  EXPECT_EQ(hint("jog -d ts 60", "60rpm"), "") << "it counts in rpm by itself";
  EXPECT_EQ(hint("move -d sv2 90", "90deg"), "") << "the drive tells it";
}

TEST_F(Completing, OffersForAPdoWhatGoesIntoIt) {
  EXPECT_TRUE(offers_word("pdo map RPDO1 ", "controlword"));
  EXPECT_FALSE(offers_word("pdo map RPDO1 ", "statusword")) << "it is sent";
  EXPECT_TRUE(offers_word("pdo map tpdo2 0x6064 statu", "statusword"));
  EXPECT_TRUE(offers_word("pdo map TPDO1 0x604", "0x6041"));
  EXPECT_FALSE(offers_word("pdo map TPDO1 0x100", "0x1005"));
  EXPECT_FALSE(offers_word("pdo map TPDO1 Pn", "Pn0214")) << "a panel parameter is set by SDO";
  EXPECT_TRUE(offers_word("read 0x100", "0x1005"));
}

TEST_F(Completing, OffersThePresetsOfTheFamily) {
  EXPECT_TRUE(offers_word("pdo preset ", "lmc058"));
  EXPECT_FALSE(offers_word("pdo preset ", "csp"));
  EXPECT_TRUE(offers_word("pdo preset -d sv2 ", "csp"));
  EXPECT_TRUE(offers_word("pdo preset -d ts t", "tpdo"));
}

TEST_F(Completing, GoesOnWithAnAddressInTheFormThatWasBegun) {
  EXPECT_EQ(hint("read 6099h.", "6099h.1"), hint("read 0x6099:", "0x6099:1"));
  EXPECT_TRUE(offers_word("read 6099", "6099h.2"));
  EXPECT_TRUE(offers_word("read 604", "6041h"));
  EXPECT_TRUE(offers_word("read 2005h.2", "2005h.20h"));
  EXPECT_TRUE(offers_word("write 60ffh", "60FFh"));
  EXPECT_FALSE(offers_word("read 0x6099:", "6099h.1"));
  EXPECT_FALSE(offers_word("read 6099h.", "0x6099:1"));
}

TEST_F(Completing, LeavesOutWhatTheManualReserves) {
  EXPECT_TRUE(offers_word("param set Pn0000=", "Pn0000=5"));
  EXPECT_FALSE(offers_word("param set Pn0000=", "Pn0000=6"));
  EXPECT_FALSE(offers_word("param set Pn0000 6", "6"));
  EXPECT_FALSE(offers_word("param set Pn0000 Res", "Reserved"));
  EXPECT_FALSE(offers_word("mode -d dm ", "0"));
}

TEST_F(Completing, OffersNodesThatWereHeardAndGoesOnInAList) {
  EXPECT_TRUE(offers_word("use ", "1"));
  EXPECT_FALSE(offers_word("use ", "5"));
  ASSERT_EQ(shell.run({"nmt", "reset", "-n", "1,5", "--wait", "--yes"}), 0) << console.err_text;
  EXPECT_TRUE(offers_word("use ", "5"));
  EXPECT_EQ(hint("use ", "5"), "pre-operational");
  EXPECT_TRUE(offers_word("status -n 1,", "1,5"));
}

TEST_F(Completing, MakesNoAxisOfAnotherWhoseNameDiffersInTheCaseOfLetters) {
  const auto file = fs::temp_directory_path() / ("alike-" + std::to_string(::getpid()) + ".toml");
  std::ofstream(file) << "[bus.main]\nurl = \"sim:gsd600@1,gsd600@2\"\n[axis.Lift]\nnode = 1\nfamily = "
                         "\"gsd600\"\n[axis.lift]\nnode = 2\nfamily = \"gsd600\"\n";
  shell.defaults().cabinet = file.string();
  for (const auto* name : {"Lif", "lif"}) {
    const auto offer = complete(std::string("status ") + name, shell);
    ASSERT_EQ(offer.candidates.size(), 1U) << name;
    EXPECT_EQ(offer.candidates.front().word, std::string(name) + "t");
  }
  fs::remove(file);
}

TEST_F(Completing, OffersNothingInAComment) {
  EXPECT_TRUE(offers_word("read statusw", "statusword"));
  EXPECT_TRUE(complete("# read statusw", shell).candidates.empty());
  EXPECT_TRUE(complete("read 0x6041 # read statusw", shell).candidates.empty());
}

TEST_F(Completing, OpensNoDeviceAndNoPipe) {
  const auto pipe = fs::temp_directory_path() / ("pipe-" + std::to_string(::getpid()));
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  // Open at both ends, it would be read, and what is in it would be gone.
  const int fd = ::open(pipe.c_str(), O_RDWR | O_NONBLOCK);
  ASSERT_EQ(::write(fd, "mine", 4), 4);
  for (const auto* before : {"--cabinet ", "-d "})
    static_cast<void>(complete(before + pipe.string() + " param get x", shell));
  char kept[8] = {};
  EXPECT_EQ(::read(fd, kept, sizeof kept), 4);
  ::close(fd);
  fs::remove(pipe);
}

TEST_F(Completing, TakesAnEmptyWordForNoOption) {
  EXPECT_EQ(hint("param get '' zh Pn021", "Pn0214"), "Speed loop gain 1") << "'' is not --lang";
}

TEST_F(Completing, PutsABackslashBeforeWhatWouldEndAWordAndReadsQuotes) {
  const auto folder = fs::temp_directory_path() / ("completing " + std::to_string(::getpid()));
  fs::create_directories(folder / "a folder");
  std::ofstream(folder / "速度 1.json") << "{}";
  const auto begun = fs::temp_directory_path().string() + "/completing\\ " + std::to_string(::getpid()) + "/";
  EXPECT_TRUE(offers_word("diff " + begun, begun + "a\\ folder/"));
  EXPECT_TRUE(offers_word("diff " + begun + "速", begun + "速度\\ 1.json"));
  EXPECT_TRUE(offers_word("diff '" + folder.string() + "/速", begun + "速度\\ 1.json"));
  fs::remove_all(folder);
  EXPECT_TRUE(offers_word("param get '速度 环' Pn021", "Pn0214"));
  EXPECT_EQ(complete("param get 速度 Pn021", shell).typed, 5U);
}

TEST_F(Completing, OffersEachOfFiveThousandObjects) {
  const auto file = fs::temp_directory_path() / ("many-" + std::to_string(::getpid()) + ".eds");
  std::ofstream out(file);
  out << "[DeviceInfo]\nVendorName=x\n[ManufacturerObjects]\nSupportedObjects=5000\n";
  for (int i = 0; i < 5000; ++i) out << i + 1 << "=0x" << std::hex << 0x2000 + i << std::dec << "\n";
  for (int i = 0; i < 5000; ++i)
    out << "[" << std::hex << 0x2000 + i << std::dec << "]\nParameterName=Object number " << i
        << "\nObjectType=0x7\nDataType=0x0007\nAccessType=rw\nPDOMapping=0\n";
  out.close();
  shell.defaults().drive = file.string();
  EXPECT_EQ(complete("read object_number_", shell).candidates.size(), 5000U);
  EXPECT_GE(complete("read ", shell).candidates.size(), 5000U);
  fs::remove(file);
}

}  // namespace
}  // namespace servoctl::cli
