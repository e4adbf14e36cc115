// What `pdo save` writes, `pdo apply` puts back, into this drive and into another.
#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>

#include "base/file.hpp"
#include "cli/line_runner.hpp"
#include "cli/shell.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

class PdoFiles : public testing::Test {
 protected:
  PdoFiles() : folder_(fs::temp_directory_path() / ("servoctl-pdos-" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~PdoFiles() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Runs lines on one bus; gives what the last one printed.
  std::string run(const std::string& bus, const std::vector<std::string>& lines) {
    RecordingConsole console;
    Shell::Options options;
    options.drive_folders = {fs::path(source_dir()) / "eds"};
    options.clock = sim::SimBus::Clock::virtual_time;
    options.defaults.bus = bus;
    Shell shell(console, std::move(options));
    LineRunner runner(shell);
    for (const auto& line : lines) {
      console.out_text.clear();
      EXPECT_EQ(runner.run(line), 0) << line << "\n" << console.err_text;
    }
    return console.out_text;
  }

 private:
  fs::path folder_;
};

TEST_F(PdoFiles, BringAMappingIntoAnotherDrive) {
  for (const auto* name : {"a.toml", "a.json"}) {
    const auto file = path(name);
    const auto wanted =
        run("sim:gsd600@1",
            {"pdo preset pp -n 1 -d gsd600 -y", "pdo map TPDO3 statusword --type 7 -n 1 -d gsd600 -y",
             "pdo save " + file + " -n 1 -d gsd600", "pdo show -n 1 -d gsd600"});
    const auto there =
        run("sim:gsd600@1", {"pdo apply " + file + " -n 1 -d gsd600 -y", "pdo show -n 1 -d gsd600"});
    EXPECT_EQ(there, wanted);
    const auto other = run("sim:gsd600@9", {"pdo apply " + file + " -n 9 -d gsd600 -y",
                                            "pdo save " + path("b.toml") + " -n 9 -d gsd600 -y",
                                            "pdo save " + path("b.json") + " -n 9 -d gsd600 -y"});
    EXPECT_EQ(read_file(path("b" + fs::path(name).extension().string())).value(), read_file(file).value());
  }
}

TEST_F(PdoFiles, OfEveryPresetSuitTheirFamily) {
  const fs::path folders[] = {fs::path(source_dir()) / "eds"};
  std::size_t presets = 0;
  for (const auto& family : drive::find_families(folders)) {
    const auto rules = drive::load_rules(family);
    ASSERT_TRUE(rules);
    for (const auto& preset : rules->pdo.presets) {
      SCOPED_TRACE(family.name + " " + preset.name);
      ++presets;
      const auto tail = " -n 1 -d " + family.name + " -y";
      const auto bus = "sim:" + family.name + "@1";
      EXPECT_NE(run(bus, {"pdo preset " + preset.name + tail}).find("written, read back"), std::string::npos);
      EXPECT_NE(run(bus, {"pdo preset " + preset.name + tail, "pdo preset " + preset.name + tail})
                    .find("already as requested"),
                std::string::npos);
    }
  }
  EXPECT_GE(presets, 15U);
}

TEST_F(PdoFiles, MayBeABackup) {
  const auto file = path("backup.json");
  const auto wanted = run("sim:gsd600@1", {"pdo preset pt -n 1 -d gsd600 -y",
                                           "backup " + file + " -n 1 -d gsd600", "pdo show -n 1 -d gsd600"});
  EXPECT_EQ(run("sim:gsd600@1", {"pdo apply " + file + " -n 1 -d gsd600 -y", "pdo show -n 1 -d gsd600"}),
            wanted);
}

TEST_F(PdoFiles, SayOfAnAssignmentWhichPdosItHas) {
  const auto file = path("fixed.toml");
  const auto wanted = run("sim:sv2@1", {"pdo enable RPDO260 TPDO258 -n 1 -d sv2 -y",
                                        "pdo save " + file + " -n 1 -d sv2", "pdo show -n 1 -d sv2"});
  EXPECT_EQ(run("sim:sv2@1", {"pdo enable RPDO259 -n 1 -d sv2 -y", "pdo apply " + file + " -n 1 -d sv2 -y",
                              "pdo show -n 1 -d sv2"}),
            wanted);
}

TEST_F(PdoFiles, OfADcfCarryItsConfiguredValues) {
  const auto file = path("one.dcf");
  ASSERT_TRUE(write_file_atomically(
      file,
      "[DeviceComissioning]\nNodeID=5\n\n[MandatoryObjects]\nSupportedObjects=0\n\n"
      "[OptionalObjects]\nSupportedObjects=2\n1=0x1801\n2=0x1A01\n\n"
      "[1801]\nParameterName=TPDO2\nObjectType=0x9\nSubNumber=2\n\n"
      "[1801sub0]\nParameterName=n\nObjectType=0x7\nDataType=0x0005\nAccessType=ro\nDefaultValue=2\n\n"
      "[1801sub1]\nParameterName=COB-ID\nObjectType=0x7\nDataType=0x0007\nAccessType=rw\n"
      "DefaultValue=0x80000280\nParameterValue=0x40000285\n\n"
      "[1A01]\nParameterName=TPDO2 mapping\nObjectType=0x9\nSubNumber=2\n\n"
      "[1A01sub0]\nParameterName=n\nObjectType=0x7\nDataType=0x0005\nAccessType=rw\nParameterValue=1\n\n"
      "[1A01sub1]\nParameterName=o\nObjectType=0x7\nDataType=0x0007\nAccessType=rw\nParameterValue="
      "0x60640020\n"));
  const auto shown =
      run("sim:gsd600@9", {"pdo apply " + file + " -n 9 -d gsd600 -y", "pdo show -n 9 -d gsd600"});
  EXPECT_NE(shown.find("TPDO2  0x289 ($NODEID+0x280) valid"), std::string::npos) << shown;
  EXPECT_NE(shown.find("32 of 64 bits: Position actual value (32)"), std::string::npos) << shown;
}

}  // namespace
}  // namespace servoctl::cli
