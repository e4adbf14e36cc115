// What a prompt tells of a family that the drive is not, and how often.
#include "tests/cli/wrong_family_fixture.hpp"

namespace servoctl::cli {
namespace {

class WrongFamilyPrompt : public testing::Test {
 protected:
  WrongFamilyPrompt() : shell_(console, options()) {}
  static Shell::Options options() {
    Shell::Options o;
    o.drive_folders = {fs::path(source_dir()) / "eds"};
    o.clock = sim::SimBus::Clock::virtual_time;
    o.defaults.bus = "sim:da200@1,gsd600@2,dm@3,ts@4";
    return o;
  }
  int run(std::string_view line) {
    console.out_text.clear();
    console.err_text.clear();
    return shell_.run(split_words(line).value());
  }
  bool told(std::string_view text) const { return console.err_text.find(text) != std::string::npos; }
  RecordingConsole console;
  Shell shell_;
};

TEST_F(WrongFamilyPrompt, TellsOnceASession) {
  EXPECT_EQ(run("write 0x6060 1 -n 4 -d cia402"), 0);
  EXPECT_TRUE(told("nothing proves that it is a cia402"));
  EXPECT_EQ(run("write 0x6060 3 -n 4 -d cia402"), 0);
  EXPECT_FALSE(told("proves")) << console.err_text;
  EXPECT_EQ(run("nmt reset -n 4 --yes --wait"), 0);
  EXPECT_EQ(run("write 0x6060 3 -n 4 -d cia402"), 0);
  EXPECT_TRUE(told("nothing proves that it is a cia402")) << "another may stand there after a restart";
}

TEST_F(WrongFamilyPrompt, TellsAReadWhatIsKnown) {
  EXPECT_EQ(run("read 0x6041 -n 1 -d gsd600"), 0);
  EXPECT_FALSE(told("is no"));
  EXPECT_EQ(run("write 0x6060 1 -n 1 -d gsd600"), 8);
  EXPECT_EQ(run("read 0x6041 -n 1 -d gsd600"), 0);
  EXPECT_TRUE(told("notice: node 1: not a gsd600")) << console.err_text;
  EXPECT_EQ(run("disable -n 1 -d gsd600"), 0) << console.err_text;
}

TEST_F(WrongFamilyPrompt, RefusesAllWhenOneOfSeveralIsAnother) {
  EXPECT_EQ(run("write 0x6060 3 -n 2,3 -d gsd600"), 8);
  EXPECT_TRUE(told("node 3: not a gsd600")) << console.err_text;
  EXPECT_EQ(run("read 0x6060 -n 2 --json"), 0);
  EXPECT_EQ(console.out_text.find("\"value\":3"), std::string::npos) << console.out_text;
  EXPECT_EQ(run("clone --from 2 --to 3 -d gsd600 --yes"), 8);
  EXPECT_EQ(run("diff node:2 node:3 -d gsd600"), 8);
}

TEST_F(WrongFamilyPrompt, TellsThatANodeWhichIsNotThereDoesNotAnswer) {
  EXPECT_EQ(run("write 0x6060 1 -n 9 -d gsd600"), 4);
  EXPECT_EQ(run("backup nothing.json -n 9 -d gsd600"), 4);
  EXPECT_EQ(run("write 0x6060 1 -n 2,9 -d gsd600"), 4);
  EXPECT_TRUE(told("node 9 did not answer")) << console.err_text;
}

}  // namespace
}  // namespace servoctl::cli
