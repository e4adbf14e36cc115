// The inhibit time of a TPDO changes only while the PDO is invalid (CiA 301, 7.5.2.37): every way by which it
// alone is set makes the PDO invalid and valid again.
#include "axis_lines.hpp"

namespace servoctl::cli {
namespace {

class InhibitTimeAlone : public AxisLines {
 protected:
  /// The word in the column `hex` of a read.
  std::string read(std::string_view object, std::string_view place) {
    EXPECT_EQ(run(fmt::format("read {} {} --json", object, place)), 0) << all();
    const auto at = console.out_text.find("\"bytes\":\"");
    return at == std::string::npos
               ? ""
               : console.out_text.substr(at + 9, console.out_text.find('"', at + 9) - at - 9);
  }
  void begin() {
    shell.reset();
    Shell::Options options;
    options.drive_folders = {fs::path(source_dir()) / "eds"};
    options.clock = sim::SimBus::Clock::virtual_time;
    shell = std::make_unique<Shell>(console, options);
    shell->stay_open(true);
  }
};

TEST_F(InhibitTimeAlone, IsAppliedByACabinet) {
  for (const auto* family : {"cia402", "gsd600", "da200"}) {
    begin();
    shell->defaults().cabinet = folder / "cabinet.toml";
    write(fmt::format(
        "[bus.main]\nurl = \"sim:{0}@1\"\n[axis.lift]\nbus = \"main\"\nnode = 1\nfamily = \"{0}\"\n"
        "parameters = {{ \"0x1800:3\" = 250 }}\n",
        family));
    const auto place = fmt::format("-n 1 -b sim:{}@1", family);
    const auto before = read("0x1800:1", place);
    ASSERT_EQ(run("cabinet apply --yes"), 0) << family << all();
    EXPECT_EQ(read("0x1800:3", place), "FA 00") << family;
    EXPECT_EQ(read("0x1800:1", place), before) << family;
  }
}

TEST_F(InhibitTimeAlone, IsInTheLinesOfWhatHasChanged) {
  for (const auto* family : {"gsd600", "da200"}) {
    begin();
    const auto place = fmt::format("-n 1 -d {0} -b sim:{0}@1", family);
    const auto file = (folder / "changed.servoctl").string();
    const auto before = read("0x1800:1", place);
    for (const auto* line : {"pdo disable TPDO1", "write 0x1800:3 250", "pdo enable TPDO1"})
      ASSERT_EQ(run(fmt::format("{} --yes {}", line, place)), 0) << family << all();
    ASSERT_EQ(run(fmt::format("backup {} --only changed --yes {}", file, place)), 0) << all();
    begin();
    ASSERT_NE(read("0x1800:3", place), "FA 00");
    ASSERT_EQ(run(fmt::format("run {} --yes {}", file, place)), 0) << family << content(file) << all();
    EXPECT_EQ(read("0x1800:3", place), "FA 00") << family;
    EXPECT_EQ(read("0x1800:1", place), before) << family;
  }
}

TEST_F(InhibitTimeAlone, IsInTheLinesOfADifference) {
  begin();
  constexpr const char* kPlace = "-n 1 -d gsd600 -b sim:gsd600@1";
  const auto wanted = (folder / "wanted.servoctl").string();
  std::ofstream(wanted) << "drive gsd600\nuse 1\nwrite 0x1800:3 250\n";
  const auto before = read("0x1800:1", kPlace);
  EXPECT_EQ(run(fmt::format("diff node:1 {} --batch {}", wanted, kPlace)), 1) << all();
  const auto lines = (folder / "lines.servoctl").string();
  std::ofstream(lines) << console.out_text;
  ASSERT_EQ(run(fmt::format("run {} --yes {}", lines, kPlace)), 0) << content(lines) << all();
  EXPECT_EQ(read("0x1800:3", kPlace), "FA 00");
  EXPECT_EQ(read("0x1800:1", kPlace), before);
}

}  // namespace
}  // namespace servoctl::cli
